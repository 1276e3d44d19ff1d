"""What the residual map says of one variable, and the variables of which it can say nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace

#: Variables for which no linear feature of the motion is made, and why.
SILENT = {
    Trace.WHEEL_LOAD: "loads are not measured; acceleration stands in for what they change",
    Trace.SLIP_SPEED: "slip below the camera's noise cannot be told from rolling",
    Trace.SLIP_COUPLING: "slip below the camera's noise cannot be told from rolling",
    Trace.SLIP_RATIO: "slip below the camera's noise cannot be told from rolling",
    Trace.COEFFICIENT: "coefficients change what happens at every value of every variable",
    Trace.ACTUATION: "without measured wheel speeds the map cannot tell motors from friction",
    Trace.MEASUREMENT: "a fault of the camera has no force",
}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MapEntry:
    """One variable of the map.

    Parameters
    ----------
    traced_to : Trace
        The variable.
    form : str
        The features that explain most.
    share : float
        Share of the residual's mean square that they explain on runs left out; negative: nothing.
    p_value : float
        Probability that the best of all variables explains as much in permuted runs.
    """

    traced_to: Trace
    form: str
    share: float
    p_value: float

    @property
    def supported(self) -> bool:
        """Whether the variable is significant."""
        return self.p_value <= SETTINGS.level and self.share > 0.0
