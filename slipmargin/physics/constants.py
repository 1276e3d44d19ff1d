"""Numbers that the equations share."""

from __future__ import annotations

#: Standard acceleration of gravity used throughout [m/s²].  The golden numbers are per unit of
#: m g and do not depend on it; forces in newtons use this value.
GRAVITY_M_S2 = 9.81
#: A force against the motion fades out below these speeds as v/√(v² + v₀²) [m/s], [rad/s]: far below
#: any speed of interest, and smooth, so that a robot can come to rest.
SLOW_M_S, SLOW_RAD_S = 1e-3, 1e-2
#: Added to speeds by which another is divided (slip ratio, lead) [m/s].
CRAWL_M_S = 1e-3
