"""Forward search over candidates with pulls, judged by orientations that a fit has not seen.

The candidates are all effects of the catalogue and all general forms that move the static limit of these
pulls; which ones do is found by trying.  Each is fitted to all pulls, and scored by minus twice the log
likelihood of whole settings that were left out of the fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import (
    Fit,
    GaussianPrior,
    build,
    evaluate,
    fit,
    limits_of,
)
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.settings import PULLS
from slipmargin.diagnosis.tangents import free_slopes, score_test_gain
from slipmargin.diagnosis.watch import OutOfTime, Watch
from slipmargin.effects import AnyEffect
from slipmargin.errors import InputError

_SURROGATES = 999


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullState:
    """Effects fitted to groups of pulls; ``scores`` (R,) are the groups' sums of squares, each left out."""

    fit: Fit
    scores: Array

    @property
    def structure(self) -> tuple[Candidate, ...]:
        """The candidates in it."""
        return self.fit.structure

    @property
    def score(self) -> float:
        """Sum over groups."""
        return float(self.scores.sum())

    @property
    def off(self) -> float:
        """Sum of squares beside the contact states that the pulls make probable, as fitted."""
        return float(np.sum(beside(self.fit.residual)))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullRound:
    """One step: where it started, what was scored (best first), what was chosen, and whether it was taken."""

    before: PullState
    tried: tuple[PullState, ...]
    best: PullState | None
    p_value: float
    taken: bool

    @property
    def after(self) -> PullState:
        """What stands after it."""
        return self.best if self.taken and self.best is not None else self.before

    def rivals(self) -> list[PullState]:
        """States that these pulls cannot tell from the best one."""
        if self.best is None:
            return []
        return [s for s in self.tried if s is not self.best and no_worse(s, self.best)]


def beside(residual: Array) -> Array:
    """(R,) sums over groups of a², a in σ: how far pulls are beside the contact states they make probable."""
    return np.asarray(np.sum(residual[:, ::2] ** 2, axis=1))


def noise_N(pulls: Pulls) -> tuple[float, float, bool]:
    """Repeatability σ [N] of a pull, its degrees of freedom, and whether repeated pulls showed it.

    Repeats scatter by noise, and by what the wheels happen to stand on: where the root mean square is
    much larger than the median of the differences says, the median counts, which jumps hardly move.
    Without repeats the
    differences from the line between neighbouring orientations stand in for it.

    Raises
    ------
    InputError
        With fewer than four orientations.
    """
    settings, which = pulls.settings()
    if len(settings) < 4:
        raise InputError("pulls.csv", f"holds {len(settings)} settings", "pull in at least four orientations")
    if pulls.sigma_N is not None:
        return pulls.sigma_N, np.inf, False
    groups = [pulls.force_N[which == g] for g in range(len(settings))]
    freedom = float(sum(len(g) - 1 for g in groups))
    if freedom >= 4.0:
        spread = math.sqrt(sum(float(np.sum((g - g.mean()) ** 2)) for g in groups) / freedom)
        pairs = np.concatenate([np.abs(g - np.roll(g, 1))[len(g) == 2 :] for g in groups if len(g) > 1])
        typical = float(np.median(pairs)) / (0.6745 * math.sqrt(2.0))
        if spread > PULLS.scatters * typical:  # repeats stood on different material
            spread = typical
        least = 1e-4 * float(np.mean(pulls.force_N))
        return max(spread, least), freedom, True
    means = np.array([g.mean() for g in groups])
    order = np.argsort(np.mod(settings[:, 0], 2.0 * np.pi))
    phi, mean = np.mod(settings[order, 0], 2.0 * np.pi), means[order]
    w = (phi[1:-1] - phi[:-2]) / np.maximum(phi[2:] - phi[:-2], 1e-9)
    apart = (mean[1:-1] - (mean[:-2] * (1.0 - w) + mean[2:] * w)) / np.sqrt(1.0 + w**2 + (1.0 - w) ** 2)
    return max(float(np.median(np.abs(apart))) / 0.6745, 1e-4 * float(mean.mean())), float(len(apart)), False


def state_of(problem: PullProblem, found: Fit) -> PullState:
    """A fit with its scores: each part of its groups is predicted with parameters fitted to the others."""
    groups, split = found.trials, parts(len(found.trials))
    scores = np.sum(found.residual**2, axis=1)
    if len(found.x):
        effects = [build(found.structure, x) for x in left_out(found, split)]
        left = problem.residuals(effects, [groups[part] for part in split])
        for part, residual in zip(split, left, strict=True):
            scores[part] = np.sum(residual**2, axis=1)
    return PullState(fit=found, scores=scores)


