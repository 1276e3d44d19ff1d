"""What the path asks of the centre of mass, against numbers taken from its own way over the floor."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.model import nominal_model
from slipmargin.paths.geometry import Geometry
from slipmargin.paths.grid import grid_of
from slipmargin.paths.path import through
from slipmargin.physics.frames import rotate_rows

COM = np.array([0.03, -0.05])
WAY = through(np.array([[0.0, 0.0, 0.0], [0.6, 0.4, 0.9], [1.2, 0.0, -0.5]]))


def centre(s: np.ndarray) -> np.ndarray:
    """Pose of the centre of mass at s: origin + R(φ) com."""
    x, y, phi = WAY.pose(s).T
    c, d = np.cos(phi), np.sin(phi)
    return np.column_stack([x + c * COM[0] - d * COM[1], y + d * COM[0] + c * COM[1], phi])


def test_push_and_bend_are_the_acceleration_of_the_centre_of_mass() -> None:
    model = nominal_model(kiwi(com_m=(COM[0], COM[1])), "paper")
    shape = Geometry.of(model, WAY, grid_of(WAY, 30), np.array([0.25, 0.6]))
    s, h = shape.s.ravel(), 1e-4
    first = (centre(s + h) - centre(s - h)) / (2 * h)
    second = (centre(s + h) - 2 * centre(s) + centre(s - h)) / h**2
    for u, sq in ((1.0, 0.0), (0.0, 1.0), (-0.4, 0.7)):
        expected = rotate_rows(WAY.pose(s)[:, 2], first * u + second * sq, inverse=True)
        got = (shape.push * u + shape.bend * sq).reshape(-1, 3)
        inner = np.abs(s[:, None] - WAY.pieces[0].knots).min(axis=1) > 2 * h
        inner &= (s > h) & (s < WAY.length - h)
        assert got[inner] == pytest.approx(expected[inner], abs=2e-5)


def test_times_are_those_of_constant_acceleration() -> None:
    model, grid = nominal_model(kiwi(), "paper"), grid_of(WAY, 30)
    shape = Geometry.of(model, WAY, grid, np.linspace(0.0, 1.0, 5))
    a = 0.3
    time = shape.times(2.0 * a * grid.s, np.full(len(grid.step), a))
    assert time == pytest.approx(np.sqrt(2.0 * shape.s / a), abs=1e-9)


def ends(points: list[list[float]]) -> np.ndarray:
    model, way = nominal_model(kiwi(), "paper"), through(np.array(points))
    return Geometry.of(model, way, grid_of(way, 30), np.array([0.0, 1.0])).floor_rates(model.reach_m)


def test_an_end_speed_is_the_wheels_where_the_robot_all_but_turns_on_the_spot() -> None:
    """Waypoints rounded to a micrometre gave 0.05 m/s over the floor while the wheels were to do 5 km/s."""
    model = nominal_model(kiwi(), "paper")
    spot, *near = (ends([[0.0, 0.0, 0.0], [x, 0.0, 1.5], [1.0, 0.0, 1.5]]) for x in (0.0, 1e-6, 1e-4))
    for rates in near:
        assert rates == pytest.approx(spot, rel=1e-3)
    way = through(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.5], [1.0, 0.0, 1.5]]))
    h = 1e-6
    moved = (way.pose(np.array([h])) - way.pose(np.array([0.0])))[0] / h
    assert spot[0] == pytest.approx(np.linalg.norm(moved * [1.0, 1.0, model.reach_m]), rel=1e-3)
