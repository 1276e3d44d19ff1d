"""Faults that the wheels' signals show by themselves: wrapped angles, other units, coarse encoders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry import bridged
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair, run_by_run
from slipmargin.data.settings import SETTINGS
from slipmargin.physics.kinematics import integrated

_TURN = 2.0 * np.pi
#: What wheel speeds may be given in instead of rad/s: the factor that makes them rad/s.
_SPEED_UNITS = {"turns a minute": _TURN / 60.0, "degrees a second": np.pi / 180.0, "turns a second": _TURN}


def unwrapped(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Headings and wheel angles without the jumps by a whole turn of a counter that starts again."""
    data_set, heading = run_by_run(
        data_set,
        _unwrapped_heading,
        "wrapped_heading",
        "1",
        lambda size, where: f"The heading jumps by a whole turn {size:.0f} times, {where}: it was unwrapped.",
    )
    data_set, wheels = run_by_run(
        data_set,
        _unwrapped_wheels,
        "wrapped_wheel_angle",
        "1",
        lambda size, where: (
            f"Wheel angles jump by a whole turn {size:.0f} times, {where}: they were unwrapped."
        ),
    )
    return data_set, (*heading, *wheels)


def _unwrapped_heading(record: Record) -> tuple[Record, float]:
    column, count = _unwrap(record.pose[:, 2], np.zeros(len(record.t_s)))
    if not count:
        return record, 0
    return replace(record, pose=np.column_stack([record.pose[:, :2], column])), count


def _unwrapped_wheels(record: Record) -> tuple[Record, float]:
    if record.theta is None:
        return record, 0
    speed = next(
        (s for s in (record.omega, record.omega_cmd) if s is not None and np.isfinite(s).any(axis=0).all()),
        None,
    )
    way = np.zeros(record.theta.shape)
    if speed is not None:
        way = integrated(record.t_s, bridged(record.t_s, speed))
    columns, counts = zip(*(_unwrap(a, w) for a, w in zip(record.theta.T, way.T, strict=True)), strict=True)
    if not sum(counts):
        return record, 0
    return replace(record, theta=np.column_stack(columns)), sum(counts)


def _unwrap(angle: Array, expected: Array) -> tuple[Array, int]:
    """The angle without jumps by whole turns, and how many there were.

    It can only be wrapped if all of it lies within one turn (of 2π, or of 360 where it is in degrees).
    ``expected`` is about how it changes: the turns of a step are those that bring it nearest to that.
    """
    known = np.isfinite(angle)
    values = angle[known]
    if len(values) < 2:
        return angle, 0
    step, way = np.diff(values), np.diff(expected[known])
    span = float(np.ptp(values))
    period = _TURN if span <= _TURN + 1e-6 else 360.0
    if span > 360.0 + 1e-6 or np.max(np.abs(step)) <= 0.5 * period:
        return angle, 0
    if np.max(np.abs(way)) > 0.5 * period and period != _TURN:
        return angle, 0
    turns = np.round((step - way) / period)
    left = np.abs(step - period * turns - way)[turns != 0.0]
    # A step of a whole turn is that and little else; one of a marker mistaken for another is anything.
    near = 0.1 * period + 4.0 * np.median(np.abs(step - way))
    if not len(left) or np.mean(left < near) < SETTINGS.whole_turns:
        return angle, 0
    out = np.array(angle)
    out[known] = values - period * np.append(0.0, np.cumsum(turns))
    return out, int(np.count_nonzero(turns))


