"""Values that a variable may have at a state: one where it is known, a range of probes where not."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.ranges import span
from slipmargin.model import Model
from slipmargin.physics.constants import CRAWL_M_S, GRAVITY_M_S2
from slipmargin.physics.frames import to_floor
from slipmargin.physics.kinematics import rate_as_axes_turn
from slipmargin.physics.terms import OF_PLACE, ForceTerm, Multiplier, place_variable
from slipmargin.physics.variables import Basis, Variable

#: Probes over an unknown variable.
PROBES = 73
#: … and of a direction, which a narrow lobe of friction may lie along.
_DIRECTIONS = 16 * PROBES + 1
#: A range for accelerations that nobody stated: this many times the best grip times g [1].
ACCELERATION_RANGE = 1.0

_BODY = {Variable.VELOCITY_X: 0, Variable.VELOCITY_Y: 1, Variable.YAW_RATE: 2}
_ACCELERATION = {Variable.ACCELERATION_X: 0, Variable.ACCELERATION_Y: 1, Variable.YAW_ACCELERATION: 2}
_PLACE = {Variable.POSITION_X: 0, Variable.POSITION_Y: 1}


def probes(
    model: Model,
    motion: Motion,
    slide: Array,
    creep: Array,
    term: Multiplier | ForceTerm,
    *,
    transverse: bool = False,
) -> Array:
    """Values (P, M, N) or (P, M, 1) that the variable of ``term`` may take; wheel loads: :func:`load_probes`.

    Parameters
    ----------
    slide : (M, N)
        Transverse slip [m/s].
    creep : (M, N)
        Largest drive slip [m/s], where the motion does not say which it is.
    term
        Its functions say where a variable that is not known is probed: over their period, at their knots,
        or as far as they change.
    transverse : bool
        Whether the transverse component is asked for (slip variables).
    """
    variable, shape = term.variable, term.shape
    if variable in _BODY:
        return np.asarray(motion.velocity[None, :, _BODY[variable], None])
    if variable is Variable.SPEED:
        return np.asarray(np.hypot(motion.velocity[:, 0], motion.velocity[:, 1])[None, :, None])
    if variable in _ACCELERATION:
        return _acceleration(model, motion, _ACCELERATION[variable])
    if variable in _PLACE:
        known = None if motion.position is None else motion.position[:, _PLACE[variable]]
        return _known_or_range(known, term)
    if isinstance(term, Multiplier) and variable in OF_PLACE:
        return _of_place(model, motion, term)
    if variable is Variable.HEADING:
        return _heading(motion)
    if variable is Variable.TIME:
        return _known_or_range(motion.time_s, term)
    if variable is Variable.WHEEL_ANGLE:
        turn = float(shape[0]) if term.basis is Basis.FOURIER else 2.0 * np.pi
        return np.append(np.linspace(0.0, turn, PROBES), shape[0])[:, None, None]
    if variable is Variable.SLIP_HEADING:
        way = model.geometry.free if transverse else model.geometry.grip
        angle = np.arctan2(way[:, 1], way[:, 0])
        if transverse:
            return np.asarray(_heading(motion) + angle + np.where(slide < 0.0, np.pi, 0.0)[None])
        return np.asarray(np.concatenate([_heading(motion) + angle + half for half in (0.0, np.pi)]))
    if variable is Variable.SLIP_DIRECTION:
        return _slip_direction(model, motion, slide, creep)
    if isinstance(term, Multiplier) and variable is Variable.PASSING_SPEED:
        return _passing(model, motion, creep, float(term.place[0]))
    return _slip(model, motion, slide, creep, variable, transverse)


def _slip_direction(model: Model, motion: Motion, slide: Array, creep: Array) -> Array:
    """Floor direction (P, M or 1, N or 1) of the whole slip, for every drive slip up to ``creep`` either way.

    Where the heading is not known it is any direction, whatever the slip.
    """
    if motion.heading is None:
        return np.linspace(-np.pi, np.pi, _DIRECTIONS)[:, None, None]
    grip, free = model.geometry.grip, model.geometry.free
    drive = _drive_slip(motion, np.linspace(-1.0, 1.0, 17)[:, None, None] * creep)
    x, y = (drive * grip[:, k] + slide * free[:, k] for k in (0, 1))
    return np.asarray(_heading(motion) + np.arctan2(y, x))


def _passing(model: Model, motion: Motion, creep: Array, share: float) -> Array:
    """How fast (P, M, N) floor and tread pass each contact, for every drive slip up to ``creep``.

    A wheel that brakes slips at most as fast as the floor passes: then it is locked.
    """
    floor = np.einsum("idj,mj->mid", model.geometry.hub_rows(), motion.velocity)
    along = np.sum(floor * model.geometry.grip, axis=-1)
    most = np.where(along > 0.0, np.minimum(creep, along), creep)
    least = -np.where(along < 0.0, np.minimum(creep, -along), creep)
    slip = _drive_slip(motion, least + np.linspace(0.0, 1.0, 17)[:, None, None] * (most - least))
    return np.asarray(np.linalg.norm(floor - share * slip[..., None] * model.geometry.grip, axis=-1))


def _slip(
    model: Model, motion: Motion, slide: Array, creep: Array, variable: Variable, transverse: bool
) -> Array:
    drive = np.abs(_drive_slip(motion, np.linspace(0.0, 1.0, 9)[:, None, None] * creep))
    if variable is Variable.SLIP_ANGLE:
        return np.asarray(np.arctan2(np.abs(slide)[None], drive))
    slip = np.abs(slide)[None] if transverse else drive
    if variable is Variable.SLIP_SPEED:
        return np.asarray(slip)
    hub_rows = model.geometry.hub_rows()
    hub = np.linalg.norm(np.einsum("idj,mj->mid", hub_rows, motion.velocity), axis=2)
    if variable is Variable.HUB_SPEED:
        return np.asarray(hub[None])
    rolling = np.maximum(hub, np.abs(motion.velocity @ model.geometry.rolling_rows().T))[None]
    if variable is Variable.SLIP_RATIO:
        return np.asarray(slip / (rolling + CRAWL_M_S))
    if variable is Variable.ROLLING_SPEED:
        return np.asarray(rolling)
    return np.ones((1, 1, 1))  # UNITY, and COMMAND_SPEED, which no friction may depend on


def _drive_slip(motion: Motion, possible: Array) -> Array:
    """The drive slip (P, M, N): the known one, else all that are possible."""
    return possible if motion.drive_slip is None else motion.drive_slip[None]


def _heading(motion: Motion) -> Array:
    if motion.heading is not None:
        return np.asarray(motion.heading[None, :, None])
    return np.linspace(-np.pi, np.pi, PROBES)[:, None, None]


def _known_or_range(known: Array | None, term: Multiplier | ForceTerm) -> Array:
    if known is not None:
        return np.asarray(known[None, :, None])
    return span(term.basis, term.shape, term.variable, term.coefficients.shape[-1], PROBES)[:, None, None]


def _of_place(model: Model, motion: Motion, term: Multiplier) -> Array:
    """Where contacts are, seen from a place; the whole range where position or heading is not known."""
    variable = term.variable
    if motion.position is None or motion.heading is None:
        return span(Basis.STEP, term.shape, variable, len(term.coefficients))[:, None, None]
    turned = to_floor(motion.heading[:, None], *model.geometry.position_m.T)
    x, y = (motion.position[:, k, None] + turned[k] for k in (0, 1))
    at_x, at_y, direction = term.place
    return np.asarray(place_variable(variable is Variable.BEFORE_LINE, at_x, at_y, direction, x, y)[None])


def _acceleration(model: Model, motion: Motion, column: int) -> Array:
    """Rate of the body twist, which the wheels are asked for: a_o − ω ẑ×v_o."""
    if motion.acceleration is not None:
        rate = motion.acceleration + rate_as_axes_turn(motion.velocity)
        return np.asarray(rate[None, :, column, None])
    best = ACCELERATION_RANGE * GRAVITY_M_S2 * float(np.max(model.grip.roller[:, 0]))
    arm = model.reach_m
    top = best if column < 2 else best * model.inertia.mass_kg * arm / model.inertia.inertia_kg_m2
    return np.linspace(-top, top, 9)[:, None, None]


def load_probes(model: Model, least_N: Array, change_N: Array) -> Array:
    """Values (P, M, N) that WHEEL_LOAD may take: loads [N] from ``least_N`` to that plus ``change_N`` (M, N).

    Both without acceleration; accelerations add as much as the best grip allows.
    """
    top = ACCELERATION_RANGE * GRAVITY_M_S2 * float(np.max(model.grip.roller[:, 0]))
    swing = np.linalg.norm(model.loads.per_acceleration_kg, axis=1) * top
    low, high = np.maximum(least_N - swing, 0.0), least_N + change_N + swing
    steps = np.linspace(0.0, 1.0, 9 if np.any(high > low) else 1)[:, None, None]
    return np.asarray((low + steps * (high - low)) * model.count / model.inertia.weight_N - 1.0)
