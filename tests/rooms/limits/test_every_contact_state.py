"""Contact states, loads and orientations that one figure of several left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import slipmargin as sm
from slipmargin.effects import Recipe
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.errors import NoSolution
from slipmargin.limits import bounds_states
from slipmargin.limits.bounds import headings, starting_by_motor
from slipmargin.limits.bounds_states import States
from slipmargin.limits.bounds_summary import bounds
from slipmargin.limits.motion_realised import growth_per_s, realised
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.uncertainty import draws
from slipmargin.limits.uncertainty_motion import lowest_starts
from slipmargin.model import nominal_model
from slipmargin.physics.frames import directions
from slipmargin.robot import Coefficients, LoadRule, Robot, Surface, Uncertain


def coefficients(drive: float, transverse: float) -> Coefficients:
    return Coefficients(drive=drive, transverse=transverse)


def sectors(robot: str, share: float) -> Robot:
    """A built-in robot whose wheels are rigid over this share of the rim."""
    found = sm.read_robot(robot).robot
    return replace(found, wheels=tuple(replace(w, rigid_fraction=share) for w in found.wheels))


def test_the_motors_limit_counts_wheels_on_rigid_material() -> None:
    """With --robust the motor line said 9.09 m/s² where it is 1.21: rollers alone were asked."""
    model = nominal_model(sectors("mecanum4", 0.2), "floor")
    around = headings(30.0)
    free, any_state = (
        starting_by_motor(model, around, contact=contact) for contact in (Contact.ROLLERS, Contact.UNKNOWN)
    )
    assert np.all(any_state <= free) and np.min(any_state) < 0.3 * np.min(free)
    found = bounds(model, step_deg=30.0, contact=Contact.UNKNOWN)
    assert found.motor_limit_m_s2 <= np.min(any_state) * (1.0 + 1e-9)


def test_creep_that_grows_on_some_material_is_found() -> None:
    """Wheels all on rollers die out; on sectors a creep grew by 3061 a second, and no word said so."""
    robot = sectors("ohio-kiwi-symmetric", 0.2)
    floor = Surface(name="floor", roller=coefficients(0.4, 0.06), rigid=coefficients(0.6, 0.3))
    body = replace(robot.body, com_height_m=0.3, inertia_kg_m2=0.015)
    high = replace(robot, surfaces=(floor,), body=body, load_rule=LoadRule.QUASI_STATIC)
    model = nominal_model(high, "floor")
    ahead = np.append(directions(np.deg2rad([270.0]))[0], 0.0)[None]
    motion = Motion(velocity=0.5 * ahead, acceleration=0.4 * ahead)
    free, any_state = (
        growth_per_s(model, motion, contact=contact)[0] for contact in (Contact.ROLLERS, Contact.UNKNOWN)
    )
    assert free < 0.0 < 100.0 < any_state
    assert np.max(realised(model, motion, contact=Contact.UNKNOWN).use) < 1.0


def test_ends_of_safe_sets_are_tried_along_normals_of_their_own_motions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The normals of the first five motions stood for those of five kinds."""
    every: list[np.ndarray] = []
    taken = bounds_states._normals

    def kept(rows: np.ndarray, run: np.ndarray) -> np.ndarray:
        every.append(taken(rows, run))
        return every[-1]

    monkeypatch.setattr(bounds_states, "_normals", kept)
    robot = sm.read_robot("mecanum4").robot
    states = States.of(nominal_model(robot, "floor"), 0.9, Contact.ROLLERS)
    first = np.flatnonzero(np.diff(states.kind, prepend=-1))
    assert len(first) > 1 and states.normals.shape[1] == len(first)
    np.testing.assert_array_equal(states.normals, every[0][:, first])


def test_wheels_that_are_rigid_all_round_have_the_spread_of_rigid_material() -> None:
    """The chance of slip was 0 or 1: the spread of rollers that they have not got was drawn."""
    robot = sectors("mecanum4", 1.0)
    rigid = Coefficients(drive=Uncertain((0.6, 0.6), 0.06), transverse=0.1)
    floor = replace(robot.surfaces[0], rigid=rigid)
    robot = replace(robot, surfaces=(floor,), motor=None)
    model = nominal_model(robot, floor.name)
    found = lowest_starts(model, draws(robot, model, 400, 3))
    pull = 0.1 * np.mean(found)
    assert pull > 0.0 and 0.6 * pull < np.std(found) < 1.6 * pull


def tilted(height_m: float, tilt_rad: float, rule: LoadRule = LoadRule.QUASI_STATIC) -> Recipe:
    robot = sm.read_robot("ohio-kiwi-symmetric").robot
    robot = replace(robot, body=replace(robot.body, com_height_m=height_m), load_rule=rule)
    return Recipe(robot=robot, effects=(FloorTilt(tilt_x_rad=tilt_rad, tilt_y_rad=0.0),))


def test_cvxpy_counts_the_loads_of_each_orientation() -> None:
    """A force above the floor shifts the loads; those of φ = 0 stood for all, 9.5 % too bold at 60°."""
    recipe = tilted(0.08, 0.07)
    facets, solved = (
        sm.sweep(recipe, "paper", from_deg=0.0, to_deg=90.0, step_deg=30.0, method=method)
        for method in ("facets", "cvxpy")
    )
    np.testing.assert_allclose(solved.f_max_N, facets.f_max_N, rtol=1e-6)


def test_orientations_that_nobody_asked_for_do_not_refuse_a_sweep() -> None:
    """Limits from 30° to 60° are possible, and the sweep failed since the robot slips at 0°."""
    recipe = Recipe(
        robot=sm.read_robot("ohio-kiwi").robot, effects=(FloorTilt(tilt_x_rad=0.185, tilt_y_rad=0.0),)
    )
    with pytest.raises(NoSolution):
        sm.sweep(recipe, "paper", from_deg=0.0, to_deg=10.0, step_deg=10.0)
    found = sm.sweep(recipe, "paper", from_deg=30.0, to_deg=60.0, step_deg=10.0)
    assert np.all(found.f_max_N > 0.1)
    assert any("0.00 N at φ" in said for said in found.warnings)
    assert found.plot().axes and found.panels() and found.page()


def test_no_friction_across_is_no_friction_that_falls() -> None:
    robot = sm.read_robot("ohio-kiwi").robot
    floor = replace(robot.surfaces[0], roller=Coefficients(drive=0.26, transverse=0.0))
    found = sm.polytope(replace(robot, surfaces=(floor,)), floor.name)
    assert not any("falls to" in said for said in found.warnings)
