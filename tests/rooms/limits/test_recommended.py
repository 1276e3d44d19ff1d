"""What is recommended, driven as a motion, uses no more of the grip than the margin leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import four_wheels, models

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import ahead_of, cornering, directions, headings, spin
from slipmargin.limits.bounds_inside import inside
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model, nominal_model
from slipmargin.robot import Body, Coefficients, GripShape, LoadRule, Surface

MARGIN, ALLOWED = 0.1, 0.002


def mecanum(com_m: tuple[float, float] = (0.06, 0.08)) -> Model:
    """Twenty kilograms whose mass sits off the centre: 2.109 m/s² was recommended and used 0.916."""
    floor = Surface(
        name="floor",
        roller=Coefficients(drive=0.5, transverse=0.02),
        rigid=Coefficients(drive=0.5, transverse=0.5),
    )
    body = Body(mass_kg=20.0, inertia_kg_m2=1.0, com_m=np.array(com_m))
    return nominal_model(replace(four_wheels(), body=body, surfaces=(floor,)), "floor")


def driven(model: Model, velocity: Array, acceleration: Array) -> Array:
    """Largest use (M,) by the machinery of ``check``, so fast that the drag is full."""
    motion = Motion(velocity=velocity, acceleration=acceleration)
    return np.asarray(realised(model, motion).use.max(axis=1))


def flat_out(velocity: Array) -> Array:
    """Velocities at which every wheel that slides at all has its full drag."""
    return np.asarray(1e4 * velocity)


def test_the_mecanum_robot_keeps_its_margin() -> None:
    model, around = mecanum(), headings(2.0) + 0.0123  # no wheel's transverse slip is exactly zero
    safe = directions(model, around, share=1.0 - MARGIN)
    ahead = ahead_of(around)
    use = driven(model, flat_out(ahead), safe.starting_m_s2[:, None] * ahead)
    assert np.max(use) <= 1.0 - MARGIN + ALLOWED
    assert np.min(use) >= 1.0 - MARGIN - ALLOWED  # and it is the limit: no timid answer


@settings(max_examples=25, deadline=None)
@given(models(shapes=(GripShape.BOX, GripShape.DISC_STRIP), motors=True))
def test_every_direction_keeps_the_margin(model: Model) -> None:
    around = headings(15.0) + 0.0123  # no wheel's transverse slip is exactly zero
    ahead = ahead_of(around)
    left = np.stack([-ahead[:, 1], ahead[:, 0], ahead[:, 2]], axis=1)
    safe = directions(model, around, share=1.0 - MARGIN)
    for value, way in ((safe.starting_m_s2, ahead), (safe.braking_m_s2, -ahead)):
        held = (value > 0.0) & np.isfinite(safe.steady_use)  # else the limits are those of coasting
        if np.any(held):
            use = driven(model, flat_out(ahead[held]), value[held, None] * way[held])
            assert np.max(use) <= 1.0 - MARGIN + ALLOWED
    held = safe.turning_m_s2 > 0.0
    for way in (left, -left):
        if np.any(held & (safe.starting_m_s2 > 0.0)):
            some = held & (safe.starting_m_s2 > 0.0)
            use = driven(model, flat_out(ahead[some]), safe.turning_m_s2[some, None] * way[some])
            assert np.max(use) <= 1.0 - MARGIN + ALLOWED


def test_cornering_of_an_offset_mass_is_not_refused_for_its_own_centripetal_force() -> None:
    """The steady share was asked at 1 m/s, so tight curves got 0 although a slower corner is held."""
    model = mecanum()
    found = cornering(model, np.array([0.2, 20.0]), headings(15.0), share=0.9)
    assert np.all(found.tangent_m_s > 0.0) and np.all(found.held_m_s > 0.0)


def tall() -> Model:
    """An FTC robot with its mass half a metre up: it tips sideways at g · 0.15/0.5 on a floor that grips."""
    floor = Surface(
        name="floor",
        roller=Coefficients(drive=0.9, transverse=0.02),
        rigid=Coefficients(drive=0.9, transverse=0.9),
    )
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.5)
    return nominal_model(replace(robot, surfaces=(floor,)), "floor")


def test_tipping_has_the_margin_and_its_own_name() -> None:
    model, way = tall(), np.array([0.0])
    tipping = 9.81 * 0.15 / 0.5
    full, safe = (directions(model, way, share=s, motor=False) for s in (1.0, 1.0 - MARGIN))
    assert full.starting_m_s2[0] == pytest.approx(tipping, rel=1e-6)
    assert full.starting.cause == ("tips",)
    assert safe.starting_m_s2[0] <= (1.0 - MARGIN) * tipping * (1.0 + 1e-9)
    assert safe.braking_m_s2[0] <= (1.0 - MARGIN) * tipping * (1.0 + 1e-9)
    load = model.loads.at(np.array([safe.starting_m_s2[0], 0.0]))
    assert np.all(load >= MARGIN * model.loads.rest_N - 1e-9)


@settings(max_examples=8, deadline=None)
@given(models(shapes=(GripShape.BOX, GripShape.DISC_STRIP)))
def test_every_corner_of_the_box_keeps_the_margin(model: Model) -> None:
    try:
        sets = inside(model, share=1.0 - MARGIN)
    except NoSolution:
        return
    around = headings(15.0) + 0.0123
    ahead = ahead_of(around)
    for a in (-1.0, 1.0):
        for b in (-1.0, 1.0):
            for c in (-1.0, 1.0):
                way = np.array([a, b, c])
                sided = (
                    np.where(way > 0.0, sets.fast, sets.slow)
                    * np.where(ahead == 0.0, 1.0, np.sign(ahead))
                    * way
                )
                circle = np.broadcast_to(
                    np.array([a * sets.circle_m_s2, b * sets.circle_m_s2, c * np.sqrt(2.0) * sets.yaw_rad_s2])
                    / np.sqrt(2.0),
                    ahead.shape,
                )
                for corner in (sided, np.broadcast_to(way * sets.even, ahead.shape), circle):
                    use = driven(model, flat_out(ahead), np.asarray(corner))
                    assert np.max(use) <= 1.0 - MARGIN + ALLOWED


def test_yaw_in_reserve_is_stated_and_given_up_for_translation() -> None:
    model = mecanum((0.0, 0.0))
    stated, none = inside(model, share=0.9), inside(model, share=0.9, yaw_rad_s2=0.0)
    assert stated.yaw_rad_s2 == pytest.approx(0.1 * spin(model, share=0.9).starting_rad_s2)
    assert none.circle_m_s2 > stated.circle_m_s2 > 0.8 * none.circle_m_s2
    assert stated.fast[2] == stated.slow[2] == stated.even[2] == stated.yaw_rad_s2
    with pytest.raises(NoSolution, match="reserve less"):
        inside(model, share=0.9, yaw_rad_s2=1e3)
