"""What a robot file says without effect, or against itself, is answered with a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import PAPER, four_wheels, kiwi

import slipmargin as sm
from slipmargin.api.robots import warnings_of
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
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


@pytest.mark.parametrize(("grip", "idle"), [("box", 0), ("disc-strip", 1), ("ellipse", 1)])
def test_steepness_across_where_one_law_holds_for_all_directions(grip: str, idle: int) -> None:
    law = SlipRatioFriction(share=1.0, steepness=5.0, transverse_factor=2.0)
    plain, creeping = (sm.read_robot("omni4", grip=grip).with_effects(*e) for e in ((), (law,)))
    assert not warnings_of(plain, "floor")
    said = warnings_of(creeping, "floor")
    assert len(said) == idle and all("slip_ratio_friction" in s and grip in s for s in said)
    speeds = np.array([[0.0, 2.0, 1.0, 0.5, 1.0]])
    ran = [
        sm.simulate(plain.with_effects(replace(law, transverse_factor=f)), "floor", speeds, until_s=0.2)
        for f in (2.0, 4.0)
    ]
    assert np.array_equal(ran[0].run.pose, ran[1].run.pose) == bool(idle)  # the sentence is true
    listed = named_candidates(("1", "2", "3"), False, (), coupled=bool(idle))
    own = [c for c in listed if c.name == law.name]
    assert any("transverse_factor" in c.keys for c in own) != bool(idle)


def test_a_strip_wider_than_its_disc() -> None:
    wide = replace(PAPER, roller=Coefficients(drive=0.2, transverse=0.3))
    (said,) = warnings(replace(four_wheels(grip=GripShape.DISC_STRIP), surfaces=(wide,)))
    assert "surface.paper.roller" in said and "0.3" in said
    assert warnings(replace(four_wheels(grip=GripShape.ELLIPSE), surfaces=(wide,))) == ()
