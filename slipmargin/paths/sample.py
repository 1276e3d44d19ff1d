"""A plan as a trajectory: samples in time, exact between grid points since s̈ is constant there."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.motion_realised import open_loop_use, realised
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.paths.plan import Plan
from slipmargin.paths.trajectory import LEAST_SAMPLES, Trajectory
from slipmargin.physics.frames import rotate_rows
from slipmargin.work import TABLE_NUMBERS, allow

#: Columns of a trajectory: time, pose, velocity, acceleration; speed and use of each wheel.
COLUMNS, COLUMNS_OF_WHEEL = 10, 2


#: A path so many times as long as the wheels stand from the robot's middle is hardly one in metres [1].
_LONG = 1000.0


def node_times(plan: Plan) -> Array:
    """Times (n + 1,) [s] at the grid points."""
    root = np.sqrt(np.maximum(plan.x, 0.0))
    return np.concatenate([[0.0], np.cumsum(2.0 * plan.grid.step / (root[1:] + root[:-1]))])


def trajectory(plan: Plan, *, step_s: float = 0.005) -> Trajectory:
    """Samples every ``step_s`` [s] and at the end.

    Raises
    ------
    InputError
        If the step is not positive, or so long that :func:`~slipmargin.paths.check.check` reads no motion.
    """
    step_s = real("step_s", step_s, above=0.0, cure="give a positive time step [s]")
    end = plan.duration_s
    numbers = end / step_s * (COLUMNS + COLUMNS_OF_WHEEL * plan.model.count)
    cure = "take a longer step, a faster path or a smaller margin"
    if plan.path.length > _LONG * plan.model.reach_m:
        cure += f"; the path is {plan.path.length:.4g} m long: are its waypoints in metres?"
    allow("step_s", numbers, TABLE_NUMBERS, "numbers of a table", cure)
    count = int(np.ceil(end / step_s - 1e-9)) + 1
    if count < LEAST_SAMPLES:
        raise InputError(
            "step_s",
            f"is {step_s:g} s and gives {count} rows over {end:.4g} s, `check` needs {LEAST_SAMPLES}",
            f"take a step up to {longest_step(plan):.4g} s",
        )
    return at_times(plan, np.minimum(np.arange(count) * step_s, end))


def longest_step(plan: Plan) -> float:
    """The longest step [s] of a table that can be checked."""
    return plan.duration_s / (LEAST_SAMPLES - 1)


def rolled(rows: Trajectory) -> Array:
    """The pose (3,) to which the wheel speeds, linear between the rows, lead without any slip.

    The heading is exact, x and y by Simpson's rule from row to row.
    """
    step, phi = np.diff(rows.t_s)[:, None], rows.pose[0, 2]
    body = rotate_rows(rows.pose[:, 2], rows.velocity, inverse=True)
    first, last = body[:-1], body[1:]
    spin = np.concatenate([[0.0], np.cumsum(0.5 * (first + last) * step, axis=0)[:, 2]])
    half = spin[:-1] + (0.375 * first + 0.125 * last)[:, 2] * step[:, 0]
    begins, ends = rotate_rows(phi + spin[:-1], first), rotate_rows(phi + spin[1:], last)
    middle = rotate_rows(phi + half, 0.5 * (first + last))
    return np.asarray(rows.pose[0] + np.sum(step / 6.0 * (begins + 4.0 * middle + ends), axis=0))


def at_times(plan: Plan, t_s: Array) -> Trajectory:
    """Samples at ascending times (T,) within the plan [s]."""
    nodes = node_times(plan)
    j = np.clip(np.searchsorted(nodes, t_s, side="right") - 1, 0, len(plan.u) - 1)
    after = t_s - nodes[j]
    start = np.sqrt(np.maximum(plan.x[j], 0.0))
    s = plan.grid.s[j] + start * after + 0.5 * plan.u[j] * after**2
    rate = np.maximum(start + plan.u[j] * after, 0.0)
    q, first, second = plan.path.at(np.minimum(s, plan.grid.s[j + 1]), plan.grid.piece[j])
    velocity = first * rate[:, None]
    acceleration = first * plan.u[j, None] + second * rate[:, None] ** 2
    omega = plan.model.geometry.wheel_speeds(rotate_rows(q[:, 2], velocity, inverse=True))
    if np.any(plan.audit.driven):  # followed in finer steps than these
        checked = plan.audit.use.reshape(-1, plan.model.count)
        use = np.column_stack([np.interp(t_s, plan.audit.time_s.ravel(), wheel) for wheel in checked.T])
    else:
        use = use_along(plan.model, t_s, q, velocity, acceleration, contact=plan.request.contact)
    return Trajectory(
        t_s=t_s,
        pose=q,
        velocity=velocity,
        acceleration=acceleration,
        omega=omega,
        use=use,
        wheels=plan.model.geometry.names,
    )


def use_along(
    model: Model,
    t_s: Array,
    pose: Array,
    velocity: Array,
    acceleration: Array,
    *,
    contact: Contact = Contact.ROLLERS,
    held: bool = False,
) -> Array:
    """Share (T, N) of each wheel's grip along floor-frame samples (T, 3).

    With the pose ``held``, or with it or open loop, whichever is more.  The samples follow each other.
    """
    heading = pose[:, 2]
    motion = Motion(
        velocity=rotate_rows(heading, velocity, inverse=True),
        acceleration=rotate_rows(heading, acceleration, inverse=True),
        heading=heading,
        position=pose[:, :2],
        time_s=t_s,
    )
    use = realised(model, motion, contact=contact).use
    return use if held else np.maximum(use, open_loop_use(model, motion, contact=contact))


def stretched(
    model: Model, rows: Trajectory, factor: float, *, contact: Contact = Contact.ROLLERS
) -> Trajectory:
    """The same motion driven slower (``factor`` above 1) or faster (below 1), with the use this needs."""
    factor = real("factor", factor, above=0.0, cure="give a positive factor")
    velocity, acceleration = rows.velocity / factor, rows.acceleration / factor**2
    t = rows.t_s * factor
    return Trajectory(
        t_s=t,
        pose=rows.pose,
        velocity=velocity,
        acceleration=acceleration,
        omega=rows.omega / factor,
        wheels=rows.wheels,
        use=use_along(model, t, rows.pose, velocity, acceleration, contact=contact, held=True),
    )


def sustained(rows: Trajectory, hold_s: float) -> Array:
    """(T, N) the use that each wheel keeps up for ``hold_s`` from each sample on: a rolling least.

    A wheel asked for 105 % slips by the missing 5 % of its force, which takes time to become speed.
    """
    from scipy.ndimage import minimum_filter1d

    steps = max(1, round(hold_s / float(np.median(np.diff(rows.t_s)))))
    return np.asarray(minimum_filter1d(rows.use, 2 * (steps // 2) + 1, axis=0, mode="constant", cval=0.0))


def at_use(model: Model, rows: Trajectory, use: float, *, hold_s: float = 0.0) -> Trajectory:
    """The motion sped up until a wheel's use is ``use`` (to 1e-4) for at least ``hold_s``, on rollers.

    (Or for 15 % of the motion where that is shorter.)

    Raises
    ------
    NoSolution
        If it uses more already, or no speed-up by less than 20 does it.
    """

    def asked(factor: float) -> float:
        now = stretched(model, rows, factor)
        return float(np.max(sustained(now, min(hold_s, 0.15 * now.duration_s))))

    high, low = 1.0, 0.97
    if asked(1.0) >= use:
        raise NoSolution("speeding up", f"the motion already uses {asked(1.0):.4g}", "ask for a larger use")
    while asked(low) < use:
        high, low = low, 0.97 * low
        if low < 0.05:
            raise NoSolution(
                "speeding up", f"no speed makes the largest use {use:g}", "ask for a smaller use"
            )
    while high - low > 1e-5 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if asked(middle) > use else (low, middle)
    return stretched(model, rows, low)
