"""A library of motions that people can drive, each scaled into the space that there is.

A motion is a list of legs; the robot stands still at the start, between legs and at the end.  Every motion
ends where it began, so that it can be repeated and so that the next run needs no carrying.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.errors import InputError
from slipmargin.model import Model

#: Share of the room beside the robot that motions use: what a model gets wrong needs the rest.
_USED = 0.9
#: Below this room [m] a motion in that direction is left out.
_LEAST_M = 0.05
#: Headings of the straight lines [rad]; there and back, each covers its opposite too.
_HEADINGS = np.deg2rad([0.0, 30.0, 60.0, 90.0, 120.0, 150.0])
#: Waypoints of a circle, and of a figure of eight.
_ROUND = 24


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """A rectangle of floor along the axes: its middle and its sides [m]."""

    middle_m: tuple[float, float]
    size_m: tuple[float, float]

    def room_m(self, reach_m: float) -> tuple[float, float]:
        """How far (x, y) the middle of a robot of this ``reach_m`` may go from the middle of the space [m].

        Raises
        ------
        InputError
            If the robot does not fit.
        """
        x, y = (0.5 * side - reach_m for side in self.size_m)
        if min(x, y) < 0.0 or max(x, y) < _LEAST_M:
            least = 2.0 * reach_m
            raise InputError(
                "space",
                f"is {self.size_m[0]:.4g} m x {self.size_m[1]:.4g} m and the robot with its wheels takes "
                f"{least:.3g} m x {least:.3g} m",
                f"give at least {least:.3g} m, and {least + 2.0 * _LEAST_M:.3g} m in one direction",
            )
        return x, y

    def excess_m(self, pose: Array, reach_m: float) -> float:
        """How far a robot of this reach gets out of the space along poses (T, 3) [m]; 0 where it does not.

        Infinite where a pose is not finite: a motion that ran away.
        """
        if not np.all(np.isfinite(pose)):
            return np.inf
        off = np.abs(pose[:, :2] - self.middle_m) + reach_m - 0.5 * np.array(self.size_m)
        return float(max(0.0, np.max(off)))


def checked_space(place: str, size: tuple[float, float]) -> tuple[float, float]:
    """The sides of a space [m].

    Raises
    ------
    InputError
        If one is not a positive length below 1 km.
    """
    cure = "give two sides in metres, 3x2"
    a, b = (real(place, side, above=0.0, high=1000.0, cure=cure) for side in size)
    return a, b


def reach_m(model: Model) -> float:
    """Radius [m] of the circle about the body's origin that holds every wheel."""
    g = model.geometry
    return float(np.max(np.hypot(*g.position_m.T) + g.radius_m))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A motion: a short ``kind``, what it is in words, and its legs, each waypoints (K, 3) on the floor."""

    kind: str
    words: str
    legs: tuple[Array, ...]

    @property
    def extent_m(self) -> float:
        """The longer side of the rectangle that holds its waypoints [m]."""
        points = np.concatenate(self.legs)[:, :2]
        return float(np.max(np.ptp(points, axis=0)))

    def sized(self, size: float) -> Motion:
        """The same motion about the same middle, smaller or larger; headings stay."""
        points = np.concatenate(self.legs)[:, :2]
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        scaled = tuple(
            np.column_stack([middle + size * (leg[:, :2] - middle), leg[:, 2]]) for leg in self.legs
        )
        return Motion(kind=self.kind, words=self.words, legs=scaled)


def library(space: Space, model: Model) -> list[Motion]:
    """Every motion that fits the space.

    Parameters
    ----------
    space : Space
        Where the robot may drive, outline and all.
    model : Model
        The robot, for its size.

    Raises
    ------
    InputError
        If the robot does not fit into the space.
    """
    x, y = (_USED * side for side in space.room_m(reach_m(model)))
    middle = np.array([*space.middle_m, 0.0])
    made = [*_spins(), *_lines(x, y), *_turning_lines(x, y), *_stop_and_go(x, y), *_rounds(x, y)]
    return [Motion(kind=m.kind, words=m.words, legs=tuple(leg + middle for leg in m.legs)) for m in made]


def _back(*points: tuple[float, float, float]) -> tuple[Array, Array]:
    """A leg through points, and the same leg back."""
    there = np.array(points)
    return there, there[::-1].copy()


def _spins() -> list[Motion]:
    return [
        Motion(
            kind="spin",
            words="turn on the spot, once to the left and back",
            legs=_back((0.0, 0.0, 0.0), (0.0, 0.0, 2.0 * np.pi)),
        ),
        Motion(
            kind="quarter-turns",
            words="turn on the spot by a quarter, to the left and back",
            legs=_back((0.0, 0.0, 0.0), (0.0, 0.0, 0.5 * np.pi)),
        ),
    ]


def _axes(x: float, y: float) -> list[tuple[str, float, float]]:
    return [(name, a, b) for name, a, b in (("x", x, 0.0), ("y", 0.0, y)) if max(a, b) >= _LEAST_M]


def _lines(x: float, y: float) -> list[Motion]:
    made = [
        Motion(
            kind=f"line-{axis}",
            words=f"straight along the floor's {axis} and back, heading {np.rad2deg(phi):.0f}°",
            legs=_back((-a, -b, phi), (a, b, phi)),
        )
        for axis, a, b in _axes(x, y)
        for phi in _HEADINGS.tolist()
    ]
    if min(x, y) >= _LEAST_M:
        made += [
            Motion(
                kind="diagonal",
                words=f"straight from corner to corner and back, heading {np.rad2deg(phi):.0f}°",
                legs=_back((-x, -y, phi), (x, y, phi)),
            )
            for phi in (0.0, 0.5 * np.pi)
        ]
    return made


def _turning_lines(x: float, y: float) -> list[Motion]:
    return [
        Motion(
            kind=f"turning-line-{axis}",
            words=f"straight along the floor's {axis} while turning by {turn:.0f}°, and back",
            legs=_back((-a, -b, 0.0), (a, b, np.deg2rad(turn))),
        )
        for axis, a, b in _axes(x, y)
        for turn in (180.0, 360.0)
    ]


def _stop_and_go(x: float, y: float) -> list[Motion]:
    made = []
    for axis, a, b in _axes(x, y):
        for phi in (0.0, 0.5 * np.pi):
            stops = [np.array([s * a, s * b, phi]) for s in np.linspace(-1.0, 1.0, 5)]
            there = [np.array(pair) for pair in pairwise(stops)]
            made.append(
                Motion(
                    kind=f"stop-and-go-{axis}",
                    words=f"straight along the floor's {axis} with three stops, and back, heading "
                    f"{np.rad2deg(phi):.0f}°",
                    legs=(*there, *(leg[::-1].copy() for leg in reversed(there))),
                )
            )
    return made


def _rounds(x: float, y: float) -> list[Motion]:
    """Motions that need room in both directions: circles, eights, squares."""
    if min(x, y) < _LEAST_M:
        return []
    r, t = min(x, y), np.linspace(0.0, 2.0 * np.pi, _ROUND + 1)
    made = []
    for phi in (0.0, 0.5 * np.pi):
        words = f"heading {np.rad2deg(phi):.0f}° all the way"
        circle = np.column_stack([r * np.cos(t), r * np.sin(t), np.full_like(t, phi)])
        eight = np.column_stack([x * np.sin(t), y * np.sin(2.0 * t), np.full_like(t, phi)])
        corners = [
            np.array([sx * r, sy * r, phi]) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
        ]
        sides = tuple(np.array(pair) for pair in pairwise(corners))
        made += [
            Motion(kind="circle", words=f"a circle, {words}", legs=(circle,)),
            Motion(kind="eight", words=f"a figure of eight, {words}", legs=(eight,)),
            Motion(kind="square", words=f"a square with a stop at each corner, {words}", legs=sides),
        ]
    for word, way in (("left", 1.0), ("right", -1.0)):
        turning = np.column_stack([r * np.cos(t), way * r * np.sin(t), way * t])
        made.append(
            Motion(
                kind=f"turning-circle-{word}",
                words=f"a circle to the {word}, turning with it as a car does",
                legs=(turning,),
            )
        )
    return made
