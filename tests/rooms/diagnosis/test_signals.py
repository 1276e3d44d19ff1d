"""Wheel signals: as few knots as the measurement deserves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.data.record import Record
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.signals import InterpolationScheme, start_twist, wheel_signal
from slipmargin.paper.published import paper_model
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate

SIGMA = np.array([1e-3, 1e-3, 1e-2])


def record(dt: float, tremble: float) -> Record:
    """Three wheels that speed up, hold and swing; angles tremble by so many radians."""
    t = np.arange(0.0, 8.0, dt)
    ramp = np.minimum(t, 1.0)
    omega = np.stack([3.0 * ramp, -3.0 * ramp, np.sin(2.0 * t)], axis=1)
    theta = np.stack(
        [
            3.0 * (ramp**2 / 2 + np.maximum(t - 1.0, 0.0)),
            -3.0 * (ramp**2 / 2 + np.maximum(t - 1.0, 0.0)),
            0.5 * (1.0 - np.cos(2.0 * t)),
        ],
        axis=1,
    )
    rng = np.random.default_rng(0)
    return Record(
        name="run",
        t_s=t,
        pose=np.zeros((len(t), 3)),
        omega=omega,
        theta=theta + tremble * rng.standard_normal(theta.shape),
    )


def at(signal, t):
    k = np.clip(np.searchsorted(signal.knots_s, t, side="right") - 1, 0, len(signal.pieces) - 1)
    x = (t - signal.knots_s[k])[:, None]
    c = signal.pieces[k]
    return sum(c[..., p] * x**p for p in range(c.shape[2]))


def test_clean_angles_are_met_to_twenty_microradians_with_few_knots():
    run = record(0.02, 0.0)
    signal = wheel_signal(clean(run, SIGMA), False)
    assert len(signal.knots_s) < 0.5 * len(run.t_s)
    assert np.abs(at(signal, run.t_s) - run.theta).max() < 2.1e-5


def test_trembling_angles_are_met_to_their_own_noise():
    """An encoder that trembles by 0.5 mrad: knots at every tremble would be jerks that never happened."""
    run, smooth = record(0.03, 5e-4), record(0.03, 0.0)
    signal = wheel_signal(clean(run, SIGMA), False)
    assert len(signal.knots_s) < 0.5 * len(run.t_s)
    assert np.abs(at(signal, run.t_s) - smooth.theta).max() < 4.5e-3


def test_rough_motion_is_no_looser_than_noise_allows():
    """Angles that tremble by 20 mrad: few samples of them made tangents that were all wrong."""
    run = record(0.03, 2e-2)
    rough = wheel_signal(clean(run, SIGMA), False, InterpolationScheme.ROUGH)
    full = wheel_signal(clean(run, SIGMA), False, InterpolationScheme.FULL)
    assert np.abs(at(rough, run.t_s) - at(full, run.t_s)).max() < 0.02


def sliding_run(first: int, last: int):
    """Samples ``first`` to ``last`` of a kiwi that is thrown about, and slides: model, trial, velocity."""
    model, t = paper_model("paper", improved=False), np.arange(0.0, 2.0, 0.01)
    omega = np.stack([np.interp(t, [0.0, 0.05, 2.0], [0.0, a, a]) for a in (14.0, 14.0, -9.0)], axis=1)
    run = simulate(model, linear(t, omega), t)
    pose = run.pose + 0.2 * SIGMA * np.random.default_rng(1).standard_normal((len(t), 3))
    rows = slice(first, last)
    log = Record(name="run", t_s=t[rows], pose=pose[rows], omega=omega[rows], theta=run.theta[rows])
    velocity = (run.pose[first + 1] - run.pose[max(0, first - 1)]) / (t[first + 1] - t[max(0, first - 1)])
    return model, clean(log, 0.2 * SIGMA), velocity


def test_a_run_that_begins_in_the_middle_of_a_slide_starts_with_what_the_poses_say():
    """Seen in a null cut in half: started without slip it was "unexplained", with a lead to a patch."""
    model, trial, velocity = sliding_run(12, 200)
    wheels = model.geometry.no_slip_map() @ trial.record.omega[0]
    found = start_twist(model, trial, wheel_signal(trial, False), 0.2 * SIGMA)
    assert np.hypot(*(wheels[:2] - velocity[:2])) > 0.1, "it slides there"
    assert np.hypot(*(found[:2] - velocity[:2])) < 0.03 and abs(found[2] - velocity[2]) < 0.2


def test_the_noise_of_the_first_wheel_angle_is_no_slide():
    """Seen on a robot that obeys: a slope at the edge of coarse angles was added to what the poses said."""
    model, trial, velocity = sliding_run(12, 200)
    theta = trial.record.theta.copy()
    theta[0] -= 0.1 * np.array([1.0, 1.0, -1.0])  # the slope at the edge is 15 rad/s off
    coarse = replace(trial, record=replace(trial.record, theta=theta, omega=None))
    found = start_twist(model, coarse, wheel_signal(coarse, False), 0.2 * SIGMA)
    assert np.hypot(*(found[:2] - velocity[:2])) < 0.1


def test_a_run_from_rest_starts_at_rest_however_its_wheels_spin():
    model, trial, _ = sliding_run(0, 200)
    found = start_twist(model, trial, wheel_signal(trial, False), 0.2 * SIGMA)
    np.testing.assert_allclose(found, 0.0, atol=1e-12)
