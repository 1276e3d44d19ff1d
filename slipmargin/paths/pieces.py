"""Pieces of a path q(s) = (x, y, φ): straight, parabolic blend, arc, spline.

Each piece runs from s = 0 to its ``length`` and gives q, q' and q'' exactly.  Lengths are measured in
metres with headings weighed by an arm: ds² = dx² + dy² + (arm dφ)².
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.errors import InputError

#: q, q', q'' of M samples, each (M, 3).
Jet = tuple[Array, Array, Array]


class Piece(ABC):
    """Abstract: a smooth part of a path."""

    @property
    @abstractmethod
    def length(self) -> float:
        """Span of s [m]."""

    @abstractmethod
    def at(self, s: Array) -> Jet:
        """q, q', q'' (M, 3) at ``s`` (M,)."""

    @property
    def knots(self) -> Array:
        """Places inside where a third derivative jumps: grid points that must not be missed."""
        return np.zeros(0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Quadratic(Piece):
    """q = start + slope s + ½ bend s²: a straight line (bend 0) or the blend of a corner."""

    start: Array
    slope: Array
    bend: Array
    span: float

    @property
    def length(self) -> float:
        """Span of s [m]."""
        return self.span

    def at(self, s: Array) -> Jet:
        """q, q', q''."""
        s = np.asarray(s, dtype=float)[:, None]
        first = self.slope + self.bend * s
        return (
            self.start + self.slope * s + 0.5 * self.bend * s**2,
            first,
            np.broadcast_to(self.bend, first.shape).copy(),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arc(Piece):
    """A circular arc about ``centre`` (2,) with a heading that turns evenly.

    ``angle`` is where it starts, seen from the centre [rad]; ``sweep`` its extent, positive
    counter-clockwise [rad]; ``heading`` φ at the start, ``turn`` by how much it grows [rad].
    """

    centre: Array
    radius: float
    angle: float
    sweep: float
    heading: float
    turn: float
    arm: float

    @property
    def length(self) -> float:
        """Span of s [m]."""
        return float(np.hypot(self.radius * self.sweep, self.arm * self.turn))

    def at(self, s: Array) -> Jet:
        """q, q', q''."""
        s = np.asarray(s, dtype=float)
        rate, spin = self.sweep / self.length, self.turn / self.length
        a = self.angle + rate * s
        c, d, zero = self.radius * np.cos(a), self.radius * np.sin(a), np.zeros_like(a)
        q = np.stack([self.centre[0] + c, self.centre[1] + d, self.heading + spin * s], axis=1)
        return (
            q,
            np.stack([-d * rate, c * rate, zero + spin], axis=1),
            np.stack([-c * rate**2, -d * rate**2, zero], axis=1),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spline(Piece):
    """A cubic spline: ``coefficients`` (4, B, 3), highest power first, on ``breaks`` (B + 1,)."""

    breaks: Array
    coefficients: Array

    @property
    def length(self) -> float:
        """Span of s [m]."""
        return float(self.breaks[-1])

    @property
    def knots(self) -> Array:
        """The inner breaks."""
        return np.asarray(self.breaks[1:-1])

    def at(self, s: Array) -> Jet:
        """q, q', q''."""
        s = np.asarray(s, dtype=float)
        k = np.clip(np.searchsorted(self.breaks, s, side="right") - 1, 0, len(self.breaks) - 2)
        t = (s - self.breaks[k])[:, None]
        a, b, c, d = self.coefficients[:, k]
        return ((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c, 6 * a * t + 2 * b


def line(start: Array, end: Array, arm: float) -> Quadratic:
    """The straight way between two poses."""
    start, end = frozen("start", start, (3,)), frozen("end", end, (3,))
    span = float(distance(start, end, arm))
    if span <= 0.0:
        raise InputError("end", "is the pose at which the line starts", "give two different poses")
    return Quadratic(start=start, slope=(end - start) / span, bend=np.zeros(3), span=span)


def arc(start: Array, centre: Array, sweep_rad: float, turn_rad: float, arm: float) -> Arc:
    """An arc from the pose ``start`` (3,) about ``centre`` (2,), counter-clockwise positive.

    ``turn_rad`` is how much the heading grows on the way (equal to ``sweep_rad``: tangent heading).
    """
    start, centre = frozen("start", start, (3,)), frozen("centre", centre, (2,))
    sweep_rad = real("sweep_rad", sweep_rad, cure="give an angle [rad]")
    ray = start[:2] - centre
    radius = float(np.hypot(*ray))
    if radius <= 0.0 or sweep_rad == 0.0:
        raise InputError(
            "arc", "has no length", "give a centre beside the start and a sweep that is not zero"
        )
    return Arc(
        centre=centre,
        radius=radius,
        angle=float(np.arctan2(ray[1], ray[0])),
        sweep=sweep_rad,
        heading=float(start[2]),
        turn=real("turn_rad", turn_rad, cure="give an angle [rad]"),
        arm=arm,
    )


def distance(a: Array, b: Array, arm: float) -> Array:
    """√(Δx² + Δy² + (arm Δφ)²) [m] between poses (..., 3)."""
    d = np.asarray(b, dtype=float) - np.asarray(a, dtype=float)
    return np.asarray(np.sqrt(d[..., 0] ** 2 + d[..., 1] ** 2 + (arm * d[..., 2]) ** 2))
