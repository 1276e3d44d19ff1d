"""The computation of one design's columns, as a value that can be sent to other processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.study.columns import columns_of
from slipmargin.study.objectives import Kind
from slipmargin.study.robot_on_surface import RobotOnSurface


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Computes the columns of some kinds, design by design."""

    kinds: tuple[Kind, ...]

    def __call__(self, design: RobotOnSurface) -> dict[str, float]:
        """One design's row; NaN where it cannot be built."""
        return columns_of(design, self.kinds)
