"""The effect ``rolling_resistance``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, Variant, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable

#: Constants of a basis in SI units; coefficients of a force along the motion, and of a yaw moment.
_ONE = np.array([1.0, 0.0])
_AHEAD, _TURN = np.array([[1.0], [0.0], [0.0]]), np.array([[0.0], [0.0], [1.0]])


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RollingResistance(Effect):
    """F ← F − (c m g + b |v|) v/|v|, and a share of the matching yaw moment at the wheels’ mean radius.

    The force acts at the height ρ of the axles: a floor that gives way carries a wheel c ρ ahead of its
    centre, which is a force through the axle.  So the wheels behind are pressed down.
    """

    name = "rolling_resistance"
    summary = "Something resists motion whatever the wheels do: bearings, soft carpet, air."
    traced_to = Trace.VELOCITY
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "coefficient", "1", (-0.05, 0.0, 1.0), 0.01, "resistance over weight, independent of speed"
        ),
        parameter("viscous_N_s_per_m", "N s/m", (-5.0, 0.0, 200.0), 1.0, "resistance per speed"),
        parameter(
            "yaw_share",
            "1",
            (0.0, 1.0, 5.0),
            0.2,
            "resistance to turning, over that of everything at the wheels' mean radius",
            idle=True,
        ),
    )
    variants = (
        Variant(free=("coefficient",), label="at any speed the same"),
        Variant(free=("coefficient", "viscous_N_s_per_m")),
        Variant(free=("coefficient", "viscous_N_s_per_m", "yaw_share"), label="with its share of yaw"),
    )
    source = "rolling resistance coefficient, ISO 28580 sense; positive = against the motion"
    confirm = "tow the robot with the wheels lifted off their drive and read the force at two speeds"

    coefficient: float
    viscous_N_s_per_m: float = 0.0
    yaw_share: float = 1.0

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with a force against the motion."""
        inertia = nominal.inertia
        arm = nominal.reach_m
        coulomb, viscous = self.coefficient * inertia.weight_N, self.viscous_N_s_per_m
        height = float(np.mean(nominal.geometry.radius_m))
        steady = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            frame=Frame.AGAINST_MOTION,
            shape=_ONE,
            coefficients=np.array([[coulomb], [0.0], [self.yaw_share * coulomb * arm]]),
            height_m=height,
        )
        rising = replace(
            steady, variable=Variable.SPEED, basis=Basis.POLYNOMIAL, coefficients=viscous * _AHEAD
        )
        turning = ForceTerm(
            variable=Variable.YAW_RATE,
            basis=Basis.POLYNOMIAL,
            frame=Frame.BODY,
            shape=_ONE,
            coefficients=-self.yaw_share * viscous * arm**2 * _TURN,
        )
        return replace(part, terms=(*part.terms, steady, rising, turning))
