"""What a plan would use with a heading that is a little off."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.model import nominal_model
from slipmargin.paths.check import check
from slipmargin.paths.off_heading import use_off_heading
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.report.paths import plan_lines
from slipmargin.robot import Robot


@pytest.mark.parametrize("robot", [four_wheels(45.0), kiwi(rigid_fraction=0.0)], ids=["mecanum", "kiwi"])
@pytest.mark.parametrize("degrees", [1.0, 4.0])
def test_it_is_what_a_check_of_the_turned_motion_finds(robot: Robot, degrees: float) -> None:
    """0.9 was promised for a straight drive of mecanum wheels that uses 0.97 a degree to the side."""
    model = nominal_model(robot, robot.surfaces[0].name)
    found = plan(model, through(np.array([[0, 0, 0], [1.0, 0, 0]])), Request(share=0.9, points=60))
    rows, angle = trajectory(found, step_s=0.001), np.deg2rad(degrees)
    turned = [
        check(model, rows.t_s, rows.pose + np.array([0.0, 0.0, side * angle])).max_use for side in (-1, 1)
    ]
    use = use_off_heading(found, angle)  # with how the creep settles, which a check of samples does not see
    assert use >= 0.99 * max(turned) and (degrees > 1.0 or use <= 1.01 * max(turned))
    assert use_off_heading(found, 0.0) == pytest.approx(found.max_use, rel=1e-9)
    said = [line for line in plan_lines(found, {}) if line.startswith("heading")]
    assert bool(said) == (use_off_heading(found) > 1.02 * 0.9)


def test_the_number_is_among_those_of_the_answer() -> None:
    """It stood in the lines alone, where no script looks."""
    made = sm.plan("omni4", "floor", [[0, 0, 0], [1.0, 0, 0]], points=60)
    assert made.to_dict()["max_use_off_heading"] == use_off_heading(made.plan)