def known_throughout(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Runs from the first row to the last at which every wheel is known: what it did beyond is not said."""
    return run_by_run(
        data_set,
        _known_throughout,
        "wheels_unknown",
        "1",
        lambda size, runs: (
            f"At the start or the end of a log a wheel's cells are empty, {runs}: "
            f"these {size:g} rows were left out."
        ),
    )


def _known_throughout(record: Record) -> tuple[Record, float]:
    first, stop = 0, len(record.t_s)
    for field in ("omega", "theta", "omega_cmd"):
        signal: Array | None = getattr(record, field)
        for column in () if signal is None else signal.T:
            known = np.flatnonzero(np.isfinite(column))
            if len(known):
                first, stop = max(first, int(known[0])), min(stop, int(known[-1]) + 1)
    lost = len(record.t_s) - (stop - first)
    if not lost or stop - first < 2 or not record.seen[first:stop].any():
        return record, 0.0
    return record.part(slice(first, stop)), float(lost)


def speeds_agree(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Wheel speeds in rad/s and on the clock on which they are the rate of the wheel angles.

    Where angles and speeds are both logged, they must agree.  A factor of a unit on all wheels is taken out
    of the speeds; a factor near one that all wheels share is that of the clock, and is taken out of the
    time; speeds that agree with no factor are left out, since the angles hold all they say.
    """
    parts = [p for t in data_set.trials if (p := _blocks(t)) is not None]
    if not parts:
        return data_set, ()
    by_speed = np.concatenate([p[0] for p in parts])
    by_angle = np.concatenate([p[1] for p in parts])
    power = np.sum(by_speed**2, axis=0)
    if not np.all(power > 0.0) or not np.all(np.sum(by_angle**2, axis=0) > 0.0):
        return data_set, ()
    factor = np.sum(by_speed * by_angle, axis=0) / power
    every = tuple(t.name for t in data_set.trials)
    for unit, wanted in _SPEED_UNITS.items():
        if np.all(np.abs(factor / wanted - 1.0) < SETTINGS.unit_within):
            changed = tuple(
                t if t.omega is None else replace(t, omega=wanted * t.omega) for t in data_set.trials
            )
            repair = Repair(
                kind="wheel_speed_unit",
                runs=every,
                size=1.0 / wanted,
                unit="1",
                sentence=f"The wheel speeds are {1.0 / wanted:.4g} times the rate of the wheel angles: "
                f"they are in {unit} "
                "and were converted to rad/s.",
            )
            done, more = speeds_agree(replace(data_set, trials=changed))
            return done, (repair, *more)
    if np.any(np.abs(factor - 1.0) > SETTINGS.no_speed):
        worst = int(np.argmax(np.abs(factor - 1.0)))
        changed = tuple(t if t.theta is None else replace(t, omega=None) for t in data_set.trials)
        names = data_set.recipe.robot.wheels
        return replace(data_set, trials=changed), (
            Repair(
                kind="wheel_speed_left_out",
                runs=every,
                size=float(factor[worst]),
                unit="1",
                sentence=f"The speed of wheel {names[worst].name} disagrees with its angle, which changes "
                f"{factor[worst]:.3g} "
                "times as fast: the speeds were left out, the angles hold the motion.",
            ),
        )
    pooled = float(np.sum(by_speed * by_angle) / np.sum(power))
    each = np.array([float(np.sum(s * a) / np.sum(s**2)) for s, a in parts if np.sum(s**2) > 0.0])
    error = float(np.std(each, ddof=1) / np.sqrt(len(each))) if len(each) > 1 else 1.0
    error = max(error, float(np.ptp(factor)) / len(factor))
    if abs(pooled - 1.0) < max(SETTINGS.clock_least, SETTINGS.clock_errors * error):
        return data_set, ()
    changed = tuple(t.restamped(t.t_s[0] + pooled * (t.t_s - t.t_s[0])) for t in data_set.trials)
    return replace(data_set, trials=changed), (
        Repair(
            kind="clock_rate",
            runs=every,
            size=1.0 / pooled - 1.0,
            unit="1",
            sentence=f"All wheels turn {100.0 * (pooled - 1.0):+.2g} % more between two stamps than their "
            f"speeds say: the "
            f"clock of the log runs {100.0 * (1.0 / pooled - 1.0):+.2g} % off, and the time was corrected.",
        ),
    )


def _blocks(record: Record) -> tuple[Array, Array] | None:
    """Angles turned in blocks of a run by integrated speeds and by the logged angles, (K, N) each."""
    if record.theta is None or record.omega is None:
        return None
    if not (np.isfinite(record.theta).any(axis=0).all() and np.isfinite(record.omega).any(axis=0).all()):
        return None
    t, theta, omega = record.t_s, bridged(record.t_s, record.theta), bridged(record.t_s, record.omega)
    from scipy.interpolate import CubicSpline

    turned = CubicSpline(t, omega).antiderivative()(t)
    count = max(1, int(record.duration_s / SETTINGS.block_s))
    edges = np.unique(np.searchsorted(t, np.linspace(t[0], t[-1], count + 1)).clip(0, len(t) - 1))
    return np.diff(turned[edges], axis=0), np.diff(theta[edges], axis=0)


def fine_angles(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Angles of coarse encoders smoothed to within a tick; by the measured speeds where these know better."""
    return run_by_run(
        data_set,
        _fine,
        "coarse_encoder",
        "rad",
        lambda size, where: (
            f"The encoders have steps of {1e3 * size:.3g} mrad ({_TURN / size:.0f} ticks a turn), "
            f"{where}: the angles were "
            "smoothed to within a step."
        ),
        total=max,
    )


def _fine(record: Record) -> tuple[Record, float]:
    if record.theta is None:
        return record, 0.0
    ticks = np.array([tick(column) for column in record.theta.T])
    coarse = ticks > _TURN / SETTINGS.fine_ticks
    if not coarse.any():
        return record, 0.0
    t = record.t_s
    theta = np.array(record.theta)
    omega = None if record.omega is None else np.array(record.omega)
    for i in np.flatnonzero(coarse):
        angle, speed = _smoothed(t, theta[:, i], None if omega is None else omega[:, i], float(ticks[i]))
        theta[:, i] = angle
        if omega is not None:
            omega[:, i] = speed
    return replace(record, theta=theta, omega=omega), float(ticks.max())


def tick(angle: Array) -> float:
    """The step of an encoder [rad] of which all changes of its angle are multiples; 0 where there is none.

    Equal changes in a row are one piece of evidence: a wheel that turns evenly makes them without ticks.
    """
    step = np.abs(np.diff(angle[np.isfinite(angle)]))
    other = np.append(True, np.abs(np.diff(step)) > 1e-5)[: len(step)]
    step = step[other & (step > 1e-5)]
    if len(step) < 8:
        return 0.0
    size = float(step.min())
    size = float(np.mean(step / np.maximum(1.0, np.round(step / size))))
    rest = np.abs(step / size - np.round(step / size))
    # Angles of six decimals miss a multiple by a millionth of a radian.
    return size if np.all(rest * size < 5e-6 + 1e-4 * size) else 0.0


def _smoothed(t: Array, angle: Array, speed: Array | None, step: float) -> tuple[Array, Array]:
    """Angle and speed that agree with an encoder's steps and change smoothly."""
    known = np.isfinite(angle)
    if speed is not None and np.isfinite(speed).any():
        rate = bridged(t, speed[:, None])[:, 0]
        way = integrated(t, rate)
        offset = angle[known] - way[known]
        moving = np.abs(rate[3:]) > 0.1 * np.abs(rate).max()
        rough = np.abs(np.diff(way, n=3))[moving]
        own = len(rough) > 0 and float(np.quantile(rough, 0.75)) < SETTINGS.own_speed * step
        if own and float(np.std(offset)) < SETTINGS.within_tick * step:
            return way + float(np.mean(offset)), rate
    from scipy.interpolate import make_smoothing_spline

    at, values = t[known], angle[known]
    span = float(np.median(np.diff(at)))
    best = None
    # The stiffest curve that stays as near to the counts as rounding leaves them.
    for stiffness in span**3 * 10.0 ** np.arange(5.0, -1.1, -0.5):
        best = make_smoothing_spline(at, values, lam=stiffness)
        if float(np.sqrt(np.mean((best(at) - values) ** 2))) < 1.05 * step / np.sqrt(12.0):
            break
    assert best is not None
    return np.asarray(best(t)), np.asarray(best.derivative()(t))
