"""A drive that ramps its command, against small steps and against one worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings, strategies as st
from strategies import kiwi

from slipmargin.model import nominal_model
from slipmargin.sim.pack import pack
from slipmargin.sim.ramp import ramped
from slipmargin.sim.sensitivity import beside


def turned(c: np.ndarray, x: np.ndarray) -> np.ndarray:
    """(θ, ω, ω̇) (3, M, N) of pieces (M, N, 5) at times (M,) into them."""
    x = x[:, None]
    angle = c[..., 0] + x * (c[..., 1] + x * (c[..., 2] + x * c[..., 3]))
    speed = c[..., 1] + x * (2.0 * c[..., 2] + 3.0 * c[..., 3] * x)
    return np.array([angle, speed, 2.0 * c[..., 2] + 6.0 * c[..., 3] * x])


def packed(ramp: float) -> np.ndarray:
    model = nominal_model(kiwi(), "paper")
    return pack(replace(model, actuators=replace(model.actuators, ramp_s2_per_rad=ramp)))


def seen(times: np.ndarray, coef: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """θ and ω (T, N) of pieces."""
    piece = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(coef) - 1)
    angle, speed, _ = turned(coef[piece], at - times[piece])
    return angle, speed


def pieces(knots: np.ndarray, draw: np.random.Generator, held: bool) -> np.ndarray:
    """Commanded pieces (K, 3, 5): parabolas of speed that jump, angles that do not."""
    coef = np.zeros((len(knots) - 1, 3, 5))
    coef[:, :, 1] = draw.uniform(-20.0, 20.0, coef.shape[:2])
    if not held:
        coef[:, :, 2:4] = draw.uniform(-60.0, 60.0, (*coef.shape[:2], 2))
    h = np.diff(knots)[:, None]
    gained = h * (coef[:, :, 1] + h * (coef[:, :, 2] + h * coef[:, :, 3]))
    coef[1:, :, 0] = np.cumsum(gained, axis=0)[:-1]
    return coef


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), held=st.booleans(), rate=st.floats(5.0, 500.0))
def test_it_is_what_small_steps_give(seed: int, held: bool, rate: float) -> None:
    draw = np.random.default_rng(seed)
    knots = np.concatenate([[0.0], np.cumsum(draw.uniform(0.02, 0.4, 5))])
    coef, start = pieces(knots, draw, held), draw.uniform(-20.0, 20.0, 3)
    times, out = ramped(packed(1.0 / rate), knots, coef, start)
    assert times[0] == knots[0] and times[-1] == knots[-1] and np.all(np.diff(times) > 0.0)
    fine = np.linspace(0.0, knots[-1], 8001)
    step = fine[1]
    asked = seen(knots, coef, fine)[1]
    speed = np.empty_like(asked)
    speed[0] = start
    for k in range(1, len(fine)):
        speed[k] = speed[k - 1] + np.clip(asked[k] - speed[k - 1], -rate * step, rate * step)
    mine, my_speed = seen(times, out, fine)
    steepest = max(rate, float(np.max(np.abs(coef[:, :, 2:4]))) * 6.0)
    np.testing.assert_allclose(my_speed[1:], speed[1:], atol=3.0 * steepest * step)
    angle = np.cumsum(0.5 * step * (speed[1:] + speed[:-1]), axis=0)
    np.testing.assert_allclose(mine[1:] - mine[0], angle, atol=4.0 * steepest * step * fine[-1])
    # between two knots it never turns faster than allowed, to rounding
    _, last, grows = turned(out, np.diff(times))
    assert np.all(np.abs(out[:, :, 2] * 2.0) <= rate * (1.0 + 1e-6))
    assert np.all(np.abs(grows) <= rate * (1.0 + 1e-6))
    # and its speed has no jump
    np.testing.assert_allclose(last[:-1], out[1:, :, 1], atol=1e-9 * (1.0 + rate))


def test_a_step_of_the_command_takes_its_time() -> None:
    """10 rad/s at 100 rad/s²: there after 0.1 s, by half of what a jump gives in that time behind."""
    coef = np.zeros((1, 3, 5))
    coef[0, :, 1] = 10.0
    times, out = ramped(packed(0.01), np.array([0.0, 1.0]), coef, np.zeros(3))
    np.testing.assert_allclose(times, [0.0, 0.1, 1.0], atol=1e-12)
    angle, speed = seen(times, out, np.array([1.0]))
    np.testing.assert_allclose(speed, 10.0, rtol=1e-12)
    np.testing.assert_allclose(angle, 9.5, rtol=1e-12)


def test_another_ramp_moves_the_wheels() -> None:
    """A change that moves wheels is simulated: to first order from one run it would do nothing."""
    assert beside(packed(0.01), packed(0.01)) and not beside(packed(0.01), packed(0.02))
