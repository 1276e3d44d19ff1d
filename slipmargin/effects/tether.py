"""A cable pulls the robot towards where it is held."""

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
class Tether(Effect):
    """F = k (anchor − p) in the floor frame: no pull at the anchor, more the farther away."""

    name: ClassVar[str] = "tether"
    traced_to: ClassVar[Trace] = Trace.POSITION
    part: ClassVar[Part] = Part.LOSSES
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="stiffness_N_per_m",
            unit="N/m",
            low=0.0,
            high=200.0,
            null=0.0,
            scale=0.5,
            meaning="pull per distance from the anchor",
        ),
        Parameter(
            name="anchor_x_m",
            unit="m",
            low=-5.0,
            high=5.0,
            null=0.0,
            scale=0.1,
            meaning="where it does not pull, x",
        ),
        Parameter(
            name="anchor_y_m",
            unit="m",
            low=-5.0,
            high=5.0,
            null=0.0,
            scale=0.1,
            meaning="where it does not pull, y",
        ),
    )
    source: ClassVar[str] = (
        "Williams et al. 2002, section III.B.2 (the cables are held by hand); positive = towards the anchor"
    )
    confirm: ClassVar[str] = "hold the cable elsewhere and repeat one trial"

    stiffness_N_per_m: float
    anchor_x_m: float
    anchor_y_m: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the cable’s pull."""
        k = self.stiffness_N_per_m
        pull = np.array([[k * self.anchor_x_m], [k * self.anchor_y_m], [0.0]])
        unit = np.ones(2)
        floor = Frame.FLOOR
        hold = ForceTerm(
            variable=Variable.UNITY, basis=Basis.CONSTANT, shape=unit, frame=floor, coefficients=pull
        )
        along_x = ForceTerm(
            variable=Variable.POSITION_X,
            basis=Basis.POLYNOMIAL,
            shape=unit,
            frame=floor,
            coefficients=np.array([[-k], [0.0], [0.0]]),
        )
        along_y = ForceTerm(
            variable=Variable.POSITION_Y,
            basis=Basis.POLYNOMIAL,
            shape=unit,
            frame=floor,
            coefficients=np.array([[0.0], [-k], [0.0]]),
        )
        return replace(part, terms=(*part.terms, hold, along_x, along_y))
