"""The effect ``clock_rate``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class ClockRate(Effect):
    """t ← period_factor t: the log's clock, or a nominal rate that stands in for one, is off.

    Where the wheels' angles are logged, the path does not change; speeds and accelerations do, so that only
    forces tell it: friction coefficients times period_factor² stay the same, unless friction is known.
    A rate that is stated is right to a tenth, a clock that stamps the rows to a twentieth.
    """

    name = "clock_rate"
    summary = "The log's clock runs faster or slower than stated."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (
        parameter("period_factor", "1", (0.9, 1.0, 1.1), 0.02, "true over nominal sampling period"),
    )
    is_the_clock = True
    source = "a nominal rate, or the clock that stamps the rows; above 1 = more time passed than stated"
    confirm = "stop the time of a recording by hand, or compare the log's clock with another one"

    period_factor: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this clock."""
        return replace(part, clock=part.clock * self.period_factor)
