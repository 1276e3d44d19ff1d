"""The same robot, path, commands and wheels in the paper's convention and in that of ROS.

The floor turns with the body (by −90°), so φ, speeds, moments and times are the same numbers in both, and
only vectors are turned.  The signs of the wheels stay: a drive direction of the file points the other way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.sliding_direction import SlidingDirection
from slipmargin.physics.convention import Convention
from slipmargin.robot import Robot

#: Effects' parameters that are the two components of one vector.
PAIRS = (
    ("marker_x_m", "marker_y_m"),
    ("shift_x_m", "shift_y_m"),
    ("tilt_x_rad", "tilt_y_rad"),
    ("nap_x", "nap_y"),
    ("anchor_x_m", "anchor_y_m"),
    ("centre_x_m", "centre_y_m"),
    ("force_x_N", "force_y_N"),
    ("place_x_m", "place_y_m"),
)
#: One that is a direction on the floor.
DIRECTION = "direction_rad"
#: Those that are of the floor: a floor with one of them is another floor once it is turned.
OF_THE_FLOOR = {"tilt_x_rad", "nap_x", "anchor_x_m", "centre_x_m", "force_x_N", DIRECTION}
#: Those that are a factor along each axis.
FACTORS = ("scale_x", "scale_y")


def ros(vectors: Sequence[float] | Array) -> Array:
    """Vectors (..., 2), or poses, twists and wrenches (..., 3), of the paper's axes in those of ROS."""
    found = np.array(vectors, dtype=float)
    x, y = Convention.ROS.from_right_forward(found[..., 0].copy(), found[..., 1].copy())
    found[..., 0], found[..., 1] = x, y
    return found


def robot_in_ros(robot: Robot) -> Robot:
    """The same machine as its ROS user writes it down; wheel speeds keep their signs."""
    assert robot.convention is Convention.PAPER
    wheels = tuple(
        replace(w, position_m=ros(w.position_m), drive_direction_deg=w.drive_direction_deg - 90.0 + 180.0)
        for w in robot.wheels
    )
    body = replace(robot.body, com_m=ros(robot.body.com_m))
    return replace(robot, convention=Convention.ROS, wheels=wheels, body=body)


def in_ros(recipe: Recipe) -> Recipe:
    """The same machine with the same effects."""
    return Recipe(
        robot=robot_in_ros(recipe.robot), effects=tuple(effect_in_ros(effect) for effect in recipe.effects)
    )


def effect_in_ros(effect: AnyEffect) -> AnyEffect:
    """The same effect: those of its parameters that are a vector are turned."""
    for x, y in PAIRS:
        if hasattr(effect, x):
            one, two = ros([getattr(effect, x), getattr(effect, y)]).tolist()
            effect = replace(effect, **{x: one, y: two})
    if hasattr(effect, DIRECTION):
        turned = getattr(effect, DIRECTION) - np.pi / 2.0
        effect = replace(effect, **{DIRECTION: float(np.arctan2(np.sin(turned), np.cos(turned)))})
    if isinstance(effect, FloorGrain):  # half a turn of 2β; four times a turn nothing changes
        effect = replace(effect, cosine=-effect.cosine, sine=-effect.sine)
    if hasattr(effect, FACTORS[0]):
        effect = replace(effect, scale_x=effect.scale_y, scale_y=effect.scale_x)
    return effect


def gives_the_floor_a_direction(effect: AnyEffect) -> bool:
    """Whether the floor with this effect is another one once it is turned."""
    return isinstance(effect, SlidingDirection) or any(hasattr(effect, name) for name in OF_THE_FLOOR)
