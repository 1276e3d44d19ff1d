"""Where fits of effects at a place of the floor, or at a time, start: spread over what the runs cover."""

from __future__ import annotations

import math

from slipmargin.effects.effect import Parameter, parameter

#: Farthest that a place may lie from the floor's origin [m]: the coordinates of a map are places as well …
_FARTHEST_M = 1e7
#: … and from the middle of where the runs were, where a fit looks for it.
_WITHIN_M = 100.0
#: Starts of a place: the middle and two rings of six, in shares of how far the runs reach from there …
_RINGS = (0.2, 0.55)
_ANGLES = tuple(k * math.pi / 3.0 for k in range(6))
AROUND_X = (0.0, *(ring * math.cos(angle) for ring in _RINGS for angle in _ANGLES))
AROUND_Y = (0.0, *(ring * math.sin(angle) for ring in _RINGS for angle in _ANGLES))
#: … each with three radii, in the same shares.
_RADII = (0.15, 0.35, 0.65)
PLACE_RADIUS = tuple(radius for radius in _RADII for _ in AROUND_X)
PLACE_X, PLACE_Y = AROUND_X * len(_RADII), AROUND_Y * len(_RADII)
#: Starts of a line: normals all around [rad], through the middle and some way out, in the same shares.
LINE_DIRECTION = tuple(k * math.pi / 4.0 for k in range(8))
LINE_OFFSET = (0.0, 0.3)
#: The two parameters that say where a line lies.
LINE = ("offset_m", "direction_rad")
#: The three that say where a round patch lies.
PATCH = ("centre_x_m", "centre_y_m", "radius_m")


def place(
    name: str,
    meaning: str,
    scale: float,
    starts: tuple[tuple[float, ...], tuple[float, ...]],
    *,
    along: str = "",
    within_m: float = _WITHIN_M,
) -> tuple[Parameter, Parameter]:
    """A place of the floor in x and y [m], with what it means; fits start at ``starts``, x beside y.

    They are counted from the middle of where the runs were, in metres or in shares of what is ``along``.
    """
    x, y = (
        parameter(
            f"{name}_{axis}_m",
            "m",
            (-_FARTHEST_M, 0.0, _FARTHEST_M),
            scale,
            f"{meaning}, {axis}",
            starts=values,
            idle=True,
            along=along,
            coordinate=axis,
            within=within_m,
        )
        for axis, values in zip("xy", starts, strict=True)
    )
    return x, y


def line(
    offset: str, direction: str, offsets: tuple[float, ...], directions: tuple[float, ...]
) -> tuple[Parameter, Parameter]:
    """Where a line of the floor lies, with what its two parameters mean; fits start at every direction of
    ``directions`` [rad] with every offset of ``offsets`` in shares of how far the runs reach.
    """
    return (
        parameter(
            LINE[0],
            "m",
            (-_FARTHEST_M, 0.0, _FARTHEST_M),
            0.02,
            offset,
            starts=tuple(a for a in offsets for _ in directions),
            idle=True,
            along="position",
            coordinate="offset",
            within=_WITHIN_M,
        ),
        parameter(
            LINE[1],
            "rad",
            (-7.0, 0.0, 7.0),
            0.2,
            direction,
            starts=directions * len(offsets),
            idle=True,
        ),
    )


#: Width w of an edge [m]: from 10 to 90 % it is 4.4 w wide, the two millimetres that a contact is long.
EDGE_M = 0.0005
#: What everything that has an edge says of it; a fit from a wide one reaches places from farther away.
EDGE = parameter(
    "edge_m",
    "m",
    (EDGE_M, EDGE_M, 1.0),
    0.005,
    "width of the edge; a sharp one is as wide as a contact",
    starts=(0.05,),
    idle=True,
)
