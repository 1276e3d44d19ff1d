"""General forms of what happens before the wheels and after the motion: commands and camera."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.forms import Ranges, spread
from slipmargin.effects import Part, Trace
from slipmargin.effects.general import Term
from slipmargin.model import Model
from slipmargin.physics.terms import Multiplier, PoseShift
from slipmargin.physics.variables import Basis, Variable


def actuation_forms(model: Model, r: Ranges) -> list[Candidate]:
    """Speed over command or time, all wheels alike, or each by itself."""
    everyone = np.ones(model.count)

    def over(variable: Variable, most: float) -> Callable[[Array], list[Term]]:
        shape = np.array([0.0, most])

        def terms(values: Array) -> list[Term]:
            return [
                Multiplier(
                    variable=variable,
                    basis=Basis.HATS,
                    shape=shape,
                    wheels=everyone,
                    coefficients=values,
                )
            ]

        return terms

    def by_wheel(values: Array) -> list[Term]:
        return [
            Multiplier(
                variable=Variable.UNITY,
                basis=Basis.CONSTANT,
                shape=np.array([1.0, 0.0]),
                wheels=row,
                coefficients=values[i : i + 1],
            )
            for i, row in enumerate(np.eye(model.count))
        ]

    forms = (
        ("speed over command", 5, over(Variable.COMMAND_SPEED, r.command_rad_s)),
        ("speed over time", 4, over(Variable.TIME, r.duration_s)),
        ("speed of each wheel", model.count, by_wheel),
    )
    return [
        spread(Trace.ACTUATION, label, Part.TRANSIENTS, np.full(size, 0.05), np.full(size, 0.95), made)
        for label, size, made in forms
    ]


def measurement_forms(r: Ranges) -> list[Candidate]:
    """Measured pose over true position, heading or time."""
    reach = np.array([r.position_m, 0.0])
    steps = np.array([0.01, 0.01, 0.01])

    def warp(
        variables: tuple[Variable, ...], shape: Array, basis: Basis, count: int
    ) -> Callable[[Array], list[Term]]:
        def terms(values: Array) -> list[Term]:
            blocks = values.reshape(len(variables), 3, count)
            return [
                PoseShift(variable=v, basis=basis, shape=shape, coefficients=block)
                for v, block in zip(variables, blocks, strict=True)
            ]

        return terms

    place = (Variable.POSITION_X, Variable.POSITION_Y)

    def candidate(
        label: str, variables: tuple[Variable, ...], shape: Array, basis: Basis, count: int
    ) -> Candidate:
        scale = np.tile(np.repeat(steps, count), len(variables))
        return spread(
            Trace.MEASUREMENT, label, Part.SENSING, scale, 100.0 * scale, warp(variables, shape, basis, count)
        )

    return [
        candidate("pose over position", place, reach, Basis.POLYNOMIAL, 3),
        candidate("pose over heading", (Variable.HEADING,), np.array([2.0 * np.pi, 0.0]), Basis.FOURIER, 4),
        candidate("pose over time", (Variable.TIME,), np.array([r.duration_s, 0.0]), Basis.POLYNOMIAL, 2),
    ]
