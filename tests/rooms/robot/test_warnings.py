"""What a robot file says without effect, or against itself, is answered with a sentence."""

from __future__ import annotations

from dataclasses import replace

import pytest
from strategies import PAPER, four_wheels, kiwi

from slipmargin.io.robot_file import built_in_names, read_recipe
from slipmargin.model import nominal_model
from slipmargin.robot import Coefficients, GripShape, LoadRule
from slipmargin.robot.warnings import contradiction, warnings


@pytest.mark.parametrize("name", built_in_names())
def test_the_built_in_robots_deserve_no_other(name: str) -> None:
    robot = read_recipe(name).robot
    # The paper's equal loads contradict its own layout (δ = 15°): the one warning that stays.
    assert warnings(robot) == ((contradiction(robot),) if name == "ohio-kiwi" else ())


def test_a_height_that_shifts_no_load() -> None:
    for rule in LoadRule:
        fractions = (1 / 3, 1 / 3, 1 / 3) if rule is LoadRule.FIXED else None
        robot = kiwi(30.0, com_height_m=0.08, load_rule=rule, load_fractions=fractions)
        said = warnings(robot)
        if rule is LoadRule.QUASI_STATIC:
            assert said == ()
        else:
            assert len(said) == 1 and "0.08 m" in said[0] and rule.value in said[0]
            # A regular ring of three: 1 m/s² shifts m h a · 2/(3 R) = 3 · 0.08 · 2/(3 · 0.095) N at most.
            assert "1 m/s² shifts up to 1.68 N (17.2 % of m g / N)" in said[0]
            assert not nominal_model(robot, "paper").loads.follow_acceleration  # the sentence is true


def test_loads_that_contradict_the_centre_of_mass() -> None:
    robot = kiwi(30.0, com_m=(0.0, 0.01))
    assert warnings(robot) == (contradiction(robot),)
    assert "need the centre of mass at (0, 0) m" in warnings(robot)[0]
    assert warnings(kiwi(30.0, com_m=(0.0, 0.01), load_rule=LoadRule.STATIC)) == ()


def test_rigid_sectors_that_grip_as_rollers_do() -> None:
    alike = replace(PAPER, rigid=PAPER.roller)
    (said,) = warnings(replace(kiwi(30.0, rigid_fraction=0.1), surfaces=(alike,)))
    assert "surface.paper" in said and "rigid_fraction" in said
    assert warnings(replace(kiwi(30.0, rigid_fraction=0.0), surfaces=(alike,))) == ()


def test_a_strip_wider_than_its_disc() -> None:
    wide = replace(PAPER, roller=Coefficients(drive=0.2, transverse=0.3))
    (said,) = warnings(replace(four_wheels(grip=GripShape.DISC_STRIP), surfaces=(wide,)))
    assert "surface.paper.roller" in said and "0.3" in said
    assert warnings(replace(four_wheels(grip=GripShape.ELLIPSE), surfaces=(wide,))) == ()
