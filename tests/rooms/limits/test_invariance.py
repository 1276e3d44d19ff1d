"""What F_emax must not depend on, on drawn robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import kiwi, reals, robots

from slipmargin.limits import Pull
from slipmargin.limits.sweep import limit
from slipmargin.model import nominal_model
from slipmargin.robot import Body, GripShape, Robot, Wheel

PHI = np.linspace(-3.0, 3.0, 13)
SHAPES = (GripShape.BOX, GripShape.BOX, GripShape.ELLIPSE, GripShape.DISC_STRIP)


def force(robot: Robot, phi: np.ndarray = PHI, pull: Pull | None = None) -> np.ndarray:
    return limit(nominal_model(robot, robot.surfaces[0].name), phi, pull or Pull())


def accuracy(robot: Robot) -> float:
    """Relative error to which its limits are computed: a linear program's, or a cone program's."""
    return 1e-10 if robot.friction.grip is GripShape.BOX else 1e-7


def moved(robot: Robot, place: np.ndarray, *, turn_deg: float = 0.0, mirror: bool = False) -> Robot:
    """The robot with a linear map (2, 2) applied to its wheels and centre of mass."""
    sign = -1.0 if mirror else 1.0
    wheels = tuple(
        replace(
            w,
            position_m=place @ w.position_m,
            roller_angle_deg=sign * w.roller_angle_deg,
            drive_direction_deg=sign * w.drive_direction_deg + (180.0 if mirror else turn_deg),
        )
        for w in robot.wheels
    )
    return replace(robot, wheels=wheels, body=replace(robot.body, com_m=place @ robot.body.com_m))


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES), reals(0.1, 10.0))
def test_size(robot: Robot, factor: float) -> None:
    grown = moved(robot, factor * np.eye(2))
    grown = replace(grown, body=replace(grown.body, com_height_m=factor * robot.body.com_height_m))
    np.testing.assert_allclose(force(grown), force(robot), rtol=accuracy(robot))
    pull, far = (
        Pull(point_m=np.array([0.1, 0.2]), height_m=0.1),
        Pull(point_m=factor * np.array([0.1, 0.2]), height_m=factor * 0.1),
    )
    np.testing.assert_allclose(force(grown, pull=far), force(robot, pull=pull), rtol=accuracy(robot))


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES), reals(-180.0, 180.0))
def test_body_axes(robot: Robot, turn_deg: float) -> None:
    c, s = np.cos(np.deg2rad(turn_deg)), np.sin(np.deg2rad(turn_deg))
    turned = moved(robot, np.array([[c, -s], [s, c]]), turn_deg=turn_deg)
    np.testing.assert_allclose(force(turned, PHI - np.deg2rad(turn_deg)), force(robot), rtol=accuracy(robot))


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES))
def test_mirror(robot: Robot) -> None:
    mirrored = moved(robot, np.diag([-1.0, 1.0]), mirror=True)
    np.testing.assert_allclose(force(mirrored, -PHI), force(robot), rtol=accuracy(robot))


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES), reals(0.1, 100.0))
def test_force_grows_as_the_mass(robot: Robot, factor: float) -> None:
    body = replace(robot.body, mass_kg=factor * robot.body.mass_kg)
    np.testing.assert_allclose(force(replace(robot, body=body)), factor * force(robot), rtol=accuracy(robot))


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES))
def test_order_of_the_wheels(robot: Robot) -> None:
    fractions = None if robot.load_fractions is None else robot.load_fractions[::-1]
    np.testing.assert_allclose(
        force(replace(robot, wheels=robot.wheels[::-1], load_fractions=fractions)),
        force(robot),
        rtol=accuracy(robot),
    )


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES), reals(-3.0, 3.0))
def test_only_the_angle_between_pull_and_heading_counts(robot: Robot, turn: float) -> None:
    np.testing.assert_allclose(
        force(robot, PHI + turn, Pull(direction_rad=turn)), force(robot), rtol=accuracy(robot)
    )


@settings(max_examples=30, deadline=None)
@given(robots(shapes=SHAPES))
def test_pulling_back_is_as_hard_as_pulling_forward(robot: Robot) -> None:
    # Friction knows no sense unless an effect says so, and a level pull moves no load.
    np.testing.assert_allclose(force(robot, PHI + np.pi), force(robot), rtol=accuracy(robot))


@settings(max_examples=30, deadline=None)
@given(robots(), reals(1.0, 3.0))
def test_more_friction_never_hurts(robot: Robot, factor: float) -> None:
    floor = robot.surfaces[0]
    better = replace(floor, roller=replace(floor.roller, drive=floor.roller.drive * factor))
    assert np.all(force(replace(robot, surfaces=(better,))) >= force(robot) * (1 - 1e-12))


def test_wheel_radius_and_roller_count_do_not_enter() -> None:
    robot = kiwi()
    other = replace(robot, wheels=tuple(replace(w, radius_m=0.1, rollers=3) for w in robot.wheels))
    np.testing.assert_array_equal(force(other), force(robot))


@pytest.mark.parametrize("height", [0.0, 0.4])
def test_height_of_the_centre_of_mass_does_not_enter_at_rest(height: float) -> None:
    robot = kiwi()
    tall = replace(robot, body=Body(mass_kg=3.0, inertia_kg_m2=0.027, com_height_m=height))
    assert isinstance(tall.wheels[0], Wheel)
    np.testing.assert_array_equal(force(tall), force(robot))
