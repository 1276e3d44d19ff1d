"""Several robots side by side: who is best at what, who are alike, and where each one's battery belongs.

A difference counts where it is larger than chance would make it.  What is uncertain is the floor: the
friction coefficients that the robot files give with a spread.  A coefficient that two files state alike is
the same floor under both, so it moves both values together and much of it cancels in the difference;
coefficients stated differently are independent.  To first order the difference of two values has the variance

    Σ_k (g_k − g'_k)²,   g_k the change of a value by one standard deviation of coefficient k.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.bounds_summary import recommended
from slipmargin.physics.loads import LoadRule
from slipmargin.robot.uncertain import Uncertain
from slipmargin.study.columns import columns_of, static_columns
from slipmargin.study.objectives import Kind
from slipmargin.study.quantities import QUANTITIES
from slipmargin.study.robot_on_surface import RobotOnSurface

#: Values closer than this share are alike: between the 5 degrees of the directions in which cornering is
#: looked at, its weakest one may be lower by so much [1].
SAME = 5e-3
#: Standard deviations of a difference below which it may be chance: 95 % of a normal distribution.
SURE = 1.96
#: A gain by moving the centre of mass below this share is not worth moving a battery [1].
WORTH = 0.01
#: The centre of mass is looked for within this share of the wheels' reach; so many places a side, rounds of
#: finer places around the best, and the step of the directions while looking [deg].
REACH, SIDE, ROUNDS, LOOK_DEG = 0.6, 7, 4, 4.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What ideas are compared by: a word, the unit and the sentence's end after a value; more is better."""

    key: str
    word: str
    unit: str
    meaning: str


START, DRIVE, PLACE = "start_worst_m_s2", "drive_worst_m_s2", "place_share"
QUESTIONS = (
    Question(key=START, word="starting", unit="m/s²", meaning="in the weakest direction"),
    Question(
        key=DRIVE,
        word="driving",
        unit="m/s²",
        meaning="in the weakest direction, up to half of the motors' top speed",
    ),
    Question(key="brake_worst_m_s2", word="braking", unit="m/s²", meaning="in the weakest direction"),
    Question(key="corner_m_s", word="cornering", unit="m/s", meaning="in a bend of 0.5 m radius"),
    Question(key="spin_rad_s2", word="turning", unit="rad/s²", meaning="on the spot"),
    Question(key="push_N", word="pushing", unit="N", meaning="at the weakest orientation"),
    Question(
        key=PLACE,
        word="battery",
        unit="%",
        meaning="of what starting would be with the centre of mass in the best place",
    ),
)
#: Which material's which coefficient, and how the file spells it.
_Floor = tuple[str, str, str]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """Where the centre of mass lies and where it would lie best [m], and starting there [m/s²]."""

    own_m: tuple[float, float]
    best_m: tuple[float, float]
    own_m_s2: float
    best_m_s2: float

    @property
    def share(self) -> float:
        """The part of the best place's starting that there is already [%]."""
        return 100.0 * max(self.own_m_s2, 0.0) / self.best_m_s2 if self.best_m_s2 > 0.0 else math.nan


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Idea:
    """One robot: its values by question (NaN: it has none), and their changes by what is uncertain."""

    name: str
    design: RobotOnSurface
    values: Mapping[str, float]
    changes: Mapping[_Floor, Mapping[str, float]]
    place: Place | None

    def deviation(self, key: str) -> float:
        """Standard deviation of a value by the uncertain friction; 0 where none is uncertain."""
        return math.sqrt(sum(one.get(key, 0.0) ** 2 for one in self.changes.values()))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ranking:
    """The answer to a question: ideas from best to worst, the ``alike`` first of which cannot be told apart.

    ``chance`` says whether a spread of the friction, not only rounding, is why some are alike.
    """

    question: Question
    order: tuple[int, ...]
    alike: int
    chance: bool


def compare(names: Sequence[str], designs: Sequence[RobotOnSurface]) -> tuple[Idea, ...]:
    """The values of each idea.

    Raises
    ------
    InputError
        Where a robot cannot be built on its surface.
    """
    floors = [_uncertain(design) for design in designs]
    tried: list[RobotOnSurface] = []
    for design, keys in zip(designs, floors, strict=True):
        design.build()  # an idea that cannot be is an error, not a row without numbers
        tried += [design, *(_moved(design, key, side) for key in keys for side in (-1.0, 1.0))]
    rows = iter(_values(tried))
    out = []
    for name, design, keys in zip(names, designs, floors, strict=True):
        values, changes = next(rows), {}
        for key in keys:
            low, high = next(rows), next(rows)
            changes[key] = {q: 0.5 * (high[q] - low[q]) for q in values if math.isfinite(high[q] - low[q])}
        place = _place(design)
        values[PLACE] = math.nan if place is None else place.share
        out.append(Idea(name=name, design=design, values=values, changes=changes, place=place))
    return tuple(out)


