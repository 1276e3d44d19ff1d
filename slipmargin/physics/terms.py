"""Friction that varies and forces that come on top, as data.

Multiplier (wheel i, target direction):  μ_i ← μ_i · max(0, 1 + w_i Σ_b c_b φ_b(v_i)), w_i = wheels[i]
Force term:                               w   ← w + Σ_b C[:, b] φ_b(v)   in the frame it names
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError
from slipmargin.physics.variables import Basis, Frame, Target, Variable

#: The families as plain numbers, for code that is compiled.
CONSTANT, POLYNOMIAL, FOURIER, HATS, DECAY, RECIPROCAL, WINDOW, ODD, STEP, LOBE = (int(b) for b in Basis)

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
        Variable.FROM_PLACE,
        Variable.BEFORE_LINE,
        Variable.SLIP_DIRECTION,
        Variable.PASSING_SPEED,
    }
)
#: Variables of a wheel that are measured from the place of a term.
OF_PLACE = frozenset({Variable.FROM_PLACE, Variable.BEFORE_LINE})
#: Frames of forces that act against a motion: at rest there are none.
AGAINST = frozenset({Frame.AGAINST_MOTION, Frame.AT_PLACE})


def place_variable(before_line: Any, at_x: Any, at_y: Any, direction: Any, x: Any, y: Any) -> Any:
    """BEFORE_LINE or FROM_PLACE of contacts at (x, y) [m], seen from a place and its direction [rad]."""
    dx, dy = x - at_x, y - at_y
    if before_line:
        return -dx * np.cos(direction) - dy * np.sin(direction)
    return np.sqrt(dx * dx + dy * dy)


def basis_function(basis: int, j: int, count: int, a: float, b: float, v: Any) -> Any:
    """φ_j(v), the j-th of ``count`` functions of a family with constants a, b; a number or an array v."""
    if basis == POLYNOMIAL:
        return (v / a) ** (j + 1)
    if basis == FOURIER:
        phase = 2.0 * np.pi * (j // 2 + 1) * v / a
        return np.sin(phase) if j % 2 else np.cos(phase)
    if basis == HATS:
        knot = (np.minimum(np.maximum(v, a), b) - a) / (b - a) * (count - 1)
        return np.maximum(0.0, 1.0 - np.abs(knot - j))
    if basis == DECAY:
        return np.exp(-((np.abs(v) / a) ** b)) - 1.0
    if basis == RECIPROCAL:
        return a / (v + b) - 1.0
    if basis == WINDOW:
        return 1.0 * ((v >= a) & (v < b))
    if basis == ODD:
        return 2.0 / np.pi * np.arctan(v / a) if j == 0 else v * np.abs(v) ** (j - 1.0)
    if basis == STEP:
        return 0.5 - 0.5 * np.tanh((v - a) / (2.0 * b))
    if basis == LOBE:
        return 1.0 / (1.0 + (np.sin(0.5 * (v - a)) / np.sin(0.25 * b)) ** 32)
    return 1.0 + 0.0 * v


def basis_slope(basis: int, j: int, count: int, a: float, b: float, v: Any) -> Any:
    """dφ_j/dv (where a function kinks: its slope to the right)."""
    if basis == POLYNOMIAL:
        return (j + 1) / a * (v / a) ** j
    if basis == FOURIER:
        rate = 2.0 * np.pi * (j // 2 + 1) / a
        return rate * np.cos(rate * v) if j % 2 else -rate * np.sin(rate * v)
    if basis == HATS:
        knot, per = (v - a) / (b - a) * (count - 1), (count - 1) / (b - a)
        up, down = (knot >= j - 1) & (knot < j) & (knot >= 0.0), (knot >= j) & (knot < j + 1)
        return per * (1.0 * up - 1.0 * (down & (knot >= 0.0) & (knot < count - 1)))
    if basis == DECAY:
        x = np.maximum(np.abs(v) / a, 1e-300)
        return np.copysign(np.exp(-(x**b)) * b * x ** (b - 1.0) / a, -v)
    if basis == RECIPROCAL:
        return -a / (v + b) ** 2
    if basis == ODD:
        return 2.0 / np.pi * a / (a * a + v * v) if j == 0 else j * np.abs(v) ** (j - 1.0)
    if basis == STEP:
        return 0.25 / b * (np.tanh((v - a) / (2.0 * b)) ** 2 - 1.0)
    if basis == LOBE:
        far = np.sin(0.5 * (v - a)) / np.sin(0.25 * b)
        return -16.0 * far**31 * np.cos(0.5 * (v - a)) / np.sin(0.25 * b) / (1.0 + far**32) ** 2
    return 0.0 * v


def first_of_two(count: int, a: float, b: float, v: float) -> int:
    """Number of the first of the two :data:`HATS` that are not zero at a value, which may be none."""
    knot = (np.minimum(np.maximum(v, a), b) - a) / (b - a) * (count - 1)
    return int(knot) if knot > 0.0 else 0


def basis_values(basis: Basis, shape: Array, count: int, v: Array) -> Array:
    """Every function of a family at values ``v``: array ``v.shape + (count,)``; ``shape`` (2,) holds a, b."""
    v, a, b = np.asarray(v, dtype=float), float(shape[0]), float(shape[1])
    out = np.empty((*v.shape, count))
    for j in range(count):
        out[..., j] = basis_function(int(basis), j, count, a, b, v)
    return out


#: Families that divide by their first constant.
_OVER_A = frozenset({Basis.POLYNOMIAL, Basis.FOURIER, Basis.ODD})


def _constants(basis: Basis, shape: Array) -> Array:
    """The constants (2,) a, b of a family, if it has a value with them.

    Raises
    ------
    InputError
        Where every value would be a division by zero, or not a number.
    """
    shape = frozen("shape", shape, (2,))
    a, b = shape.tolist()
    cure = ""
    if basis in _OVER_A and a == 0.0:
        cure = "give a first number that is not 0"
    elif basis is Basis.STEP and b == 0.0:
        cure = "give a second number that is not 0"
    elif basis is Basis.DECAY and not (a > 0.0 and b > 0.0):
        cure = "give a scale and an exponent above 0"
    elif basis in (Basis.HATS, Basis.WINDOW) and not a < b:
        cure = "give a second number that is larger than the first"
    elif basis is Basis.LOBE and not 0.0 < b < 4.0 * np.pi:
        cure = "give an arc above 0 and below 4 π"
    if cure:
        raise InputError("shape", f"is [{a:g}, {b:g}], with which {basis.name.lower()} has no value", cure)
    return shape


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Multiplier:
    """A factor on friction: ``coefficients`` (B,) in ``basis`` over ``variable``.

    ``wheels`` (N,) are the weights w_i: 1 where the modulation applies in full, 0 where not at all;
    ``shape`` (2,) are the constants of the basis; ``place`` (3,) is where on the floor the variable is
    measured from: x, y [m] and a direction [rad]; of ``PASSING_SPEED`` its first number is the tread's share.
    """

    variable: Variable
    basis: Basis
    coefficients: Array
    shape: Array
    wheels: Array
    target: Target = Target.BOTH
    place: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "place", frozen("place", self.place, (3,)))
        put(self, "coefficients", frozen("coefficients", self.coefficients, (None,)))
        put(self, "shape", _constants(self.basis, self.shape))
        put(self, "wheels", frozen("wheels", self.wheels, (None,)))

    def factor(self, v: Array, weight: Array | float = 1.0) -> Array:
        """The factor at values ``v`` for wheels of this weight, same shape as v; never below zero."""
        count, (a, b) = len(self.coefficients), self.shape.tolist()
        change = np.zeros_like(v, dtype=float)
        for j, c in enumerate(self.coefficients.tolist()):  # a table (…, B) of them takes longer than they do
            change += c * basis_function(int(self.basis), j, count, a, b, v)
        return np.asarray(np.maximum(0.0, 1.0 + weight * change), dtype=np.float64)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceTerm:
    """A wrench on the body about its centre of mass: ``coefficients`` (3, B) [N, N, N m].

    The force acts ``height_m`` above the floor, or at the height of the centre of mass where that is
    None, and shifts the wheel loads by its moment; ``lift_N`` is an upward force that comes with it.
    ``place_m`` (2,) is the place of the body [m] in whose frame ``AT_PLACE`` it acts.
    """

    variable: Variable
    basis: Basis
    coefficients: Array
    shape: Array
    frame: Frame
    height_m: float | None = 0.0
    lift_N: float = 0.0
    place_m: Array = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "coefficients", frozen("coefficients", self.coefficients, (3, None)))
        put(self, "shape", _constants(self.basis, self.shape))
        put(self, "place_m", frozen("place_m", self.place_m, (2,)))
        if self.frame is not Frame.AT_PLACE and np.any(self.place_m):
            raise InputError(
                "place_m", f"is given with the frame {self.frame.name.lower()}", "use the frame at_place"
            )
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
        object.__setattr__(self, "shape", _constants(self.basis, self.shape))

    def shift(self, v: Array) -> Array:
        """(Δx, Δy, Δφ) at values ``v``, ``v.shape + (3,)``."""
        return _triple(self, v)


def _triple(term: ForceTerm | PoseShift, v: Array) -> Array:
    phi = basis_values(term.basis, term.shape, term.coefficients.shape[1], v)
    return np.asarray(phi @ term.coefficients.T, dtype=np.float64)