def restated(problem: PullProblem, done: PullRound) -> PullRound:
    """A round of a problem with other noise: the same states, scored with this problem's."""

    def scored(s: PullState) -> PullState:
        return state_of(problem, evaluate(problem, s.structure, s.fit.x, s.fit.trials))

    tried = [scored(s) for s in done.tried]
    best = next((t for t, s in zip(tried, done.tried, strict=True) if s is done.best), None)
    tried.sort(key=lambda s: s.score)
    return replace(done, before=scored(done.before), tried=tuple(tried), best=best)


def left_out(found: Fit, split: Sequence[Index]) -> list[Array]:
    """Parameters fitted without each part of the groups: one Gauss–Newton step from the fit to all."""
    low, high, scale = limits_of(found.structure)
    tangent = found.jacobian * scale
    prior = GaussianPrior.of(found.structure, found.residual)
    rows = []
    for part in split:
        kept = np.delete(np.arange(len(found.trials)), part)
        flat = tangent[kept].reshape(-1, len(found.x))
        normal = flat.T @ flat + prior.precision
        normal += 1e-9 * (np.trace(normal) + 1e-12) * np.eye(len(found.x))
        slope = flat.T @ found.residual[kept].ravel() + prior.precision @ ((found.x - prior.null) / scale)
        rows.append(np.clip(found.x - np.linalg.solve(normal, slope) * scale, low, high))
    return rows


def parts(count: int) -> list[Index]:
    """Indices 0 … count − 1 in at most :attr:`PullSettings.search_folds` parts, neighbours apart."""
    many = min(PULLS.search_folds, count)
    return [np.arange(k, count, many, dtype=np.int64) for k in range(many)]


def no_worse(state: PullState, best: PullState) -> bool:
    """Whether a state's score is within chance of the best one's."""
    gap = state.scores - best.scores
    chance = PULLS.as_good_errors * float(np.std(gap)) * math.sqrt(len(gap))
    return float(gap.sum()) <= max(PULLS.alike, chance)


def search(
    problem: PullProblem,
    groups: Index,
    candidates: Sequence[Candidate],
    seed: int,
    watch: Watch | None = None,
) -> tuple[PullState, list[PullRound]]:
    """The effects that these groups of pulls ask for, and the rounds in which they were found.

    The round in which the time of the ``watch`` ends tries nothing and takes nothing.
    """
    state = state_of(problem, evaluate(problem, (), np.zeros(0), groups))
    rounds: list[PullRound] = []
    timed = replace(problem, watch=watch)
    while len(state.structure) < PULLS.most_effects:
        try:
            step = _take_step(timed, state, candidates, seed)
        except OutOfTime:
            step = PullRound(before=state, tried=(), best=None, p_value=1.0, taken=False)
        rounds.append(step)
        if not step.taken or step.best is None:
            break
        state = step.best
    return state, rounds


