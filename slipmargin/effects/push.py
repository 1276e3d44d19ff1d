"""The effect ``push``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, Variant, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable

_TIMES = tuple((k + 0.5) / 20.0 for k in range(20))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Push(Effect):
    """F ← F + (f_x, f_y), M ← M + m in the floor frame for ``time_s`` ≤ t < ``time_s`` + ``duration_s``."""

    name = "push"
    summary = "Something pushes the robot at the same time of every run (a gust, a bump, a mechanism)."
    traced_to = Trace.TIME
    part = Part.LOSSES
    scope = Scope.LOADING
    parameters = (
        parameter("force_x_N", "N", (-1000.0, 0.0, 1000.0), 0.5, "push towards +x of the floor"),
        parameter("force_y_N", "N", (-1000.0, 0.0, 1000.0), 0.5, "push towards +y of the floor"),
        parameter("moment_N_m", "N m", (-100.0, 0.0, 100.0), 0.05, "moment with it, counter-clockwise"),
        parameter(
            "time_s",
            "s",
            (0.0, 0.0, 1000.0),
            0.05,
            "when it begins, from the start of the run",
            starts=_TIMES,
            idle=True,
            along="time",
        ),
        parameter("duration_s", "s", (0.01, 0.1, 100.0), 0.05, "how long it lasts", starts=(0.1,)),
    )
    #: A short push shows by its impulse; how long it lasted hardly shows.
    variants = (Variant(free=("force_x_N", "force_y_N", "moment_N_m", "time_s"), fixed={"duration_s": 0.1}),)
    source = "Newton's second law; positive = towards +x, +y, counter-clockwise"
    confirm = "watch the robot at that time of a run, or start the run a second later"

    force_x_N: float
    force_y_N: float = 0.0
    moment_N_m: float = 0.0
    time_s: float = 0.0
    duration_s: float = 0.1

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the push."""
        del nominal
        push = ForceTerm(
            variable=Variable.TIME,
            basis=Basis.WINDOW,
            shape=np.array([self.time_s, self.time_s + self.duration_s]),
            frame=Frame.FLOOR,
            coefficients=np.array([[self.force_x_N], [self.force_y_N], [self.moment_N_m]]),
        )
        return replace(part, terms=(*part.terms, push))
