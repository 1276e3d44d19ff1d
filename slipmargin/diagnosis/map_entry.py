"""What the residual map says of one variable."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MapEntry:
    """One variable of the map.

    Parameters
    ----------
    traced_to : Trace
        The variable.
    form : str
        The candidate whose tangent explains most.
    share : float
        Share of the residual's sum of squares that it takes off on runs left out; negative: nothing.
    p_value : float
        Probability that the best of all candidates takes off as much from surrogate noise.
    """

    traced_to: Trace
    form: str
    share: float
    p_value: float

    @property
    def supported(self) -> bool:
        """Whether the variable is significant."""
        return self.p_value <= SETTINGS.level and self.share > 0.0
