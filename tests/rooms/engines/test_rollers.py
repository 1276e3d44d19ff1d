"""An independent engine (MuJoCo) with real rollers: every roller a body on a hinge, omni and mecanum.

The engine is built from the data sheet (``tests/engines/rollers.py``) and knows no friction formula of the
package.  A single wheel shows its two coefficients and its rollers' hand; robots then judge limits of
speeding up, wheel loads under acceleration, and plans.  The whole study is ``benchmarks/rollers.py``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the optional extra [mujoco] is not installed")

from engines.rollers import Build, Engine, MovingOff, Trolley, roller_of
from rollers import GROSS, HEADINGS, cases, limits, load_errors, moved_off, paths, played

CASES = cases()
NAMES = tuple(CASES)
#: Wheel angles over one pitch of the rollers [rad].
PITCH = np.arange(3) / 3 * 2.0 * np.pi / Build().rollers
#: What the weight's tangential part is on a slope of 4°.
SLOPE = float(np.sin(np.radians(4.0)))


@pytest.mark.parametrize("name", NAMES)
def test_wheels_are_round(name):
    for wheel in CASES[name].robot.wheels:
        roller = roller_of(wheel, Build())
        half = np.pi / Build().rollers
        assert np.ptp(roller.reach_m(np.linspace(-half, half, 101))) < 2e-5 * wheel.radius_m
        assert roller.reach_m(np.array([2.0 * half]))[0] < wheel.radius_m * (1.0 - 1e-4)
        assert roller.centre_m + roller.b_m == pytest.approx(wheel.radius_m, abs=1e-12)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("wheel", [0, 1])
@pytest.mark.parametrize("name", NAMES)
def test_a_locked_wheel_has_the_two_coefficients_in_the_two_directions(name, wheel, sense):
    machine = CASES[name]
    geometry, known = machine.model.geometry, machine.robot.surface(machine.surface).roller
    for direction, coefficient in ((geometry.free, known.transverse), (geometry.grip, known.drive)):
        along = sense * direction[wheel]
        force = [Trolley(machine.robot, machine.surface, wheel, angle_rad=a).pull(along) for a in PITCH]
        # Up to 2.1 % more across mecanum rollers: neighbours that share the load point half a degree apart.
        np.testing.assert_allclose(force @ along, coefficient, rtol=0.03)


@pytest.mark.parametrize("wheel", [0, 1])
def test_a_mecanum_wheel_of_the_other_hand_holds_where_this_one_rolls(wheel):
    machine = CASES["4 mecanum"]
    geometry, known = machine.model.geometry, machine.robot.surface(machine.surface).roller
    robot = machine.robot
    mirrored = tuple(replace(w, roller_angle_deg=-w.roller_angle_deg) for w in robot.wheels)
    along = geometry.free[wheel]
    force = Trolley(replace(robot, wheels=mirrored), machine.surface, wheel).pull(along)
    assert float(force @ along) == pytest.approx(known.drive, rel=0.02)


@pytest.mark.parametrize("heading", HEADINGS[[1, 6]])
@pytest.mark.parametrize("name", NAMES)
def test_wheels_roll_below_the_starting_limit_and_slip_above_it(name, heading):
    machine = CASES[name]
    limit = float(limits(machine, np.array([heading]))[0])
    below, above = (moved_off(machine, heading, share * limit).max() for share in (0.95, 1.05))
    assert below < 0.6 * GROSS
    assert above > 1.5 * GROSS


@pytest.mark.parametrize("slope", [0.0, SLOPE])
@pytest.mark.parametrize("name", NAMES)
def test_mean_loads_under_acceleration(name, slope):
    """Means over 100 ms within 2 % of m g / N, level and on a slope of 4°; load transfer is more."""
    machine, heading = CASES[name], HEADINGS[3]
    limit = float(limits(machine, np.array([heading]))[0])
    motion = MovingOff(heading_rad=heading, acceleration_m_s2=(0.4 if slope else 0.7) * limit, hold_s=0.5)
    errors = load_errors(machine, motion, (slope, 0.0))
    assert len(errors) >= 3
    assert np.abs(errors).max() < 0.02
    model = machine.model
    pull = model.inertia.weight_N * np.array([slope, 0.0])
    moved = model.loads.at(motion.acceleration_m_s2 * motion.direction, model.inertia.com_height_m * pull)
    assert np.abs(moved - model.loads.rest_N).max() > 0.02 * model.inertia.weight_N / model.count


@pytest.mark.parametrize("name", NAMES)
def test_a_settled_robot_stands_as_statics_says(name):
    machine = CASES[name]
    log = Engine(machine.robot, machine.surface).run(lambda t: np.zeros(machine.model.count), 0.1)
    fair = machine.model.inertia.weight_N / machine.model.count
    np.testing.assert_allclose(log.load_N.mean(axis=0), machine.model.loads.rest_N, atol=0.01 * fair)
    assert np.abs(log.pose[-1]).max() < 1e-4


@pytest.mark.parametrize("name", NAMES)
def test_a_plan_is_driven_without_gross_slip(name):
    seen = played(CASES[name], paths()["turn while translating"])
    assert seen["planned_use"] == pytest.approx(0.9, abs=0.01)
    assert seen["creep_percent"] < 100.0 * GROSS
    assert seen["end_off_mm"] < 10.0 * seen["distance_m"]
    assert seen["end_off_deg"] < 0.5
