"""The effect ``wheel_runout``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import IN_MOTIONS, Part, Quantity, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.physics.kinematics import WheelGeometry

#: Where fits start: 6 % in three directions.  Between wheels that hold the robot, the first per cent of one
#: wheel shows less than what makes it slip [1].
_COSINE, _SINE = (0.06, -0.03, -0.03), (0.0, 0.052, -0.052)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelRunout(WheelEffect):
    """ρ_i ← ρ_i (1 + cosine · cos θ_i + sine · sin θ_i): the axle is not in the middle of the wheel.

    The robot moves ahead of, and behind, where round wheels put it, once a turn.  Limits are those of
    round wheels.
    """

    name = "wheel_runout"
    summary = "A wheel is out of round: worn on one side, bent or not centred on its axle."
    traced_to = Trace.WHEEL_ANGLE
    part = Part.CONTACTS
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "cosine",
            "1",
            (-0.3, 0.0, 0.3),
            0.005,
            "change of the radius at wheel angle 0 over the mean",
            starts=_COSINE,
        ),
        parameter("sine", "1", (-0.3, 0.0, 0.3), 0.005, "the same a quarter of a turn later", starts=_SINE),
    )
    all_wheels, one_wheel = False, True
    needs_wheel_phase = True
    needs_wheel_angles = True
    counts_in = IN_MOTIONS + "round wheels"
    source = "eq. (2) with a radius that depends on the wheel's angle; positive = larger there"
    confirm = "lift the robot, turn the wheel against a dial gauge and read how far its rim moves in one turn"

    cosine: float
    sine: float = 0.0

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry whose wheels are out of round by as much more."""
        more = self.mask(nominal)[:, None] * np.array([self.cosine, self.sine])
        return replace(part, runout=part.runout + more)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """How far the rim moves in one turn."""
        radius = float(np.max(self.mask(model) * model.geometry.radius_m))
        return (
            Quantity(
                name="rim_moves_m", value=2.0 * radius * float(np.hypot(self.cosine, self.sine)), unit="m"
            ),
        )
