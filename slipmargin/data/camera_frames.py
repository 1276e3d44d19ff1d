"""Faults of single camera frames: repeated, zero, or far from where the robot can be.

A log may write the last pose again until the next frame comes, or zeros where there was none.  Such rows
are no measurement.  A frame that the robot could not have reached with its last velocity, and from which
it is back a moment later, is no measurement either: a marker was mistaken for another.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.noise import white_noise
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair, run_by_run
from slipmargin.data.settings import SETTINGS

Flags = NDArray[np.bool_]


def _rows(record: Record, bad: Flags) -> tuple[Record, float]:
    """The run without the poses of some rows, and how many had one."""
    gone = bad & np.isfinite(record.pose).any(axis=1)
    if not gone.any() or not (record.seen & ~gone).any():
        return record, 0.0
    pose = np.array(record.pose)
    pose[gone] = np.nan
    return replace(record, pose=pose), float(gone.sum())


def without_zeros(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without poses that are zero in x, y and heading where the poses before and after are not near that."""

    def mend(record: Record) -> tuple[Record, float]:
        zero = np.all(record.pose == 0.0, axis=1)
        others = record.seen & ~zero
        if not zero.any() or not others.any():
            return record, 0.0
        at = np.flatnonzero(others)
        row = np.arange(len(zero))
        after = np.searchsorted(at, row)
        before, after = at[np.maximum(after - 1, 0)], at[np.minimum(after, len(at) - 1)]
        near = np.where(np.abs(row - before) <= np.abs(after - row), before, after)
        step = np.abs(np.diff(record.pose[at], axis=0))
        usual = np.quantile(step, 0.9, axis=0) if len(step) else np.zeros(3)
        far = np.any(np.abs(record.pose[near]) > SETTINGS.zero_steps * usual, axis=1)
        return _rows(record, zero & far)

    return run_by_run(
        data_set,
        mend,
        "zero_frames",
        "1",
        lambda size, where: f"{size:.0f} poses are all zeros, {where}: they were taken as missing.",
    )


def without_repeats(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without poses that repeat the row before although the robot moves, and at the times of the frames.

    A frame that comes between two rows is stamped with the later one.  Where frames come regularly, the
    time of each follows from all of them, and the pose is brought to the time of its row.
    """
    rates: list[float] = []

    def mend(record: Record) -> tuple[Record, float]:
        record, count = _rows(record, _repeats(record))
        return record, count

    def words(size: float, where: str) -> str:
        repeats = f"{size:.0f} poses repeat the row before exactly although the robot moves"
        return f"{repeats}, {where}: they were taken as missing."

    data_set, repairs = run_by_run(data_set, mend, "repeated_frames", "1", words)

    def stamp(record: Record) -> tuple[Record, float]:
        moved = _at_rows(record)
        if moved is None:
            return record, 0.0
        rates.append(moved[1])
        return replace(record, pose=moved[0]), moved[2]

    def late(size: float, where: str) -> str:
        rate = float(np.median(rates))
        return (
            f"The camera gives {rate:.3g} frames a second and its frames come up to {1e3 * size:.2g} ms "
            f"before their rows, "
            f"{where}: each pose was brought to the time of its row."
        )

    data_set, stamped = run_by_run(data_set, stamp, "slow_camera", "s", late, total=max)
    return data_set, (*repairs, *stamped)


def _repeats(record: Record) -> Flags:
    pose = record.pose
    same = np.zeros(len(pose), dtype=bool)
    same[1:] = np.all(pose[1:] == pose[:-1], axis=1)
    if same.sum() < SETTINGS.least_repeats:
        return np.zeros(len(pose), dtype=bool)
    frames = np.flatnonzero(record.seen & ~same)
    if len(frames) < 4:
        return np.zeros(len(pose), dtype=bool)
    step = np.abs(np.diff(pose[frames], axis=0))
    # A coarse camera repeats a pose at rest, or while the robot moves by less than its step.
    finest = np.array([float(c[c > 0.0].min()) if (c > 0.0).any() else 0.0 for c in step.T])
    whole = np.maximum(finest, 1e-12)
    coarse = np.all(np.abs(step / whole - np.round(step / whole)) < 1e-3)
    if not coarse:
        return same
    after = np.append(np.any(step > 2.5 * finest, axis=1), False)
    owner = np.searchsorted(frames, np.arange(len(pose)), side="right") - 1
    return np.asarray(same & after[owner.clip(0)] & (owner >= 0))


def _at_rows(record: Record) -> tuple[Array, float, float] | None:
    """Poses at the times of their rows, the rate of the frames [Hz], and the longest delay [s]."""
    t, seen = record.t_s, np.flatnonzero(record.seen)
    row = float(np.median(np.diff(t)))
    if len(seen) < 8 or len(seen) > SETTINGS.slow_camera * len(t):
        return None
    at = t[seen]
    span = float(np.median(np.diff(at)))
    number = np.append(0.0, np.cumsum(np.round(np.diff(at) / span)))
    if np.min(np.diff(number)) < 1.0:
        return None
    for _ in range(3):
        period, first = np.polyfit(number, at, 1)
        again = np.round((at - first) / period)
        again -= again[0]
        if np.array_equal(again, number) or np.min(np.diff(again)) < 1.0:
            break
        number = again
    late = at - (first + period * number)
    late -= late.min()
    # A regular camera's frames are late by less than a row; equal lateness is the camera's delay, not a
    # fault.
    if period < 1.3 * row or late.max() > 1.15 * row or late.max() < 0.1 * row:
        return None
    from scipy.interpolate import CubicSpline

    pose = np.array(record.pose)
    pose[seen] = CubicSpline(at - late, pose[seen])(at)
    return pose, 1.0 / float(period), float(late.max())


def without_excursions(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without frames far from where the robot can be, if it is back where it can be soon after."""
    # The noise of frames that are not off is not known before they are found: twice is enough.
    sigma = white_noise(data_set.trials)
    for _ in range(2):
        trials = tuple(_rows(t, _excursions(t, sigma))[0] for t in data_set.trials)
        sigma = np.minimum(sigma, white_noise(trials))

    return run_by_run(
        data_set,
        lambda record: _rows(record, _excursions(record, sigma)),
        "jumping_frames",
        "1",
        lambda size, where: (
            f"{size:.0f} poses are where the robot cannot have been a moment before and after, {where}: "
            f"they were taken as "
            "missing."
        ),
    )


def _excursions(record: Record, sigma: Array) -> Flags:
    bad = np.zeros(len(record.t_s), dtype=bool)
    rows = np.flatnonzero(record.seen)
    if len(rows) < 2 * SETTINGS.velocity_frames or not _jumps(record.t_s[rows], record.pose[rows], sigma):
        return bad
    gone = _off(record.t_s[rows], record.pose[rows], sigma)
    bad[rows[gone]] = True
    return bad


def _jumps(t: Array, pose: Array, sigma: Array) -> bool:
    """Whether any frame is clearly off the line between its neighbours."""
    w = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None]
    off = np.abs(pose[1:-1] - pose[:-2] * (1.0 - w) - pose[2:] * w)
    return bool(np.any(off > 0.5 * SETTINGS.off_sigma * sigma * np.sqrt(1.0 + w**2 + (1.0 - w) ** 2)))


