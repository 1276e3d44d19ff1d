"""The verdict: whether a correction may be called found, judged by runs that its fit has not seen.

Nothing here knows a model.  What goes in are sums of squares of each run, predicted before and after
the correction; what comes out is yes or no, with every reason for a no and the figures behind it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index, frozen
from slipmargin.diagnosis.settings import SETTINGS, SearchSettings

#: Up to so many runs every pattern of signs is tried; beyond, this many are drawn.
_EXACT, _DRAWN = 12, 4095
_POSITION, _HEADING = (0, 1), (2,)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunErrors:
    """Errors of R runs: sums of (gap / noise)² ``squares`` (R, 3) in x, y, φ of ``counts`` (R, 3).

    Where part of the noise lasts, the gap is whitened, so that its samples are independent.  ``raw`` (R, 3)
    are the sums of the gaps' own squares [m², m², rad²], zero where nobody asks for them.
    """

    squares: Array
    counts: Array
    raw: Array | None = None

    def __post_init__(self) -> None:
        shape = np.shape(self.squares)
        raw = np.zeros(shape) if self.raw is None else self.raw
        object.__setattr__(self, "squares", frozen("squares", self.squares, (None, 3)))
        object.__setattr__(self, "counts", frozen("counts", self.counts, (shape[0], 3)))
        object.__setattr__(self, "raw", frozen("raw", raw, (shape[0], 3)))

    def of(self, runs: Index) -> RunErrors:
        """Some of the runs."""
        assert self.raw is not None
        return RunErrors(squares=self.squares[runs], counts=self.counts[runs], raw=self.raw[runs])

    def chi(self, runs: Index | None = None, channels: tuple[int, ...] = (0, 1, 2)) -> float:
        """Root mean square of gap over noise of some runs (all by default) in some channels."""
        rows = np.arange(len(self.squares)) if runs is None else runs
        part = np.ix_(rows, np.array(channels))
        return float(np.sqrt(self.squares[part].sum() / max(1.0, self.counts[part].sum())))

    def size(self, sigma: Array) -> float:
        """Root mean square of the gaps themselves over the noise's ``sigma`` (3,), whitened or not."""
        assert self.raw is not None
        return float(np.sqrt(np.sum(self.raw / sigma**2) / max(1.0, self.counts.sum())))

    def of_runs(self) -> Array:
        """Chi (R,) of each run."""
        return np.asarray(np.sqrt(self.squares.sum(axis=1) / np.maximum(1.0, self.counts.sum(axis=1))))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """Whether a correction holds on runs that it has not seen.

    Parameters
    ----------
    failures : tuple of str
        Every condition that it misses, in words; empty where it holds.
    explained : float
        Share of the mean square beyond the noise that it removes on the runs that nothing has seen.
    p_value : float
        Probability that the runs favour it as clearly by chance: the signs of the runs' changes flipped.
    runs : int
        Number of runs whose error changes by more than noise.
    better, worse : int
        How many of them get better, and how many clearly worse.
    chi_before, chi_after : float
        On all runs, each predicted with parameters that have not seen it.
    partial : bool
        Whether what it leaves is well above the noise.
    """

    failures: tuple[str, ...]
    explained: float
    p_value: float
    runs: int
    better: int
    worse: int
    chi_before: float
    chi_after: float
    partial: bool

    @property
    def holds(self) -> bool:
        """Whether it may be called found."""
        return not self.failures


def near_noise(errors: RunErrors, unseen: NDArray[np.bool_], sigma: Array) -> bool:
    """Whether errors are near the noise's ``sigma`` (3,), in all runs and in those that nothing has seen.

    Noise that lasts can take up much of what is missing: then the errors themselves are larger than noise.
    """
    chi = max(errors.chi(), errors.chi(judged(unseen)))
    return chi <= SETTINGS.noise_chi and errors.size(sigma) <= SETTINGS.noise_size


def judged(unseen: NDArray[np.bool_]) -> Index:
    """The runs by which a finding is judged: those that nothing has seen, or all where there are none."""
    return np.flatnonzero(unseen if np.any(unseen) else np.ones(len(unseen), dtype=bool))


