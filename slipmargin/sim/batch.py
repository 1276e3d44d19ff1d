"""Many runs in one call: signals prepared once, models as packed rows, threads over runs."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen, real
from slipmargin.errors import InputError
from slipmargin.physics.frames import to_body, to_floor, velocity_at
from slipmargin.physics.grips import GripShape, drive_left
from slipmargin.sim import layout as at
from slipmargin.sim.cold import warm_up
from slipmargin.sim.lifting import LIFTED
from slipmargin.sim.motion import TASK, TOLD, TRACE, probed, run, workspace
from slipmargin.sim.pack import edges_of, wheels_of
from slipmargin.sim.play import taken_up
from slipmargin.sim.ramp import ramped
from slipmargin.sim.sensitivity import beside, grow, growing
from slipmargin.sim.signal import WheelSignal
from slipmargin.sim.threads import spread
from slipmargin.sim.wheels import begun, follow, in_straight_parts
from slipmargin.work import WHEEL_STEPS, raised

RTOL = 1e-6
#: Most steps of a run that others are told beside: they are kept, 30 MB a thread.
_KEPT = 100_000
#: A transverse force that leaves less of the drive grip than this share counts as leaving it.
_LEAST_LEFT = 1e-9


class Ending(IntEnum):
    """How a run ended; the text says what to change."""

    DONE = 0  #: it reached its last output time
    TIPS = 1  #: no three wheels carry the robot any more
    NOT_FINITE = 2  #: forces or velocities overflowed
    STUCK = 3  #: the step size fell to nothing
    TOO_LONG = 4  #: more steps than allowed
    JAMS = 5  #: a wheel lifted off, and no loads were found that agree with the acceleration


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Push:
    """A force through the vertical of the centre of mass, piecewise linear in time: floor frame [N, N, N m].

    ``t_s`` (Q,) ascending [s], Q ≥ 2, ``wrench`` (Q, 3); outside its rows the nearest end's value.  It
    acts ``height_m`` above the floor [m] and shifts the loads by its moment.
    """

    t_s: Array
    wrench: Array
    height_m: float = 0.0

    def __post_init__(self) -> None:
        t = frozen("push.t_s", self.t_s, (None,))
        if len(t) < 2 or np.min(np.diff(t)) <= 0.0:
            raise InputError("push.t_s", f"is {t[:5].tolist()}", "give two ascending times or more")
        object.__setattr__(self, "t_s", t)
        object.__setattr__(self, "wrench", frozen("push.wrench", self.wrench, (len(t), 3)))
        cure = "give a height above the floor [m]"
        object.__setattr__(self, "height_m", real("push.height_m", self.height_m, low=0.0, cure=cure))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """What R runs did; T is the longest run's number of output times (shorter runs repeat their last).

    ``pose`` (R, T, 3): x, y [m], φ [rad] of the body frame's origin in the floor frame; ``state``
    (R, T, 6): centre of mass in the floor frame, body-frame velocity of the centre of mass;
    ``ending`` (R,) :class:`Ending`; ``stopped_s`` (R,) time reached; ``steps`` (R, 2) taken, rejected;
    ``lifts_s`` (R,) time after which a wheel first hung in the air (NaN: none did), ``in_air_s`` (R, N) for
    how long each did, to a step of the integration.
    Where asked for: ``theta``, ``load`` (R, T, N), ``slip``, ``force`` (R, T, N, 2) [drive, transverse],
    ``coefficient`` and ``steepness`` (R, T, N, 2) μ [1] and k [s/m] that were in force at that instant,
    ``utilisation`` (R, T, N) |f_W| over what the coefficient and the transverse force left of it.
    Where other models were given: ``change`` (R, M, T, 3), what each adds to the pose, to first order.
    """

    pose: Array
    state: Array
    ending: NDArray[np.int64]
    stopped_s: Array
    steps: NDArray[np.int64]
    lifts_s: Array
    in_air_s: Array
    theta: Array | None = None
    slip: Array | None = None
    force: Array | None = None
    load: Array | None = None
    coefficient: Array | None = None
    steepness: Array | None = None
    utilisation: Array | None = None
    change: Array | None = None

    def lifted_s(self, r: int, first_s: float) -> float | None:
        """When a wheel of run ``r``, which began at ``first_s``, first hung in the air; None: none did."""
        after = float(self.lifts_s[r])
        return None if np.isnan(after) else first_s + after


@final
class Batch:
    """Wheel signals and output times, flattened once; :meth:`run` is what a fit calls over and over.

    Parameters
    ----------
    signals : sequence of WheelSignal
        One a run (S of them), all with the same number of wheels.
    times_s : sequence of arrays
        Output times of each signal, ascending, within its knots [s].
    commanded : bool
        True: the signals are commands, the model's transients act; False: they are what the wheels did.
    pushes : sequence of Push or None, optional
        External force of each signal.
    began_s : sequence of float, optional
        When the run of each signal began [s]: what depends on time counts from there, and so do the times of
        an :class:`Outcome`.  By default it is where the signal begins.
    """

    def __init__(
        self,
        signals: Sequence[WheelSignal],
        times_s: Sequence[Array],
        *,
        commanded: bool = False,
        pushes: Sequence[Push | None] | None = None,
        began_s: Sequence[float] | None = None,
    ) -> None:
        if not signals:
            raise InputError("signals", "there are none", "give at least one run")
        if len(times_s) != len(signals):
            raise InputError(
                "times_s",
                f"has {len(times_s)} runs, there are {len(signals)} signals",
                "give the output times of each run",
            )
        pushes = [None] * len(signals) if pushes is None else list(pushes)
        if len(pushes) != len(signals):
            raise InputError(
                "pushes",
                f"has {len(pushes)} runs, there are {len(signals)} signals",
                "give one push (or None) a run",
            )
        self.wheels = signals[0].wheels
        self.count = len(signals)
        self.commanded = commanded
        for s in signals:
            if s.wheels != self.wheels:
                raise InputError(
                    "signals", f"have {self.wheels} and {s.wheels} wheels", "give one robot's runs"
                )
        first = [float(s.knots_s[0]) for s in signals] if began_s is None else [float(t) for t in began_s]
        if len(first) != len(signals) or any(
            not t0 <= s.knots_s[0] for t0, s in zip(first, signals, strict=True)
        ):
            raise InputError(
                "began_s", "is not one time a signal, at its start or before", "give when each run began"
            )
        times = [_times(t, s) - t0 for t, s, t0 in zip(times_s, signals, first, strict=True)]
        self._given = [_given(s, t, p, t0) for s, t, p, t0 in zip(signals, times, pushes, first, strict=True)]
        self.longest = max(len(t) for t in times)
        self.lengths = np.array([len(t) for t in times])
        self._all = np.arange(self.count)

    def at_clock(self, clock: float, *, by_speed: bool = False) -> Batch:
        """The same signals on another clock: each stated time is ``clock`` times as long.

        Wheels turn as far as before, but for those known ``by_speed``, which turn as fast as before.
        """
        if clock == 1.0:
            return self
        other = copy.copy(self)
        stretch = clock ** -np.arange(5.0) * (clock if by_speed else 1.0)
        turned = 1.0 if by_speed else 1.0 / clock
        other._given = [
            (knots * clock, coef * stretch, spin * turned, push * [clock, 1.0, 1.0, 1.0, 1.0], times * clock)
            for knots, coef, spin, push, times in self._given
        ]
        return other

    def run(
        self,
        models: Array,
        start_pose: Array,
        *,
        start_twist: Array | None = None,
        which: NDArray[np.int64] | None = None,
        signal: NDArray[np.int64] | None = None,
        tell: bool = False,
        rtol: float = RTOL,
        atol: float | None = None,
        max_steps: float | None = None,
        held_down: float = LIFTED,
        others: Array | None = None,
    ) -> Outcome:
        """Simulate.

        Parameters
        ----------
        models : array (L,) or (M, L)
            One packed model or several: :mod:`slipmargin.sim.pack`, ``pack`` and ``stack``.
        start_pose : array (3,) or (R, 3)
            Pose of the body frame's origin at each run's first knot [m, m, rad].
        start_twist : array (3,) or (R, 3), optional
            Floor-frame velocity of the origin and yaw rate [m/s, m/s, rad/s]; rest by default.
        which, signal : integer arrays (R,), optional
            Run r moves model ``which[r]`` by signal ``signal[r]``; by default every signal with model 0.
        tell : bool
            Also return wheel angles, slip, forces, loads and grip utilisation.
        rtol, atol : float
            Error per step: rtol |state| + atol [m, rad, m/s, rad/s]; atol is rtol/100 by default.
        max_steps : float, optional
            Steps, taken or rejected, after which a run ends; by default what :mod:`slipmargin.work` allows.
        held_down : float
            A run ends where the floor would have to pull a wheel down by more than this [m g/N]; infinite:
            it goes on where the robot tips, and where it jams, there with the loads at rest until the
            signal's next knot.
        others : array (M, L), optional
            Packed models beside all of these (:meth:`beside`): what each changes is told to first order,
            in less time than a run of each takes.  A run that did not end as it should, or takes more than
            100 000 steps, says zero.

        Returns
        -------
        Outcome
        """
        warm_up()
        models = np.atleast_2d(models)
        n, longest = self.wheels, self.longest
        if int(models[0, at.COUNT]) != n:
            raise InputError(
                "wheels",
                f"the signals have {n}, the robot has {int(models[0, at.COUNT])}",
                "give a column for every wheel",
            )
        signal = self._all if signal is None else signal
        runs = len(signal)
        which = np.zeros(runs, dtype=np.int64) if which is None else which
        steps = raised(WHEEL_STEPS) / n if max_steps is None else max_steps
        steps = steps if others is None else min(steps, _KEPT)
        com = models[which, at.COM_X : at.COM_Y + 1]
        tasks = np.zeros((runs, TASK + n))
        tasks[:, :3] = start_pose
        tasks[:, 3:6] = 0.0 if start_twist is None else start_twist
        tasks[:, 6:TASK] = rtol, 0.01 * rtol if atol is None else atol, steps, held_down
        _to_centre(tasks, com)
        out = np.empty((runs, longest, 6 + TOLD * n if tell else 6))
        rows, most = self._acting(models), 0
        if others is not None:
            others, most = self._acting(others), int(steps)
            theirs = wheels_of(others)
            change = np.zeros((runs, len(others), longest, 3))

        def work(r: int) -> None:
            # Its own copy of the wheels: those that wobble are turned where they stand.
            row, (knots, coef, spin, push, times) = rows[which[r]].copy(), self._given[signal[r]]
            count = self.lengths[signal[r]]
            turning = begun(row, spin, knots[0])
            tasks[r, TASK:] = turning
            if row[at.LAGGED] > 0.0:
                if row[at.RAMP] > 0.0:
                    knots, coef = ramped(row, knots, coef, spin)
                if row[at.BENT] > 0.0:
                    knots, coef = in_straight_parts(row, knots, coef)
                knots, coef = follow(row, knots, coef, turning)
            if row[at.PLAYS] > 0.0:
                knots, coef = taken_up(row, knots, coef)
            columns = probed(row, len(push) > 0)
            edges = np.sort(np.concatenate([push[:, 0], edges_of(row)]))
            tables = workspace(n, row[at.DRIVEN] > 0.0)
            place = np.array([-1, 0, 0])
            own = row, wheels_of(row), knots, coef, push
            trace = np.empty((most, TRACE + n))
            run(*own, edges, columns, place, times, tasks[r], tables, trace, out[r, :count])
            out[r, count:] = out[r, count - 1]
            if others is not None and tasks[r, 0] == Ending.DONE:
                taken = trace[: int(tasks[r, 2])]
                more = growing(len(others))
                grow(*own, columns, others, theirs.copy(), taken, times, tables, more, change[r, :, :count])
                change[r, :, count:] = change[r, :, count - 1 : count]

        spread(work, runs)
        state = out[..., :6]
        pose = state[..., :3].copy()
        if com.any():
            cx, cy = to_floor(state[..., 2], com[:, None, 0], com[:, None, 1])
            pose[..., 0] -= cx
            pose[..., 1] -= cy
            if others is not None:
                change[..., 0] += cy[:, None] * change[..., 2]
                change[..., 1] -= cx[:, None] * change[..., 2]
        return Outcome(
            pose=pose,
            state=state,
            ending=tasks[:, 0].astype(np.int64),
            stopped_s=tasks[:, 1],
            steps=tasks[:, 2:4].astype(np.int64),
            lifts_s=np.where(tasks[:, 4] < 0.0, np.nan, tasks[:, 4]),
            in_air_s=tasks[:, TASK:],
            change=None if others is None else change,
            **(_told(out[..., 6:].reshape(runs, longest, n, TOLD), models[which]) if tell else {}),
        )

    def beside(self, model: Array, other: Array) -> bool:
        """Whether two packed models differ only in the forces at an instant, as these signals act."""
        one, two = self._acting(np.stack([model])), self._acting(np.stack([other]))
        return beside(one[0], two[0])

    def _acting(self, models: Array) -> Array:
        """Packed models (M, L) as these signals act on them, writable: one compilation serves all arrays."""
        rows = models.copy()
        if not self.commanded:
            rows[:, [at.DRIVEN, at.LAGGED]] = 0.0
        return rows


def _told(seen: Array, models: Array) -> dict[str, Array]:
    """What each wheel did, from the columns that a run writes of it."""
    slip, force, load, coefficient = seen[..., 1:3], seen[..., 3:5], seen[..., 5], seen[..., 6:8]
    viscous = models[:, None, None, [at.VISCOUS_W, at.VISCOUS_T]]
    friction = np.abs(force + viscous * slip)
    limit = coefficient * load[..., None]
    safe = np.where(limit > 0.0, limit, 1.0)
    utilisation = np.empty(load.shape)
    for r, model in enumerate(models):
        shape, coupling = list(GripShape)[int(model[at.SHAPE])], float(model[at.COUPLING])
        left = drive_left(
            shape,
            coupling,
            friction[r, ..., 1] / safe[r, ..., 1],
            friction[r, ..., 1] / safe[r, ..., 0],
        )
        utilisation[r] = friction[r, ..., 0] / (safe[r, ..., 0] * np.maximum(left, _LEAST_LEFT))
    return {
        "theta": seen[..., 0],
        "slip": slip,
        "force": force,
        "load": load,
        "coefficient": coefficient,
        "steepness": seen[..., 8:10],
        "utilisation": utilisation,
    }


def _given(signal: WheelSignal, times: Array, push: Push | None, first: float) -> tuple[Any, ...]:
    """What a compiled run needs of a signal, times since the run began; arrays writable and contiguous."""
    coef = np.concatenate([signal.pieces, np.zeros((*signal.pieces.shape[:2], 1))], axis=2)
    pushed = np.empty((0, 5))
    if push is not None:
        pushed = np.column_stack([push.t_s - first, push.wrench, np.full(len(push.t_s), push.height_m)])
    return (signal.knots_s - first, coef, np.array(signal.spin_rad_s), pushed, times)


def _to_centre(start: Array, com: Array) -> None:
    """In place: origin pose and floor-frame twist → centre of mass, body-frame velocity."""
    phi, w = start[:, 2], start[:, 5]
    cx, cy = to_floor(phi, com[:, 0], com[:, 1])
    start[:, 3], start[:, 4] = velocity_at(*to_body(phi, start[:, 3], start[:, 4]), w, com[:, 0], com[:, 1])
    start[:, 0] += cx
    start[:, 1] += cy


def _times(t: Array, signal: WheelSignal) -> Array:
    times = frozen("times_s", t, (None,))
    if len(times) == 0 or (len(times) > 1 and np.min(np.diff(times)) < 0.0):
        raise InputError("times_s", "are empty or not ascending", "give ascending output times")
    first, last = float(signal.knots_s[0]), float(signal.knots_s[-1])
    if times[0] < first - 1e-12 or times[-1] > last + 1e-9:
        raise InputError(
            "times_s",
            f"run from {times[0]:g} to {times[-1]:g} s, the wheels are known from {first:g} to {last:g} s",
            "ask within the wheels' data",
        )
    return np.clip(times, first, last)
