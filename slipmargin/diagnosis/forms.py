"""The building blocks of a general form: free coefficients of friction, force or measurement terms.

General forms find effects that are not in the catalogue, and they check named ones: if the general form
over the same variable fits clearly better, the named effect is not reported.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import GeneralEffect, Part, Trace
from slipmargin.effects.general import PREFIX, Term
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Ranges:
    """How far the data reach: they set the knots and scales of the general forms."""

    speed_m_s: float
    slip_m_s: float
    acceleration_m_s2: float
    yaw_rate_rad_s: float
    position_m: float  #: from the middle of where the runs were
    middle_m: tuple[float, float]
    duration_s: float
    command_rad_s: float

    @property
    def covered(self) -> dict[str, float]:
        """Where the runs were and how far they cover what starts of named effects are spread over."""
        x, y = self.middle_m
        return {"position": self.position_m, "x": x, "y": y, "time": self.duration_s}


#: Standard deviations of the Gaussian prior [scales]: of the difference between neighbours of a polygon,
#: and of every coefficient.  They matter only where no trial has been.
_NEIGHBOURS, _LARGEST = 5.0, 30.0


def prior_rows(blocks: Sequence[tuple[Basis, int]]) -> Array:
    """Prior rows (Q, P) of coefficients in consecutive blocks of (basis, count)."""
    size = sum(count for _, count in blocks)
    rows = [np.eye(size) / _LARGEST]
    at = 0
    for basis, count in blocks:
        if basis is Basis.HATS:
            steps = np.zeros((count - 1, size))
            steps[:, at : at + count] = np.diff(np.eye(count), axis=0) / _NEIGHBOURS
            rows.append(steps)
        at += count
    return np.concatenate(rows)


def spread(
    trace: Trace,
    label: str,
    part: Part,
    scale: Array,
    bound: Array,
    terms: Callable[[Array], Sequence[Term]],
    prior: Array | None = None,
    low: Array | None = None,
) -> Candidate:
    """A general form: a free coefficient for each number of ``scale``, doing nothing at zero."""
    size = len(scale)
    return Candidate(
        name=PREFIX + trace.value,
        label=f"{PREFIX}{trace.value}: {label}",
        trace=trace,
        named=False,
        keys=tuple(f"c{i + 1}" for i in range(size)),
        units=("1",) * size,
        null=np.zeros(size),
        scale=scale,
        low=-bound if low is None else low,
        high=bound,
        starts=np.zeros((1, size)),
        prior=prior_rows([(Basis.CONSTANT, size)]) if prior is None else prior,
        wheel_phase=trace is Trace.WHEEL_ANGLE,
        build=lambda values: GeneralEffect(traced_to=trace, part=part, terms=tuple(terms(values))),
    )


def friction(
    trace: Trace,
    label: str,
    model: Model,
    rows: Sequence[tuple[Variable, Basis, tuple[float, float], int, Target, Array | None]],
    bound: float = 5.0,
) -> Candidate:
    """Modulations of friction: rows of (variable, basis, shape, count, target, wheel weights)."""
    everyone = np.ones(model.count)
    size = sum(row[3] for row in rows)

    def terms(values: Array) -> list[Term]:
        made: list[Term] = []
        at = 0
        for variable, basis, shape, count, target, weights in rows:
            made.append(
                Multiplier(
                    variable=variable,
                    basis=basis,
                    shape=np.array(shape),
                    target=target,
                    coefficients=values[at : at + count],
                    wheels=everyone if weights is None else weights,
                )
            )
            at += count
        return made

    prior = prior_rows([(row[1], row[3]) for row in rows])
    low, high = np.full(size, -bound), np.full(size, bound)
    stiff = np.repeat([row[4] >= Target.STIFFNESS for row in rows], [row[3] for row in rows])
    fades = np.repeat([row[1] is Basis.DECAY for row in rows], [row[3] for row in rows])
    low[stiff] = SETTINGS.least_steepness - 1.0
    high[stiff & fades] = 1.0 - SETTINGS.least_steepness
    return spread(trace, label, Part.GRIP, np.full(size, 0.1), high, terms, prior, low)


def forces(
    trace: Trace,
    label: str,
    model: Model,
    frame: Frame,
    rows: Sequence[tuple[Variable, Basis, tuple[float, float], int, tuple[int, ...], float]],
) -> Candidate:
    """Force terms: rows of (variable, basis, shape, count, axes, size of the variable)."""
    weight = model.inertia.weight_N
    arm = model.reach_m
    unit = np.array([weight, weight, weight * arm]) * 0.02
    scale: list[float] = []
    for _, _, _, count, axes, reach in rows:
        scale += [unit[axis] / reach for axis in axes for _ in range(count)]

    def terms(values: Array) -> list[Term]:
        made: list[Term] = []
        at = 0
        for variable, basis, shape, count, axes, _ in rows:
            coefficients = np.zeros((3, count))
            for axis in axes:
                coefficients[axis] = values[at : at + count]
                at += count
            made.append(
                ForceTerm(
                    variable=variable,
                    basis=basis,
                    shape=np.array(shape),
                    frame=frame,
                    coefficients=coefficients,
                )
            )
        return made

    prior = prior_rows([(basis, count) for _, basis, _, count, axes, _ in rows for _ in axes])
    return spread(trace, label, Part.LOSSES, np.array(scale), 50.0 * np.array(scale), terms, prior)
