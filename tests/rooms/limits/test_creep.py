"""The common creep of wheels of which some have no grip: the balance is singular there, not the answer."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strategies import four_wheels, kiwi, reals

from slipmargin.limits.creep import RUNAWAY
from slipmargin.limits.creep_states import Balance
from slipmargin.model import nominal_model
from slipmargin.robot import Wheel

ROBOTS = [four_wheels(), kiwi()]
PER_STATE = ("grip", "drag", "steep", "steep_across", "slide", "need", "carried")


def balance(robot, grip, shares):
    """What wheels with this grip [N] and nothing across are asked for when they use these shares."""
    along, across = nominal_model(robot, "paper").wrench_maps()
    none, k = np.zeros((1, len(grip))), np.full((1, len(grip)), 1000.0)
    return Balance(
        law=0,
        along=along,
        across=across,
        grip=grip[None],
        drag=none,
        steep=k,
        steep_across=k,
        slide=none,
        need=-(along @ (grip * shares))[None],
        carried=np.zeros((1, 4)),
        scale=np.array([10.0, 10.0, 1.0]),
    )


@pytest.mark.parametrize("grips", [(1, 0, 1, 0), (0, 1, 0, 1), (1, 1, 0, 0), (1, 0, 0, 0), (0, 0, 0, 0)])
def test_wheels_that_have_no_grip_leave_the_rest_in_balance(grips):
    """A mecanum robot with half its wheels on ice: two on a diagonal resist two directions out of three."""
    grip = 10.0 * np.array(grips, dtype=float)
    found = balance(four_wheels(), grip, 0.4)
    twist, use = found.rest()
    assert np.all(np.isfinite(twist))
    np.testing.assert_allclose(use[0, grip > 0.0], 0.4, atol=1e-8)
    assert use.max() <= 1.0


@given(st.sampled_from(ROBOTS), st.integers(0, 2**31))
@settings(max_examples=60, deadline=None)
def test_the_forces_found_do_what_is_asked(robot, seed):
    rng = np.random.default_rng(seed)
    n = len(robot.wheels)
    grip = rng.uniform(1.0, 20.0, n) * rng.integers(0, 2, n)
    found = balance(robot, grip, 0.6 * rng.uniform(-1.0, 1.0, n))
    twist, _ = found.rest()
    force = grip * 2.0 / np.pi * np.arctan(1000.0 * (twist @ found.along)[0])
    np.testing.assert_allclose(found.along @ force, -found.need[0], atol=1e-7)


def test_settling_with_wheels_that_have_no_grip_ends():
    grip = np.array([10.0, 0.0, 10.0, 0.0])
    before, after = (balance(four_wheels(), grip, share) for share in (0.1, 0.4))
    peak = after.settling(before, np.array([3.0, 3.0, 0.03]))
    assert np.all(np.isfinite(peak))


#: Wheels (degrees around the centre, drive direction, roller angle) of a robot whose creep turns it: 0.5 kg.
TIPSY = ((-36.0, 14.0, 0.0), (84.0, -180.0, 45.0), (204.0, 254.0, 0.0))


@given(reals(0.0, 1.0), st.integers(2, 6))
@settings(max_examples=60, deadline=None)
def test_where_a_creep_settles_does_not_hang_on_where_it_was_looked_for(part: float, count: int) -> None:
    """A plan jumped by 0.5 % with the last digit: its states took another rest, one that the robot leaves."""
    around = [math.radians(a) for a, _, _ in TIPSY]
    wheels = tuple(
        Wheel(
            name=f"w{i}",
            position_m=(0.03 * math.cos(a), 0.03 * math.sin(a)),
            drive_direction_deg=drive,
            radius_m=0.02,
            roller_angle_deg=roller,
            rigid_fraction=0.0,
        )
        for i, (a, (_, drive, roller)) in enumerate(zip(around, TIPSY, strict=True))
    )
    along, across = nominal_model(replace(kiwi(), wheels=wheels), "paper").wrench_maps()
    share = np.linspace(0.0, part, count)[:, None]
    slide = np.array([0.0214829, -0.0417346, 0.105493]), np.array([0.0228719, -0.0438405, 0.106756])
    need = np.array([-0.083954, -0.022784, -0.0031315]), np.array([-0.083722, -0.023622, -0.0031315])
    carried = np.array([0.5, -0.097115, -0.026355, -1.00628]), np.array([0.5, -0.098496, -0.027791, -1.02342])
    each = {
        name: one + share * (two - one)
        for name, (one, two) in (("slide", slide), ("need", need), ("carried", carried))
    }
    shape = (count, 3)
    found = Balance(
        law=0,
        along=along,
        across=across,
        grip=np.full(shape, 0.1635),
        drag=np.full(shape, 0.008175),
        steep=np.full(shape, 1000.0),
        steep_across=np.full(shape, 1000.0),
        scale=np.array([0.4905, 0.4905, 0.01127]),
        **each,
    )
    twist, use = found.rest()
    for m in range(count):
        rows = {name: getattr(found, name)[m : m + 1] for name in PER_STATE}
        alone, used = replace(found, **rows).rest()
        np.testing.assert_allclose(used[0], use[m], rtol=1e-6)
        if used.max() < RUNAWAY:
            np.testing.assert_allclose(alone[0], twist[m], rtol=1e-6, atol=1e-9)
