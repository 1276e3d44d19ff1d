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


def on_rigid(theta: Any, pitch_rad: Any, rigid_fraction: Any) -> Any:
    """Whether wheels at angles ``theta`` [rad] stand on rigid material; numbers or arrays that broadcast."""
    within = theta - np.floor(theta / pitch_rad) * pitch_rad
    return within >= (1.0 - rigid_fraction) * pitch_rad
