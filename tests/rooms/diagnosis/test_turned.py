"""Robots, effects and limits are turned into the other convention, and back, without a rounding."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conventions import effect_in_ros, robot_in_ros, ros
from hypothesis import given, settings, strategies as st
from strategies import effects, four_wheels, kiwi

import slipmargin as sm
from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.diagnosis.result import Estimate
from slipmargin.diagnosis.turned import _dependence, _estimates, change_in
from slipmargin.effects import GeneralEffect, Part, Recipe, Trace
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_weave import FloorWeave
from slipmargin.effects.sliding_direction import SlidingDirection
from slipmargin.effects.turned import effect_in, recipe_in
from slipmargin.physics.convention import Convention
from slipmargin.physics.terms import ForceTerm, Multiplier, PoseShift
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot.turned import robot_in
from slipmargin.robot.uncertain import Uncertain

PAPER, ROS = Convention.PAPER, Convention.ROS


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_a_robot_is_turned_as_its_other_user_writes_it_and_back(robot) -> None:
    there = robot_in(robot, ROS)
    for ours, theirs in zip(there.wheels, robot_in_ros(robot).wheels, strict=True):
        assert ours.position_m.tolist() == (np.array(theirs.position_m) + 0.0).tolist()
        assert math.remainder(ours.drive_direction_deg - theirs.drive_direction_deg, 360.0) == 0.0
    back = robot_in(there, PAPER)
    for ours, first in zip(back.wheels, robot.wheels, strict=True):
        assert ours.position_m.tolist() == first.position_m.tolist()
        assert ours.drive_direction_deg == pytest.approx(first.drive_direction_deg, abs=1e-12)
    assert back.body.com_m.tolist() == robot.body.com_m.tolist() and back.convention is PAPER


@pytest.mark.parametrize(
    ("com_m", "turned"),
    [
        (["0.02 ± 0.005", -0.01], [-0.01, "-0.02 ± 0.005"]),
        (["0.0 ± 0.005", [-0.02, -0.01]], [[-0.02, -0.01], "-0.0 ± 0.005"]),
        ([0.01, [0.02, 0.03]], [[0.02, 0.03], -0.01]),
    ],
)
def test_a_spread_of_the_centre_of_mass_is_turned_too(com_m, turned) -> None:
    # It was lost, so a corrected robot file in the axes of ROS bore plain numbers.
    robot = replace(kiwi(), body=replace(kiwi().body, com_m=com_m))
    there = robot_in(robot, ROS)
    assert written(there) == turned
    assert written(robot_in(there, PAPER)) == com_m


def written(robot) -> list:
    """The centre of mass as a robot file spells it."""
    return [v.written() if isinstance(v, Uncertain) else v for v in robot.body.com_m.each]


@settings(deadline=None, max_examples=60)
@given(effects(list(CATALOGUE), reach=0.5))
def test_every_effect_of_the_catalogue_is_turned_and_back(effect) -> None:
    there = effect_in(effect, PAPER, ROS)
    assert there.to_table() == pytest.approx(effect_in_ros(effect).to_table(), abs=1e-12)
    back = effect_in(there, ROS, PAPER).to_table()
    assert back == pytest.approx(effect.to_table(), abs=1e-12)


BASES = {
    Basis.POLYNOMIAL: (0.3, 1.0),
    Basis.FOURIER: (2.0 * math.pi, 1.0),
    Basis.HATS: (-0.4, 0.5),
    Basis.DECAY: (0.4, 1.0),
    Basis.RECIPROCAL: (3.0, 2.0),
    Basis.ODD: (0.2, 1.0),
    Basis.STEP: (0.1, 0.05),
    Basis.LOBE: (0.3, 1.2),
}
COMPONENTS = (
    Variable.VELOCITY_X,
    Variable.VELOCITY_Y,
    Variable.POSITION_X,
    Variable.POSITION_Y,
    Variable.HEADING,
)


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_general_forms_do_the_same_in_both_conventions(data: st.DataObject) -> None:
    basis = data.draw(st.sampled_from(list(BASES)))
    numbers = st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4).map(np.array)
    kind = data.draw(st.sampled_from(["friction", "sliding", "force", "shift"]))
    common = {"basis": basis, "shape": np.array(BASES[basis])}
    round_ = data.draw(st.sampled_from((Basis.FOURIER, Basis.LOBE)))
    if kind in ("friction", "sliding"):
        sliding = st.sampled_from((Variable.SLIP_HEADING, Variable.SLIP_DIRECTION))
        variable = data.draw(sliding if kind == "sliding" else st.sampled_from(COMPONENTS))
        common |= {"shape": np.array(BASES[round_]), "basis": round_} if kind == "sliding" else {}
        term = Multiplier(
            variable=variable,
            target=Target.BOTH,
            coefficients=0.5 * data.draw(numbers),
            wheels=np.ones(4),
            **common,
        )
        part = Part.GRIP
    elif kind == "force":
        frame = data.draw(st.sampled_from(list(Frame)))
        three = np.stack([data.draw(numbers) for _ in range(3)])
        variable = data.draw(st.sampled_from(COMPONENTS))
        place = np.array([0.05, -0.02]) if frame is Frame.AT_PLACE else np.zeros(2)
        term = ForceTerm(variable=variable, frame=frame, coefficients=0.1 * three, place_m=place, **common)
        part = Part.LOSSES
    else:
        three = np.stack([data.draw(numbers) for _ in range(3)])
        term = PoseShift(variable=data.draw(st.sampled_from(COMPONENTS)), coefficients=0.1 * three, **common)
        part = Part.SENSING
    effect = GeneralEffect(traced_to=Trace.POSITION, part=part, terms=(term,))
    one = Recipe(robot=four_wheels(), effects=(effect,))
    two = recipe_in(one, ROS)
    speeds = [[0.0, 3.0, 4.0, 5.0, 2.0], [0.3, 6.0, 1.0, 2.0, 4.0]]
    paper, turned = (sm.simulate(r, "paper", speeds, step_s=0.1, relative_error=1e-10) for r in (one, two))
    np.testing.assert_allclose(turned.run.pose, ros(paper.run.pose), rtol=1e-7, atol=1e-9)
    back = recipe_in(two, PAPER).effects[0]
    assert isinstance(back, GeneralEffect)
    table = effect.to_table()["term"][0]
    for key, value in back.to_table()["term"][0].items():
        assert value == (pytest.approx(table[key], abs=1e-12) if isinstance(value, list) else table[key])


def test_a_cosine_alone_over_a_slip_direction_turns_with_the_axes() -> None:
    term = Multiplier(
        variable=Variable.SLIP_DIRECTION,
        basis=Basis.FOURIER,
        coefficients=np.array([0.3]),
        shape=np.array([2.0 * math.pi, 0.0]),
        wheels=np.ones(4),
    )
    effect = GeneralEffect(traced_to=Trace.HEADING, part=Part.GRIP, terms=(term,))
    one = Recipe(robot=four_wheels(), effects=(effect,))
    speeds = [[0.0, 3.0, 4.0, 5.0, 2.0], [0.3, 6.0, 1.0, 2.0, 4.0]]
    runs = [
        sm.simulate(r, "paper", speeds, step_s=0.1, relative_error=1e-10) for r in (one, recipe_in(one, ROS))
    ]
    np.testing.assert_allclose(runs[1].run.pose, ros(runs[0].run.pose), rtol=1e-7, atol=1e-9)


def test_limits_over_orientation_and_direction_are_counted_from_the_other_axes() -> None:
    recipe = Recipe(robot=kiwi())
    ours = change_in(limits_change(recipe, recipe, "paper"), ROS)
    theirs = limits_change(recipe_in(recipe, ROS), recipe_in(recipe, ROS), "paper")
    for name in type(ours.before).__slots__:
        np.testing.assert_allclose(getattr(ours.before, name), getattr(theirs.before, name), rtol=1e-6)


def test_estimates_are_named_by_the_axes_of_the_file() -> None:
    from slipmargin.effects.camera_scale import CameraScale
    from slipmargin.effects.floor_tilt import FloorTilt

    def estimate(name: str, value: float, low: float, high: float) -> Estimate:
        return Estimate(name=name, value=value, low=low, high=high, unit="rad")

    tilt = FloorTilt(tilt_x_rad=0.1, tilt_y_rad=0.2)
    for group in ("", " (hall)"):
        given = (
            estimate(f"tilt_x_rad{group}", 0.1, 0.09, 0.12),
            estimate(f"tilt_y_rad{group}", 0.2, 0.1, 0.3),
        )
        x, y = _estimates(given, tilt, PAPER, ROS)
        assert (x.name, x.value, x.low, x.high) == (f"tilt_x_rad{group}", 0.2, 0.1, 0.3)
        assert (y.name, y.value, y.low, y.high) == (f"tilt_y_rad{group}", -0.1, -0.12, -0.09)
        assert _estimates((x, y), tilt, ROS, PAPER) == given
    (only,) = _estimates((estimate("tilt_x_rad", 0.1, 0.0, 0.2),), tilt, PAPER, ROS)
    assert only.name == "tilt_y_rad" and only.value == -0.1
    scales = _estimates(
        (estimate("scale_x", 1.1, 1.0, 1.2),), CameraScale(scale_x=1.1, scale_y=1.0), PAPER, ROS
    )
    assert [(e.name, e.value, e.low, e.high) for e in scales] == [("scale_y", 1.1, 1.0, 1.2)]


@pytest.mark.parametrize(
    ("variable", "there"),
    [(Variable.PASSING_SPEED, [0.5, 0.0, 0.0]), (Variable.FROM_PLACE, [0.0, -0.5, 0.0])],
)
def test_a_place_is_turned_and_a_share_of_the_tread_is_not(variable: Variable, there: list[float]) -> None:
    term = Multiplier(
        variable=variable,
        basis=Basis.CONSTANT,
        coefficients=np.array([0.1]),
        shape=np.zeros(2),
        wheels=np.ones(3),
        place=np.array([0.5, 0.0, 0.0]),
    )
    written = GeneralEffect(traced_to=Trace.SLIP_RATIO, part=Part.GRIP, terms=(term,))
    (turned,) = effect_in(written, PAPER, ROS).terms
    assert turned.place[:2].tolist() == pytest.approx(there[:2], abs=1e-15)


@pytest.mark.parametrize("kind", [FloorGrain, FloorWeave])
def test_friction_over_a_direction_is_told_in_the_axes_of_the_file(kind: type[SlidingDirection]) -> None:
    """The corrected file was turned, the numbers of the report were not."""
    effect = kind(cosine=0.2, sine=-0.05)
    given = tuple(
        Estimate(name=name, value=value, low=value - 0.01, high=value + 0.03, unit="1")
        for name, value in (("cosine", 0.2), ("sine", -0.05))
    )
    way = effect.derived(None)[1]  # type: ignore[arg-type]
    towards = Estimate(name=way.name, value=way.value, low=way.value - 0.1, high=way.value + 0.1, unit="rad")
    told = {e.name: e for e in _estimates((*given, towards), effect, PAPER, ROS)}
    turned = effect_in(effect, PAPER, ROS)
    assert isinstance(turned, SlidingDirection)
    for name in ("cosine", "sine"):
        assert told[name].value == getattr(turned, name)
        assert told[name].low < told[name].value < told[name].high
    there = turned.derived(None)[1].value  # type: ignore[arg-type]
    assert told[way.name].value == pytest.approx(there, abs=1e-12)
    assert told[way.name].high - told[way.name].low == pytest.approx(0.2)


def test_a_place_on_which_the_residual_depends_is_named_by_the_axes_of_the_file() -> None:
    said = ResidualDependence(variable="position x", channel="turn", share=0.5, surprise=9.0, p_value=0.01)
    assert _dependence(said).variable == "position y"
    assert _dependence(replace(said, variable="heading")).variable == "heading"
