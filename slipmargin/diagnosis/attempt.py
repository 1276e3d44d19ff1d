"""A search and its judgement: with the noise that was read, and with white noise where that hid an effect."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.data.noise import lasting_noise
from slipmargin.diagnosis.conditions import Ready
from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.ladder import check
from slipmargin.diagnosis.searched import Searched, searched
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attempt:
    """What was searched, under which conditions, and what holds; ``was_cut``: time ended the search."""

    conditions: Ready
    searched: Searched
    checked: Checked
    seed: int
    watch: Watch
    was_cut: bool

    @staticmethod
    def of(conditions: Ready, seed: int, watch: Watch) -> Attempt:
        """Search the runs and judge what was found by those that the search has not seen."""
        found = searched(conditions.data_set, seed, watch, conditions.held)
        return Attempt._judged(conditions, found, seed, watch)

    @staticmethod
    def _judged(conditions: Ready, found: Searched, seed: int, watch: Watch) -> Attempt:
        was_cut = watch.expired
        court = found.court(conditions.data_set, seed)
        return Attempt(
            conditions=conditions,
            searched=found,
            checked=check(court, found.state, found.rounds, watch),
            seed=seed,
            watch=watch,
            was_cut=was_cut,
        )

    def with_white_noise(self) -> Attempt | None:
        """Another attempt, where nothing holds and noise lasts, if it explains more; else None.

        Noise that lasts as long as a manoeuvre looks like what an effect does: what leaves nothing but white
        noise on runs that it has not seen explains more.
        """
        lasting = self.conditions.data_set.lasting
        if self.checked.state is not None or lasting is None or self.watch.expired:
            return None
        if np.max(lasting.time_s * (lasting.share > 0.0)) < SETTINGS.piece_s:
            return None
        white, watch = self.conditions.with_white_noise(), self.watch.staged("with white noise")
        found = searched(white.data_set, self.seed, watch, white.held, SETTINGS.noise_chi)
        if found.state.chi > SETTINGS.noise_chi:
            return None
        other = Attempt._judged(white, found, self.seed, watch)
        return other if other._leaves_white_noise() else None

    def _leaves_white_noise(self) -> bool:
        """Whether something holds, and what it leaves does not last."""
        problem, state = self.checked.problem, self.checked.state
        if state is None:
            return False
        everyone = np.arange(len(problem.trials), dtype=np.int64)
        after = problem.predict([state.fit.effects], [everyone])[0]
        left = [(t.t_s, t.pose - a[: len(t.t_s)]) for t, a in zip(problem.trials, after, strict=True)]
        return lasting_noise(left)[1] is None
