"""Slips that people make when they type a robot file are named, with the number and the cure."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from robot_files import GOOD
from strategies import PAPER, four_wheels, kiwi, robots

import slipmargin as sm
from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.io.robot_file import built_in_names, read_recipe, recipe_from_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.robot import Coefficients, Convention, Motor, Robot
from slipmargin.robot.mistakes import refuse_impossible, unlikely


def scaled(robot: Robot, factor: float) -> Robot:
    """The same robot with its wheels at other distances."""
    wheels = tuple(replace(w, position_m=factor * w.position_m) for w in robot.wheels)
    return replace(robot, wheels=wheels)


@pytest.mark.parametrize("name", built_in_names())
def test_the_built_in_robots_are_likely(name: str) -> None:
    assert unlikely(read_recipe(name).robot) == []


@pytest.mark.parametrize(
    ("time", "turn", "said"), [(1.0, 1.0, ""), (1e3, 1.0, "t_s"), (1.0, 57.3, "phi_rad")]
)
def test_times_in_milliseconds_and_headings_in_degrees_are_said(time: float, turn: float, said: str) -> None:
    """Milliseconds were admissible, with the exit status of a motion that is."""
    t = np.linspace(0.0, 2.0, 41)
    pose = np.column_stack([0.1 * t**2, 0.0 * t, turn * 0.3 * np.sin(3.0 * t)])
    warned = sm.check("omni4", "floor", np.column_stack([time * t, pose])).warnings
    assert [w.split(":")[0] for w in warned] == ([said] if said else [])


def test_a_motor_in_turns_per_minute_and_kg_cm_is_said() -> None:
    """A robot of 1.6 m/s was given 9.8, and 118 m/s² to start with, without a word."""
    robot = replace(four_wheels(), body=replace(four_wheels().body, mass_kg=12.0, inertia_kg_m2=0.35))
    robot = replace(robot, wheels=tuple(replace(w, radius_m=0.048) for w in robot.wheels))
    right = replace(robot, motor=Motor(max_speed_rad_s=32.67, stall_torque_N_m=2.38))
    wrong = replace(robot, motor=Motor(max_speed_rad_s=312.0, stall_torque_N_m=24.3))
    assert unlikely(right) == unlikely(robot)
    speed, torque = (s for s in unlikely(wrong) if s.startswith("motor"))
    assert "write 32.67" in speed and "17.2 times" in torque


@given(robots())
@settings(max_examples=60, deadline=None)
def test_no_drawn_robot_is_impossible(robot: Robot) -> None:
    refuse_impossible(robot)


def test_rollers_the_wrong_way_round() -> None:
    assert unlikely(four_wheels()) == []
    (said,) = unlikely(four_wheels(-45.0))
    # Grip line of a wheel at (0.15, 0.2): (0.2 − 0.15)/√2 = 0.0354 m from the middle, else 0.35/√2 = 0.247 m.
    assert "wrong way round?" in said and "0.0354 m" in said and "0.247 m" in said
    one = four_wheels()
    one = replace(one, wheels=(replace(one.wheels[0], roller_angle_deg=-45.0), *one.wheels[1:]))
    (said,) = unlikely(one)
    assert said.startswith("wheel fr: rollers")


def test_rollers_the_wrong_way_round_on_a_square() -> None:
    robot = four_wheels()
    square = tuple(
        replace(w, position_m=0.2 * np.sign(w.position_m), roller_angle_deg=-w.roller_angle_deg)
        for w in robot.wheels
    )
    with pytest.raises(InputError, match=r"wrong way round.*change the sign of every roller_angle_deg"):
        replace(robot, wheels=square)


def test_rollers_that_cannot_turn_the_robot_are_read_out() -> None:
    robot = four_wheels()
    alike = tuple(replace(w, roller_angle_deg=45.0) for w in robot.wheels)
    with pytest.raises(
        InputError, match=r"fr 45, fl 45, rl 45, rr 45 .* about 45 or -45 degrees, .* an X"
    ) as told:
        replace(robot, wheels=alike)
    assert "radians" not in str(told.value)


def test_roller_angles_in_radians() -> None:
    """All alike they are refused; with the right signs the file was read, and could hardly move aside."""
    robot = four_wheels()
    said = "give degrees, not radians: 0.785 rad is 45 degrees, and mecanum wheels have about 45 or -45"
    alike = tuple(replace(w, roller_angle_deg=0.785) for w in robot.wheels)
    with pytest.raises(InputError, match=f"fr 0.785, fl 0.785, rl 0.785, rr 0.785 .*, {said}"):
        replace(robot, wheels=alike)
    (warning,) = unlikely(four_wheels(0.785))
    assert warning.startswith(f"wheel: roller_angle_deg looks like radians; {said}")


def test_millimetres() -> None:
    for factor, place in ((1000.0, "wheel[1].position_m"), (1e-3, "wheel[1].radius_m")):
        with pytest.raises(InputError, match="in metres, not millimetres") as caught:
            recipe_from_text(write_recipe_of(scaled(kiwi(30.0), factor)))
        assert caught.value.place == place
    (said, *_) = unlikely(scaled(four_wheels(), 50.0))
    assert "12.5 m from their middle, 250 times the radius" in said
    wide = replace(kiwi(30.0), wheels=tuple(replace(w, radius_m=0.5) for w in kiwi(30.0).wheels))
    (said,) = unlikely(wide)
    assert "0.5 m exceeds" in said
    everything = GOOD
    for old, new in (("0.091763", "91.763"), ("0.024588", "24.588"), ("-0.095", "-95.0"), ("0.0254", "25.4")):
        everything = everything.replace(old, new)
    with pytest.raises(InputError, match=re.escape("puts the mass 0.0949 m from the centre")) as caught:
        recipe_from_text(everything)
    assert caught.value.place == "body.inertia_kg_m2"


def write_recipe_of(robot: Robot) -> str:
    """The robot's file."""
    return write_recipe(Recipe(robot=robot))


