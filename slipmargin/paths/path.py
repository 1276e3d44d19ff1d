"""A path: where the robot goes and which way it faces, without saying how fast."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.paths.pieces import Jet, Piece, Quadratic, Spline, distance

#: Largest angle between the tangents of two pieces that still counts as smooth [rad].
SMOOTH_RAD = 1e-6
#: No robot drives so far [m] or turns so often [rad].
FARTHEST = 1e6
#: Coordinates on a map have up to 1e7 m; beyond this they would be rounded to more than 10 µm [m].
_LARGEST = 1e10
#: Corners sharper than this cannot be rounded by a spline [rad].
SHARP_RAD = np.deg2rad(150.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Path:
    """Pieces end to end; s [m] runs from 0 to :attr:`length`."""

    pieces: tuple[Piece, ...]
    closed: bool = False

    def __post_init__(self) -> None:
        if not self.pieces:
            raise InputError("path", "has no piece", "give at least one line, arc or spline")
        ends = list(zip(self.pieces[:-1], self.pieces[1:], strict=True))
        for k, (one, two) in enumerate(ends, 1):
            _joined(f"piece {k + 1}", one, two)
        if self.closed and len(self.pieces) > 1:
            _joined("piece 1", self.pieces[-1], self.pieces[0], turns=True)

    @property
    def breaks(self) -> Array:
        """(P + 1,) s at which pieces begin and end [m]."""
        return np.concatenate([[0.0], np.cumsum([p.length for p in self.pieces])])

    @property
    def length(self) -> float:
        """Length in s [m]."""
        return float(self.breaks[-1])

    def at(self, s: Array, piece: NDArray[np.int64] | None = None) -> Jet:
        """q, q', q'' (M, 3) at ``s`` (M,) [m].

        ``piece`` (M,) chooses the side at a break; without it the later piece is taken.
        """
        s = np.asarray(s, dtype=float)
        breaks = self.breaks
        which = piece_at(breaks, s) if piece is None else np.asarray(piece)
        out = (np.empty((len(s), 3)), np.empty((len(s), 3)), np.empty((len(s), 3)))
        for k, part in enumerate(self.pieces):
            rows = which == k
            if np.any(rows):
                inside = np.clip(s[rows] - breaks[k], 0.0, part.length)
                for target, value in zip(out, part.at(inside), strict=True):
                    target[rows] = value
        return out

    def pose(self, s: Array) -> Array:
        """(M, 3) x [m], y [m], φ [rad]."""
        return self.at(s)[0]


def piece_at(breaks: Array, s: Array) -> NDArray[np.int64]:
    """Index of the piece that holds each ``s``."""
    return np.clip(np.searchsorted(breaks, s, side="right") - 1, 0, len(breaks) - 2)


def through(waypoints: Array, *, arm: float = 0.1, closed: bool = False, source: str = "waypoint") -> Path:
    """A smooth path (continuous curvature) through poses (W, 3).

    A cubic spline over chord length, natural at open ends, periodic where ``closed`` (the heading may
    then have wound by whole turns).

    Parameters
    ----------
    arm : float
        Length that makes a heading comparable with a distance [m].

    Raises
    ------
    InputError
        Fewer than two waypoints, a value that is not finite, a waypoint repeated, or a kink: the
        waypoint is named.
    """
    from scipy.interpolate import CubicSpline

    points = checked(waypoints, arm, source)
    gap = points[-1] - points[0]
    turns = 2.0 * np.pi * round(gap[2] / (2.0 * np.pi))
    if closed:
        if distance(np.array([0.0, 0.0, turns]), gap, arm) > 1e-9:
            points = np.vstack([points, points[0] + np.array([0.0, 0.0, turns])])
        if len(points) < 4:
            raise InputError(
                source,
                f"{len(points) - 1} waypoints cannot close a smooth path",
                "give at least three different waypoints",
            )
    _no_sharp_corner(points, arm, closed, source)
    knot = np.concatenate([[0.0], np.cumsum(distance(points[:-1], points[1:], arm))])
    if closed:
        trend = np.array([0.0, 0.0, points[-1, 2] - points[0, 2]]) / knot[-1]
        level = points - knot[:, None] * trend
        level[-1] = level[0]
        c = np.array(CubicSpline(knot, level, bc_type="periodic").c)
        c[2] += trend
        c[3] += knot[:-1, None] * trend
    else:
        c = np.array(CubicSpline(knot, points, bc_type="natural" if len(points) > 2 else "not-a-knot").c)
        c = np.concatenate([np.zeros((4 - len(c), *c.shape[1:])), c])
    return Path(pieces=(Spline(breaks=knot, coefficients=c),), closed=closed)


def corners(waypoints: Array, *, blend_m: float = 0.0, arm: float = 0.1, source: str = "waypoint") -> Path:
    """Straight lines between poses, each corner rounded by a parabola that starts ``blend_m`` before it.

    Raises
    ------
    InputError
        As :func:`through`; also a corner without blend, and a blend longer than half a line.
    """
    points = checked(waypoints, arm, source)
    span = distance(points[:-1], points[1:], arm)
    way = np.diff(points, axis=0) / span[:, None]
    weigh = np.array([1.0, 1.0, arm])
    cosine = np.clip(np.sum(way[:-1] * weigh * way[1:] * weigh, axis=1), -1.0, 1.0)
    bent = np.arccos(cosine) > 1e-6
    for k in np.flatnonzero(bent).tolist():
        if blend_m <= 0.0:
            turn = np.rad2deg(np.arccos(cosine[k]))
            raise InputError(
                f"{source} {k + 2}",
                f"is a kink of {turn:.3g} degrees, where the robot would have to stop",
                "blend it (for example 0.05 m) or drive a spline through the waypoints",
            )
        if np.arccos(cosine[k]) > SHARP_RAD:
            raise _turned_back(f"{source} {k + 2}")
        if blend_m > 0.5 * min(span[k], span[k + 1]) + 1e-12:
            raise InputError(
                f"{source} {k + 2}",
                f"has no room for a blend of {blend_m:g} m",
                f"use at most {0.5 * min(span[k], span[k + 1]):.4g} m",
            )
    cut = np.where(np.concatenate([[False], bent, [False]]), blend_m, 0.0)
    pieces: list[Piece] = []
    for k, d in enumerate(way):
        rest = span[k] - cut[k] - cut[k + 1]
        if rest > 1e-12 * span[k]:
            pieces.append(
                Quadratic(start=points[k] + cut[k] * d, slope=d, bend=np.zeros(3), span=float(rest))
            )
        if k + 1 < len(way) and bent[k]:
            pieces.append(
                Quadratic(
                    start=points[k + 1] - blend_m * d,
                    slope=d,
                    bend=(way[k + 1] - d) / (2.0 * blend_m),
                    span=2.0 * blend_m,
                )
            )
    return Path(pieces=tuple(pieces))


def checked(waypoints: Array, arm: float, source: str) -> Array:
    """Waypoints that are finite, at least two and all different from the one before."""
    points = np.array(waypoints, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(source, f"table has shape {points.shape}", "give rows of x_m, y_m, phi_rad")
    for k, row in enumerate(points, 1):
        if not np.all(np.isfinite(row)):
            raise InputError(f"{source} {k}", f"is {tuple(row.tolist())}", "give finite numbers")
        if np.max(np.abs(row - points[0])) > FARTHEST or np.max(np.abs(row)) > _LARGEST:
            raise InputError(f"{source} {k}", f"is {tuple(row.tolist())}", "give metres and radians")
    if len(points) < 2:
        raise InputError(source, f"{len(points)} waypoint is no path", "give at least two waypoints")
    gap = distance(points[:-1], points[1:], arm)
    if np.min(gap) <= 1e-9 * max(1.0, float(np.max(gap))):
        k = int(np.argmin(gap)) + 2
        raise InputError(f"{source} {k}", f"repeats waypoint {k - 1}", "remove it: a path moves on")
    return points


def _no_sharp_corner(points: Array, arm: float, closed: bool, source: str) -> None:
    way = np.diff(points, axis=0) * np.array([1.0, 1.0, arm])
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    after = np.vstack([way[1:], way[:1]]) if closed else way[1:]
    before = way if closed else way[:-1]
    for k, cosine in enumerate(np.sum(before * after, axis=1)):
        if np.arccos(np.clip(cosine, -1.0, 1.0)) > SHARP_RAD:
            raise _turned_back(f"{source} {(k + 1) % (len(points) - 1) + 1 if closed else k + 2}")


def _turned_back(place: str) -> InputError:
    return InputError(
        place,
        "is a kink: the path turns back on itself there",
        "split the path at this waypoint, or blend it by a waypoint to the side",
    )


def _joined(place: str, one: Piece, two: Piece, *, turns: bool = False) -> None:
    a = [x[0] for x in one.at(np.array([one.length]))]
    b = [x[0] for x in two.at(np.array([0.0]))]
    gap = b[0] - a[0]
    if turns:
        gap[2] -= 2.0 * np.pi * round(gap[2] / (2.0 * np.pi))
    if np.max(np.abs(gap)) > 1e-6:
        raise InputError(
            place,
            "does not start where the piece before it ends",
            f"start it at x {a[0][0]:.6g} m, y {a[0][1]:.6g} m, phi {a[0][2]:.6g} rad",
        )
    if np.max(np.abs(b[1] - a[1])) > SMOOTH_RAD * max(1.0, float(np.max(np.abs(a[1])))):
        raise InputError(
            place,
            "starts in another direction than the piece before it ends (a kink)",
            "blend the corner, or put an arc between the two",
        )
