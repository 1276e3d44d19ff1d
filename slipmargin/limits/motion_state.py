"""How the robot moves, as samples: what a limit in motion may know of its state."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, Index, frozen

#: Speed at which a force against the motion is full, over that below which it really fades out [1].
_NO_FADE = 1e-9


class Contact(Enum):
    """What material each wheel stands on (eq. 5)."""

    ROLLERS = "all wheels stand on rollers"
    RIGID = "all wheels stand on rigid material"
    UNKNOWN = "each wheel may stand on either: the worst counts"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """M samples of a state.  ``None`` means unknown: a limit then takes the whole interval.

    Parameters
    ----------
    velocity : array (M, 3)
        Body-frame velocity of the body's origin (right, forward) [m/s] and yaw rate [rad/s].
    heading : array (M,), optional
        φ [rad].
    position : array (M, 2), optional
        Floor-frame position of the origin [m].
    time_s : array (M,), optional
        Time since the start of the run [s].
    acceleration : array (M, 3), optional
        Body-frame acceleration of the origin [m/s²] and yaw acceleration [rad/s²].
    drive_slip : array (M, N), optional
        Slip of every wheel along its grip direction ĝ, of body and wheel as they move [m/s].
    saturated : bool
        Take the drag at its full value with the sign of the transverse slip (zero where a wheel does
        not slide sideways), as if k were infinite: the published limit, independent of the speed.
        So are forces against the motion, which fade out only where the robot comes to rest.
    """

    velocity: Array
    heading: Array | None = None
    position: Array | None = None
    time_s: Array | None = None
    acceleration: Array | None = None
    drive_slip: Array | None = None
    saturated: bool = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "velocity", frozen("velocity", self.velocity, (None, 3)))
        m = len(self.velocity)
        shapes: dict[str, tuple[int | None, ...]] = {
            "heading": (m,),
            "position": (m, 2),
            "time_s": (m,),
            "acceleration": (m, 3),
            "drive_slip": (m, None),
        }
        for name, shape in shapes.items():
            if getattr(self, name) is not None:
                put(self, name, frozen(name, getattr(self, name), shape))

    @staticmethod
    def full_drag(ahead: Array, speed_m_s: Array | float = 1e-3) -> Motion:
        """States along ``ahead`` (M, 3) at full drag, by default so slow that nothing else depends on it."""
        return Motion(velocity=np.reshape(speed_m_s, (-1, 1)) * ahead, saturated=True)

    @property
    def fade(self) -> float:
        """Of the speed below which a force against the motion fades out [1]: none of it at full drag."""
        return _NO_FADE if self.saturated else 1.0

    @property
    def count(self) -> int:
        """Number of samples M."""
        return len(self.velocity)

    def take(self, rows: slice | Array | Index) -> Motion:
        """The samples that ``rows`` selects."""
        picked: dict[str, Any] = {
            field.name: value[rows]
            for field in fields(self)
            if isinstance(value := getattr(self, field.name), np.ndarray)
        }
        return replace(self, **picked)
