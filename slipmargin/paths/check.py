"""Audit of anybody's trajectory: which wheel uses how much of its grip, and how much slower is safe.

Only t, x, y, φ are needed; sampling may be irregular.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numba import njit

from slipmargin.checks import Array, frozen, measurable, real
from slipmargin.errors import InputError
from slipmargin.limits.motion_external import tipping
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.paths.trajectory import LEAST_SAMPLES
from slipmargin.physics.frames import rotate_rows

#: Half the shortest window of a derivative [s]: below it rounded files make noise of accelerations.
SHORTEST = 0.005
#: Longest window of a derivative, as a share of the motion [1]: a window averages away what is shorter than
#: it, and a motion may speed up, drive and brake in less than a third of its time each.
LONGEST = 0.1
#: Largest ratio of two neighbouring steps [1]: its square is what is left of the digits of an acceleration.
MOST_UNEVEN = 1e7
#: Slowest time scaling tried [1].
SLOWEST = 1e4
#: A share this far above the limit is at it [1]: the four digits that are printed are the limit's.
AT_LIMIT = 5e-5


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Check:
    """What a trajectory asks of the wheels at its T samples.

    ``use`` (T, N) and ``torque`` (T, N) shares of each wheel's grip and motor torque, ``speed`` (T, N) share
    of its top speed; ``tipping`` (T, N) share of its load at constant speed that a wheel loses (it lifts at
    1).
    ``worst`` is (time, x, y, wheel index).
    ``time_scale_needed``: stretch time by this factor and every share is within ``share``; 1 where it already
    is, infinite where no slowing down helps.  ``smooth_s`` is the window of the derivatives [s], and
    ``unsmoothed`` the check without one where its verdict is another (else None).
    """

    t_s: Array
    velocity: Array
    acceleration: Array
    omega: Array
    use: Array
    torque: Array
    speed: Array
    load_N: Array
    tipping: Array
    max_use: float
    worst: tuple[float, float, float, int]
    share: float
    time_scale_needed: float
    smooth_s: float
    unsmoothed: Check | None

    def states(self, pose: Array) -> Motion:
        """The samples, at poses (T, 3), as states."""
        return _states(self.t_s, pose, self.velocity, self.acceleration)

    @property
    def admissible(self) -> bool:
        """Whether grip, motors' torque and tipping keep the share, and wheels their top speed."""
        return self.time_scale_needed <= 1.0


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Course:
    """Samples of pose, velocity and acceleration in the floor frame, each (M, 3)."""

    t_s: Array
    pose: Array
    velocity: Array
    acceleration: Array


def check(
    model: Model,
    t_s: Array,
    pose: Array,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    smooth_s: float = 0.0,
) -> Check:
    """Audit a trajectory.

    Parameters
    ----------
    t_s : (T,)
        Time [s], strictly increasing, at least 6 samples; sampling may be irregular.
    pose : (T, 3)
        x [m], y [m], φ [rad]; φ may jump by whole turns.
    share : float
        λ: the share of the grip, of the motors' torque and of what lifts a wheel that may be used.
    smooth_s : float
        Window [s] over which derivatives are fitted: 0 for a planned trajectory, more for a measured one, at
        most a tenth of the motion.

    Raises
    ------
    InputError
        Too few samples, times that do not increase, a value that is not finite, a window that is too long.
    """
    t_s, pose = _samples(t_s, pose)
    share = real("margin", share, above=0.0, high=1.0, cure="give a slip margin from 0 to below 1")
    smooth_s = real("smooth_s", smooth_s, low=0.0, cure="give a window [s], 0 for none")
    longest = LONGEST * float(t_s[-1] - t_s[0])
    if smooth_s > longest * (1.0 + 1e-6):
        raise InputError(
            "smooth_s",
            f"is {smooth_s:g} s, which averages accelerations of a motion of {t_s[-1] - t_s[0]:.4g} s away",
            f"give a window up to a tenth of the motion, {longest:.7g} s",
        )
    found = _checked(model, t_s, pose, share, contact, smooth_s)
    if smooth_s == 0.0:
        return found
    bare = _checked(model, t_s, pose, share, contact, 0.0)
    return found if bare.admissible == found.admissible else replace(found, unsmoothed=bare)


