"""Where fits of effects at a place of the floor, or at a time, start: spread over what the runs cover."""

from __future__ import annotations

import math

#: Starts of a place: a ring of six and the middle, in shares of how far the runs reach from the origin.
PLACE_X = (0.0, *(0.55 * math.cos(k * math.pi / 3.0) for k in range(6)))
PLACE_Y = (0.0, *(0.55 * math.sin(k * math.pi / 3.0) for k in range(6)))
#: Starts of a direction at the same places [rad]: away from the origin.
PLACE_DIRECTION = (0.0, *(k * math.pi / 3.0 for k in range(6)))
#: Width of a smooth edge [m]: the contact is a few millimetres long, and no fit knows an edge better.
EDGE_M = 0.005
