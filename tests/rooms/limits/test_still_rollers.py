"""Rollers that do not turn: what a limit leaves uncounted, and why (docs/theory.md, section 8)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import slipmargin as sm
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.bounds_summary import Bounds, bounds
from slipmargin.limits.motion_state import Contact
from slipmargin.limits.still_rollers import StillRollers, still_rollers
from slipmargin.model import Model
from slipmargin.report.bounds import answer
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate

#: A share above which a wheel slips grossly.
GROSS = 0.985


@pytest.fixture(scope="module")
def mecanum() -> Bounds:
    return bounds(read_recipe("mecanum4").build("floor"), step_deg=5.0)


def slips(model: Model, heading_rad: float, acceleration: float) -> bool:
    """Whether the simulated robot slips, sped up along a heading from 1 m/s for 1.5 s."""
    ahead = np.array([np.cos(heading_rad), np.sin(heading_rad), 0.0])
    t = np.array([0.0, 1.5])
    speeds = (1.0 + acceleration * t)[:, None] * model.geometry.wheel_speeds(ahead[None])
    run = simulate(model, linear(t, speeds, spin=speeds[0]), np.linspace(*t, 151), start_twist=ahead)
    return bool(np.max(run.utilisation) > GROSS)


def test_the_simulator_slips_above_the_helped_limit_and_not_below(mecanum: Bounds) -> None:
    s, ahead = mecanum.still_rollers, 0.5 * np.pi
    assert s is not None and s.heading_rad == pytest.approx(ahead)
    assert s.helped_m_s2 == pytest.approx(9.81 * 0.45 * np.sqrt(0.5), rel=3e-3)
    assert not slips(mecanum.model, ahead, 0.98 * s.helped_m_s2)
    assert slips(mecanum.model, ahead, 1.02 * s.helped_m_s2)


def test_three_degrees_beside_it_the_limit_that_counts_no_roller_slips(mecanum: Bounds) -> None:
    """Why the help is not counted: 2.775 m/s² holds straight ahead only."""
    s, limit = mecanum.still_rollers, float(np.max(mecanum.full.starting_m_s2))
    assert s is not None
    assert s.dragged_m_s2 == pytest.approx(2.428, abs=5e-4)
    assert limit == pytest.approx(9.81 * 0.4 * np.sqrt(0.5))
    assert not slips(mecanum.model, 0.5 * np.pi, limit)
    assert slips(mecanum.model, np.deg2rad(87.0), limit)


def test_bounds_and_plan_say_what_is_not_counted(mecanum: Bounds) -> None:
    """A plan straight ahead used 0.8 of the grip and blamed caps, motors or tipping, none of which bound."""
    line = "rollers     at 90° none turns, and the limit counts none: 3.115 m/s² while their friction helps"
    assert [said for said in answer(mecanum) if said.startswith(line)]
    lines = sm.plan("mecanum4", "floor", [[0, 0, 0], [0, 2, 0]], points=100).lines()
    assert lines[2] == "limited by  all wheels 72 %, motors 28 %"
    assert lines[3].startswith(
        "rollers     for 72 % of the time none turns and no wheel uses more than 0.8 of"
    )
    sideways = sm.plan("mecanum4", "floor", [[0, 0, 0], [2, 0, 0]], points=100).lines()
    assert not [said for said in sideways if said.startswith("rollers")]


def test_where_the_drag_leaves_nothing_it_is_said_in_words(mecanum: Bounds) -> None:
    none = replace(
        mecanum.everywhere,
        still_rollers=StillRollers(heading_rad=0.0, helped_m_s2=6.42, dragged_m_s2=-np.inf),
    )
    (said,) = [line for line in answer(none) if line.startswith("rollers")]
    assert said.endswith("once a drift to the side makes it drag: none, it must slip") and "inf" not in said


def test_the_numbers_are_in_the_json_too() -> None:
    """They stood in the answer alone."""
    found = sm.bounds("mecanum4", "floor", step_deg=5.0)
    s, told = found.bounds.still_rollers, found.to_dict()["still_rollers"]
    assert s is not None and told == {
        "heading_rad": s.heading_rad,
        "helped_m_s2": s.helped_m_s2,
        "dragged_m_s2": s.dragged_m_s2,
    }
    assert "still_rollers" not in sm.bounds("omni4", "floor", step_deg=15.0).to_dict()


def test_on_rigid_material_no_roller_stands(mecanum: Bounds) -> None:
    assert mecanum.still_rollers is not None
    assert still_rollers(mecanum.model, mecanum.full, Contact.RIGID) is None


def test_robots_whose_rollers_do_not_push_ahead_have_nothing_to_say() -> None:
    for name, surface in (("ohio-kiwi", "paper"), ("omni4", "floor")):
        said = answer(bounds(read_recipe(name).build(surface), step_deg=15.0))
        assert not [line for line in said if line.startswith("rollers")]
