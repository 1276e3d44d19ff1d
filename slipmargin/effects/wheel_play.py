"""The effect ``wheel_play``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import IN_MOTIONS, Part, Quantity, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelPlay(WheelEffect):
    """θ_i = min(max(θ_i before, θ_m,i − play/2), θ_m,i + play/2): the wheel waits until the play is taken up.

    θ_m is what a command or an encoder on the motor says.  A wheel whose motor turns at the start of a run
    has taken its play up, one whose motor stands is in the middle.  While a wheel waits it stands, as one
    with light friction of its own does.  Each change of direction costs the play, so runs that never turn
    back hardly show it; in runs with one change of direction each it looks like ``camera_delay`` or
    ``wheel_radius``.
    """

    name = "wheel_play"
    summary = "A wheel turns back only once its motor has taken up the play (gears, a coupling, a worn key)."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    one_wheel = True
    parameters = (
        parameter(
            "play_rad",
            "rad",
            (0.0, 0.0, 0.5),
            0.005,
            "how far a wheel turns to and fro while its motor is held",
            starts=(0.02, 0.1, 0.3),
        ),
    )
    counts_in = IN_MOTIONS + "wheels without play"
    source = "play operator of gears with the encoder on the motor (Visintin 1994, section III.2); whole play"
    confirm = "hold the motor, turn the wheel to and fro by hand and read how far it goes"

    play_rad: float

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with as much more play."""
        return replace(part, play_rad=part.play_rad + self.mask(nominal) * self.play_rad)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """How far the rim moves to and fro while the motor is held."""
        radius = float(max(self.mask(model) * model.geometry.radius_m))
        return (Quantity(name="rim_moves_m", value=radius * self.play_rad, unit="m"),)
