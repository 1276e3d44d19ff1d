"""Wheel loads: how the weight is shared, affine in the acceleration and in the external wrench.

Forces on the body: friction at the floor, external forces F_k at heights h_k, the weight at the height h
of the centre of mass c.  The balance of moments about horizontal axes through c, with friction equal to
m a − Σ F_k, gives

    Σ N_i (p_i − c) = −m h a + Σ h_k F_k,      Σ N_i = W − lift.

Accelerating forwards presses the rear wheels down; a force forwards above the floor, the front ones.
For three wheels this decides the loads, N = S (Σ N, Σ N p); for more (they are hyperstatic) S is the
minimum-norm solution: equal suspension stiffness.  There a contact that lies δ out of the plane of the
others shifts N by c Π δ e_i, with the stiffness c of each wheel and the projector Π on the loads
that have neither resultant nor moment (docs/theory.md, section 3): the loads are a band.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError
from slipmargin.physics.constants import GRAVITY_M_S2


class LoadRule(Enum):
    """How the weight is shared between the wheels."""

    EQUAL = "equal"  #: m g / N each, as published in eq. (8)
    STATIC = "static"  #: from the centre of mass at rest
    QUASI_STATIC = "quasi-static"  #: from the centre of mass, its height and the acceleration
    FIXED = "fixed"  #: stated fractions of m g


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Loads:
    """Wheel loads N_i = rest_i (1 − lift/Σ rest) + per_acceleration_i · a + per_moment_i · Σ h_k F_k.

    Parameters
    ----------
    rest_N : (N,)
        Loads at rest on a level floor.
    per_acceleration_kg : (N, 2)
        Change of load per body-frame acceleration of the centre of mass.
    per_moment_1_per_m : (N, 2)
        Change of load per height × external force, body frame [N per N m].
    rule : str
        In words where they come from.
    centred : float
        Share of the way that the centre of mass goes from where the file puts it to where the loads'
        resultant acts: on a level floor the two are one point.
    raised_m : float
        How much higher the centre of mass is than the file says [m].
    uneven_N : (V, N)
        Corners of the band of load shifts on an uneven floor, each without resultant or moment; none
        where the floor is even.
    """

    rest_N: Array
    per_acceleration_kg: Array
    per_moment_1_per_m: Array
    rule: str
    centred: float = 0.0
    raised_m: float = 0.0
    uneven_N: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        n, put = len(np.asarray(self.rest_N)), object.__setattr__
        put(self, "uneven_N", frozen("uneven_N", np.reshape(self.uneven_N, (-1, n)), (None, n)))
        put(self, "rest_N", frozen("rest_N", self.rest_N, (n,)))
        put(self, "per_acceleration_kg", frozen("per_acceleration_kg", self.per_acceleration_kg, (n, 2)))
        put(self, "per_moment_1_per_m", frozen("per_moment_1_per_m", self.per_moment_1_per_m, (n, 2)))
        if float(np.min(self.rest_N)) < -1e-12:
            worst = int(np.argmin(self.rest_N))
            raise InputError(
                "loads",
                f"wheel {worst + 1} would carry {self.rest_N[worst]:.3g} N at rest",
                "move the centre of mass inside the wheels' contact polygon",
            )

    @property
    def follow_acceleration(self) -> bool:
        """Whether accelerating shifts load."""
        return bool(np.any(self.per_acceleration_kg))

    def shifts(self) -> Array:
        """(1 + V, N) shifts of the loads [N]: none first, then the band's corners.

        A corner ends where the first wheel hangs in the air at rest: more unevenness shifts no more.
        """
        if not len(self.uneven_N):
            return np.zeros((1, len(self.rest_N)))
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(self.uneven_N < 0.0, self.rest_N / -self.uneven_N, np.inf)
        held = np.clip(np.min(part, axis=1, keepdims=True), 0.0, 1.0)
        return np.vstack([np.zeros((1, len(self.rest_N))), held * self.uneven_N])

    def at(self, acceleration: Array, tilting: Array | float = 0.0, lift_N: Array | float = 0.0) -> Array:
        """Loads (..., N) [N].

        Parameters
        ----------
        acceleration : (..., 2) or more columns
            Body-frame acceleration of the centre of mass [m/s²]; further columns are not read.
        tilting : (..., 2)
            Σ h_k F_k of the external forces, body frame [N m].
        lift_N : (...)
            Upward force at the centre of mass [N].
        """
        change = np.asarray(acceleration)[..., :2] @ self.per_acceleration_kg.T
        if np.ndim(tilting):
            change = change + np.asarray(tilting) @ self.per_moment_1_per_m.T
        if isinstance(lift_N, float) and lift_N == 0.0:
            return np.asarray(self.rest_N + change)
        still = 1.0 - np.asarray(lift_N, dtype=float)[..., None] / np.sum(self.rest_N)
        return np.asarray(self.rest_N * still + change)


def sharing_matrix(position_m: Array) -> Array:
    """Loads from their resultant: N = S (W, W x, W y), S (N, 3).

    The minimum-norm solution of Σ N_i = W, Σ N_i p_i = W p: exact for three wheels, equal
    suspension stiffness for more (they are hyperstatic).
    """
    moments = np.vstack([np.ones(len(position_m)), position_m.T])
    return np.asarray(np.linalg.pinv(moments), dtype=np.float64)


def out_of_plane(position_m: Array) -> Array:
    """(N,) load shifts where the first wheel carries 1 more because its contact is below the others' plane.

    They have neither resultant nor moment: Π e_1 / Π_11 with the projector Π = 1 − A A⁺, A = [1, x, y].
    Zero for three wheels; every such shift for four; for more, one of several.
    """
    left = _projector(position_m)
    return np.asarray(left[:, 0] / left[0, 0] if left[0, 0] > 1e-9 else 0.0 * left[:, 0])


def _projector(position_m: Array) -> Array:
    """Π (N, N): what is left of heights of the contacts less the plane that fits them best."""
    plane = np.column_stack([np.ones(len(position_m)), position_m])
    return np.asarray(np.eye(len(plane)) - plane @ np.linalg.pinv(plane))


def uneven_shifts(position_m: Array, stiffness_N_per_m: float, unevenness_m: float) -> Array:
    """(V, N) load shifts [N] where one wheel's contact lies above or below the plane of the others.

    Springs of equal stiffness under a rigid body: a contact raised by δ_i lifts the body by the plane that
    fits the heights best, and what is left presses, N ← N + c (1 − A A⁺) δ with A = [1, x, y].  Corners that
    lie within others are left out: four wheels have two.
    """
    left = _projector(position_m)
    if len(left) == 4:  # one pattern (+, −, +, −): the wheel that shifts most is the band's end
        left = left[:, [int(np.argmax(np.round(np.diag(left), 9)))]]
    corners = stiffness_N_per_m * unevenness_m * left.T
    return np.vstack([corners, -corners])


def load_centre(position_m: Array, rest_N: Array) -> Array:
    """The point (2,) at which the loads' resultant acts [m]."""
    return np.asarray(position_m.T @ rest_N / rest_N.sum(), dtype=np.float64)