def _take_step(
    problem: PullProblem, before: PullState, candidates: Sequence[Candidate], seed: int
) -> PullRound:
    groups = before.fit.trials
    taken = {c.name for c in before.structure}
    room = problem.count(groups) - len(before.fit.x)
    small = [c for c in candidates if c.name not in taken and c.size < room // 2]
    fresh = [c for c in small if problem.possible((*before.fit.effects, *_begun(c))) is not None]
    slopes = free_slopes(problem, before.fit, fresh)
    worth = _promising(before, fresh, slopes) if before.structure else fresh
    tried = _scored(problem, [_short(problem, before, (c,)) for c in worth], PULLS.shortlist)
    if not tried:
        return PullRound(before=before, tried=(), best=None, p_value=1.0, taken=False)
    best = _simplest([s for s in tried if no_worse(s, tried[0])])
    if not before.structure and (_above_noise(problem, tried[0]) or _unnamed(tried[0])):
        firsts = [s.structure[-1] for s in tried if s.structure[-1].named][: PULLS.firsts]
        both = sorted([*tried, *_pairs(problem, before, firsts, fresh)], key=lambda s: s.score)
        pair = _simplest([s for s in both if no_worse(s, both[0])])
        beside_it = free_slopes(problem, best.fit, fresh)
        if _unnamed(best) or luck(problem, best, pair, beside_it, seed) <= PULLS.significance:
            tried, best = both, pair
    p_value = luck(problem, before, best, slopes, seed)
    taken_now = p_value <= PULLS.significance and best.score < before.score and not no_worse(before, best)
    return PullRound(before=before, tried=tuple(tried), best=best, p_value=p_value, taken=taken_now)


def _promising(before: PullState, candidates: list[Candidate], slopes: list[Array]) -> list[Candidate]:
    """Those whose tangents promise most, and those that have none where they do nothing."""
    gains = [score_test_gain(before.fit.residual, slope) for slope in slopes]
    best = set(np.argsort(gains)[::-1][: PULLS.shortlist].tolist())
    return [c for i, c in enumerate(candidates) if i in best or not np.any(slopes[i])]


def _short(problem: PullProblem, before: PullState, added: tuple[Candidate, ...]) -> Fit:
    """The best of short fits, from every start of the last candidate, of what is known with others added."""
    structure = (*before.structure, *added)
    known = [before.fit.x, *(c.starts[0] for c in added[:-1])]
    starts = np.unique(np.stack([added[-1].null, *added[-1].starts]), axis=0)
    groups = before.fit.trials
    fits = [fit(problem, structure, np.concatenate([*known, s]), groups, iterations=2) for s in starts]
    return min(fits, key=lambda f: f.cost)


def _scored(problem: PullProblem, short: list[Fit], many: int) -> list[PullState]:
    """The best few of short fits, fitted to the end and scored; best first."""
    best = sorted(short, key=lambda f: f.cost)[:many]
    ended = [fit(problem, f.structure, f.x, f.trials, iterations=8) for f in best]
    return sorted((state_of(problem, f) for f in ended), key=lambda s: s.score)


def _pairs(
    problem: PullProblem, before: PullState, firsts: list[Candidate], candidates: Sequence[Candidate]
) -> list[PullState]:
    """Two named effects at once: where two are missing, neither alone need look good."""
    named = [c for c in candidates if c.named]
    pairs: dict[frozenset[str], Fit] = {}
    for first in firsts:
        for second in named:
            key = frozenset((first.label, second.label))
            if second.name == first.name or key in pairs:
                continue
            if problem.possible(_begun(first, second)) is not None:
                pairs[key] = _short(problem, before, (first, second))
    return _scored(problem, list(pairs.values()), PULLS.firsts)


def _begun(*candidates: Candidate) -> tuple[AnyEffect, ...]:
    """The candidates where their fits start first."""
    return tuple(c.build(c.starts[0]) for c in candidates)


def _above_noise(problem: PullProblem, state: PullState) -> bool:
    """Whether more is left than noise leaves on average.

    This decides what is tried and nothing that is said, so it is no test at a level: one wrong effect of
    two has left 69 where noise leaves 46, which is rarer than once in a hundred only from 71 on.
    """
    return state.off > problem.count(state.fit.trials) - len(state.fit.x)


def _unnamed(state: PullState) -> bool:
    return any(not c.named for c in state.structure)


def _simplest(good: list[PullState]) -> PullState:
    """Of states that are equally good: those with names, then fewest parameters, then the best score."""
    return min(good, key=lambda s: (_unnamed(s), len(s.fit.x), s.score))


def luck(
    problem: PullProblem, before: PullState, best: PullState, slopes: Sequence[Array], seed: int
) -> float:
    """Probability that the best of all candidates gains as much from noise alone.

    The noise is what the chosen effect leaves, each setting's with one random sign and made larger for the
    parameters that were fitted.  An effect too many leaves next to nothing of few pulls, so where the noise
    of a pull is known, that noise too must reach the gain more rarely.  What a candidate gains from a draw
    is its projection on the candidate's tangent (``slopes``, one (R, 2 K, P) each).
    """
    gain, rng = before.fit.cost - best.fit.cost, np.random.default_rng(seed)
    pulls = problem.count(best.fit.trials)
    size = max(float(np.sqrt(pulls / max(1, pulls - len(best.fit.x)))), 1.0)
    left = size * best.fit.residual
    bases = [_orthonormal(t) for t in slopes]
    signs = rng.choice([-1.0, 1.0], size=(_SURROGATES, len(left)))
    draws = [signs[:, :, None] * left]
    if problem.noise_known:
        white = np.zeros_like(draws[0])
        there = problem.rows[best.fit.trials] >= 0
        white[:, :, ::2] = there * rng.standard_normal((_SURROGATES, *there.shape))
        draws.append(white)
    return max(_rarity(drawn.reshape(_SURROGATES, -1), bases, gain) for drawn in draws)


def _rarity(drawn: Array, bases: Sequence[Array], gain: float) -> float:
    """Share of drawn residuals (S, 2 R K) of which the best projection gains as much."""
    most = np.max([np.sum((drawn @ basis) ** 2, axis=1) for basis in bases], axis=0)
    return float(1 + np.count_nonzero(most >= gain)) / (1 + len(drawn))


def _orthonormal(tangent: Array) -> Array:
    flat = tangent.reshape(-1, tangent.shape[-1])
    left, singular, _ = np.linalg.svd(flat, full_matrices=False)
    return np.asarray(left[:, singular > 1e-9 * max(1e-300, float(singular.max(initial=0.0)))])