def test_a_mass_in_grams_or_tonnes() -> None:
    for mass, says in ((0.012, "0.012 kg"), (12000.0, "12000 kg")):
        robot = four_wheels()
        (said,) = unlikely(replace(robot, body=replace(robot.body, mass_kg=mass)))
        assert says in said and "from the centre" in said and "check mass_kg" in said


def test_a_height_in_millimetres() -> None:
    with pytest.raises(InputError, match="height in metres, not millimetres"):
        recipe_from_text(GOOD.replace("com_height_m = 0.0", "com_height_m = 80.0"))
    robot = kiwi(30.0, com_height_m=0.8)
    (said,) = unlikely(robot)
    assert "8.4 times" in said and "1.2 m/s²" in said


def test_a_coefficient_of_nine() -> None:
    wild = replace(PAPER, roller=Coefficients(drive=9.0, transverse=0.1))
    (said,) = unlikely(replace(kiwi(30.0), surfaces=(wild,)))
    assert said.startswith("surface.paper.roller.drive: a friction coefficient of 9 ")


def test_a_car_that_drives_sideways_is_asked_for_its_convention() -> None:
    """A file in ROS's axes without its line ``convention = "ros"``."""
    made = sm.new_robot("rover", "mecanum").recipe.robot
    assert unlikely(made) == []
    (said,) = unlikely(replace(made, convention=Convention.PAPER))
    assert said == (
        'wheel: every mecanum wheel drives to the side, as convention = "paper" has +x to the right and +y '
        'forwards; write convention = "ros" if +x is forwards in this file'
    )


def test_a_motor_is_told_in_the_numbers_of_its_file() -> None:
    """At twice its nominal voltage the hint gave twice the file's number, and a cure twice too large."""
    robot = read_recipe("mecanum4").robot
    fast = Motor(max_speed_rad_s=300.0, stall_torque_N_m=12.0, nominal_voltage_V=12.0, supply_voltage_V=24.0)
    said = " ".join(unlikely(replace(robot, motor=fast)))
    assert "max_speed_rad_s: 300 rad/s" in said and "write 31.42" in said and "12 N m push" in said
