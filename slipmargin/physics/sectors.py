"""Which part of a wheel touches the floor (section IV): a roller, or the rigid material between rollers.

A wheel's sector starts with the roller part: with n rollers, angle θ stands on rigid material where
θ mod 2π/n ≥ (1 − rigid_fraction)·2π/n.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def pitch(rollers: Any) -> Any:
    """Angle from one roller to the next, 2π/n [rad]."""
    return 2.0 * np.pi / rollers


def switching(rigid_fraction: Any, roller_w: Any, roller_t: Any, rigid_w: Any, rigid_t: Any) -> Any:
    """Whether it matters which part wheels stand on, by its share and both coefficients of each part."""
    there = (rigid_fraction > 0.0) & (rigid_fraction < 1.0)
    return there & ((roller_w != rigid_w) | (roller_t != rigid_t))


def on_rigid(theta: Any, pitch_rad: Any, rigid_fraction: Any) -> Any:
    """Whether wheels at angles ``theta`` [rad] stand on rigid material; numbers or arrays that broadcast."""
    within = theta - np.floor(theta / pitch_rad) * pitch_rad
    return within >= (1.0 - rigid_fraction) * pitch_rad
