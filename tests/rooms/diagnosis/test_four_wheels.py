"""Four wheels: how their diagonals share the weight, and runs that begin while wheels slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted
from strategies import four_wheels, kiwi

from slipmargin.data.record import Record
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.fit import fit
from slipmargin.diagnosis.mimics import mimics
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.screen import screen
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect, Recipe, Scope, Trace
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.load_transfer import LoadTransfer
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.wheel_runout import WheelRunout
from slipmargin.effects.wheel_wobble import WheelWobble
from slipmargin.io.robot_file import read_recipe
from slipmargin.model import nominal_model
from slipmargin.physics.loads import load_centre, out_of_plane, uneven_shifts
from slipmargin.robot import Robot
from slipmargin.sim.batch import Batch, Ending
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear

SIGMA = np.array([5e-4, 5e-4, 2e-3])
NAMES = ("1", "2", "3", "4")


def loads_of(robot: Robot, effect: WheelLoads) -> np.ndarray:
    nominal = nominal_model(robot, robot.surfaces[0].name)
    return np.asarray(effect.rewrite(nominal.loads, nominal).rest_N - nominal.loads.rest_N)


def candidates(wheels: tuple[str, ...]) -> dict[str, Candidate]:
    return {c.label: c for c in named_candidates(wheels, False, ())}


def test_the_diagonals_share_the_weight_without_moving_its_centre() -> None:
    robot = four_wheels()
    nominal = nominal_model(robot, robot.surfaces[0].name)
    shift = loads_of(robot, WheelLoads(shift_x_m=0.0, shift_y_m=0.0, diagonal_share=0.04))
    # By hand: a rectangle's wheels 1 and 3 carry so much more, 2 and 4 so much less.
    np.testing.assert_allclose(shift, 0.04 * nominal.inertia.weight_N * np.array([1, -1, 1, -1]), rtol=1e-12)
    place, rest = nominal.geometry.position_m, nominal.loads.rest_N
    np.testing.assert_allclose(load_centre(place, rest + shift), load_centre(place, rest), atol=1e-15)


def test_a_shift_without_resultant_is_that_of_an_uneven_floor_and_three_wheels_have_none() -> None:
    place = np.array([[-0.069, 0.040], [-0.062, -0.050], [0.062, -0.050], [0.069, 0.041]])
    pattern = out_of_plane(place)
    np.testing.assert_allclose(np.column_stack([np.ones(4), place]).T @ pattern, 0.0, atol=1e-12)
    uneven = uneven_shifts(place, 1e4, 1e-3)[0]
    np.testing.assert_allclose(pattern, uneven / uneven[0], rtol=1e-9)
    shift = loads_of(kiwi(), WheelLoads(shift_x_m=0.0, shift_y_m=0.0, diagonal_share=0.2))
    np.testing.assert_allclose(shift, 0.0, atol=1e-12)


def test_only_robots_that_have_diagonals_are_asked_for_their_share() -> None:
    assert candidates(NAMES)["wheel_loads"].keys == ("shift_x_m", "shift_y_m", "diagonal_share")
    assert candidates(NAMES[:3])["wheel_loads"].keys == ("shift_x_m", "shift_y_m")


def test_a_shift_of_the_loads_starts_where_other_wheels_slip_as_well() -> None:
    """Below the slip limit a shift of 5 mm changes nothing, and loads 65 mm off were not found."""
    reach = 0.2
    (stated,) = (
        c
        for c in named_candidates(NAMES, False, (), {"body": reach})
        if c.label == "wheel_loads with the centre of mass where stated"
    )
    shifts = stated.starts[1:, :2]
    np.testing.assert_allclose(np.hypot(*shifts.T), 0.25 * reach)
    np.testing.assert_allclose(shifts.sum(axis=0), 0.0, atol=1e-12)
    assert len(shifts) == 3 and len(stated.starts) <= SETTINGS.secants


def on_creep(*effects: AnyEffect) -> Recipe:
    """The four-wheeled robot as it is believed: on a floor that makes every wheel creep."""
    recipe = read_recipe("robojackets-2018")
    return replace(recipe, effects=(SlipRatioFriction(share=1.0, steepness=4.0), *effects))


def test_the_share_of_the_diagonals_is_found_from_motion() -> None:
    truth = WheelLoads(shift_x_m=0.004, shift_y_m=-0.003, com_share=1.0, diagonal_share=-0.03)
    plant = Plant(name="loads", traces=(Trace.WHEEL_LOAD,), effects=(truth,))
    data = planted(on_creep(), plant, seed=3, count=4, duration_s=2.0, rate_hz=50.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
    loads = candidates(NAMES)["wheel_loads"]
    found = fit(problem, (loads,), loads.starts[0], np.arange(4))
    flat = found.jacobian.reshape(-1, 3)  # a unit of it is the noise
    error = np.sqrt(np.diag(np.linalg.inv(flat.T @ flat)))
    assert np.all(np.abs(found.x - [0.004, -0.003, -0.03]) < 4.0 * error)
    assert error[2] < 0.003


def test_a_run_in_which_a_wheel_lifts_for_a_moment_is_predicted_to_its_end() -> None:
    recipe = on_creep(LoadTransfer(com_height_m=0.12))
    t = np.linspace(0.0, 1.0, 61)
    theta = (10.0 * t + 90.0 * t**2)[:, None] * np.array([1.0, 1.0, -1.0, -1.0])  # 2.5 m/s² forwards
    record = Record(name="run", t_s=t, pose=np.zeros((61, 3)), theta=theta)
    problem = Problem.of(recipe, "carpet", (clean(record, SIGMA),), SIGMA, False)
    pose = problem.predict([()], [np.arange(1)])[0][0]
    assert np.linalg.norm(pose[-1] - pose[30]) > 1.0, "it stopped on the way"


def test_how_hard_the_floor_may_pull_a_wheel_down_is_said_for_each_batch() -> None:
    model = on_creep(LoadTransfer(com_height_m=0.12)).build("carpet")
    t = np.array([0.0, 0.05, 1.0])
    batch = Batch([linear(t, np.outer([0.0, 60.0, 60.0], [1.0, 1.0, -1.0, -1.0]))], [t])
    first, second = (batch.run(pack(model), np.zeros(3), held_down=pull) for pull in (1e-9, 1.0))
    assert first.ending[0] == Ending.TIPS and second.ending[0] == Ending.DONE


def test_a_law_of_the_slip_ratio_has_coefficients_of_its_own() -> None:
    stated, own = (
        replace(on_creep(), effects=(SlipRatioFriction(share=1.0, steepness=4.0, **factors),)).build("carpet")
        for factors in ({}, {"drive_coefficient_factor": 1.5, "transverse_coefficient_factor": 3.0})
    )
    np.testing.assert_allclose(own.grip.roller, stated.grip.roller * [1.5, 3.0], rtol=1e-12)
    assert np.array_equal(own.grip.rigid, stated.grip.rigid)


def test_what_is_lost_while_accelerating_is_hardly_told_from_a_late_camera() -> None:
    plant = Plant(name="late", traces=(Trace.MEASUREMENT,), effects=(CameraDelay(delay_s=0.0),))
    data = planted(on_creep(), plant, seed=3, count=4, duration_s=2.0, rate_hz=50.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
    known = candidates(NAMES)
    lag = replace(known["camera_delay"], scope=Scope.FLOOR, label="lag of the robot")
    found = fit(problem, (lag,), np.zeros(1), np.arange(4))
    (said,) = mimics(problem, found, list(known.values()))
    assert said.startswith("Hardly told apart: camera_delay of 0.01 s would look, to 100%, like a change of ")
    assert "delay_s (lag of the robot) by +0.01" in said
    radius = fit(problem, (known["wheel_radius[1]"],), np.ones(1), np.arange(4))
    assert mimics(problem, radius, [known["camera_delay"]]) == ()


@pytest.mark.parametrize(
    "off", [WheelRunout(cosine=0.14, sine=0.05), WheelWobble(cosine_rad=0.2, sine_rad=0.1)]
)
def test_a_wheel_far_from_true_is_seen_though_three_others_hold_the_robot(
    off: WheelRunout | WheelWobble,
) -> None:
    """Its first per mille, which the slip takes up, shows another direction than 15 %."""
    recipe = Recipe(robot=four_wheels())
    names = nominal_model(recipe.robot, recipe.robot.surfaces[0].name).geometry.names
    plant = Plant(name=off.name, traces=(Trace.WHEEL_ANGLE,), effects=(replace(off, wheels=names[:1]),))
    data = planted(recipe, plant, seed=4, count=6, duration_s=2.0, rate_hz=60.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
    everyone = np.arange(len(trials))
    base = fit(problem, (), np.zeros(0), everyone)
    turning = [c for c in named_candidates(names, False, ()) if c.name in ("wheel_runout", "wheel_wobble")]
    found = screen(problem, base, turning, (), tuple(everyone[k::3] for k in range(3)), 30, 0)
    best = next(entry for entry in found.entries if len(entry.parts) == 1)
    assert best.label == f"{off.name}[{names[0]}]" and found.share(best) > 0.5
