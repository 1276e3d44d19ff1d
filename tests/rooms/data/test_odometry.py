"""Paths by wheels and by camera: exact on motions that can be written down."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strategies import models

from slipmargin.data.odometry import body_path, bridged, driven_m, wheel_angles, wheel_path
from slipmargin.model import Model


@settings(max_examples=40, deadline=None)
@given(model=models(), twist=st.tuples(*[st.floats(-2, 2)] * 3))
def test_no_slip_is_the_twist_under_which_no_contact_slips(model: Model, twist: tuple[float, ...]) -> None:
    # Second road: u_i·ĝ_i of docs/theory.md, section 1, set to zero wheel by wheel.
    vx, vy, wz = twist
    c = model.geometry
    hub = np.array([vx, vy]) + wz * np.stack([-c.position_m[:, 1], c.position_m[:, 0]], axis=1)
    rate = -np.sum(hub * c.grip, axis=1) / (c.radius_m * np.sum(c.drive * c.grip, axis=1))
    np.testing.assert_allclose(c.no_slip_map() @ rate, twist, atol=1e-9)
    path = wheel_path(c, np.outer(np.linspace(1.0, 2.0, 5), rate))
    np.testing.assert_allclose(path[-1], twist, atol=1e-9)


def test_body_path_of_a_circle() -> None:
    phi = np.linspace(0.0, 2.0, 2001)
    pose = np.stack([3.0 + 0.5 * np.sin(phi), 1.0 - 0.5 * np.cos(phi), phi], axis=1)
    path = body_path(pose)
    np.testing.assert_allclose(path[-1], [1.0, 0.0, 2.0], atol=1e-6)  # arc length along the body's x
    pose[1000] = np.nan
    np.testing.assert_allclose(body_path(pose)[-1], path[-1], atol=1e-6)


def test_the_distance_driven_counts_ways_back_and_circles_but_no_noise() -> None:
    random, s = np.random.default_rng(4), np.linspace(0.0, 1.0, 2001)
    ahead, zero = np.interp(s, [0.3, 0.7], [0.0, 1.0]), 0.0 * s  # it stands at both ends
    circle = 0.3 * np.stack([np.sin(2.0 * np.pi * s), 1.0 - np.cos(2.0 * np.pi * s)], axis=1)
    for path, length, rel in (
        (np.stack([ahead, zero], axis=1), 1.0, 1e-3),
        (np.stack([1.0 - np.abs(1.0 - 2.0 * ahead), zero], axis=1), 2.0, 0.01),
        (circle, 0.6 * np.pi, 0.01),
        (np.stack([zero, zero], axis=1), 0.0, 0.0),
    ):
        seen = path + random.normal(0.0, 5e-4, path.shape)
        assert driven_m(seen, 4e-3) == pytest.approx(length, rel=rel, abs=4e-3)
    straight = np.stack([ahead, zero], axis=1) + random.normal(0.0, 5e-4, (len(s), 2))
    assert driven_m(straight, 4e-3) == float(np.hypot(*(straight[-1] - straight[0])))


def test_missing_samples_lie_on_the_line_between() -> None:
    t = np.array([0.0, 1.0, 3.0, 4.0])
    values = np.array([[0.0, np.nan], [np.nan, np.nan], [3.0, np.nan], [np.nan, np.nan]])
    out = bridged(t, values)
    np.testing.assert_allclose(out[:, 0], [0, 1, 3, 3])
    assert np.isnan(out[:, 1]).all() and np.isnan(values[1, 0])


def test_angles_from_speeds() -> None:
    t = np.array([0.0, 0.1, 0.4])
    omega = np.array([[1.0], [2.0], [np.nan]])
    theta = wheel_angles(t, None, omega)
    assert theta is not None
    np.testing.assert_allclose(theta[:, 0], [0.0, 0.15, 0.75])
    assert wheel_angles(t, np.full((3, 1), np.nan), None) is None
    np.testing.assert_allclose(wheel_angles(t, omega, None), [[1.0], [2.0], [2.0]])  # type: ignore[arg-type]