def ranking(ideas: Sequence[Idea], question: Question) -> Ranking | None:
    """Who is best at a question; None where no idea has a value."""
    key = question.key
    found = [k for k, idea in enumerate(ideas) if math.isfinite(idea.values[key])]
    if not found:
        return None
    order = tuple(sorted(found, key=lambda k: -ideas[k].values[key]))
    best = ideas[order[0]]
    close = WORTH if key == PLACE else SAME
    level = [k for k in order if _gap(best, ideas[k], key) <= close * abs(best.values[key])]
    alike = [
        k for k in order if k in level or _gap(best, ideas[k], key) <= SURE * _spread(best, ideas[k], key)
    ]
    return Ranking(
        question=question,
        order=(*(k for k in order if k in alike), *(k for k in order if k not in alike)),
        alike=len(alike),
        chance=len(alike) > len(level),
    )


def _gap(one: Idea, other: Idea, key: str) -> float:
    return abs(one.values[key] - other.values[key])


def _spread(one: Idea, other: Idea, key: str) -> float:
    """Standard deviation of the difference of two ideas' values."""
    floors = {*one.changes, *other.changes}
    return math.sqrt(
        sum(
            (one.changes.get(k, {}).get(key, 0.0) - other.changes.get(k, {}).get(key, 0.0)) ** 2
            for k in floors
        )
    )


def lacks_torque(idea: Idea, question: Question) -> bool:
    """Whether motors without torque left are why it has no value: a robot that can start does not slip."""
    return question.key == DRIVE and idea.values[DRIVE] <= 0.0 < idea.values[START]


def _values(designs: Sequence[RobotOnSurface]) -> list[dict[str, float]]:
    """Values of every question but that of the battery."""
    pull = static_columns(designs, names=["f_worst"])[0]["f_worst"]
    out = []
    for design, least in zip(designs, pull, strict=True):
        moving = columns_of(design, (Kind.MOTION,))
        model = design.build()
        found = {q.key: moving[q.key] for q in QUESTIONS if q.key in moving}
        found[DRIVE] = recommended(model)
        out.append({**found, "push_N": float(least) * model.inertia.weight_N})
    return out


def _uncertain(design: RobotOnSurface) -> tuple[_Floor, ...]:
    """The coefficients of the floor that have a spread."""
    floor, found = design.robot.surface(design.surface), []
    for material in ("roller", "rigid"):
        for way in ("drive", "transverse"):
            value = getattr(getattr(floor, material), way)
            if isinstance(value, Uncertain):
                found.append((material, way, str(value.written())))
    return tuple(found)


def _moved(design: RobotOnSurface, key: _Floor, side: float) -> RobotOnSurface:
    """The design with one coefficient a standard deviation higher or lower."""
    material, way, _ = key
    floor = design.robot.surface(design.surface)
    pair = getattr(floor, material)
    value: Uncertain = getattr(pair, way)
    deviation = value.sd if value.sd is not None else (value.ends[1] - value.ends[0]) / math.sqrt(12.0)
    number = min(max(float(value) + side * deviation, value.span[0]), value.span[1])
    change: dict[str, Any] = {material: replace(pair, **{way: number}), "library": None}
    new = replace(floor, **change)
    others = tuple(new if s.name == floor.name else s for s in design.robot.surfaces)
    return design.with_robot(replace(design.robot, surfaces=others))


def _place(design: RobotOnSurface) -> Place | None:
    """The best place of the centre of mass for starting; None where the loads do not follow it."""
    if design.robot.load_rule in (LoadRule.EQUAL, LoadRule.FIXED):
        return None
    own = (float(design.robot.body.com_m[0]), float(design.robot.body.com_m[1]))
    reach = REACH * np.max(np.abs([w.position_m for w in design.robot.wheels]), axis=0)
    steps = np.linspace(-1.0, 1.0, SIDE)
    best, at = _starting(design, own, LOOK_DEG), own
    places, size = (
        [(float(x), float(y)) for x in reach[0] * steps for y in reach[1] * steps],
        2.0 / (SIDE - 1),
    )
    for _ in range(1 + ROUNDS):
        for place in places:
            value = _starting(design, place, LOOK_DEG)
            if value > best:
                best, at = value, place
        size *= 0.5
        places = [
            (at[0] + size * reach[0] * i, at[1] + size * reach[1] * j)
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
            if i or j
        ]
    here, there = _starting(design, own, 1.0), _starting(design, at, 1.0)
    if not math.isfinite(here):
        return None
    if not there > here:
        at, there = own, here
    return Place(own_m=own, best_m=at, own_m_s2=here, best_m_s2=there)


_X, _Y = (next(q for q in QUANTITIES if q.key == key) for key in ("com_x_m", "com_y_m"))


def _starting(design: RobotOnSurface, place_m: tuple[float, float], step_deg: float) -> float:
    """Starting in the weakest direction with its mass centred at a place [m/s²]; −inf where it cannot be."""
    try:
        model = _Y.put(_X.put(design, place_m[0]), place_m[1]).build()
        return float(np.min(directions(model, headings(step_deg)).starting_m_s2))
    except (InputError, NoSolution):
        return -math.inf
