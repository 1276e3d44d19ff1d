"""Something resists motion whatever the wheels do: bearings, soft carpet, air."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RollingResistance(Effect):
    """F ← F − (c m g + b |v|) v/|v|, and the matching yaw moment at the wheels’ mean radius."""

    name: ClassVar[str] = "rolling_resistance"
    traced_to: ClassVar[Trace] = Trace.VELOCITY
    part: ClassVar[Part] = Part.LOSSES
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="coefficient",
            unit="1",
            low=-0.05,
            high=1.0,
            null=0.0,
            scale=0.01,
            meaning="resistance over weight, independent of speed",
        ),
        Parameter(
            name="viscous_N_s_per_m",
            unit="N s/m",
            low=-5.0,
            high=200.0,
            null=0.0,
            scale=1.0,
            meaning="resistance per speed",
        ),
    )
    source: ClassVar[str] = "rolling resistance coefficient, ISO 28580 sense; positive = against the motion"
    confirm: ClassVar[str] = (
        "tow the robot with the wheels lifted off their drive and read the force at two speeds"
    )

    coefficient: float
    viscous_N_s_per_m: float = 0.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with a force against the motion."""
        inertia = nominal.inertia
        arm = float(np.mean(np.hypot(*(nominal.geometry.position_m - inertia.com_m).T)))
        coulomb, viscous = self.coefficient * inertia.weight_N, self.viscous_N_s_per_m
        none = [0.0, 0.0]
        push = ForceTerm(
            variable=Variable.SPEED,
            basis=Basis.ODD,
            frame=Frame.AGAINST_MOTION,
            shape=np.array([1e-3, 0.0]),
            coefficients=np.array([[coulomb, viscous], none, none]),
        )
        turn = ForceTerm(
            variable=Variable.YAW_RATE,
            basis=Basis.ODD,
            frame=Frame.BODY,
            shape=np.array([1e-3 / arm, 0.0]),
            coefficients=np.array([none, none, [-coulomb * arm, -viscous * arm**2]]),
        )
        return replace(part, terms=(*part.terms, push, turn))
