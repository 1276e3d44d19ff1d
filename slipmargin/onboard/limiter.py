"""Cutting a wanted acceleration or twist back to the limit, direction kept: the algorithm of the C header.

The header that ``slipmargin export c`` writes does the same on one state, row by row along the step; here
it runs on M states at once.  Rows A a ≤ b hold the grip of every wheel, the load that keeps it on the floor
and the torque of its motor (:mod:`~slipmargin.onboard.table`).  While the twist goes from v to v + t Δ within
dt the acceleration of the origin in body axes is

    a(t) = t Δ/dt + ω(t) ẑ × v(t),

so the end of a step gives one quadratic a row.  Motors also turn wheels and rotors faster, by the rate t Δ/dt
of the twist itself.  Three of them count: the acceleration at the start of the
step, at its end, and steady motion at its end, so that the next step can always keep the twist.  Drag takes
its worst value between the twist now and the twist reached by the drag of now alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.motion_realised import LIGHTEST
from slipmargin.onboard.table import LimitTable, threes
from slipmargin.physics.frames import to_body
from slipmargin.physics.grips import across_alone, left_beside
from slipmargin.physics.kinematics import com_acceleration, rate_as_axes_turn

#: Twists and accelerations are cut to this size, so that single precision does not overflow.
LARGEST = 1e4
#: Parts of a step that are tried one after the other [1].
SHORTER = (1.0, 0.25)
#: The shortest step that counts as one [s].
SHORTEST_S = 1e-6
#: A wheel whose drag uses its whole grip is taken to have this share of it left when wheels share a
#: wrench: else no wheel might be left to share [1].
LEAST_LEFT = 0.01
#: A row may be missed by this share of the grip at rest (of the stall torque, of the load at rest), so that
#: rounding stops no robot that just keeps it; the second where loads decide how a wrench is shared, which is
#: known for an acceleration close by only [1].
ROUNDING, SHARING = 1e-6, 1e-2


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """A (M, R, 6) a ≤ b (M, R); ``slack`` is the tolerance of b.

    a is the acceleration of the centre of mass (3) and the rate of the body twist (3).
    """

    A: Array
    b: Array
    slack: Array


def rows(table: LimitTable, start: Array, end: Array, heading: Array, near: Array) -> Rows:
    """Rows (M, R) that hold while the twist goes from ``start`` to ``end``, both (M, 3).

    ``near`` (M, 3) is an acceleration close to what the rows will allow: it shares a wrench between more than
    three wheels, whose loads it shifts.
    """
    low, high = drag_between(table, start, end)
    left = _drive(table, np.maximum(np.abs(low), np.abs(high)))
    wrench_low, wrench_high, shift = _wrench(table, start, heading)
    spread = _spread(table, left, shift, near)
    cross = spread @ table.across
    own = np.arange(table.count)
    A, b, slack = [], [], []
    for lightest, heaviest in zip(table.rest_low_N, table.rest_high_N, strict=True):
        for sign in (1.0, -1.0):
            H = _worst(sign * cross, low, high)
            H[:, own, own] -= table.share * left
            A.append(_on_acceleration(sign * spread, table, H))
            b.append(_offset(sign * spread, wrench_low, wrench_high, H, lightest + shift, heaviest + shift))
            still = sign * np.einsum("mnk,mk->mn", spread, 0.5 * (wrench_low + wrench_high))
            slack.append(np.abs(table.share * left * (0.5 * (lightest + heaviest) + shift) + still))
        if table.stall_torque_N_m is not None:
            turned = table.torque_force[:, None] * cross
            turned[:, own, own] += table.torque_drag
            for sign in (1.0, -1.0):
                H, by_wrench = _worst(sign * turned, low, high), sign * table.torque_force[:, None] * spread
                A.append(_on_acceleration(by_wrench, table, H, sign * table.spin))
                offset = _offset(by_wrench, wrench_low, wrench_high, H, lightest + shift, heaviest + shift)
                b.append(offset + table.share * _torque(table, sign, start, end))
                slack.append(np.full(offset.shape, table.share * table.stall_torque_N_m))
    if table.transfers:
        tip = np.zeros((len(start), table.count, 6))
        tip[..., :2] = -table.per_acceleration_kg
        A.append(tip)
        b.append(table.share * (table.rest_low_N[0] + shift))
        slack.append(b[-1])
    return Rows(
        A=np.concatenate(A, axis=1),
        b=np.concatenate(b, axis=1),
        slack=tolerance(table) * np.concatenate(slack, axis=1),
    )


def tolerance(table: LimitTable) -> float:
    """Share of the grip at rest by which a row may be missed [1]."""
    return SHARING if table.shares_by_load else ROUNDING


def _worst(part: Array, low: Array, high: Array) -> Array:
    """Largest part (M, N, N) · drag of every wheel."""
    return np.asarray(np.where(part > 0.0, part * high[:, None, :], part * low[:, None, :]))


def _spread(table: LimitTable, left: Array, shift: Array, near: Array) -> Array:
    """L (M, N, 3): how the wheels share a wrench, in proportion to their grip."""
    if not table.shares_by_load:
        return np.broadcast_to(table.spread, (len(near), table.count, 3))
    load = table.rest_low_N[0] + shift + near[:, :2] @ table.per_acceleration_kg.T
    grip = np.maximum(left, LEAST_LEFT) * np.maximum(load, LIGHTEST * table.mean_load_N)
    wheels, weight, alone = threes(table.along)
    each = np.zeros((len(wheels), table.count, 3))
    each[np.arange(len(wheels))[:, None], wheels] = alone
    counts = np.prod(grip[:, wheels], axis=2)
    return np.asarray(np.einsum("mt,tnk->mnk", counts, each) / (counts @ weight)[:, None, None])


def drag_between(table: LimitTable, start: Array, end: Array) -> tuple[Array, Array]:
    """Least and greatest drag per load (M, N) while the twist goes from ``start`` to ``end``."""
    boxes = zip(table.drag, table.slope, strict=True)
    coupled = zip(table.coupled_drag, table.coupled_slope, strict=True)
    ends = [
        across_alone(table.law, table.coupling, twist @ table.lateral.T, *laws)
        for laws, twist in product(zip(boxes, coupled, strict=True), (start, end))
    ]
    return np.min(ends, axis=0), np.max(ends, axis=0)


def _drive(table: LimitTable, drag: Array) -> Array:
    """Drive coefficient (M, N) that a drag (M, N) leaves."""
    return np.asarray(table.drive * left_beside(table.coupling, drag / table.most_beside))


def _wrench(table: LimitTable, twist: Array, heading: Array) -> tuple[Array, Array, Array]:
    """Box (M, 3) of external wrenches and the change of the loads (M, N) that the heading makes."""
    both = twist @ table.viscous.T
    shift = np.zeros((len(twist), table.count))
    if table.turned:
        force = np.stack(to_body(heading, *table.floor_wrench[:2]), axis=1)
        both = both + np.column_stack([force, np.full(len(twist), table.floor_wrench[2])])
        shift = np.stack(to_body(heading, *table.floor_moment_N_m), axis=1) @ table.floor_loads.T
    return table.wrench_low + both, table.wrench_high + both, shift


def _on_acceleration(spread: Array, table: LimitTable, H: Array, spin: Array | float = 0.0) -> Array:
    A = np.empty((len(H), table.count, 6))
    A[..., :3], A[..., 3:] = spread * table.mass, spin
    A[..., :2] += H @ table.per_acceleration_kg
    return A


def _offset(spread: Array, low: Array, high: Array, H: Array, lightest: Array, heaviest: Array) -> Array:
    load = np.where(H > 0.0, np.expand_dims(heaviest, -2), np.expand_dims(lightest, -2))
    least = np.einsum("mnk,mk->mn", np.maximum(spread, 0.0), low)
    least += np.einsum("mnk,mk->mn", np.minimum(spread, 0.0), high)
    return np.asarray(least - np.sum(H * load, axis=2))


def _torque(table: LimitTable, sign: float, start: Array, end: Array) -> Array:
    """Torque (M, N) that the motors give with a sign over a step [N m]."""
    stall = table.stall_torque_N_m
    assert stall is not None
    if table.top_speed_rad_s is None:
        return np.full((len(start), table.count), stall)
    fastest = np.maximum(sign * (start @ table.rolling.T), sign * (end @ table.rolling.T))
    return np.asarray(stall * np.clip(1.0 - np.maximum(fastest, 0.0) / table.top_speed_rad_s, 0.0, 1.0))


def _range(held: Rows, start: Array, slope: Array) -> tuple[Array, Array]:
    """Least and greatest t (M,) with A (start + t slope) ≤ b; the first above the second where none is."""
    room = held.b - np.einsum("mrc,mc->mr", held.A, start) + held.slack
    rise = np.einsum("mrc,mc->mr", held.A, slope)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        t = room / rise
    most = np.where(rise > 0.0, t, np.where((rise == 0.0) & (room < 0.0), -np.inf, np.inf))
    least = np.where(rise < 0.0, t, -np.inf)
    return least.max(axis=1), most.min(axis=1)


def _first(held: Rows, constant: Array, linear: Array, square: Array) -> Array:
    """First t ≥ 0 (M,) at which A (c + l t + s t²) ≤ b ends; rows that fail at 0 already do not count."""
    room = held.b - np.einsum("mrc,mc->mr", held.A, constant) + held.slack
    p = np.einsum("mrc,mc->mr", held.A, linear)
    q = np.einsum("mrc,mc->mr", held.A, square)
    inside = p * p + 4.0 * q * room
    below = p + np.sqrt(np.maximum(inside, 0.0))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        t = 2.0 * room / below
    ends = (room >= 0.0) & (inside >= 0.0) & (below > 0.0)
    return np.asarray(np.where(ends, t, np.inf).min(axis=1))


def _turning(table: LimitTable, twist: Array, step: Array) -> tuple[Array, Array, Array]:
    """Coefficients (M, 3) of 1, t and t² of the centre's acceleration by turning at the twist v + t Δ."""
    (vx, vy, w), (dx, dy, dw), (cx, cy) = twist.T, step.T, table.com_m
    none = np.zeros_like(w)
    constant = np.stack([-w * vy - w * w * cx, w * vx - w * w * cy, none], axis=1)
    linear = np.stack(
        [-(w * dy + dw * vy) - 2.0 * w * dw * cx, w * dx + dw * vx - 2.0 * w * dw * cy, none], axis=1
    )
    square = np.stack([-dw * dy - dw * dw * cx, dw * dx - dw * dw * cy, none], axis=1)
    return constant, linear, square