def _checked(model: Model, t_s: Array, pose: Array, share: float, contact: Contact, smooth_s: float) -> Check:
    """The check of samples in order, with one window."""
    course = _Course(t_s, pose, *derivatives(t_s, pose, smooth_s))
    use, torque, speed, load, lost = _shares(model, course, contact, 1.0)
    i, k = np.unravel_index(int(np.argmax(use)), use.shape)
    return Check(
        t_s=t_s,
        velocity=course.velocity,
        acceleration=course.acceleration,
        omega=model.geometry.wheel_speeds(rotate_rows(pose[:, 2], course.velocity, inverse=True)),
        use=use,
        torque=torque,
        speed=speed,
        load_N=load,
        tipping=lost,
        max_use=float(np.max(use)),
        worst=(float(t_s[i]), float(pose[i, 0]), float(pose[i, 1]), int(k)),
        share=share,
        time_scale_needed=_time_scale(model, course, share, contact),
        smooth_s=smooth_s,
        unsmoothed=None,
    )


def widened(t_s: Array, smooth_s: float) -> bool:
    """Whether smoothing over ``smooth_s`` takes more into any window than no smoothing does."""
    half = 0.5 * smooth_s
    return half > SHORTEST and bool(np.any(t_s[2:] - t_s[:-2] <= half))


def derivatives(t_s: Array, pose: Array, smooth_s: float = 0.0) -> tuple[Array, Array]:
    """Velocity and acceleration (T, 3) by a parabola fitted round every sample.

    The window holds the two neighbours and everything within ``smooth_s``/2 (at least 5 ms).  The
    acceleration is then an average of the true one with weights that are never negative, so a jump in
    acceleration is blurred but not overshot, as an interpolating spline would.

    A velocity that turns round between an end and the sample beside it is none: a parabola to one side of a
    robot at rest overshoots a little, and the drag of its rollers would turn round with it.
    """
    velocity, acceleration = np.empty_like(pose), np.empty_like(pose)
    _parabolas(t_s, pose, max(0.5 * smooth_s, SHORTEST), velocity, acceleration)
    for end, beside in ((0, 1), (-1, -2)):
        velocity[end, velocity[end] * velocity[beside] < 0.0] = 0.0
    return velocity, acceleration


@njit(cache=True)
def _parabolas(t: Array, pose: Array, half: float, velocity: Array, acceleration: Array) -> None:
    """Least-squares parabolas in τ = (t − t_i)/width; the three unknowns by Cramer's rule."""
    count, low, high = len(t), 0, 0
    for i in range(count):
        while t[i] - t[low] > half:
            low += 1
        while high < count - 1 and t[high + 1] - t[i] <= half:
            high += 1
        a = max(min(low, i - 1, count - 3), 0)
        b = min(max(high, i + 1, 2), count - 1)
        width = max(t[b] - t[i], t[i] - t[a])
        m0, m1, m2, m3, m4 = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(a, b + 1):
            x = (t[k] - t[i]) / width
            m0, m1, m2, m3, m4 = m0 + 1.0, m1 + x, m2 + x * x, m3 + x**3, m4 + x**4
        c00, c01, c02 = m2 * m4 - m3 * m3, m2 * m3 - m1 * m4, m1 * m3 - m2 * m2
        c11, c12, c22 = m0 * m4 - m2 * m2, m1 * m2 - m0 * m3, m0 * m2 - m1 * m1
        det = m0 * c00 + m1 * c01 + m2 * c02
        for j in range(3):
            s0, s1, s2 = 0.0, 0.0, 0.0
            for k in range(a, b + 1):
                x, y = (t[k] - t[i]) / width, pose[k, j] - pose[i, j]
                s0, s1, s2 = s0 + y, s1 + x * y, s2 + x * x * y
            velocity[i, j] = (c01 * s0 + c11 * s1 + c12 * s2) / det / width
            acceleration[i, j] = 2.0 * (c02 * s0 + c12 * s1 + c22 * s2) / det / width**2