def judge(
    before: RunErrors,
    after: RunErrors,
    unseen: NDArray[np.bool_],
    seed: int = 0,
    settings: SearchSettings = SETTINGS,
    *,
    by_chance: bool = True,
    numbers: Index | None = None,
    sigma: Array | None = None,
) -> Judgement:
    """Judge a correction by R runs, each predicted with parameters that have not seen it.

    Parameters
    ----------
    before, after : RunErrors
        The runs predicted without and with the correction.
    unseen : array (R,) of bool
        Runs that nothing has seen, neither parameters nor the choice of the correction; where there are
        none, all runs are judged alike.
    seed : int
        Draws the signs where there are too many patterns to try all.
    settings : SearchSettings
        What is asked for.
    by_chance : bool
        Whether the runs must be enough, and agree enough, to rule out chance.  A first look at some of the
        runs leaves that to the judgement by all of them.
    numbers : array (R,) of int, optional
        Which runs of the data set these are, from 0, where they are not all.
    sigma : array (3,), optional
        The noise's standard deviation [m, m, rad].  Where noise that lasts takes up what is missing, the
        share that is explained is that of the errors themselves, which are larger than this.
    """
    case = _Case(before=before, after=after, unseen=unseen, settings=settings, sigma=sigma)
    failures = [
        *case.alone(),
        *case.too_little(),
        *case.worse_in_a_channel(),
        *(case.chance(seed) if by_chance else ()),
        *case.worse_runs(),
        *case.worse_groups(case.everyone if numbers is None else numbers),
    ]
    change = case.change[case.tell]
    return Judgement(
        failures=tuple(failures),
        explained=case.explained,
        p_value=sign_flip_p_value(change, seed),
        runs=len(change),
        better=int(np.count_nonzero(change > 0.0)),
        worse=case.clearly_worse,
        chi_before=before.chi(),
        chi_after=after.chi(),
        partial=after.chi(case.fresh) > settings.noise_chi,
    )


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class _Case:
    """A correction before the runs, and each condition that it may miss: as a sentence, or as nothing."""

    before: RunErrors
    after: RunErrors
    unseen: NDArray[np.bool_]
    settings: SearchSettings
    sigma: Array | None

    @property
    def everyone(self) -> Index:
        """All runs."""
        return np.arange(len(self.before.squares))

    @property
    def fresh(self) -> Index:
        """The runs that judge."""
        return judged(self.unseen)

    @property
    def where(self) -> str:
        """Which runs judge, in words."""
        return "on runs that nothing has seen" if np.any(self.unseen) else "on runs each predicted without it"

    @property
    def few(self) -> bool:
        """Whether so few runs are unseen, and the errors so large, that chance decides what those show."""
        most = min(self.settings.few_unseen, len(self.everyone))
        return 0 < int(np.count_nonzero(self.unseen)) < most and self.before.chi() > self.settings.far_chi

    @property
    def explained(self) -> float:
        """The share that it removes on the runs that judge."""
        before, after, fresh = self.before, self.after, self.fresh
        if self.sigma is not None and before.chi(fresh) < 1.0:
            was, now = (errors.of(fresh).size(self.sigma) for errors in (before, after))
            if was > self.settings.noise_size:
                return explained_share(was, now)
        return explained_share(before.chi(fresh), after.chi(fresh))

    @cached_property
    def change(self) -> Array:
        """What the logarithm of each run's sum of squares falls by (R,)."""
        one, two = (np.maximum(e.squares.sum(axis=1), 1e-12) for e in (self.before, self.after))
        return np.asarray(np.log(one) - np.log(two))

    @cached_property
    def tell(self) -> NDArray[np.bool_]:
        """Which runs' errors (R,) change by more than noise."""
        s, counts = self.settings, self.after.counts.sum(axis=1)
        tell = np.abs(self.change) > s.noise_deviations * np.sqrt(2.0 / np.maximum(1.0, counts))
        if self.before.chi() > s.noise_chi:  # a run that was at the noise and stays there says nothing
            worst = np.maximum(self.before.of_runs(), self.after.of_runs())
            partly = self.after.chi() > s.noise_chi  # what the correction's form leaves counts as noise then
            tell &= worst > s.noise_chi if partly else beyond_noise(worst, self.before.counts.sum(axis=1))
        return np.asarray(tell)

    @property
    def clearly_worse(self) -> int:
        """How many runs get clearly worse.

        Parameters from other runs are not exact: a run may pay with a small part of what all runs gain.
        """
        s, ones, twos = self.settings, self.before.of_runs(), self.after.of_runs()
        pays = s.worse_factor * max(0.0, self.before.chi() ** 2 - self.after.chi() ** 2)
        return sum(
            clearly_worse(ones[i], twos[i], s) and bool(twos[i] ** 2 - ones[i] ** 2 > pays)
            for i in np.flatnonzero(self.tell)
        )

    def alone(self) -> Iterator[str]:
        """Whether there is one run only."""
        if len(self.everyone) < 2:
            yield "one run alone bears out nothing that was fitted to it; drive another"

    def too_little(self) -> Iterator[str]:
        """Whether it removes less than is asked for."""
        s, before, after, fresh = self.settings, self.before, self.after, self.fresh
        least = min(s.least_chi, before.chi(fresh))
        enough = self.explained >= s.explained_share or (
            self.few
            and explained_share(before.chi(), after.chi()) >= s.explained_share
            and share_as_low(before, after, fresh, (0, 1, 2)) > s.level
        )
        if not enough or before.chi(fresh) - after.chi(fresh) < least:
            yield (
                f"{self.where} chi goes from {before.chi(fresh):.3g} to {after.chi(fresh):.3g}, "
                f"which is {100.0 * self.explained:.0f} % of the mean square beyond the noise; "
                f"{100.0 * s.explained_share:.0f} % are asked for"
            )

    def worse_in_a_channel(self) -> Iterator[str]:
        """Whether the position or the heading gets worse."""
        before, after = self.before, self.after
        for word, channels in (("position", _POSITION), ("heading", _HEADING)):
            for rows, whose in ((self.fresh, self.where), (self.everyone, "over all runs")):
                one, two = before.chi(rows, channels), after.chi(rows, channels)
                lucky = self.few and whose == self.where
                chance = lucky and share_as_low(before, after, rows, channels) > self.settings.level
                if clearly_worse(one, two, self.settings) and not chance:
                    yield f"{whose} the {word} gets worse (chi {one:.3g} to {two:.3g})"
                    break

    def chance(self, seed: int) -> Iterator[str]:
        """Whether the runs that change may get better by chance."""
        s, tell, ones, twos = self.settings, self.tell, self.before.of_runs(), self.after.of_runs()
        runs, better = int(np.count_nonzero(tell)), int(np.count_nonzero(self.change[tell] > 0.0))
        p_value = sign_flip_p_value(self.change[tell], seed)
        # Explained to the noise, each by parameters from the others, which are not exact.
        gains = np.maximum(0.0, ones**2 - twos**2)
        to_noise = np.all((twos**2 - s.noise_chi**2 <= s.worse_factor * gains)[tell])
        fewest = s.fewest_explained if to_noise else s.fewest_runs
        every_one = better == runs >= min(fewest, len(self.everyone))
        if p_value > s.level and not every_one:
            yield (
                f"{better} of the {runs} runs whose error changes at all get better, which may be chance "
                f"(paired permutation p = {p_value:.2g})"
            )

    def worse_runs(self) -> Iterator[str]:
        """Whether too many runs get clearly worse."""
        worse, many = self.clearly_worse, len(self.everyone)
        if worse > self.settings.worse_share * many:
            yield f"{worse} of {many} runs get clearly worse"

    def worse_groups(self, names: Index) -> Iterator[str]:
        """Whether a quarter of the runs, in the order of the files, gets worse."""
        for rows in groups(len(self.everyone)):
            one, two = self.before.chi(rows), self.after.chi(rows)
            if clearly_worse(one, two, self.settings):
                yield (
                    f"runs {names[rows[0]] + 1} to {names[rows[-1]] + 1} as a group get worse "
                    f"(chi {one:.3g} to {two:.3g})"
                )


