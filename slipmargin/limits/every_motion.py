"""Motions that stand for every motion: what is safe in all of them is safe in any."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.frames import directions

#: Directions of translation and yaw rates (times speed over arm) that the sets must be safe for.
HEADINGS, YAW = 72, (-1.0, 0.0, 1.0)
#: How far beside a turning point of a drag [rad].
BESIDE = 1e-5


def all_motions(model: Model) -> Motion:
    """Directions of motion without and with turning, each at full drag, and turning on the spot.

    Directions go round in order, so that neighbours are alike in all but the wheels' speeds.
    """
    arm = model.reach_m
    even = 2.0 * np.pi * np.arange(HEADINGS) / HEADINGS
    moves = []
    for yaw in YAW:
        turning = turning_points(model, yaw / arm) % (2.0 * np.pi)
        ahead = directions(np.sort(np.concatenate([even, turning])))
        moves.append(np.column_stack([ahead, np.full(len(ahead), yaw / arm)]))
    return Motion.full_drag(np.vstack([*moves, [[0.0, 0.0, 1.0 / arm], [0.0, 0.0, -1.0 / arm]]]))


def turning_points(model: Model, yaw: float) -> Array:
    """Headings on both sides of where a wheel's drag turns round: between them no sign changes."""
    rows = model.geometry.lateral_rows()
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.arccos(-rows[:, 2] * yaw / np.hypot(rows[:, 0], rows[:, 1]))
    at = np.arctan2(rows[:, 1], rows[:, 0])
    turn = np.concatenate([at + off, at - off])
    turn = turn[np.isfinite(turn)]
    return np.concatenate([turn + BESIDE, turn - BESIDE])
