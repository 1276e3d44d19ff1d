"""Which motions to take: one after the other, each the best beside those before it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, evaluate, limits_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.rivals import can_be
from slipmargin.diagnosis.tangents import free_slopes
from slipmargin.experiment.gain import Contrast, information, known
from slipmargin.experiment.remaining import Remaining
from slipmargin.experiment.result import Narrowing
from slipmargin.experiment.timing import Drive

#: Standard deviations of half a 95 % interval.
_HALF = 1.96
#: A pair that no motion of the library brings this far apart [χ²] does not decide the choice.
_HOPELESS = 1.0

Score = Callable[[Sequence[int]], tuple[float, ...]]


def greedy(count: int, able: Sequence[Drive], score: Score) -> list[int]:
    """Numbers of the drives chosen: each makes the score of all so far largest.

    A kind of motion is driven twice only where every kind has been driven: the same motion again says less
    of what the models get wrong than the noise promises.
    """
    chosen: list[int] = []
    for _ in range(min(count, len(able))):
        free = [k for k in range(len(able)) if k not in chosen]
        used = {able[k].motion.kind for k in chosen}
        fresh = [k for k in free if able[k].motion.kind not in used] or free
        chosen.append(max(fresh, key=lambda k: score([*chosen, k])))
    return chosen


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair:
    """Two of the explanations, by number, the first taken to be right, and how they differ in each motion."""

    right: int
    rival: int
    contrast: Contrast


def pairs(left: Remaining, on_new: Sequence[Fit]) -> list[Pair]:
    """Every ordered pair of the explanations; ``on_new`` are they on the motions."""
    before = [known(f, left.misfit) for f in left.fits]
    return [
        Pair(
            right=i,
            rival=j,
            contrast=Contrast.of(on_new[i], on_new[j], before[j], left.misfit),
        )
        for i, j in permutations(range(len(left.fits)), 2)
    ]


def separating(count: int, able: Sequence[Drive], every: Sequence[Pair]) -> list[int]:
    """The drives after which the pair that is told apart least is told apart best."""
    able_pairs = [p for p in every if max(p.contrast.gain([k]) for k in range(len(able))) >= _HOPELESS]

    def score(runs: Sequence[int]) -> tuple[float, ...]:
        gains = [p.contrast.gain(runs) for p in able_pairs or every]
        return min(gains), float(np.sum(np.log1p(gains)))

    return greedy(count, able, score)


def narrowing(count: int, able: Sequence[Drive], left: Remaining, on_new: Fit) -> list[int]:
    """The drives that make the widest interval of the best explanation narrowest, in units of its scale."""
    before = known(left.fits[0], left.misfit)
    each = information(on_new.jacobian, limits_of(on_new.structure)[2], left.misfit)

    def score(runs: Sequence[int]) -> tuple[float, ...]:
        return (-float(np.max(_deviations(before + each[list(runs)].sum(axis=0)))),)

    return greedy(count, able, score)


def narrowed(left: Remaining, on_new: Fit, chosen: Sequence[int]) -> tuple[Narrowing, ...]:
    """Every interval of the best explanation, today and with the chosen runs; the widest first."""
    best = left.fits[0]
    if not len(best.x):
        return ()
    scale = limits_of(best.structure)[2]
    before = known(best, left.misfit)
    after = before + information(on_new.jacobian, scale, left.misfit)[list(chosen)].sum(axis=0)
    keys = [
        (f"{c.name}.{key}", unit) for c in best.structure for key, unit in zip(c.keys, c.units, strict=True)
    ]
    return _sorted(keys, _deviations(before), _deviations(after), scale)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unseen:
    """An effect that is not there as far as the runs say, and what old and new runs say of it, per scale."""

    candidate: Candidate
    before: Array
    each: Array


def unseen(left: Remaining, new: Problem) -> list[Unseen]:
    """The named effects that a run could show, each alone beside the best explanation, by its tangent."""
    seen: dict[str, Candidate] = {}
    for c in left.candidates:
        plain = c.named and c.nested and not c.idle.any() and not c.wheel_phase
        beside = (*left.fits[0].structure, c), np.concatenate([left.fits[0].x, c.starts[0]])
        if plain and c.subject not in seen and can_be(left.problem, *beside):
            seen[c.subject] = c
    candidates = list(seen.values())
    parts = []
    for problem in (left.problem.rough(), new.rough()):
        everyone = np.arange(len(problem.trials), dtype=np.int64)
        base = evaluate(problem, left.fits[0].structure, left.fits[0].x, everyone)
        parts.append(free_slopes(problem, base, candidates))
    made = []
    for c, old, ahead in zip(candidates, *parts, strict=True):
        # Nothing is larger than its range: what no run shows is as wide as that.
        range_ = np.diag((2.0 * c.scale / (c.high - c.low)) ** 2)
        before = information(old, c.scale, left.misfit).sum(axis=0) + range_
        made.append(Unseen(candidate=c, before=before, each=information(ahead, c.scale, left.misfit)))
    return made


def showing(count: int, able: Sequence[Drive], hidden: Sequence[Unseen]) -> list[int]:
    """The drives that make what can hide smallest, each effect counting by the factor that it shrinks by."""

    def score(runs: Sequence[int]) -> tuple[float, ...]:
        rows = list(runs)
        sizes = [np.max(_deviations(u.before + u.each[rows].sum(axis=0))) for u in hidden]
        return (-float(np.sum(np.log(sizes))),)

    return greedy(count, able, score)


def hideable(hidden: Sequence[Unseen], chosen: Sequence[int]) -> tuple[Narrowing, ...]:
    """What can hide today and with the chosen runs, what shrinks most first."""
    made: list[Narrowing] = []
    for u in hidden:
        keys = [
            (f"{u.candidate.label}.{key}", unit)
            for key, unit in zip(u.candidate.keys, u.candidate.units, strict=True)
        ]
        after = u.before + u.each[list(chosen)].sum(axis=0)
        made += _sorted(keys, _deviations(u.before), _deviations(after), u.candidate.scale)
    return tuple(sorted(made, key=lambda n: n.expected / n.today))


def _deviations(information_: Array) -> Array:
    """Standard deviations (P,) per scale."""
    return np.asarray(np.sqrt(np.maximum(np.diag(np.linalg.inv(information_)), 0.0)))


def _sorted(
    keys: Sequence[tuple[str, str]], before: Array, after: Array, scale: Array
) -> tuple[Narrowing, ...]:
    return tuple(
        Narrowing(
            parameter=keys[k][0],
            unit=keys[k][1],
            today=float(_HALF * before[k] * scale[k]),
            expected=float(_HALF * after[k] * scale[k]),
        )
        for k in np.argsort(-before, kind="stable")
    )