def explained_share(before: float, after: float) -> float:
    """Share of the mean square beyond the noise, chi² − 1, that falls away; negative where it grows.

    Where chi is below 1 to begin with, the noise was read too large (lasting noise has taken up what is
    missing), and nobody knows how much of the rest it is: then it is the share of the whole mean square.
    """
    beyond = before**2 - 1.0
    if beyond <= 0.0:
        return float(1.0 - (after / before) ** 2) if before > 0.0 else 0.0
    return float(np.clip(1.0 - max(0.0, after**2 - 1.0) / beyond, -99.0, 1.0))


def share_as_low(before: RunErrors, after: RunErrors, some: Index, channels: tuple[int, ...]) -> float:
    """Share of all choices of as many runs that get better by as little as ``some`` of them do, or by less.

    A run gets better by the logarithm of its sum of squares, which no single run outweighs.
    """
    floor = 1e-12
    one, two = (np.maximum(e.squares[:, channels].sum(axis=1), floor) for e in (before, after))
    gain = np.log(one / two)
    chosen = [float(gain[list(rows)].sum()) for rows in combinations(range(len(gain)), len(some))]
    return float(np.mean(np.array(chosen) <= float(gain[some].sum()) + 1e-12))


def beyond_noise(chi: Array, counts: Array) -> NDArray[np.bool_]:
    """Whether the chi of runs with ``counts`` values is above that of noise whose size is known to 3 %."""
    chance = SETTINGS.quiet_deviations / np.sqrt(2.0 * np.maximum(1.0, counts))
    return np.asarray(chi > SETTINGS.quiet_chi + chance)


def clearly_worse(before: float, after: float, settings: SearchSettings = SETTINGS) -> bool:
    """Whether a chi grows by more than a share of itself and more than the log's reconstruction leaves."""
    return not after <= before * (1.0 + settings.worse_factor) + settings.least_chi


def groups(count: int) -> list[Index]:
    """The runs in the order of the files, a quarter of them (two at least) in each group."""
    size = max(2, -(-count // 4))
    found = [np.arange(at, min(at + size, count), dtype=np.int64) for at in range(0, count, size)]
    if len(found) > 1 and len(found[-1]) < 2:
        found[-2:] = [np.concatenate(found[-2:])]
    return found


def sign_flip_p_value(change: Array, seed: int = 0) -> float:
    """Probability that a sum of changes is as large if each might as well have the other sign.

    All patterns of signs are tried for up to twelve changes, beyond that 4095 are drawn (the one at hand
    counts as one of them).  Without any change it is 1.
    """
    count = len(change)
    if not count:
        return 1.0
    total = float(np.sum(change))
    slack = 1e-12 * float(np.sum(np.abs(change)))
    if count <= _EXACT:
        signs = np.array(list(product((-1.0, 1.0), repeat=count)))
        return float(np.mean(signs @ change >= total - slack))
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], size=(_DRAWN, count))
    return float((1 + np.sum(signs @ change >= total - slack)) / (1 + _DRAWN))
