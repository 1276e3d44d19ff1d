"""A printed number or claim beside the recomputed value, and the verdict on it.

A number is *reproduced* when it rounds to the printed digits or lies within 5 % of the printed value; a claim
in words when the computed number meets the condition that its note states.  What the authors chose or
measured *cannot be checked*; the note says why.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.paper.numbers import BY_KEY, Published, published
from slipmargin.paper.published import DISTANCE_M, DURATION_S
from slipmargin.sim.run import Run

#: Share of the printed value within which a number counts as reproduced although its digits differ.
TOLERANCE = 0.05
#: Commanded speed of the paper's run [m/s].
SPEED_M_S = DISTANCE_M / DURATION_S


class Verdict(str, Enum):
    """What the recomputation says of a printed number or claim."""

    REPRODUCED = "reproduced"
    DIFFERS = "differs"
    UNCHECKED = "cannot be checked"

    def __str__(self) -> str:
        return self.value


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One printed number or claim beside the recomputed value, in SI units."""

    source: Published
    recomputed: float | None
    verdict: Verdict
    note: str

    @property
    def difference(self) -> float | None:
        """Recomputed minus published; None where one of them is missing."""
        if self.recomputed is None or self.source.value is None:
            return None
        return self.recomputed - self.source.value


def number(key: str, recomputed: float, note: str = "", holds: bool | None = None) -> Row:
    """The row of a printed number; ``holds`` overrides the rule of digits and 5 %."""
    source = BY_KEY[key]
    gap = abs(recomputed - published(key))
    if holds is None:
        holds = gap <= source.half_digit * (1.0 + 1e-9) or gap <= TOLERANCE * abs(published(key))
    verdict = Verdict.REPRODUCED if holds else Verdict.DIFFERS
    return Row(source=source, recomputed=float(recomputed), verdict=verdict, note=note)


def claim(key: str, recomputed: float, holds: bool, note: str) -> Row:
    """The row of a claim in words that a computed number decides."""
    verdict = Verdict.REPRODUCED if holds else Verdict.DIFFERS
    return Row(source=BY_KEY[key], recomputed=float(recomputed), verdict=verdict, note=note)


def unchecked(key: str, why: str, recomputed: float | None = None) -> Row:
    """The row of what no computation can check, with the reason."""
    return Row(source=BY_KEY[key], recomputed=recomputed, verdict=Verdict.UNCHECKED, note=why)


def end_of(run: Run) -> Array:
    """x short of the goal, y, φ after stopping."""
    return np.array([DISTANCE_M - run.pose[-1, 0], run.pose[-1, 1], run.pose[-1, 2]])


def sample_at(run: Run, t_s: float) -> int:
    """Index of the sample at this time; the runs are sampled every 5 ms."""
    return int(np.argmin(np.abs(run.t_s - t_s)))
