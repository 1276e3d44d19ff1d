"""Friction that varies and forces that come on top, as data.

Modulation (wheel i, target direction):  μ_i ← μ_i · max(0, 1 + w_i Σ_b c_b φ_b(v_i)), w_i = wheels[i]
Force term:                               w   ← w + Σ_b C[:, b] φ_b(v)   in the frame it names
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError
from slipmargin.model.variables import Basis, Frame, Target, Variable

#: Variables that differ from wheel to wheel; forces, which act on the body, cannot use them.
PER_WHEEL = frozenset(
    {
        Variable.WHEEL_ANGLE,
        Variable.WHEEL_LOAD,
        Variable.SLIP_SPEED,
        Variable.SLIP_RATIO,
        Variable.SLIP_ANGLE,
        Variable.ROLLING_SPEED,
        Variable.SLIP_HEADING,
        Variable.COMMAND_SPEED,
        Variable.HUB_SPEED,
        Variable.LEAD,
    }
)


def basis_values(basis: Basis, shape: Array, count: int, v: Array) -> Array:
    """Evaluate ``count`` functions of a family.

    Parameters
    ----------
    basis, shape, count
        Family, its two constants, how many functions.
    v : array, any shape
        Values of the variable.

    Returns
    -------
    array, ``v.shape + (count,)``
    """
    v = np.asarray(v, dtype=float)
    a, b = float(shape[0]), float(shape[1])
    out = np.empty((*v.shape, count))
    for j in range(count):
        if basis is Basis.CONSTANT:
            out[..., j] = 1.0
        elif basis is Basis.POLYNOMIAL:
            out[..., j] = (v / a) ** (j + 1)
        elif basis is Basis.FOURIER:
            phase = 2.0 * np.pi * (j // 2 + 1) * v / a
            out[..., j] = np.sin(phase) if j % 2 else np.cos(phase)
        elif basis is Basis.HATS:
            knot = (np.clip(v, a, b) - a) / (b - a) * (count - 1)
            out[..., j] = np.clip(1.0 - np.abs(knot - j), 0.0, 1.0)
        elif basis is Basis.DECAY:
            out[..., j] = np.exp(-((np.abs(v) / a) ** b)) - 1.0
        elif basis is Basis.RECIPROCAL:
            out[..., j] = a / (v + b) - 1.0
        elif basis is Basis.WINDOW:
            out[..., j] = np.where((v >= a) & (v < b), 1.0, 0.0)
        elif basis is Basis.ODD:
            out[..., j] = 2.0 / np.pi * np.arctan(v / a) if j == 0 else v * np.abs(v) ** (j - 1)
    return out


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Modulation:
    """A factor on friction: ``coefficients`` (B,) in ``basis`` over ``variable``.

    ``wheels`` (N,) are the weights w_i: 1 where the modulation applies in full, 0 where not at all;
    ``shape`` (2,) are the constants of the basis.
    """

    variable: Variable
    basis: Basis
    coefficients: Array
    shape: Array
    wheels: Array
    target: Target = Target.BOTH

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "coefficients", frozen("coefficients", self.coefficients, (None,)))
        put(self, "shape", frozen("shape", self.shape, (2,)))
        put(self, "wheels", frozen("wheels", self.wheels, (None,)))

    def factor(self, v: Array, weight: Array | float = 1.0) -> Array:
        """The factor at values ``v`` for wheels of this weight, same shape as v; never below zero."""
        phi = basis_values(self.basis, self.shape, len(self.coefficients), v)
        return np.asarray(np.maximum(0.0, 1.0 + weight * (phi @ self.coefficients)), dtype=np.float64)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceTerm:
    """A wrench on the body at its centre of mass: ``coefficients`` (3, B) [N, N, N m]."""

    variable: Variable
    basis: Basis
    coefficients: Array
    shape: Array
    frame: Frame

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "coefficients", frozen("coefficients", self.coefficients, (3, None)))
        put(self, "shape", frozen("shape", self.shape, (2,)))
        if self.variable in PER_WHEEL:
            raise InputError(
                "variable",
                f"{self.variable.name} belongs to a wheel",
                "a force on the body needs a variable of the body",
            )

    def wrench(self, v: Array) -> Array:
        """The wrench at values ``v``, ``v.shape + (3,)``, in the term's own frame."""
        return _triple(self, v)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoseShift:
    """A fault of the pose measurement: ``coefficients`` (3, B) [m, m, rad], floor frame."""

    variable: Variable
    basis: Basis
    coefficients: Array
    shape: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "coefficients", frozen("coefficients", self.coefficients, (3, None)))
        object.__setattr__(self, "shape", frozen("shape", self.shape, (2,)))

    def shift(self, v: Array) -> Array:
        """(Δx, Δy, Δφ) at values ``v``, ``v.shape + (3,)``."""
        return _triple(self, v)


def _triple(term: ForceTerm | PoseShift, v: Array) -> Array:
    phi = basis_values(term.basis, term.shape, term.coefficients.shape[1], v)
    return np.asarray(phi @ term.coefficients.T, dtype=np.float64)
