"""Whitening by a Kalman filter against the Cholesky factor of the covariance, and as a linear map."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st

from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.whitening import whitened


@settings(deadline=None, max_examples=30)
@given(
    share=st.floats(0.0, 0.99),
    time_s=st.floats(0.005, 3.0),
    sigma=st.floats(1e-4, 10.0),
    gaps=st.floats(0.0, 0.7),
    seed=st.integers(0, 1000),
)
def test_it_is_the_cholesky_factors_inverse(
    share: float, time_s: float, sigma: float, gaps: float, seed: int
) -> None:
    random = np.random.default_rng(seed)
    step, count = 0.01, 40
    seen = random.random((2, count)) >= gaps
    seen[:, 0] = True
    values = sigma * random.standard_normal((2, count))
    noise = LastingNoise(share=np.full(3, share), time_s=np.full(3, time_s))
    found = whitened(values, seen, sigma, noise, 0, step)
    t = step * np.arange(count)
    covariance = sigma**2 * (share * np.exp(-np.abs(t[:, None] - t) / time_s) + (1.0 - share) * np.eye(count))
    for row, there, got in zip(values, seen, found, strict=True):
        factor = np.linalg.cholesky(covariance[np.ix_(there, there)])
        np.testing.assert_allclose(got[there], np.linalg.solve(factor, row[there]), rtol=1e-6, atol=1e-9)
        assert np.all(got[~there] == 0.0)


def test_white_noise_is_divided_by_its_size() -> None:
    values = np.arange(12.0).reshape(2, 6)
    noise = LastingNoise(share=np.zeros(3), time_s=np.ones(3))
    found = whitened(values, np.ones((2, 6), dtype=bool), 2.0, noise, 1, 0.01)
    np.testing.assert_allclose(found, values / 2.0)
