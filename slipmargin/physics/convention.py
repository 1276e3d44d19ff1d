"""Which way a robot file's axes point, and which way a positive wheel speed drives: the paper's way or ROS's.

Every equation of this package holds in any right-handed body frame: turning body and floor axes by one angle
turns velocities, forces and positions with them and leaves φ, moments and friction as they are.  So a robot
is computed in the axes of its own file, and a convention is needed only where a word, a picture, another
tool's axes or the sign of a wheel comes in.

``paper`` (Williams, Carter, Gallina and Rosati 2002, Fig. 3 and eq. 3; docs/theory.md, section 1): +Y is the
front, +X to the right; a positive wheel speed moves the wheel's contact point along the drive direction ŝ, so
the robot goes the other way.  ``ros`` (REP 103, "In relation to a body the standard is: x forward, y left, z
up"): +X is the front, +Y to the left; a positive wheel speed drives the robot along the drive direction.  In
both, φ is the yaw of the body's axes against the floor's.  So φ = 0 faces along the floor's +y in ``paper``
and along its +x in ``ros``.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import Any

import numpy as np

from slipmargin.checks import Array


class Convention(Enum):
    """The axes and signs of one robot file and of everything that is read and written with it."""

    PAPER = "paper"
    ROS = "ros"

    @property
    def front_rad(self) -> float:
        """Direction of the robot's front, counter-clockwise from the body's +x [rad]."""
        return 0.5 * math.pi if self is Convention.PAPER else 0.0

    @property
    def contact_sign(self) -> float:
        """+1 where a positive wheel speed moves the contact point along the drive direction, −1 against it.

        The robot goes the other way than the contact point.
        """
        return 1.0 if self is Convention.PAPER else -1.0

    @property
    def axes(self) -> tuple[str, str]:
        """Where the body's +x and +y point, in words."""
        return ("to the right", "forwards") if self is Convention.PAPER else ("forwards", "to the left")

    @property
    def short_axes(self) -> tuple[str, str]:
        """The same as one word each."""
        return ("right", "forward") if self is Convention.PAPER else ("forward", "left")

    @property
    def compass(self) -> str:
        """What directions of 0° and 90° mean, in words."""
        x, y = ("right", "forwards") if self is Convention.PAPER else ("forwards", "left")
        return f"0° is {x}, 90° {y}"

    def right_forward(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Components to the right and forwards of a vector in this convention's axes; exact."""
        return (x, y) if self is Convention.PAPER else (-y, x)

    def from_right_forward(self, right: Any, forward: Any) -> tuple[Any, Any]:
        """Components in this convention's axes of a vector to the right and forwards; exact."""
        return (right, forward) if self is Convention.PAPER else (forward, -right)

    def from_front(self, direction_rad: Any) -> Array:
        """Directions counted from the body's +x as angles from the robot's front [rad]."""
        return np.asarray(direction_rad) - self.front_rad

    def phi_of_yaw(self, yaw_rad: Any) -> Array:
        """φ [rad] of a robot whose front has the heading ``yaw_rad`` from the floor's +x (REP 103).

        Positions and velocities on the floor stay as they are: the floor frame is the same.
        """
        return np.asarray(yaw_rad) - self.front_rad

    def yaw_of_phi(self, phi_rad: Any) -> Array:
        """Heading [rad] of the front from the floor's +x; the inverse of :meth:`phi_of_yaw`."""
        return np.asarray(phi_rad) + self.front_rad