def _off(t: Array, pose: Array, sigma: Array) -> Flags:
    """Which frames are off: those between a jump and the first frame to which the robot can have come."""
    return _forwards(t, pose, sigma, _good_start(t, pose, sigma))


def _forwards(t: Array, pose: Array, sigma: Array, start: int) -> Flags:
    gone = np.zeros(len(t), dtype=bool)
    gone[:start] = True
    last = [start]
    k = start + 1
    while k < len(t):
        reachable = _reachable(t, pose, sigma, last, k)
        if not reachable:
            back = k + 1
            while back < len(t) and t[back] - t[last[-1]] <= SETTINGS.back_within_s:
                if _reachable(t, pose, sigma, last, back):
                    break
                back += 1
            ends = back >= len(t)
            if ends and len(t) - k <= SETTINGS.most_at_ends:
                gone[k:] = True
                break
            inside = list(range(max(k, back - SETTINGS.velocity_frames), back))
            # Frames that lead on to the one where the robot is believed to be back show where it really is.
            leads_on = not ends and len(inside) >= 3 and _reachable(t, pose, sigma, inside, back)
            if not ends and not leads_on and t[back] - t[last[-1]] <= SETTINGS.back_within_s:
                gone[k:back] = True
                k = back
            else:  # it stays there: an event, after which the last frames say nothing
                last = []
        last = [*last[-(SETTINGS.velocity_frames - 1) :], k]
        k += 1
    return gone


def _good_start(t: Array, pose: Array, sigma: Array) -> int:
    """The first frame that is not off, as seen backwards from those after it."""
    few, most = 2 * SETTINGS.velocity_frames, SETTINGS.most_at_ends
    head = slice(2 * few if len(t) > 2 * few else None, None, -1)
    if len(t[head]) < few:
        return 0
    gone = _forwards(-t[head], pose[head], sigma, 0)[::-1]
    return most if gone[:most].all() else int(np.argmin(gone[:most]))


def _allowed(sigma: Array, gap: float, back: float) -> Array:
    """How far a frame may be from a straight line of the last ones (3,)."""
    most = SETTINGS.acceleration_m_s2 * np.array([1.0, 1.0, 1.0 / SETTINGS.lever_m])
    return np.asarray(SETTINGS.off_sigma * sigma * np.sqrt(2.0) + most * gap * (0.5 * gap + back))


def _reachable(t: Array, pose: Array, sigma: Array, last: list[int], k: int) -> bool:
    """Whether the robot can have come to frame ``k`` from the last good ones with the velocity of these."""
    gap = float(t[k] - t[last[-1]])
    one = pose[last[-1]]
    if len(last) < 3:
        return bool(np.all(np.abs(pose[k] - one) <= _allowed(sigma, gap, 1.0 * gap) + 1.5 * gap))
    at = t[last] - t[last[-1]]
    middle = at.mean()
    spread = float(np.sum((at - middle) ** 2))
    velocity = ((at - middle) @ pose[last]) / spread
    level = pose[last].mean(axis=0) - velocity * middle
    # The line through noisy frames is uncertain where it is extended.
    share = np.sqrt(1.0 + 1.0 / len(last) + (gap - middle) ** 2 / spread)
    allowed = _allowed(sigma * share / np.sqrt(2.0), gap, 0.5 * float(-at[0]))
    return bool(np.all(np.abs(pose[k] - level - velocity * gap) <= allowed))
