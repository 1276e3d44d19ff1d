"""Noise from neighbours that smooth motion cannot explain, and its colour from the spectrum of a residual."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from slipmargin.checks import Array
from slipmargin.data.noise import lasting_noise, white_noise
from slipmargin.data.record import Record

T = np.arange(0.0, 3.0, 0.01)
SIGMA = np.array([0.0005, 0.0007, 0.002])


def smooth() -> Array:
    ramp = np.clip(T - 0.3, 0.0, None)
    return np.stack([0.3 * ramp**2, 0.1 * np.sin(ramp), 0.5 * ramp], axis=1)


def record(seed: int, sigma: Array = SIGMA) -> Record:
    random = np.random.default_rng(seed)
    return Record(name="one", t_s=T, pose=smooth() + sigma * random.standard_normal((len(T), 3)))


@settings(deadline=None, max_examples=10)
@given(size=st.floats(0.3, 20.0), seed=st.integers(0, 1000))
def test_noise_is_estimated_whatever_the_motion(size: float, seed: int) -> None:
    found = white_noise(tuple(record(seed + k, size * SIGMA) for k in range(20)))
    np.testing.assert_allclose(found, size * SIGMA, rtol=0.15)


def test_noise_of_a_slow_camera_in_a_fast_log() -> None:
    def slow(one: Record) -> Record:
        pose = np.full(one.pose.shape, np.nan)
        pose[::4] = one.pose[::4]
        return Record(name="slow", t_s=T, pose=pose)

    found = white_noise(tuple(slow(record(k)) for k in range(20)))
    np.testing.assert_allclose(found, SIGMA, rtol=0.15)


def residuals(seed: int, share: float, time_s: float, motion: float = 0.0) -> list[tuple[Array, Array]]:
    """Ten runs of noise of variance SIGMA², ``share`` of it lasting, and the motion that a force makes."""
    random = np.random.default_rng(seed)
    keep = float(np.exp(-0.01 / time_s))
    found = []
    for _ in range(10):
        lasting = np.zeros((len(T), 3))
        lasting[0] = random.standard_normal(3)
        for k in range(1, len(T)):
            lasting[k] = keep * lasting[k - 1] + np.sqrt(1.0 - keep**2) * random.standard_normal(3)
        white = random.standard_normal((len(T), 3))
        at = random.uniform(0.2, 2.0)
        since, pushed = np.clip(T - at, 0.0, None), np.clip(T - at, 0.0, 0.4)
        drift = motion * pushed * (since - 0.5 * pushed)
        found.append((T, SIGMA * (np.sqrt(share) * lasting + np.sqrt(1.0 - share) * white) + drift[:, None]))
    return found


@pytest.mark.parametrize(("share", "time_s"), [(0.8, 0.05), (0.6, 0.1), (1.0, 0.1), (0.9, 0.2)])
def test_noise_that_lasts_is_measured(share: float, time_s: float) -> None:
    sigma, lasting = lasting_noise(residuals(1, share, time_s))
    assert lasting is not None
    np.testing.assert_allclose(sigma, SIGMA, rtol=0.35)
    np.testing.assert_allclose(lasting.share, share, atol=0.2)
    assert np.all((lasting.time_s > 0.35 * time_s) & (lasting.time_s < 2.5 * time_s))


@pytest.mark.parametrize("seed", range(10))
def test_white_noise_is_white(seed: int) -> None:
    sigma, lasting = lasting_noise(residuals(seed, 0.0, 1.0))
    assert lasting is None
    np.testing.assert_allclose(sigma, SIGMA, rtol=0.1)


@pytest.mark.parametrize("motion", [0.02, 0.1, 1.0])
def test_the_motion_that_a_force_makes_is_no_noise(motion: float) -> None:
    sigma, lasting = lasting_noise(residuals(2, 0.0, 1.0, motion))
    assert lasting is None
    np.testing.assert_allclose(sigma, SIGMA, rtol=0.2)
