"""The result of a diagnosis: the verdict and the figures that support it, as frozen values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

from slipmargin.checks import Array
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.effects import AnyEffect, Recipe, Trace


class Verdict(Enum):
    """What the loop found."""

    EFFECT_FOUND = "effect-found"
    NO_MISSING_EFFECT = "no-missing-effect"
    UNEXPLAINED = "unexplained"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """How well a model predicts held-out trials: rms position [m], heading [rad], and chi [1]."""

    rmse_position_m: float
    rmse_heading_rad: float
    chi: float


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A parameter with its 95 % interval; ``at_bound`` where it ended on the edge of its range."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    at_bound: bool = False


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Finding:
    """One effect the model lacked, and the evidence for it."""

    effect: AnyEffect
    name: str
    label: str
    traced_to: Trace
    wheels: tuple[str, ...]
    parameters: tuple[Estimate, ...]
    derived: tuple[Estimate, ...]
    chi_without: float
    chi_with: float
    p_value: float
    candidates_tried: int
    confused_with: tuple[str, ...]
    confirm: str
    equation: str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """A candidate of one round: its label, variable, number of parameters and chi as the search counts it."""

    label: str
    traced_to: Trace
    named: bool
    parameters: int
    chi: float


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A round of the search: chi before, the candidates best first, and the one taken (None: stop)."""

    chi_before: float
    tried: tuple[Tried, ...]
    taken: str | None


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TrialTrajectories:
    """One trial for the plots: times (T,), measured, predicted before and after (T, 3)."""

    name: str
    held_out: bool
    t_s: Array
    measured: Array
    before: Array
    after: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something that happened once, at a time, in one trial: not physics."""

    trial: str
    t_s: float
    channel: str
    size_sigma: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagnosis:
    """Verdict, findings and evidence of one data set."""

    data_set: str
    surface: str
    verdict: Verdict
    noise: Array
    noise_estimated: bool
    held_out: tuple[str, ...]
    cross_validated: bool
    before: Score
    after: Score
    findings: tuple[Finding, ...]
    steps: tuple[Step, ...]
    where: tuple[ResidualDependence, ...]
    where_after: tuple[ResidualDependence, ...]
    turns: tuple[Periodicity, ...]
    excitation: tuple[float, ...]
    events: tuple[Event, ...]
    outliers: int
    trials: tuple[TrialTrajectories, ...]
    recipe: Recipe
    corrected: Recipe
    remarks: tuple[str, ...]
    repairs: tuple[Repair, ...] = ()
