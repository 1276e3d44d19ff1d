"""Paths: what they pass through, how smooth they are, and what is refused at the door."""

from __future__ import annotations

import numpy as np
import pytest

from slipmargin.errors import InputError
from slipmargin.paths.grid import BENDING, _bending, grid_of
from slipmargin.paths.path import Path, corners, through
from slipmargin.paths.pieces import arc, line

WAY = np.array([[0.0, 0.0, 0.0], [0.5, 0.3, 0.5], [1.0, 0.0, 0.0], [1.5, -0.3, -0.5]])
RING = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [1.0, 1.0, 0.0], [0.0, 1.0, -0.5]])
ARM = 0.1


def numeric(path: Path, s: np.ndarray, h: float = 1e-5) -> tuple[np.ndarray, np.ndarray]:
    left, mid, right = path.pose(s - h), path.pose(s), path.pose(s + h)
    return (right - left) / (2 * h), (right - 2 * mid + left) / h**2


def mixed() -> Path:
    """A line, half a circle with the heading along, a line back."""
    half = arc([1.0, 0.0, 0.0], [1.0, 0.4], np.pi, 0.0, ARM)
    return Path(
        pieces=(
            line([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], ARM),
            half,
            line([1.0, 0.8, 0.0], [0.0, 0.8, 0.0], ARM),
        )
    )


@pytest.mark.parametrize(
    "path",
    [through(WAY), corners(WAY, blend_m=0.1), mixed(), through(RING, closed=True)],
    ids=["spline", "corners", "arc", "closed"],
)
def test_derivatives_are_the_derivatives(path: Path) -> None:
    s = path.length * np.linspace(0.013, 0.987, 41)
    s = s[np.min(np.abs(s[:, None] - path.breaks), axis=1) > 1e-3]
    _, first, second = path.at(s)
    one, two = numeric(path, s)
    assert first == pytest.approx(one, abs=1e-7)
    assert second == pytest.approx(two, abs=2e-4)


def test_a_spline_passes_its_waypoints_and_a_closed_one_closes_smoothly() -> None:
    path = through(WAY, arm=ARM)
    knots = np.concatenate([[0.0], path.pieces[0].knots, [path.length]])
    assert path.pose(knots) == pytest.approx(WAY, abs=1e-12)
    ring = through(np.vstack([RING, RING[0] + np.array([0.0, 0.0, 2.0 * np.pi])]), arm=ARM, closed=True)
    ends = ring.at(np.array([0.0, ring.length]), np.array([0, 0]))
    assert ends[0][1] - ends[0][0] == pytest.approx([0.0, 0.0, 2.0 * np.pi], abs=1e-9)
    for derivative in ends[1:]:
        assert derivative[1] == pytest.approx(derivative[0], abs=1e-9)
    assert through(WAY[:2]).at(np.array([0.1]))[2] == pytest.approx(np.zeros((1, 3)), abs=1e-9)


def test_blends_stay_near_the_corner() -> None:
    path = corners(WAY, blend_m=0.1)
    for k in (1, 2):
        s = np.linspace(0.0, path.length, 4001)
        gap = np.min(np.hypot(*(path.pose(s)[:, :2] - WAY[k, :2]).T))
        assert 0.0 < gap < 0.1


def test_the_grid_is_dense_where_the_path_bends_and_hits_every_knot() -> None:
    path = through(WAY)
    grid = grid_of(path, 50)
    for knot in path.pieces[0].knots:
        assert np.min(np.abs(grid.s - knot)) < 1e-12
    assert np.max(_bending(path, grid.s)) <= BENDING
    assert np.all(grid.step > 0.0) and grid.s[-1] == path.length
    assert grid.step[0] < 0.1 * grid.step[6]  # the robot is slow at the ends
    with pytest.raises(InputError, match="at least 10"):
        grid_of(path, 5)


@pytest.mark.parametrize(
    ("points", "place", "problem"),
    [
        ([[0, 0, 0]], "waypoint", "no path"),
        ([[0, 0, 0], [1, 0, 0], [1, 0, 0]], "waypoint 3", "repeats waypoint 2"),
        ([[0, 0, 0], [1, np.nan, 0]], "waypoint 2", "nan"),
        ([[0, 0, 0], [1e300, 0, 0]], "waypoint 2", "give metres and radians"),
        ([[0, 0], [1, 0]], "waypoint", "shape"),
        ([[0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 1, 0]], "waypoint 2", "turns back on itself"),
    ],
)
def test_bad_waypoints_are_named(points: list[list[float]], place: str, problem: str) -> None:
    for make in (through, lambda p: corners(p, blend_m=0.1)):
        with pytest.raises(InputError, match=problem) as caught:
            make(np.array(points, dtype=float))
        assert caught.value.place == place


def test_kinks_say_which_and_offer_blending() -> None:
    with pytest.raises(InputError, match=r"waypoint 2: is a kink of .* blend it"):
        corners(WAY)
    with pytest.raises(InputError, match=r"no room for a blend of 0\.5 m, use at most 0\.29"):
        corners(WAY, blend_m=0.5)
    with pytest.raises(InputError, match=r"piece 2: starts in another direction .*blend the corner"):
        Path(pieces=(line([0, 0, 0], [1, 0, 0], ARM), line([1, 0, 0], [1, 1, 0], ARM)))
    with pytest.raises(InputError, match="piece 2: does not start where"):
        Path(pieces=(line([0, 0, 0], [1, 0, 0], ARM), line([1.1, 0, 0], [2, 0, 0], ARM)))
    with pytest.raises(InputError, match="piece 1: does not start where"):
        Path(pieces=mixed().pieces, closed=True)
    with pytest.raises(InputError, match="has no piece"):
        Path(pieces=())
    with pytest.raises(InputError, match="cannot close"):
        through(WAY[:2], closed=True)
    with pytest.raises(InputError, match="give two different poses"):
        line([0, 0, 0], [0, 0, 0], ARM)
    with pytest.raises(InputError, match="has no length"):
        arc([0, 0, 0], [0, 0], 1.0, 0.0, ARM)


def test_a_path_may_lie_where_a_map_puts_it() -> None:
    """Northings of most of the world are beyond 1e6 m: they were said to be no metres."""
    far = np.array([500000.0, 5400000.0, 0.0])
    assert through(WAY + far).length == pytest.approx(through(WAY).length, rel=1e-8)