def _reach(
    table: LimitTable, held: Rows, twist: Array, step: Array, dt: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Greatest share t (M,) of a step within the rows, or the middle of the miss; whether there is."""
    none, gain = np.zeros_like(step), step / dt[:, None]
    constant, linear, square = (np.hstack([part, none]) for part in _turning(table, twist, step))
    rate = np.hstack([com_acceleration(table.com_m, none, gain), gain])
    least, most = _range(held, constant, rate)
    t, holds = _share(least, most)
    ends = np.minimum(_first(held, constant, rate + linear, square), _first(held, constant, linear, square))
    return np.where(holds, np.minimum(t, np.maximum(ends, np.maximum(least, 0.0))), t), holds


def _share(least: Array, most: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Greatest t in [0, 1] and in [least, most], and whether there is one; else the middle of the miss."""
    holds = (least <= most) & (least <= 1.0) & (most >= 0.0)
    middle = 0.5 * (np.clip(least, 0.0, 1.0) + np.clip(most, 0.0, 1.0))
    return np.where(holds, np.clip(most, 0.0, 1.0), middle), holds


def _toward(
    table: LimitTable, now: Array, target: Array, dt: Array, heading: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """The twist (M, 3) towards a target, and whether it keeps the limit.

    Where the drag on the way lets no step hold, a shorter one is tried, then none: staying.
    """
    step = target - now
    turning = _turning(table, now, step)[0]
    rate = com_acceleration(table.com_m, np.zeros_like(step), step / dt[:, None])
    size = np.sqrt(np.sum(rate[:, :2] ** 2, axis=1, keepdims=True))
    likely = turning + rate * (table.pull_m_s2 / np.maximum(size, table.pull_m_s2))
    far, holds = _reach(table, rows(table, now, now, heading, likely), now, step, dt)
    near = turning + far[:, None] * rate
    t = np.zeros_like(far)
    found = ~holds
    for part in SHORTER:
        held = rows(table, now, now + (part * far)[:, None] * step, heading, near)
        reach, fits = _reach(table, held, now, step, dt)
        t = np.where(~found & fits, np.minimum(reach, part * far), t)
        found |= fits
    t = np.where(holds, t, far)[:, None]
    return np.where(t == 1.0, target, now + t * step), holds


def limit_twist(
    table: LimitTable, now: Array, wanted: Array, dt: Array, heading: Array
) -> tuple[Array, NDArray[np.int64]]:
    """Next twist (M, 3) on the straight line from ``now`` to ``wanted``, and a code (M,).

    Code 0: reached; 1: cut back, direction kept; 2: no step towards it holds, so it brakes; 3: even braking
    asks for more than the margin leaves, it brakes as well as it can; 4: input that is no number.
    """
    now, bad_now = cleaned(now)
    wanted, bad_wanted = cleaned(wanted)
    heading, bad_heading = cleaned(heading)
    time_passes = (dt >= SHORTEST_S) & np.isfinite(dt)
    seconds = np.where(time_passes, np.minimum(np.where(np.isfinite(dt), dt, 1.0), LARGEST), 1.0)
    bad = bad_now | bad_wanted | (bad_heading if table.turned else False)
    wanted = np.where(bad[:, None], 0.0, wanted)
    fastest = wanted
    if table.top_speed_rad_s is not None:
        speed = np.max(np.abs(wanted @ table.rolling.T), axis=1)
        fastest = wanted * (table.top_speed_rad_s / np.maximum(speed, table.top_speed_rad_s))[:, None]
    next_, holds = _toward(table, now, fastest, seconds, heading)
    braked, brakes = _toward(table, now, np.zeros_like(now), seconds, heading)
    out = np.where(holds[:, None], next_, braked)
    reached = np.all(out == wanted, axis=1)
    code = np.where(holds, np.where(reached, 0, 1), np.where(brakes, 2, 3))
    out = np.where(time_passes[:, None], out, now)
    out = np.where(bad_now[:, None], 0.0, out)
    return out, np.where(bad | ~time_passes, 4, code)


def limit_acceleration(
    table: LimitTable, twist: Array, wanted: Array, heading: Array
) -> tuple[Array, NDArray[np.int64]]:
    """Greatest share (M,) of a wanted acceleration of the origin, body axes, at a twist, and a code (M,).

    Code 0: all of it; 1: cut back; 3: no share of it keeps the margin; 4: input that is no number.
    """
    twist, bad_twist = cleaned(twist)
    wanted, bad_wanted = cleaned(wanted)
    heading, bad_heading = cleaned(heading)
    bad = bad_twist | bad_wanted | (bad_heading if table.turned else False)
    none = np.zeros_like(twist)
    start = np.hstack([com_acceleration(table.com_m, twist, none), rate_as_axes_turn(twist)])
    slope = np.hstack([com_acceleration(table.com_m, none, wanted), wanted])
    t, holds = _share(*_range(rows(table, twist, twist, heading, start[:, :3]), start, slope))
    if table.shares_by_load:
        near = (start + t[:, None] * slope)[:, :3]
        t, holds = _share(*_range(rows(table, twist, twist, heading, near), start, slope))
    code = np.where(holds, np.where(t >= 1.0, 0, 1), 3)
    return np.where(bad, 0.0, t), np.where(bad, 4, code)


def utilisation(table: LimitTable, twist: Array, acceleration: Array, heading: Array) -> Array:
    """Share (M, N) of each wheel's drive grip at a twist and an acceleration of the origin, body axes."""
    a = com_acceleration(table.com_m, twist, acceleration)
    drag = 0.5 * np.sum(np.stack(drag_between(table, twist, twist)), axis=0)
    low, high, shift = _wrench(table, twist, heading)
    moved = a[:, :2] @ table.per_acceleration_kg.T + shift
    use = np.zeros((len(twist), table.count))
    left = _drive(table, np.abs(drag))
    spread = _spread(table, left, shift, a)
    for lightest, heaviest in zip(table.rest_low_N, table.rest_high_N, strict=True):
        load = np.maximum(0.5 * (lightest + heaviest) + moved, LIGHTEST * table.mean_load_N)
        wrench = a * table.mass - 0.5 * (low + high) + (drag * load) @ table.across.T
        force = np.einsum("mnk,mk->mn", spread, wrench)
        use = np.maximum(use, np.abs(force) / np.maximum(left * load, 1e-30))
    return use


def cleaned(values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Values cut to :data:`LARGEST`, zero where one of a row is no number, and whether that was so (M,)."""
    fine = np.isfinite(values)
    bad = ~(np.all(fine, axis=1) if values.ndim == 2 else fine)
    rows_bad = bad[:, None] if values.ndim == 2 else bad
    return np.where(rows_bad, 0.0, np.clip(np.where(fine, values, 0.0), -LARGEST, LARGEST)), bad
