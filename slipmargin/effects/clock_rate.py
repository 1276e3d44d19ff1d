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
    """t ← period_factor t: a log without time stamps was sampled at another rate than its nominal one.

    Where the wheels' angles are logged, the path does not change; speeds and accelerations do, so that only
    forces tell it: friction coefficients times period_factor² stay the same, unless friction is known.
    A rate that is stated at all is right to a tenth.
    """

    name = "clock_rate"
    summary = "The log was sampled faster or slower than its nominal rate."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (
        parameter("period_factor", "1", (0.9, 1.0, 1.1), 0.02, "true over nominal sampling period"),
    )
    needs_nominal_rate = True
    source = "a log without time stamps; above 1 = sampled more slowly than stated"
    confirm = "log a time stamp with every row, or stop the time of a recording by hand"

    period_factor: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this clock."""
        return replace(part, clock=part.clock * self.period_factor)
