"""The objectives of a design study: name, unit, direction of improvement, meaning.

Forces are per m g and on rollers unless the name says otherwise; directions of motion are in the body
frame.  "Must slip": constant speed in that direction needs more drive force than the floor gives.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

from slipmargin.io.toml_table import one_of


@final
class Kind(Enum):
    """How an objective is computed, which decides its cost."""

    STATIC = "all designs at once"
    MOTION = "a model each, milliseconds"
    LAPS = "planned paths, tenths of a second each"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Objective:
    """One column of a study that can be optimised; ``sign`` +1: more is better, −1: less is better."""

    name: str
    unit: str
    sign: float
    kind: Kind
    meaning: str


def _more(name: str, unit: str, kind: Kind, meaning: str) -> Objective:
    return Objective(name=name, unit=unit, sign=1.0, kind=kind, meaning=meaning)


def _less(name: str, unit: str, kind: Kind, meaning: str) -> Objective:
    return Objective(name=name, unit=unit, sign=-1.0, kind=kind, meaning=meaning)


OBJECTIVES: tuple[Objective, ...] = (
    _more("f_worst", "m g", Kind.STATIC, "weakest pull without slip, over all headings"),
    _more("f_mean", "m g", Kind.STATIC, "mean pull without slip, over all headings"),
    _more("f_best", "m g", Kind.STATIC, "strongest pull without slip, over all headings"),
    _more("isotropy", "1", Kind.STATIC, "weakest over strongest pull"),
    _more("f_low_worst", "m g", Kind.STATIC, "weakest pull over headings and roller/rigid states"),
    _more("f_rigid_worst", "m g", Kind.STATIC, "weakest pull with every wheel on rigid material"),
    _more("f_worst_equal", "m g", Kind.STATIC, "weakest pull under equal loads m g / N"),
    _more("f_worst_static", "m g", Kind.STATIC, "weakest pull under the loads of statics"),
    _more(
        "yaw_moment_N_m", "N m", Kind.STATIC, "largest pure yaw moment held in both senses at every heading"
    ),
    _more("load_least", "m g", Kind.STATIC, "load of the lightest wheel at any heading"),
    _more("start_worst_m_s2", "m/s²", Kind.MOTION, "speeding up in the weakest direction"),
    _more("start_mean_m_s2", "m/s²", Kind.MOTION, "mean speeding up over directions"),
    _more("brake_worst_m_s2", "m/s²", Kind.MOTION, "braking in the weakest direction"),
    _more("brake_mean_m_s2", "m/s²", Kind.MOTION, "mean braking over directions"),
    _more(
        "start_unknown_m_s2",
        "m/s²",
        Kind.MOTION,
        "speeding up in the weakest direction where each wheel may stand on roller or rigid material",
    ),
    _more("corner_m_s", "m/s", Kind.MOTION, "slowest of the fastest bends of 0.5 m radius, heading held"),
    _more("spin_rad_s2", "rad/s²", Kind.MOTION, "speeding up of a turn on the spot"),
    _less("slip_share", "1", Kind.MOTION, "share of directions in which steady motion must slip, on rollers"),
    _less("slip_share_rigid", "1", Kind.MOTION, "the same with every wheel on rigid material"),
    _less(
        "slip_share_unknown",
        "1",
        Kind.MOTION,
        "the same where each wheel may stand on roller or rigid material",
    ),
    _less(
        "steady_use_unknown",
        "1",
        Kind.MOTION,
        "most grip that steady motion needs where each wheel may stand on either",
    ),
    _less("laps_s", "s", Kind.LAPS, "time over the benchmark paths with 10 % margin"),
)
BY_NAME = {o.name: o for o in OBJECTIVES}


def objective(name: str) -> Objective:
    """The objective called ``name``.

    Raises
    ------
    InputError
        Listing every known one.
    """
    return BY_NAME[one_of("objective", name, BY_NAME)]


def names_of(kind: Kind) -> tuple[str, ...]:
    """The objectives of one kind, in order."""
    return tuple(o.name for o in OBJECTIVES if o.kind is kind)
