"""Play between motor and wheel: the compiled pieces against the operator itself, sample by sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from manoeuvres import wheel_motion
from oracles.plain_simulator import played, reference_motion
from strategies import kiwi, reals

from slipmargin.model import Model, nominal_model
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.play import taken_up
from slipmargin.sim.signal import WheelSignal, held, hermite, linear
from slipmargin.sim.simulate import simulate
from slipmargin.sim.wheels import follow


def loose(*play_rad: float, lag_s: float = 0.0) -> Model:
    model = nominal_model(kiwi(), "paper")
    return replace(
        model,
        actuators=replace(model.actuators, play_rad=np.array(play_rad), lag_s=np.full(3, lag_s)),
    )


def turned(knots: np.ndarray, pieces: np.ndarray, lag_s: float, t: np.ndarray) -> np.ndarray:
    """Wheel angles (T, N) of pieces with their exponential part."""
    j = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(pieces) - 1)
    x = (t - knots[j])[:, None]
    c0, c1, c2, c3, c4 = np.moveaxis(pieces[j], 2, 0)
    fades = lag_s * (1.0 - np.exp(-x / lag_s)) if lag_s else 0.0 * x
    return c0 + x * (c1 + x * (c2 + x * c3)) + c4 * fades


@example(seed=872, play=1e-3, lag=0.06, kind="linear")  # the motor turns back twice within 10 ms
@given(
    st.integers(0, 2**31),
    reals(1e-3, 0.6),
    st.sampled_from((0.0, 0.06)),
    st.sampled_from(("held", "linear", "hermite")),
)
@settings(max_examples=25, deadline=None)
def test_the_wheel_is_the_nearest_that_the_play_allows(seed: int, play: float, lag: float, kind: str) -> None:
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.0, 26)
    omega = np.vstack([np.zeros(3), np.cumsum(rng.normal(size=(25, 3)), axis=0)])
    if kind == "hermite":
        theta = np.vstack([np.zeros(3), np.cumsum(0.5 * (omega[1:] + omega[:-1]) * 0.08, axis=0)])
        signal = hermite(t, theta, omega)
    else:
        signal = linear(t, omega) if kind == "linear" else held(t, omega)
    packed = np.array(pack(loose(play, 0.0, 0.3 * play, lag_s=lag)))
    knots, pieces = signal.knots_s, np.concatenate([signal.pieces, np.zeros((25, 3, 1))], axis=2)
    if lag:
        knots, pieces = follow(packed, knots, pieces, np.zeros(3))
    fine = np.linspace(0.0, 2.0, 20001)
    motor = turned(knots, pieces, lag, fine)
    found = turned(*taken_up(packed, knots, pieces), lag, fine)
    want, half = motor.copy(), 0.5 * np.array([play, 0.0, 0.3 * play])
    for k in range(1, len(fine)):
        want[k] = np.clip(want[k - 1], motor[k] - half, motor[k] + half)
    assert np.abs(found - want).max() <= 5e-6  # what a sample misses of a turning point
    np.testing.assert_allclose(found[:, 1], motor[:, 1], atol=1e-12)


@pytest.mark.parametrize("play", [0.01, 0.2])
def test_a_run_with_play_agrees_with_the_plain_road(play: float) -> None:
    t = np.array([0.0, 0.1, 0.4, 0.6, 0.9])
    signal = linear(t, np.outer([0.0, 1.0, 1.0, -1.0, -0.5], [6.0, -4.0, 5.0]))
    times = np.linspace(0.0, 0.9, 7)
    pose = simulate(loose(play, 0.5 * play, 0.0), signal, times).pose
    wheels, stops = played(wheel_motion(signal), t, np.array([play, 0.5 * play, 0.0]))
    want = reference_motion(loose(0.0, 0.0, 0.0), wheels, stops, times)
    assert np.abs(pose - want).max() <= 2e-6
    assert np.abs(pose - simulate(loose(0.0, 0.0, 0.0), signal, times).pose).max() > 1e-4


def test_no_play_changes_no_bit() -> None:
    model = nominal_model(kiwi(), "paper")
    signal = linear(np.array([0.0, 0.3, 0.8]), np.array([[0.0] * 3, [9.0, -4.0, 6.0], [-3.0, 2.0, 1.0]]))
    t = np.linspace(0.0, 0.8, 9)
    np.testing.assert_array_equal(
        simulate(model, signal, t).pose, simulate(loose(0.0, 0.0, 0.0), signal, t).pose
    )


def test_a_wheel_that_turns_at_the_start_has_taken_its_play_up() -> None:
    moving = held(np.array([0.0, 1.0]), np.full((2, 3), 2.0))
    packed = np.array(pack(loose(0.1, 0.1, 0.1)))
    knots, pieces = taken_up(packed, moving.knots_s, np.concatenate([moving.pieces, np.zeros((1, 3, 1))], 2))
    assert len(knots) == 2
    np.testing.assert_allclose(pieces[0, :, :2], [[-0.05, 2.0]] * 3)


def test_the_change_with_the_play_is_one_that_a_fit_can_use() -> None:
    """Regression of the derivative: two steps of different size and sign give the same slope."""
    t = np.linspace(0.0, 2.0, 101)
    signal = linear(t, np.outer(np.sin(2.0 * np.pi * t), [5.0, -3.0, 4.0]))

    def end(play: float) -> np.ndarray:
        return run_to(signal, loose(play, play, play))

    here = end(0.02)
    slopes = [(end(0.02 + d) - here) / d for d in (2.5e-4, -2.5e-4, 1e-3)]
    size = np.abs(slopes[0]).max()
    assert size > 1e-3
    for other in slopes[1:]:
        np.testing.assert_allclose(other, slopes[0], atol=0.05 * size)


def run_to(signal: WheelSignal, model: Model) -> np.ndarray:
    """Poses (9, 3) along a run."""
    return Batch([signal], [np.linspace(0.0, 2.0, 9)]).run(pack(model), np.zeros(3), rtol=1e-8).pose[0]


def test_a_command_goes_through_the_play_as_an_encoder_on_the_motor_does() -> None:
    signal = linear(np.array([0.0, 0.2, 1.0]), np.array([[0.0] * 3, [4.0] * 3, [-4.0] * 3]))
    t = np.linspace(0.0, 1.0, 5)
    told, logged, without = (
        Batch([signal], [t], commanded=commanded).run(pack(loose(p, p, p)), np.zeros(3)).pose[0]
        for commanded, p in ((True, 0.2), (False, 0.2), (True, 0.0))
    )
    np.testing.assert_allclose(told, logged, atol=1e-9)
    assert np.abs(told - without).max() > 0.01


def test_a_motor_with_a_torque_line_is_asked_through_the_play() -> None:
    signal = linear(np.array([0.0, 0.2, 1.0]), np.array([[0.0] * 3, [4.0] * 3, [-4.0] * 3]))
    t = np.linspace(0.0, 1.0, 5)
    model = loose(0.2, 0.2, 0.2)
    droop = replace(model, actuators=replace(model.actuators, droop_rad_s_per_N_m=np.full(3, 1e-3)))
    poses = [Batch([signal], [t], commanded=True).run(pack(m), np.zeros(3)).pose[0] for m in (droop, model)]
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-3)
