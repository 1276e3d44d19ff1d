"""Fitted starts against generalised least squares with the whole covariance."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st

from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.start_pose import fitted_start


@settings(deadline=None, max_examples=30)
@given(
    share=st.floats(0.0, 0.99),
    time_s=st.floats(0.005, 3.0),
    sigma=st.floats(1e-4, 10.0),
    gaps=st.floats(0.0, 0.7),
    seed=st.integers(0, 1000),
)
def test_what_is_left_is_that_of_generalised_least_squares(
    share: float, time_s: float, sigma: float, gaps: float, seed: int
) -> None:
    random = np.random.default_rng(seed)
    step, count = 0.01, 40
    seen = random.random((2, count, 3)) >= gaps
    seen[:, [0, -1]] = True
    pose = np.cumsum(random.normal(size=(2, count, 3)), axis=1)
    sizes = sigma * np.array([1.0, 2.0, 0.5])
    measured = pose + sizes * random.standard_normal(pose.shape)
    noise = LastingNoise(share=share * np.array([1.0, 0.5, 0.0]), time_s=time_s * np.array([1.0, 2.0, 1.0]))
    moved, left = fitted_start(pose, measured, seen, sizes, noise, step)
    t = step * np.arange(count)
    for run in range(2):
        arm = pose[run, :, :2] - pose[run, 0, :2]
        ways = np.zeros((count, 3, 3))  # of each sample and axis, by x, y and turn
        ways[:, 0, 0] = ways[:, 1, 1] = ways[:, 2, 2] = 1.0
        ways[:, 0, 2], ways[:, 1, 2] = -arm[:, 1], arm[:, 0]
        gap, white, rows = measured[run] - pose[run], [], []
        for axis in range(3):
            there, part = seen[run, :, axis], noise.share[axis]
            fading = np.exp(-np.abs(t[:, None] - t) / noise.time_s[axis])
            covariance = sizes[axis] ** 2 * (part * fading + (1.0 - part) * np.eye(count))
            factor = np.linalg.cholesky(covariance[np.ix_(there, there)])
            white.append(np.linalg.solve(factor, gap[there, axis]))
            rows.append(np.linalg.solve(factor, ways[there, axis]))
        shift = np.linalg.lstsq(np.concatenate(rows), np.concatenate(white), rcond=None)[0]
        np.testing.assert_allclose(moved[run], pose[run] + ways @ shift, atol=1e-6 * sigma)
        for axis in range(3):
            there = seen[run, :, axis]
            np.testing.assert_allclose(left[run, there, axis], white[axis] - rows[axis] @ shift, atol=1e-6)
            assert np.all(left[run, ~there, axis] == 0.0)


def test_white_noise_is_divided_by_its_size_and_a_wild_gap_is_bounded() -> None:
    pose = np.zeros((1, 8, 3))
    measured = np.array([1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0])[None, :, None] * np.array(
        [2.0, 4.0, 6.0]
    )
    sigma = np.array([1.0, 2.0, 3.0])
    moved, left = fitted_start(pose, measured, np.ones((1, 8, 3), dtype=bool), sigma)
    np.testing.assert_allclose(moved, pose, atol=1e-12)
    np.testing.assert_allclose(left, measured / sigma)
    lost = np.full_like(pose, np.nan)
    wild = fitted_start(lost, measured, np.ones((1, 8, 3), dtype=bool), sigma)[1]
    assert np.all(np.isfinite(wild))
