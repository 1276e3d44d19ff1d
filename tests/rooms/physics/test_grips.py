"""Supports of the three grip sets against points sampled from their definitions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import reals

from slipmargin.physics.grips import (
    box_slope,
    box_support,
    disc_strip_slope,
    disc_strip_support,
    ellipse_slope,
    ellipse_support,
)

ANGLE = np.linspace(-np.pi, np.pi, 20001)


def both(drive: float, across: float) -> np.ndarray:
    return np.repeat(np.array([drive, across])[None, :, None], 2, axis=2)


def outline(kind: str, drive: float, across: float) -> np.ndarray:
    """Boundary points by definition: shrink a far point along its ray until it obeys."""
    a, b = np.cos(ANGLE), np.sin(ANGLE)
    with np.errstate(divide="ignore"):
        reach = {
            "box": np.minimum(drive / np.abs(a), across / np.abs(b)),
            "ellipse": 1.0 / np.sqrt((a / drive) ** 2 + (b / across) ** 2),
            "disc-strip": np.minimum(drive, across / np.abs(b)),
        }[kind]
    corner = {
        "box": (drive, across),
        "ellipse": (0.0, 0.0),
        "disc-strip": (np.sqrt(max(drive**2 - across**2, 0.0)), min(across, drive)),
    }[kind]
    signs = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    return np.vstack([np.stack([reach * a, reach * b], axis=1), signs * corner])


KINDS = {
    "box": (box_support, box_slope),
    "ellipse": (ellipse_support, ellipse_slope),
    "disc-strip": (disc_strip_support, disc_strip_slope),
}


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40, deadline=None)
@given(reals(0.05, 1.0), reals(0.05, 1.5), reals(-np.pi, np.pi))
def test_support_is_the_outlines(kind: str, drive: float, across: float, at: float) -> None:
    n = np.array([np.cos(at), np.sin(at)])
    want = np.max(outline(kind, drive, across) @ n)
    # the outline's step²/8 · (30 to 1)²
    assert KINDS[kind][0](n[None], both(drive, across))[0] == pytest.approx(want, rel=2e-5)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40, deadline=None)
@given(reals(0.1, 1.0), reals(0.1, 1.5), reals(0.03, 1.5))
def test_slope_is_the_supports_derivative(kind: str, drive: float, across: float, at: float) -> None:
    support, slope = KINDS[kind]
    n, h = np.array([[np.cos(at), -np.sin(at)]]), 1e-6
    if kind == "disc-strip" and min(abs(across - drive), abs(drive * np.sin(at) - across)) < 1e-3:
        return  # the corner: one-sided
    got = slope(n, both(drive, across))[0]
    for j, step in enumerate(((h, 0.0), (0.0, h))):
        up, down = both(drive + step[0], across + step[1]), both(drive - step[0], across - step[1])
        assert got[j] == pytest.approx((support(n, up)[0] - support(n, down)[0]) / (2 * h), abs=2e-6)


@settings(max_examples=60, deadline=None)
@given(reals(0.05, 1.0), reals(0.0, 1.5), reals(-np.pi, np.pi))
def test_coupled_sets_lie_in_the_box(drive: float, across: float, at: float) -> None:
    n, mu = np.array([[np.cos(at), np.sin(at)]]), both(drive, across)
    box = box_support(n, mu)[0]
    assert ellipse_support(n, mu)[0] <= box + 1e-15
    assert disc_strip_support(n, mu)[0] <= box + 1e-15


def test_senses_limit_their_own_side() -> None:
    mu = np.array([[[0.1, 0.3], [0.2, 0.4]]])  # drive − 0.1, + 0.3; transverse − 0.2, + 0.4
    assert box_support(np.array([[1.0, 0.0]]), mu)[0] == pytest.approx(0.3)
    assert box_support(np.array([[-1.0, -2.0]]), mu)[0] == pytest.approx(0.1 + 0.4)
    assert ellipse_support(np.array([[-3.0, 2.0]]), mu)[0] == pytest.approx(np.hypot(0.3, 0.8))
