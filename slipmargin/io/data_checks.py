"""Does a data set make sense?  Each fault named in one line with its likely cause.

The wheels alone predict a motion; the camera saw one.  Slip takes a part of it away, but it neither
mirrors it, nor multiplies it by a thousand, nor hands one wheel's turning to another.  Swapped
wheels, turned signs and a mirrored frame are recognised by trying them: the arrangement that
explains the measured motion far better than the one stated is named.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.odometry import body_path, bridged, wheel_angles
from slipmargin.data.record import Record
from slipmargin.physics.kinematics import WheelGeometry

#: An arrangement is named when it leaves less than this share of the stated one's misfit (right data: all
#: others leave 1.3 times or more, whatever slips; swapped: the right one leaves 0.65 or less) …
_CLEARLY = 0.7
#: … and the stated one misses at least this share of the motion.
_MISSES = 0.65
_MOST_WHEELS = 5  #: permutations are tried up to here


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One fault: where, what, and the likely cause with its cure."""

    place: str
    problem: str
    cause: str

    def __str__(self) -> str:
        return f"{self.place}: {self.problem}; likely cause: {self.cause}"


def check_data_set(data_set: DataSet) -> tuple[Finding, ...]:
    """Every fault that the data tell of themselves; empty where they make sense."""
    found = [f for trial in data_set.trials for f in _clock(trial)]
    contacts = data_set.recipe.build(data_set.surface).geometry
    pieces = [
        p for p in (_twists(t, contacts, data_set.wheel_signal) for t in data_set.trials) if p is not None
    ]
    if pieces:
        found += _motion(
            np.concatenate([p[0] for p in pieces]), np.concatenate([p[1] for p in pieces]), contacts
        )
    return tuple(_once(found))


def _clock(trial: Record) -> list[Finding]:
    step = np.diff(trial.t_s)
    usual = float(np.median(step))
    found = []
    if usual > 0.9:
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"samples are {usual:g} s apart",
                cause="time in milliseconds, divide it by 1000",
            )
        )
    elif usual < 2e-5:
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"samples are {usual:g} s apart",
                cause="time divided by 1000 twice, multiply it by 1000",
            )
        )
    gap = int(np.argmax(step))
    if step[gap] > max(50.0 * usual, 20.0 * usual + 1.0):
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"the clock jumps by {step[gap]:.4g} s at {trial.t_s[gap]:.4g} s",
                cause="two runs in one file or a clock that was set; cut the file there",
            )
        )
    return found


