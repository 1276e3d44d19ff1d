"""Does a data set make sense?  Each fault named in one line with its likely cause.

The wheels alone predict a motion; the camera saw one.  Slip takes a part of it away, but it neither
mirrors it, nor multiplies it by a thousand, nor hands one wheel's turning to another.  Swapped
wheels, turned signs and a mirrored frame are recognised by trying them
(:mod:`~slipmargin.data.odometry_match`): the arrangement that matches the measured motion far better than
the one stated is named.  Wheels that spin on the spot can do that too; only a model that slips tells the two
apart, which the diagnosis has.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry_match import (
    Arrangement,
    Pieces,
    all_pieces,
    arrangements,
    joined,
    mismatch,
    ratios,
)
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One fault: where, what, and the likely cause with its cure.

    ``arrangement`` is the reading of the columns that wheels without slip would ask for, where that is it.
    """

    place: str
    problem: str
    cause: str
    arrangement: Arrangement | None = None

    def __str__(self) -> str:
        return f"{self.place}: {self.problem}; likely cause: {self.cause}"


def check_data_set(data_set: DataSet) -> tuple[Finding, ...]:
    """Every fault that the data tell of themselves; empty where they make sense."""
    found = [f for trial in data_set.trials for f in (*_clock(trial), *_seen(trial))]
    contacts = data_set.recipe.build(data_set.surface).geometry
    pieces = [p for p in all_pieces(data_set) if p is not None]
    if pieces:
        found += _motion(joined(pieces), contacts)
    return tuple(_once(found))


def _clock(trial: Record) -> list[Finding]:
    step = np.diff(trial.t_s)
    usual = float(np.median(step))
    found = []
    if usual > SETTINGS.slowest_row_s:
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"samples are {usual:g} s apart",
                cause="time in milliseconds, divide it by 1000",
            )
        )
    elif usual < SETTINGS.fastest_row_s:
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"samples are {usual:g} s apart",
                cause="time divided by 1000 twice, multiply it by 1000",
            )
        )
    gap = int(np.argmax(step))
    if step[gap] > max(SETTINGS.jump_rows * usual, 20.0 * usual + SETTINGS.jump_s):
        found.append(
            Finding(
                place=f"{trial.name}: t_s",
                problem=f"the clock jumps by {step[gap]:.4g} s at {trial.t_s[gap]:.2f} s",
                cause="two runs in one file or a clock that was set; cut the file there",
            )
        )
    return found


def _seen(trial: Record) -> list[Finding]:
    if trial.poses > 1:
        return []
    return [
        Finding(
            place=trial.name,
            problem="only one pose was measured, which shows no motion",
            cause="x_m, y_m and phi_rad empty in the other rows, give them in two rows or more",
        )
    ]


def _motion(pieces: Pieces, contacts: WheelGeometry) -> list[Finding]:
    rolled = float(np.sum((pieces.turned @ contacts.no_slip_map().T) ** 2))
    power = float(np.sum(pieces.seen[0] ** 2))
    if min(rolled, power) <= SETTINGS.dead * max(rolled, power):
        still = "wheels" if rolled < power else "pose"
        if max(rolled, power) < 1e-6:
            return [
                Finding(
                    place="trials",
                    problem="nothing moves in any run, neither wheels nor pose",
                    cause="dead channels or a robot at rest, give runs in which it drives",
                )
            ]
        return [
            Finding(
                place="trials",
                problem=f"the {still} never move though the other does",
                cause=f"a dead channel or the wrong column for the {still}",
            )
        ]
    scaled = _scale(*ratios(pieces, contacts))
    if scaled:
        return scaled
    stated = mismatch(pieces, None, contacts)
    if not stated > SETTINGS.misses:
        return []
    others = [(mismatch(pieces, a, contacts), a) for a in arrangements(contacts.names)]
    least = min(value for value, _ in others)
    if not least < SETTINGS.clearly_better * stated:
        return []
    best, likely = next((value, a) for value, a in others if value <= SETTINGS.as_good * least + 0.01)
    what = (
        f"where wheels slip least, their motion misses {100 * stated:.0f} % of the measured one, "
        f"{100 * best:.0f} % otherwise"
    )
    return [Finding(place="trials", problem=what, cause=likely.words, arrangement=likely)]


#: What takes a robot so many times as far, and as far round, as its wheels say.
_FAR = {
    1000.0: "x_m and y_m in millimetres, divide by 1000",
    100.0: "x_m and y_m in centimetres, divide by 100",
    1.0 / 0.0254: "x_m and y_m in inches, multiply by 0.0254",
    1.0 / 0.3048: "x_m and y_m in feet, multiply by 0.3048",
    0.001: "x_m and y_m in kilometres, or wheel angles in milliradians",
}
_SPUN = {
    np.pi / 180.0: "wheel angles or speeds in degrees instead of radians",
    2.0 * np.pi / 60.0: "wheel speeds in turns a minute instead of rad/s, multiply by 0.1047",
    2.0 * np.pi: "wheel angles in turns instead of radians",
}


def _scale(moved: float, turned: float) -> list[Finding]:
    """Lengths or angles off by a factor that slip and wear do not make, from how far robots move and turn."""
    found = []
    if not np.isnan(moved) and not SETTINGS.least_moved < moved < SETTINGS.most_moved:
        both = np.isnan(turned) or 0.5 * moved < turned < 2.0 * moved
        units = {**_SPUN, **_FAR} if both else {**_FAR, **_SPUN}
        near = (cause for factor, cause in units.items() if _is_unit(moved / factor))
        found.append(
            Finding(
                place="x_m, y_m",
                cause=next(near, "wrong unit of the pose, the wheel angles or radius_m"),
                problem=f"the robot moved {moved:.3g} times what its wheels rolled",
            )
        )
    elif not np.isnan(turned) and _is_unit(turned * np.pi / 180.0):
        found.append(
            Finding(
                place="phi_rad",
                problem=f"the robot turned {turned:.3g} times what its wheels say",
                cause="degrees instead of radians",
            )
        )
    return found


def _is_unit(ratio: float) -> bool:
    return 1.0 - SETTINGS.unit_below < ratio < 1.0 + SETTINGS.unit_above


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
