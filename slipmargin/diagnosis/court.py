"""The runs before which a structure is judged, and the judgement: what holds is what unseen runs bear out.

Far above the noise runs are judged in pieces, as the search compares them; what is reported are the errors of
whole runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Index
from slipmargin.data.record import Record
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.findings import doubted
from slipmargin.diagnosis.held_out import (
    Prediction,
    by_run,
    phases_matter,
    predicted,
    score,
    sets_of_effects,
)
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import nothing_sure
from slipmargin.diagnosis.result import Rejected, Score, Verdict
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.signals import InterpolationScheme
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.verdict import Judgement, RunErrors, explained_share, judge, judged
from slipmargin.effects import AnyEffect


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checked:
    """The structure that holds (None: none does), errors (a row each run) before and after, and the rest.

    ``problem`` has the wheel phases with which the runs were judged; ``judgement`` is that of ``state``;
    ``near_noise``: the model as it is leaves no more than noise.
    """

    state: State | None
    before: RunErrors
    after: RunErrors
    judgement: Judgement | None
    problem: Problem
    phased: bool
    rejected: tuple[Rejected, ...]
    near_noise: bool = False

    @property
    def verdict(self) -> Verdict:
        """Found, nothing missing (errors near the noise), or unexplained."""
        if self.state is not None:
            return Verdict.EFFECT_FOUND
        return Verdict.NO_MISSING_EFFECT if self.near_noise else Verdict.UNEXPLAINED


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Court:
    """The runs before which structures are judged.

    ``runs`` (R,) is the run each trial is, or is cut from; ``held`` are the trials that the search has not
    seen, ``seen`` the others; ``records`` are the uncut runs.  ``rotations`` are candidates
    of their own, one a camera, beside those that the search asks.
    """

    problem: Problem
    runs: tuple[int, ...]
    held: Index
    seen: Index
    records: tuple[Record, ...]
    seed: int
    rotations: tuple[Candidate, ...] = ()

    @property
    def unseen(self) -> NDArray[np.bool_]:
        """Which runs (in order) the search has not seen."""
        return np.isin(np.unique(self.runs), [self.runs[i] for i in self.held])

    @property
    def seen_runs(self) -> list[int]:
        """The run of each trial that the search has seen."""
        return [self.runs[i] for i in self.seen]

    def errors(
        self, state: State | None, *, in_pieces: bool = False, like: State | None = None
    ) -> Prediction:
        """Errors of every trial, predicted with parameters that were fitted to others; whole or in pieces.

        Without a state no effect acts.  They are scored as those of ``like`` are, by default as their own.
        """
        count = len(self.problem.trials)
        effects: list[tuple[AnyEffect, ...]] = [() if state is None else state.fit.effects] * count
        if state is not None:
            for part, own in zip(state.parts, sets_of_effects(state.structure, state.xs), strict=True):
                for i in state.fit.trials[part]:
                    effects[i] = own
        like = like or state
        phased = phases_matter(self.problem, () if like is None else like.fit.effects)
        full = self.problem.rebuilt(InterpolationScheme.FULL)
        if in_pieces and like is not None:
            full = full.as_seen_in(like.view)
        records = [self.records[run] for run in self.runs]
        return predicted(full, np.arange(count, dtype=np.int64), records, effects, phased)

    def verdict(self, before: RunErrors, after: RunErrors) -> Judgement:
        """The judgement by the searched runs if these already speak against it, else by all."""
        unseen, sigma = self.unseen, self.problem.sigma
        if unseen.any() and not unseen.all():
            rows = np.flatnonzero(~unseen)
            none = np.zeros(len(rows), dtype=bool)
            some = before.of(rows), after.of(rows)
            early = judge(*some, none, self.seed, by_chance=False, numbers=rows, sigma=sigma)
            if not early.holds:
                return early
        return judge(before, after, unseen, self.seed, sigma=sigma)


def put(court: Court, state: State, rejected: list[Rejected]) -> Checked | None:
    """A structure before the runs: what holds, or None and the reason among the ``rejected``."""
    labels = tuple(c.label for c in state.structure)
    after = court.errors(state)
    before = court.errors(None, like=state)
    one, two = by_run(before.errors, court.runs), by_run(after.errors, court.runs)
    fresh = judged(court.unseen)
    astray = larger(score(one, fresh), score(two, fresh))
    if state.view.piece is None:
        judgement = court.verdict(one, two)
    else:  # a wrong heading early in a whole run outweighs all that is right after it
        pieces = [court.errors(s, like=state, in_pieces=True) for s in (None, state)]
        judgement = court.verdict(*(by_run(p.errors, court.runs) for p in pieces))
    # A rotation of these is shown by pairs of runs: each run by itself leaves it open.
    unsure = zip(state.structure, nothing_sure(state, court.seen_runs), strict=True)
    idle = [c.label for c, none in unsure if none and c not in court.rotations]
    failures = judgement.failures + astray
    failures += tuple(f"the runs leave it open that {label} does nothing" for label in idle)
    if one.chi() <= SETTINGS.noise_chi and doubted(state.view, state.fit):
        failures += ("so near the noise only a name that its own evidence carries is claimed",)
    if failures:
        rejected.append(
            Rejected(
                labels=labels,
                failures=failures,
                chi_before=one.chi(),
                chi_after=two.chi(),
                borne_out=not judgement.failures + astray,
                traced_to=tuple(c.trace for c in state.structure),
                lowers=not astray and explained_share(one.chi(), two.chi()) >= SETTINGS.explained_share,
            )
        )
        return None
    return Checked(
        state=state,
        before=one,
        after=two,
        judgement=judgement,
        problem=after.problem,
        phased=after.phased,
        rejected=tuple(rejected),
    )


def larger(before: Score, after: Score) -> tuple[str, ...]:
    """Which errors of the whole runs that judge are larger after, in words.

    A correction with which one of them grows by more than the simulation is accurate is not claimed: what is
    called found makes every error that is reported smaller, or leaves it as it is.
    """
    rows = (
        ("chi", before.chi, after.chi, ""),
        ("the position error", 1e3 * before.rmse_position_m, 1e3 * after.rmse_position_m, " mm"),
        ("the heading error", 1e3 * before.rmse_heading_rad, 1e3 * after.rmse_heading_rad, " mrad"),
    )
    return tuple(
        f"on whole runs {what} grows from {was:.4g} to {now:.4g}{unit}"
        for what, was, now, unit in rows
        if not now <= (1.0 + SETTINGS.same_error) * was
    )


def better(court: Court, held: Checked, proposed: State, rejected: list[Rejected]) -> Checked | None:
    """A proposal that the runs bear out, if it predicts them better than what holds."""
    found = put(court, proposed, rejected)
    return found if found is not None and found.after.chi() < held.after.chi() else None
