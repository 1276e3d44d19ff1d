"""Plans over friction whose creep settles slowly: what the simulated wheels use is what the plan says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.bounds_summary import bounds
from slipmargin.limits.motion_realised import SLOW_CREEP, creep_lasts_s, settles_slowly
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model
from slipmargin.onboard.table import steady_warnings
from slipmargin.paths.path import corners, through
from slipmargin.paths.plan import Plan, Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.paths.verify import on_rollers, verify
from slipmargin.physics.friction_laws import law_inverse, law_slope
from slipmargin.physics.grips import GripShape
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable
from slipmargin.report.bounds import answer

SHARE = 0.9
STRAIGHT = corners(np.array([[0, 0, 0], [1.0, 0, 0]]))
BEND = through(np.array([[0, 0, 0], [0.5, 0.2, 0.4], [1.0, 0.0, 0.2]]))


def creeping(robot: str, surface: str, steepness: float, tread: float = 0.0, grip: str = "box") -> Model:
    law = SlipRatioFriction(share=1.0, steepness=steepness, tread_share=tread)
    of = read_recipe(robot).robot
    of = replace(of, friction=replace(of.friction, grip=GripShape(grip)))
    return Recipe(robot=of, effects=(law,)).build(surface)


CASES = [
    ("omni4", "floor", 10.0, 0.0, STRAIGHT),
    ("omni4", "floor", 30.0, 0.5, STRAIGHT),
    ("ohio-kiwi", "paper", 30.0, 0.0, STRAIGHT),
    ("omni4", "floor", 30.0, 0.0, BEND),
]


@pytest.fixture(scope="module", params=CASES, ids=["ratio", "creepage", "kiwi", "bend"])
def found(request: pytest.FixtureRequest) -> Plan:
    *law, path = request.param
    return plan(creeping(*law), path, Request(share=SHARE, points=100))


def test_the_simulated_wheels_use_what_was_planned(found: Plan) -> None:
    """They used 0.94 to 0.98 of what they were to use 0.9 of: braking a slip that goes with the speed."""
    ran = verify(on_rollers(found.model), trajectory(found))
    assert found.max_use <= SHARE * (1.0 + 1e-6)
    assert ran.peak <= SHARE + 2e-3
    assert ran.peak >= SHARE - 5e-3  # and it is no coward


@pytest.mark.parametrize("grip", ["disc-strip", "ellipse"])
@pytest.mark.parametrize(
    ("robot", "surface"), [("omni4", "floor"), ("mecanum4", "floor"), ("ohio-kiwi", "paper")]
)
def test_drag_of_coupled_grips_is_that_of_their_own_law(robot: str, surface: str, grip: str) -> None:
    """Planned by the box's drag, wheels of elliptic grip used 0.42 of what they were to use 0.9 of."""
    of = creeping(robot, surface, 10.0 if robot != "ohio-kiwi" else 6.0, grip=grip)
    found = plan(of, STRAIGHT, Request(share=SHARE, points=100))
    ran = verify(on_rollers(of), trajectory(found))
    assert found.max_use - 0.02 <= ran.peak <= found.max_use + 2e-3


def test_the_table_holds_what_was_used_at_most(found: Plan) -> None:
    rows = trajectory(found)
    assert np.max(rows.use) == pytest.approx(found.max_use, abs=2e-3)
    assert np.max(rows.use) <= found.max_use + 1e-9


def test_where_the_stiffness_is_constant_nothing_lasts() -> None:
    made = plan(nominal_model(kiwi(), "paper"), STRAIGHT, Request(share=SHARE, points=60))
    assert (
        not settles_slowly(made.model) and not np.any(made.audit.memory_s) and not np.any(made.audit.driven)
    )


def test_how_long_a_creep_lasts() -> None:
    """By hand: 1 / (σ'(z) μ g k) with z = σ⁻¹(0.9) and, all wheels being alike, k = κ / (v + v_0)."""
    motion, kappa = Motion(velocity=np.array([[0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])), 10.0
    model = creeping("omni4", "floor", kappa)
    lasts = creep_lasts_s(model, motion, contact=Contact.ROLLERS, share=SHARE)
    slope = law_slope(0, law_inverse(0, SHARE))
    stiffness = kappa / (motion.velocity[:, 0] + 1e-3)
    assert lasts == pytest.approx(1.0 / (slope * model.grip.roller[0, 0] * 9.81 * stiffness), rel=1e-3)


def test_bounds_and_limiter_say_whose_accelerations_they_are() -> None:
    creeps, plain = creeping("omni4", "floor", 10.0), nominal_model(kiwi(), "paper")
    one, other = (answer(bounds(model, step_deg=30.0)) for model in (creeps, plain))
    assert f"creep       {SLOW_CREEP}" in one
    assert not [line for line in other if line.startswith("creep")]
    one, other = (" ".join(steady_warnings(model, 0.1)) for model in (creeps, plain))
    assert SLOW_CREEP in one and SLOW_CREEP not in other


def test_friction_that_fades_to_nothing_at_speed_caps_a_plan() -> None:
    """With a steepness of 0 the plan ended with "velocity holds a value that is not finite"."""
    base = nominal_model(kiwi(), "paper")
    fades = Multiplier(
        variable=Variable.ROLLING_SPEED,
        basis=Basis.DECAY,
        coefficients=np.array([1.25]),
        shape=np.array([0.3, 1.0]),
        wheels=np.ones(3),
        target=Target.STIFFNESS,
    )
    model = replace(base, grip=replace(base.grip, multipliers=(fades,)))
    made = plan(model, STRAIGHT, Request(share=SHARE, points=100))
    way = trajectory(made)
    assert np.max(np.hypot(*way.velocity[:, :2].T)) < 0.3 * np.log(5.0)  # gone from there on
    assert verify(on_rollers(model), way).peak < SHARE + 5e-3
