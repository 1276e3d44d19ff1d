"""The long work of one design, as a value that other processes can be handed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.study.columns import slow_columns
from slipmargin.study.machine import Machine
from slipmargin.study.objectives import Kind


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Slow:
    """Computes the columns of some kinds, design by design."""

    kinds: tuple[Kind, ...]

    def __call__(self, machine: Machine) -> dict[str, float]:
        """One design's row; NaN where it cannot be built."""
        return slow_columns(machine, self.kinds)