def _twists(trial: Record, contacts: WheelGeometry, signal: WheelSignal) -> tuple[Array, Array] | None:
    """Wheel angles turned (K, N) and body displacement seen (K, 3), piece by piece; None if nothing moves."""
    if signal is WheelSignal.COMMANDED:
        angle = wheel_angles(trial.t_s, None, trial.omega_cmd)
    else:
        angle = wheel_angles(trial.t_s, trial.theta, trial.omega)
    if angle is None or not trial.seen.any() or len(trial.t_s) < 8:
        return None
    pose = bridged(trial.t_s, trial.pose)
    edges = np.linspace(0, len(trial.t_s) - 1, min(9, len(trial.t_s) // 4) + 1).astype(int)
    path = body_path(pose)
    return np.diff(angle[edges], axis=0), np.diff(path[edges], axis=0)


def _motion(turned: Array, seen: Array, contacts: WheelGeometry) -> list[Finding]:
    matrix = contacts.no_slip_map()
    reach = float(np.mean(np.hypot(*contacts.position_m.T)))
    weigh = np.array([1.0, 1.0, reach])
    power = float(np.sum((seen * weigh) ** 2))
    by_wheels = turned @ matrix.T
    rolled = float(np.sum((by_wheels * weigh) ** 2))
    if rolled == 0.0 or power == 0.0:
        still = "wheels" if rolled == 0.0 else "pose"
        if max(rolled, power) < 1e-6:
            return []
        return [
            Finding(
                place="trials",
                problem=f"the {still} never move though the other does",
                cause=f"a dead channel or the wrong column for the {still}",
            )
        ]
    scaled = _scale(by_wheels, seen)
    if scaled:
        return scaled
    stated = _misfit(by_wheels * weigh, seen * weigh)
    if stated < _MISSES:
        return []
    best, name = stated, ""
    for text, candidate, view in _arrangements(contacts.names, turned, seen):
        misfit = _misfit((candidate @ matrix.T) * weigh, view * weigh)
        if misfit < best * (0.999 if name else 1.0):
            best, name = misfit, text
    if not name or best > _CLEARLY * stated:
        return []
    what = f"the wheels' motion misses {100 * stated:.0f} % of the measured one, {100 * best:.0f} % otherwise"
    return [Finding(place="trials", problem=what, cause=name)]


def _scale(by_wheels: Array, seen: Array) -> list[Finding]:
    """Lengths or angles off by an absurd factor."""
    rolled, moved = np.hypot(*by_wheels[:, :2].T).sum(), np.hypot(*seen[:, :2].T).sum()
    turned_by, turned = np.abs(by_wheels[:, 2]).sum(), np.abs(seen[:, 2]).sum()
    found = []
    if rolled > 0.0 and moved > 0.0 and not 0.1 < moved / rolled < 10.0:
        ratio = moved / rolled
        unit = {
            3: "millimetres, divide by 1000",
            2: "centimetres, divide by 100",
            -3: "kilometres, or wheel angles in milliradians",
        }
        power = round(np.log10(ratio))
        cause = (
            ("x_m and y_m in " + unit[power])
            if power in unit
            else ("wrong unit of the pose, the wheel angles or radius_m")
        )
        if 0.5 < ratio * 180.0 / np.pi < 1.1:  # slip takes up to half of the motion, and adds none
            cause = "wheel angles or speeds in degrees instead of radians"
        found.append(
            Finding(
                place="x_m, y_m",
                cause=cause,
                problem=f"the robot moved {ratio:.3g} times what its wheels rolled",
            )
        )
    if turned_by > 0.3 and turned > 0.0 and 30.0 < turned / turned_by < 100.0:
        found.append(
            Finding(
                place="phi_rad",
                problem=f"the robot turned {turned / turned_by:.3g} times what its wheels say",
                cause="degrees instead of radians",
            )
        )
    return found


def _misfit(by: Array, seen: Array) -> float:
    """Share of the measured motion that one factor between 0.3 and 1.5 on the wheels leaves unexplained."""
    factor = float(np.clip(np.sum(by * seen) / np.sum(by * by), 0.3, 1.5))
    return float(np.sqrt(np.sum((seen - factor * by) ** 2) / np.sum(seen**2)))


def _arrangements(names: tuple[str, ...], turned: Array, seen: Array) -> list[tuple[str, Array, Array]]:
    """What could be wrong: (its name, wheel angles put right, motion put right), simplest first."""
    n = len(names)
    mirror = seen * np.array([1.0, -1.0, -1.0])
    views = [
        ("", seen),
        ("a mirrored frame (turn the sign of y_m and of phi_rad)", mirror),
        ("phi_rad counted clockwise (turn its sign)", _turned_back(seen)),
    ]
    orders = [tuple(range(n))]
    if n <= _MOST_WHEELS:
        orders += sorted(
            (p for p in permutations(range(n)) if p != tuple(range(n))),
            key=lambda p: sum(i != j for i, j in enumerate(p)),
        )
    signs = [
        ("", np.ones(n)),
        ("every wheel turning the other way (turn the sign of omega and theta)", -np.ones(n)),
    ]
    signs += [(f"wheel {names[i]} turning the other way (turn its sign)", _flip(n, i)) for i in range(n)]
    out = []
    for view, moved in views:
        for order in orders:
            for sign, factor in signs:
                swapped = (
                    ""
                    if order == orders[0]
                    else "columns of wheels "
                    + " and ".join(names[i] for i, j in enumerate(order) if i != j)
                    + " swapped"
                )
                text = " and ".join(part for part in (swapped, sign, view) if part)
                if text:
                    out.append((text, turned[:, list(order)] * factor, moved))
    return sorted(out, key=lambda item: item[0].count(" and "))


def _flip(n: int, i: int) -> Array:
    factor = np.ones(n)
    factor[i] = -1.0
    return factor


def _turned_back(seen: Array) -> Array:
    """Heading counted the other way; its displacements are only right while the heading is small."""
    return np.asarray(seen * np.array([1.0, 1.0, -1.0]))


def _once(found: list[Finding]) -> list[Finding]:
    """One line a fault, with how many trials share it."""
    kinds: dict[str, list[Finding]] = {}
    for finding in found:
        kinds.setdefault(finding.cause, []).append(finding)
    return [
        group[0]
        if len(group) == 1
        else Finding(
            place=f"{group[0].place} (and {len(group) - 1} more)", problem=group[0].problem, cause=cause
        )
        for cause, group in kinds.items()
    ]
