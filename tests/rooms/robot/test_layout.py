"""The wheel angle of Fig. 3."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from strategies import four_wheels, kiwi, reals

from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.model import nominal_model
from slipmargin.robot.layout import wheel_angle_deg, with_wheel_angle


@given(reals(-60.0, 85.0))
def test_any_angle_is_the_layout_of_section_1(delta: float) -> None:
    # docs/theory.md, section 1: axles (cos δ, sin δ), (−cos δ, sin δ), (0, −1); drive direction z × axle.
    turned = nominal_model(with_wheel_angle(kiwi(15.0), delta), "paper").geometry
    built = nominal_model(kiwi(delta), "paper").geometry
    np.testing.assert_allclose(turned.position_m, built.position_m, atol=1e-12)
    np.testing.assert_allclose(turned.drive, built.drive, atol=1e-12)
    assert wheel_angle_deg(with_wheel_angle(kiwi(15.0), delta)) == pytest.approx(delta, abs=1e-9)


def test_the_files_of_the_paper_s_robot_agree_with_it() -> None:
    turned = nominal_model(with_wheel_angle(read_recipe("ohio-kiwi").robot, 30.0), "paper").geometry
    built = nominal_model(read_recipe("ohio-kiwi-symmetric").robot, "paper").geometry
    np.testing.assert_allclose(turned.position_m, built.position_m, atol=1e-12)
    np.testing.assert_allclose(turned.drive, built.drive, atol=1e-12)


def test_other_layouts_are_refused() -> None:
    for robot in (four_wheels(), kiwi(turned_rad=math.pi), kiwi(turned_rad=0.3)):
        with pytest.raises(InputError, match="one wheel at the rear"):
            with_wheel_angle(robot, 20.0)
        with pytest.raises(InputError, match="one wheel at the rear"):
            wheel_angle_deg(robot)
    with pytest.raises(InputError, match="between -60 and 85"):
        with_wheel_angle(kiwi(), 86.0)
