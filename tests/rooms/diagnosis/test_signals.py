"""Wheel signals: as few knots as the measurement deserves."""

from __future__ import annotations

import numpy as np

from slipmargin.data.record import Record
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.signals import InterpolationScheme, wheel_signal

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
