"""The result of a diagnosis: the verdict and the figures that support it, as frozen values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

from slipmargin.checks import Array
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.verdict import Judgement
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
@dataclass(frozen=True, slots=True, kw_only=True)
class ShownBy:
    """What an effect does in one data set of a campaign: chi of its runs without it and with it [1].

    All other effects stay as they were fitted.
    """

    data_set: str
    runs: int
    chi_without: float
    chi_with: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Finding:
    """One effect the model lacked, and the evidence for it.

    ``name`` is that of an effect of the catalogue only if its own evidence carries it; otherwise it is
    ``unnamed_<variable>``, ``label`` still says which form was fitted, and ``doubts`` say why.  ``mapped``
    says whether the residual map supports the variable; None where the map can say nothing of it.  In a
    campaign ``group`` is the floor, loading or instrument it belongs to (empty: the machine, or there is no
    campaign), and ``shown_by`` its evidence from each data set in which it acts.
    """

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
    doubts: tuple[str, ...] = ()
    mapped: bool | None = None
    group: str = ""
    shown_by: tuple[ShownBy, ...] = ()


class LeadSource(Enum):
    """What supports a lead."""

    MAP = "map"  #: the residual of left-out runs follows the variable
    ORDER = "order"  #: the residual is periodic in a wheel's angle
    RUN_ORDER = "run-order"  #: what fits each run by itself grows or falls from run to run
    FIT = "fit"  #: a candidate over the variable fits the searched runs best, nothing more
    BORNE_OUT = "borne-out"  #: runs that it had not seen bear it out, but its own parameters do not
    REJECTED = "rejected"  #: it was fitted and not borne out by runs that it had not seen


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Lead:
    """A variable that the residual may follow: a hint, not a claim.

    ``share`` and ``p_value`` are those of its source where that has them; ``candidate`` is the label of what
    fits best over it; ``next_run`` the run to drive to confirm or refute it.
    """

    traced_to: Trace
    source: LeadSource
    why: str
    next_run: str
    share: float | None = None
    p_value: float | None = None
    candidate: str | None = None

    @property
    def follows(self) -> bool:
        """Whether the residual follows the variable more than chance makes it."""
        significant = self.p_value is not None and self.p_value <= SETTINGS.level
        tested = self.source in (LeadSource.ORDER, LeadSource.RUN_ORDER)  # by their own permutations
        return tested or (self.source is LeadSource.MAP and significant)

    @property
    def stands_out(self) -> bool:
        """Whether chance makes runs left out follow the variable as rarely as a proposal must."""
        significant = self.p_value is not None and self.p_value <= SETTINGS.significance
        return self.source is LeadSource.MAP and significant


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Rejected:
    """A structure that was proposed and is not claimed: its labels, why, and chi without and with it.

    ``traced_to`` are its effects' variables.

    ``borne_out``: as a whole, against the model with none of it, it predicts runs better to which it was not
    fitted, and yet its own parameters do not carry all of it.  ``lowers``: it takes the share that is asked
    for off all runs together, each predicted without its own, and no error of whole unseen runs grows.
    """

    labels: tuple[str, ...]
    failures: tuple[str, ...]
    chi_before: float
    chi_after: float
    borne_out: bool = False
    lowers: bool = False
    traced_to: tuple[Trace, ...] = ()


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
    """One trial for the plots: times (T,), measured, predicted before and after (T, 3).

    ``run`` is the number of the run that it is, or is cut from; ``data_set`` is where the data set of that
    run was read, or its name.
    """

    name: str
    run: int
    data_set: str
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
    """Verdict, findings and evidence of one data set.

    ``held_out`` names the runs set aside before any fit; where none was, ``cross_validated`` says whether
    each run was predicted with what was fitted to the others.
    """

    data_set: str
    surface: str
    verdict: Verdict
    noise: Array
    noise_estimated: bool
    held_out: tuple[str, ...]
    cross_validated: bool
    before: Score
    after: Score
    judgement: Judgement | None
    rejected: tuple[Rejected, ...]
    findings: tuple[Finding, ...]
    steps: tuple[Step, ...]
    map: tuple[MapEntry, ...]
    map_after: tuple[MapEntry, ...]
    leads: tuple[Lead, ...]
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

    @property
    def one_run(self) -> bool:
        """Whether there is one run alone, so that no fit was judged on another."""
        return not (self.held_out or self.cross_validated)
