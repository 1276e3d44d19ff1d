"""The height of the floor under each wheel: what a slope there does to the robot.

A contact with the load N (the upward part of what the floor presses with) on a floor that rises by ∇h per
metre is pushed with −N ∇h, whatever friction does: a frictionless floor presses at right angles to itself.
The force acts at the contact, so it turns the robot too, and it needs no torque of a round wheel.  Slopes
are small: that the robot tilts on them, which shifts its loads, and how much longer the way is, is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, final

import numpy as np

from slipmargin.checks import Array


class Profile(IntEnum):
    """The height h(d) of a floor over the distance d beyond a line; ``size`` and ``extent`` are its own."""

    RAMP = 0  #: it rises with the slope ``size`` [1] for the length ``extent`` [m]; ``edge`` [m] rounds ends
    RIDGE = 1  #: ``size`` · 2^−(2 d/extent)²: ``size`` [m] high, ``extent`` [m] wide at half its height


#: The profiles as plain numbers, for code that is compiled.
RAMP, RIDGE = (int(profile) for profile in Profile)
_LN_2 = float(np.log(2.0))


def rise(profile: Any, size: Any, extent: Any, edge: Any, d: Any) -> Any:
    """dh/dd [1] at the distance d beyond the line [m]; a number or an array d."""
    if profile == RAMP:
        return 0.5 * size * (np.tanh(0.5 * d / edge) - np.tanh(0.5 * (d - extent) / edge))
    z = 2.0 * d / extent
    return -4.0 * _LN_2 * size / extent * z * np.exp(-_LN_2 * z * z)


def beyond(offset: Any, direction: Any, x: Any, y: Any) -> Any:
    """How far (x, y) lies beyond the line at ``offset`` [m] whose normal points in ``direction`` [rad]."""
    return x * np.cos(direction) + y * np.sin(direction) - offset


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relief:
    """A floor that is not flat: ``profile`` beyond the line at ``offset_m`` along ``direction_rad``.

    ``size`` [1 or m], ``extent_m`` [m] and ``edge_m`` [m] are as :class:`Profile` says.
    """

    profile: Profile
    size: float
    extent_m: float
    offset_m: float
    direction_rad: float
    edge_m: float

    def gradient(self, x: Array, y: Array) -> Array:
        """∇h (..., 2) [1] in the floor frame at the places x, y (...) [m]."""
        d = beyond(self.offset_m, self.direction_rad, x, y)
        along = rise(self.profile, self.size, self.extent_m, self.edge_m, d)
        return np.stack([along * np.cos(self.direction_rad), along * np.sin(self.direction_rad)], axis=-1)