def _samples(t_s: Array, pose: Array) -> tuple[Array, Array]:
    t_s = measurable("t_s", frozen("t_s", t_s, (None,)))
    pose = measurable("pose", frozen("pose", pose, (len(t_s), 3))).copy()
    if len(t_s) < LEAST_SAMPLES:
        raise InputError(
            "t_s",
            f"{len(t_s)} samples are too few for accelerations",
            f"give at least {LEAST_SAMPLES} rows",
        )
    step = np.diff(t_s)
    if np.min(step) <= 0.0:
        row = int(np.argmax(step <= 0.0)) + 2
        raise InputError(
            f"row {row}",
            f"is at {t_s[row - 1]:g} s, not after {t_s[row - 2]:g} s",
            "time must increase from row to row",
        )
    uneven = np.maximum(step[1:] / step[:-1], step[:-1] / step[1:])
    if np.max(uneven) > MOST_UNEVEN:
        row = int(np.argmax(uneven)) + 2
        raise InputError(
            f"row {row}",
            f"is {step[row - 2]:g} s after the row before and {step[row - 1]:g} s before the next",
            "give samples at similar steps",
        )
    pose[:, 2] = np.unwrap(pose[:, 2])
    return t_s, pose


def _shares(
    model: Model, course: _Course, contact: Contact, stretch: float
) -> tuple[Array, Array, Array, Array, Array]:
    """Use, torque and speed shares, loads and tipping (M, N) with time stretched."""
    motion = _states(course.t_s, course.pose, course.velocity, course.acceleration, stretch)
    forces = realised(model, motion, contact=contact)
    omega = model.geometry.wheel_speeds(motion.velocity)
    torque = torque_use(model, forces.torque_N_m, omega)
    top = model.drives.max_speed_rad_s or np.inf
    return forces.use, torque, np.abs(omega) / top, forces.load_N, tipping(model, motion, forces.load_N)


def _states(t_s: Array, pose: Array, velocity: Array, acceleration: Array, stretch: float = 1.0) -> Motion:
    """Floor-frame samples (M, 3) as states, with time stretched."""
    phi = pose[:, 2]
    return Motion(
        velocity=rotate_rows(phi, velocity, inverse=True) / stretch,
        heading=phi,
        position=pose[:, :2],
        acceleration=rotate_rows(phi, acceleration, inverse=True) / stretch**2,
        time_s=(t_s - t_s[0]) * stretch,
    )


def _time_scale(model: Model, course: _Course, share: float, contact: Contact) -> float:
    """Smallest stretch ≥ 1 that makes everything admissible: bracket, then bisection to 1e-6.

    Slower is not always safer sample by sample (less braking means less help from drag is needed, never
    more), but where constant speed itself needs too much grip, at a quarter of the speed still, none helps
    before drag fades: infinite.
    """

    def fits(stretch: float, within: float = 1e-6) -> bool:
        use, torque, speed, load, lost = _shares(model, course, contact, stretch)
        return bool(
            np.max(use) <= share + within
            and np.max(torque) <= share + within
            and np.max(lost) <= share + within
            and np.max(speed) <= 1.0 + within
            and np.min(load) >= 0.0
        )

    if fits(1.0, AT_LIMIT):
        return 1.0
    low = high = 1.0
    while not fits(high):
        low, high = high, 1.25 * high
        if high > SLOWEST or (low <= 4.0 < high and _coasting(model, course, high, contact) > share):
            return np.inf
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


def _coasting(model: Model, course: _Course, stretch: float, contact: Contact) -> float:
    """Largest share of a wheel's grip that the course needs without any acceleration, time stretched."""
    still = replace(course, acceleration=np.zeros_like(course.acceleration))
    return float(np.max(_shares(model, still, contact, stretch)[0]))
