"""Loads of four wheels and more on an uneven floor: a band, of which limits take the worst."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.limits import sweep
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Motion
from slipmargin.model import nominal_model
from slipmargin.physics.loads import uneven_shifts
from slipmargin.robot import GripShape, LoadRule, Robot

CORNERS = np.array([[0.15, 0.2], [-0.15, 0.2], [-0.15, -0.2], [0.15, -0.2]])


def uneven(robot: Robot, stiffness: float = 20.0, unevenness: float = 0.5) -> Robot:
    return replace(robot, suspension_N_per_mm=stiffness, unevenness_mm=unevenness)


def test_half_a_millimetre_shifts_twelve_newtons_between_the_diagonals() -> None:
    # By hand: on four equal springs c the body takes three quarters of a contact's lift δ as heave, pitch
    # and roll; the last quarter warps: each spring by δ/4, one diagonal more, the other
    # less: 100 N/mm · 0.5/4 mm.
    shifts = uneven_shifts(CORNERS, 100e3, 0.5e-3)
    np.testing.assert_allclose(
        shifts, np.outer([1.0, -1.0], 12.5 * np.array([1.0, -1.0, 1.0, -1.0])), rtol=1e-12
    )


def test_shifts_are_those_of_springs_under_a_rigid_body() -> None:
    # Independently: body height and tilts (z, a, b) minimise the springs' energy over contacts δ.
    rng = np.random.default_rng(4)
    place = rng.normal(size=(6, 2))
    plane = np.column_stack([np.ones(6), place])
    for i, shift in enumerate(uneven_shifts(place, 1000.0, 0.01)[:6]):
        contact = np.where(np.arange(6) == i, 0.01, 0.0)
        body = np.linalg.lstsq(plane, contact, rcond=None)[0]
        np.testing.assert_allclose(shift, 1000.0 * (contact - plane @ body), atol=1e-12)
        np.testing.assert_allclose(plane.T @ shift, 0.0, atol=1e-12)  # neither weight nor moment


def test_three_wheels_are_refused_with_the_reason() -> None:
    with pytest.raises(InputError, match=r"loads.suspension_N_per_mm.*statics alone decides their loads"):
        uneven(kiwi())
    with pytest.raises(InputError, match="has no effect without unevenness_mm"):
        replace(four_wheels(), suspension_N_per_mm=20.0)


def test_a_wheel_that_hangs_in_the_air_carries_nothing() -> None:
    model = nominal_model(uneven(four_wheels(), 1e4, 2.0), "paper")
    shifts = model.loads.shifts()
    assert np.min(model.loads.rest_N + shifts) == pytest.approx(0.0, abs=1e-9)
    assert (
        sm.bounds(uneven(four_wheels(), 1e4, 2.0), "paper", step_deg=30.0).bounds.full.starting.cause[0]
        == "grip"
    )


@pytest.mark.parametrize("shape", tuple(GripShape))
def test_the_limit_is_the_worst_of_the_band(shape: GripShape) -> None:
    robot = replace(four_wheels(), friction=replace(four_wheels().friction, grip=shape))
    level, model = nominal_model(robot, "paper"), nominal_model(uneven(robot), "paper")
    heading, rng = headings(15.0), np.random.default_rng(2)
    pulls = sweep(model, heading)
    starts = directions(model, heading, share=0.9)
    one = model.loads.shifts()[1]
    for part in (*rng.uniform(-1.0, 1.0, 4), -1.0, 0.0, 1.0):  # loads anywhere between the corners
        at = replace(level, loads=replace(level.loads, rest_N=level.loads.rest_N + part * one))
        held = sweep(at, heading)
        assert np.all(pulls.f_low_N <= held.f_low_N * (1.0 + 1e-6))
        assert np.all(pulls.f_high_N >= held.f_high_N * (1.0 - 1e-6)) or abs(part) not in (0.0, 1.0)
        free = directions(at, heading, share=0.9).starting_m_s2
        slips = np.isinf(starts.steady_use)  # drag uses the whole grip: the value is that of coasting
        assert np.all((starts.starting_m_s2 <= free + 1e-6) | slips)
    np.testing.assert_allclose(pulls.f_max_N, sweep(level, heading).f_max_N, rtol=1e-12)
    assert np.any(starts.starting_m_s2 < directions(level, heading, share=0.9).starting_m_s2 - 0.01)


def test_recommended_numbers_are_the_worst_and_the_even_floor_is_beside_them() -> None:
    robot = uneven(four_wheels())
    found, level = (sm.bounds(r, "paper", step_deg=15.0) for r in (robot, four_wheels()))
    assert found.recommended_m_s2 < level.recommended_m_s2
    table = found.to_dict()["load_band"]
    np.testing.assert_array_equal(table["even_floor_starting_m_s2"], level.bounds.full.starting_m_s2)
    np.testing.assert_allclose(table["shifts_N"][0], 2.5 * np.array([1.0, -1.0, 1.0, -1.0]))
    assert "even_floor_starting_m_s2" in found.table_text().splitlines()[0]
    assert any(line.startswith("loads ") for line in found.lines())
    assert "load_band" not in level.to_dict() and not any(s.startswith("loads ") for s in level.lines())
    assert "loads of an uneven floor" in sm.sweep(robot, "paper", step_deg=30.0).lines()[3]


def test_an_audit_counts_the_band() -> None:
    level, model = nominal_model(four_wheels(), "paper"), nominal_model(uneven(four_wheels()), "paper")
    motion = Motion(velocity=np.array([[0.3, 0.1, 0.0]]), acceleration=np.array([[0.4, 0.2, 0.0]]))
    worst = max(
        realised(replace(level, loads=replace(level.loads, rest_N=level.loads.rest_N + s)), motion).use.max()
        for s in model.loads.shifts()
    )
    assert realised(model, motion).use.max() == pytest.approx(worst, rel=1e-9)
    assert worst > realised(level, motion).use.max()


def test_a_plan_on_an_uneven_floor_keeps_its_margin_at_every_corner() -> None:
    robot = uneven(replace(four_wheels(), load_rule=LoadRule.QUASI_STATIC), 10.0)
    found = sm.plan(robot, "paper", [[0.0, 0.0, 0.0], [0.6, 0.3, 0.2]], points=60)
    assert found.plan.max_use == pytest.approx(0.9, abs=2e-3)


def test_a_box_is_told_what_rollers_that_turn_freely_hold() -> None:
    box = sm.bounds("ohio-kiwi-symmetric", "paper", step_deg=15.0)
    free = sm.bounds(sm.read_robot("ohio-kiwi-symmetric", grip="disc-strip"), "paper", step_deg=15.0)
    assert box.bounds.rolling_m_s2 == pytest.approx(free.bounds.traction_m_s2, rel=1e-12)
    (line,) = [s for s in box.lines() if s.startswith("grip ")]
    assert f"{free.bounds.traction_m_s2:.4g} m/s²" in line and "% less" in line
    assert not any(s.startswith("grip ") for s in free.lines())
    assert box.to_dict()["traction_limit_disc_strip_m_s2"] == box.bounds.rolling_m_s2