def wheel_loads(
    rule: LoadRule,
    position_m: Array,
    *,
    mass_kg: float,
    com_m: Array,
    com_height_m: float,
    fractions: Array | None = None,
    uneven_N: Array | None = None,
) -> Loads:
    """The loads of a robot by a rule.

    Parameters
    ----------
    position_m : (N, 2)
        Wheel centres [m].
    fractions : (N,), optional
        Shares of m g; given exactly for the rule FIXED.
    uneven_N : (V, N), optional
        Load shifts on an uneven floor (:func:`uneven_shifts`).
    """
    n, weight, share = len(position_m), mass_kg * GRAVITY_M_S2, sharing_matrix(position_m)
    shift, statics = np.zeros((n, 2)), "statics" if n == 3 else "statics with equal suspension stiffness"
    if rule is LoadRule.EQUAL:
        rest, words = np.full(n, weight / n), "equal shares m g / N"
    elif rule is LoadRule.FIXED:
        assert fractions is not None
        rest, words = weight * fractions, "stated fractions of m g"
    else:
        rest, words = share @ (weight * np.array([1.0, *com_m])), statics
    if rule is LoadRule.QUASI_STATIC:
        shift, words = transfer(position_m, mass_kg, com_height_m), statics + ", plus load transfer"
    return Loads(
        rest_N=rest,
        per_acceleration_kg=shift,
        per_moment_1_per_m=share[:, 1:],
        rule=words,
        uneven_N=np.zeros((0, n)) if uneven_N is None else uneven_N,
    )


def transfer(position_m: Array, mass_kg: float, height_m: float) -> Array:
    """(N, 2) change of load per acceleration of a mass at a height, −m h S [kg]."""
    return np.asarray(-mass_kg * height_m * sharing_matrix(position_m)[:, 1:])


def sinking(
    n: float, x: float, y: float, xx: float, xy: float, yy: float, b: float, bx: float, by: float
) -> tuple[float, float, float]:
    """The plane l + l_x x + l_y y by which springs press more so that loads have a resultant (b, b_x, b_y).

    Sums over the springs of their stiffness times 1, x, y, x², x y, y²: (l, l_x, l_y) solves A l = b with the
    matrix of these.  Infinite where the springs stand on one line.
    """
    a, c, e = xx * yy - xy * xy, xy * y - x * yy, x * xy - xx * y
    d, f, g = n * yy - y * y, x * y - n * xy, n * xx - x * x
    over = 1.0 / (n * a + x * c + y * e)
    return (
        (a * b + c * bx + e * by) * over,
        (c * b + d * bx + f * by) * over,
        (e * b + f * bx + g * by) * over,
    )


def spread(n: float, x: float, y: float, xx: float, xy: float, yy: float) -> float:
    """Determinant of the matrix of :func:`sinking`: zero where no three springs span an area."""
    return n * (xx * yy - xy * xy) + x * (xy * y - x * yy) + y * (x * xy - xx * y)
