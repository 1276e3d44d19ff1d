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
    """The height h(d) of a floor over the distance d beyond a line, or from a middle.

    ``size`` and ``extent`` are its own.
    """

    RAMP = 0  #: it rises with the slope ``size`` [1] for the length ``extent`` [m]; ``edge`` [m] rounds ends
    RIDGE = 1  #: ``size`` · 2^−(2 d/extent)²: ``size`` [m] high, ``extent`` [m] wide at half its height
    BUMP = 2  #: as a ridge, but round: d is the distance from its middle


#: The profiles as plain numbers, for code that is compiled.
RAMP, RIDGE, BUMP = (int(profile) for profile in Profile)
_LN_2 = float(np.log(2.0))


def rise(profile: Any, size: Any, extent: Any, edge: Any, d: Any) -> Any:
    """dh/dd [1] at the distance d beyond the line, or from the middle [m]; a number or an array d."""
    if profile == RAMP:
        return 0.5 * size * (np.tanh(0.5 * d / edge) - np.tanh(0.5 * (d - extent) / edge))
    z = 2.0 * d / extent
    return -4.0 * _LN_2 * size / extent * z * np.exp(-_LN_2 * z * z)


def steepest(size: float, extent: float) -> float:
    """The largest |dh/dd| [1] of a ridge or a bump."""
    return abs(size) / extent * float(np.sqrt(8.0 * _LN_2 / np.e))


def beyond(offset: Any, direction: Any, x: Any, y: Any) -> Any:
    """How far (x, y) lies beyond the line at ``offset`` [m] whose normal points in ``direction`` [rad]."""
    return x * np.cos(direction) + y * np.sin(direction) - offset


def slope(profile: Any, size: Any, extent: Any, edge: Any, place: tuple[Any, Any], x: Any, y: Any) -> Any:
    """∇h, two components [1], at (x, y) [m]; ``place`` as in :class:`Relief`; numbers or arrays x, y."""
    if profile == BUMP:
        dx, dy = x - place[0], y - place[1]
        d = np.sqrt(dx * dx + dy * dy)
        along = rise(profile, size, extent, edge, d) / (d + 1e-30)
        return along * dx, along * dy
    along = rise(profile, size, extent, edge, beyond(place[0], place[1], x, y))
    return along * np.cos(place[1]), along * np.sin(place[1])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relief:
    """A floor that is not flat: a ``profile`` at a ``place``.

    The place of a ramp and of a ridge is a line: its offset [m] along a direction [rad].  That of a bump is
    its middle: x and y [m].  ``size`` [1 or m], ``extent_m`` [m] and ``edge_m`` [m] are as :class:`Profile`
    says.
    """

    profile: Profile
    size: float
    extent_m: float
    place: tuple[float, float]
    edge_m: float

    def gradient(self, x: Array, y: Array) -> Array:
        """∇h (..., 2) [1] in the floor frame at the places x, y (...) [m]."""
        return np.stack(slope(self.profile, self.size, self.extent_m, self.edge_m, self.place, x, y), axis=-1)
