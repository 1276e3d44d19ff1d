"""The common creep of wheels of which some have no grip: the balance is singular there, not the answer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strategies import four_wheels, kiwi

from slipmargin.limits.creep import Balance
from slipmargin.model import nominal_model

ROBOTS = [four_wheels(), kiwi()]


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
    found = balance(four_wheels(), grip, 0.4)
    peak = found.settling(np.full((1, 3), 1e-3), np.array([3.0, 3.0, 0.03]))
    assert np.all(np.isfinite(peak))
