"""A model as one flat array that compiled code reads (layout: :mod:`slipmargin.sim.layout`)."""

from __future__ import annotations

import math

import numpy as np

from slipmargin.checks import Array, read_only
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics import sectors
from slipmargin.physics.contact import BOX, DISC_STRIP, ELLIPSE
from slipmargin.physics.frames import moment
from slipmargin.physics.grips import GripShape
from slipmargin.physics.relief import Relief
from slipmargin.physics.terms import AGAINST, OF_PLACE, ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.sim import layout as at

_SHAPES = {GripShape.BOX: BOX, GripShape.DISC_STRIP: DISC_STRIP, GripShape.ELLIPSE: ELLIPSE}

#: Variables of the pose: forces that depend on them give the motion a pose Jacobian.
_HEADING = frozenset({Variable.HEADING, Variable.SLIP_HEADING, Variable.SLIP_DIRECTION}) | OF_PLACE
_PLACE = frozenset({Variable.POSITION_X, Variable.POSITION_Y}) | OF_PLACE
#: Variables known in time alone where wheel speeds are prescribed.
_TIME = frozenset(
    {
        Variable.TIME,
        Variable.WHEEL_ANGLE,
        Variable.ACCELERATION_X,
        Variable.ACCELERATION_Y,
        Variable.YAW_ACCELERATION,
    }
)
#: Variables that leave the velocity derivative analytic.
_CALM = (_TIME | _HEADING | _PLACE | {Variable.UNITY}) - {Variable.SLIP_DIRECTION}
#: Variables of the hub's velocity and of u_W whose derivatives are analytic.
_HUB = frozenset({Variable.HUB_SPEED, Variable.PASSING_SPEED})
#: Variables of the body's velocity; forces over them have analytic derivatives.
_MOTION = frozenset({Variable.VELOCITY_X, Variable.VELOCITY_Y, Variable.YAW_RATE, Variable.SPEED})
#: The bases whose coefficients all stand for one and the same function.
_SINGLE = frozenset({Basis.CONSTANT, Basis.DECAY, Basis.RECIPROCAL, Basis.WINDOW, Basis.STEP, Basis.LOBE})


def pack(model: Model) -> Array:
    """The flat array (L,) of a model, read-only.

    Commanded wheels are driven by their motors where the model has a stall torque or a droop
    (:mod:`slipmargin.sim.motion`).

    Raises
    ------
    InputError
        If the inertia of the wheels is not positive, or a term cannot be simulated (a friction term over
        the commanded speed, a drive term over anything but command and time).
    """
    n = model.count
    head = np.zeros(at.HEAD)
    wheels = _wheels(model)
    mods = [_modulation(m, n) for m in model.grip.multipliers]
    forces = [_force(f, model) for f in model.external.terms]
    commands = [_modulation(m, n) for m in model.actuators.multipliers]
    _fill(head, model)
    place = at.HEAD + wheels.size
    for count, start, blocks in (
        (at.MODULATIONS, at.MODULATIONS_AT, mods),
        (at.FORCES, at.FORCES_AT, forces),
        (at.COMMANDS, at.COMMANDS_AT, commands),
    ):
        head[count], head[start] = len(blocks), place
        place += sum(len(b) for b in blocks)
    edges, reliefs = _edges(model), [_relief(r) for r in model.external.reliefs]
    head[at.EDGES], head[at.EDGES_AT] = len(edges), place
    head[at.RELIEFS], head[at.RELIEFS_AT] = len(reliefs), place + len(edges)
    flat = np.concatenate([head, wheels.ravel(), *mods, *forces, *commands, edges, *reliefs])
    if not np.all(np.isfinite(flat)):
        raise InputError("model", "holds a number that is not finite", "give finite parameters")
    return read_only(flat)


def stack(packed: list[Array]) -> Array:
    """Several packed models as rows (M, L), padded with zeros."""
    rows = np.zeros((len(packed), max(len(p) for p in packed)))
    for row, one in zip(rows, packed, strict=True):
        row[: len(one)] = one
    return rows


def wheels_of(rows: Array) -> Array:
    """The blocks (..., N, WHEEL) of the wheels in packed models (..., L)."""
    count = int(rows.flat[at.COUNT])
    return rows[..., at.HEAD : at.HEAD + count * at.WHEEL].reshape(*rows.shape[:-1], count, at.WHEEL)


def edges_of(row: Array) -> Array:
    """The instants at which a term of a packed model (L,) jumps or kinks [s]."""
    first = int(row[at.EDGES_AT])
    return row[first : first + int(row[at.EDGES])]


def _analytic(term: Multiplier, grip: Grip) -> bool:
    """Whether the derivative of a friction term over the velocity is analytic."""
    boxed = grip.shape is GripShape.BOX or grip.coupling == 0.0
    if term.variable in _HUB:
        if term.target < Target.STIFFNESS:
            return boxed or term.target is Target.BOTH
        slips = any(m.variable is Variable.SLIP_SPEED for m in grip.multipliers)
        return (boxed or grip.coupling == 1.0) and not slips
    if term.target >= Target.STIFFNESS:
        return term.variable in _CALM
    if term.variable is Variable.SLIP_SPEED:
        return boxed
    return term.variable in _CALM or term.variable is Variable.WHEEL_LOAD


def _fill(head: Array, model: Model) -> None:
    grip, loads, drives, transients = model.grip, model.loads, model.drives, model.actuators
    variables = {m.variable for m in grip.multipliers}
    terms = {f.variable for f in model.external.terms}
    for m in grip.multipliers:
        if m.variable is Variable.COMMAND_SPEED:
            raise InputError(
                "grip",
                "friction cannot depend on the commanded speed",
                "use ROLLING_SPEED, or put the term into the transients",
            )
    for m in transients.multipliers:
        if m.variable not in (Variable.COMMAND_SPEED, Variable.TIME, Variable.UNITY):
            raise InputError(
                "transients", f"a drive cannot depend on {m.variable.name}", "use COMMAND_SPEED or TIME"
            )
    floor = any(f.frame is Frame.FLOOR for f in model.external.terms)
    follows = bool(np.any(loads.per_acceleration_kg))
    head[at.COUNT], head[at.MASS], head[at.INERTIA] = (
        model.count,
        model.inertia.mass_kg,
        model.inertia.inertia_kg_m2,
    )
    head[at.COM_X], head[at.COM_Y] = model.inertia.com_m
    head[at.STEEPNESS], head[at.SHAPE], head[at.COUPLING] = grip.k_s_per_m, _SHAPES[grip.shape], grip.coupling
    head[at.VISCOUS_W], head[at.VISCOUS_T] = grip.viscous_N_s_per_m
    head[at.LOAD_FOLLOWS] = follows
    head[at.BY_LOAD] = Variable.WHEEL_LOAD in variables
    uneven = bool(model.external.reliefs)
    head[at.BY_HEADING] = bool((variables | terms) & _HEADING) or floor or uneven
    head[at.BY_POSITION] = bool((variables | terms) & _PLACE) or uneven
    by_angle = model.geometry.changes_in_a_turn
    head[at.BY_TIME] = bool((variables | terms) & _TIME) or by_angle
    against = any(f.frame in AGAINST for f in model.external.terms)
    head[at.BY_HUB], head[at.BY_MOTION] = bool(variables & _HUB), bool(terms & _MOTION) or against
    head[at.BY_VELOCITY] = bool(terms - _CALM - _MOTION) or not all(
        _analytic(m, grip) for m in grip.multipliers
    )
    head[at.BY_ANGLE] = Variable.WHEEL_ANGLE in variables or by_angle
    head[at.SHARE], head[at.LIFTED] = model.inertia.weight_N / model.count, float(np.sum(loads.rest_N))
    head[at.LAW] = grip.law
    head[at.DELAY], head[at.RAMP] = transients.delay_s, transients.ramp_s2_per_rad
    top = drives.max_speed_rad_s
    head[at.SLOWING] = 0.0 if top is None else 1.0 / top
    head[at.DRIVEN] = drives.stall_torque_N_m is not None or bool(np.any(transients.droop_rad_s_per_N_m))
    head[at.PLAYS] = bool(np.any(transients.play_rad))
    head[at.BENT] = bool(transients.multipliers or np.any(transients.top_rad_s < np.inf))
    head[at.LAGGED] = bool(
        np.any(transients.lag_s)
        or np.any(transients.gain != 1.0)
        or transients.delay_s
        or transients.ramp_s2_per_rad
        or head[at.BENT]
    )


def _wheels(model: Model) -> Array:
    c, grip, n = model.geometry, model.grip, model.count
    rows = np.zeros((n, at.WHEEL))
    arm = c.position_m - model.inertia.com_m
    for first, along, rolls in zip((at.GRIP_X, at.FREE_X), (c.grip, c.free), c.torque_arms(), strict=True):
        rows[:, [first, first + 1]] = along
        rows[:, first + 2] = moment(arm[:, 0], arm[:, 1], along[:, 0], along[:, 1])
        rows[:, first + 3] = rolls
    rows[:, [at.ARM_X, at.ARM_Y]] = arm
    rows[:, at.RADIUS] = c.radius_m
    rows[:, at.REST] = model.loads.rest_N
    rows[:, [at.LOAD_X, at.LOAD_Y]] = model.loads.per_acceleration_kg
    rows[:, [at.ROLLER_W, at.ROLLER_T]] = grip.roller
    rows[:, [at.RIGID_W, at.RIGID_T]] = grip.rigid
    rows[:, at.PITCH] = sectors.pitch(grip.rollers)
    rows[:, at.RIGID_SHARE] = grip.rigid_fraction
    rows[:, [at.TILT_X, at.TILT_Y]] = model.loads.per_moment_1_per_m
    rows[:, at.INERTIA_OF_WHEEL] = model.drives.wheel_inertias(model.inertia.mass_kg, c.radius_m)
    stall = model.drives.stall_torques(n)
    rows[:, at.STALL_TORQUE] = np.where(np.isfinite(stall), stall, 0.0)
    rows[:, at.LAG] = model.actuators.lag_s
    rows[:, at.GAIN] = model.actuators.gain
    rows[:, at.TOP_SPEED] = np.nan_to_num(model.actuators.top_rad_s)
    rows[:, at.DROOP] = model.actuators.droop_rad_s_per_N_m
    rows[:, at.PLAY] = model.actuators.play_rad
    rows[:, [at.RUNOUT_COS, at.RUNOUT_SIN]] = c.runout
    rows[:, [at.WOBBLE_COS, at.WOBBLE_SIN]] = c.wobble
    rows[:, [at.MEAN_GRIP_X, at.MEAN_GRIP_Y]] = c.grip
    rows[:, [at.MEAN_FREE_X, at.MEAN_FREE_Y]] = c.free
    rows[:, [at.NO_SLIP_X, at.NO_SLIP_Y, at.NO_SLIP_W]] = model.geometry.no_slip_map().T
    return rows


def _modulation(m: Multiplier, n: int) -> Array:
    if len(m.wheels) != n:
        raise InputError(
            "wheels", f"has {len(m.wheels)} weights, the robot has {n} wheels", "give one weight a wheel"
        )
    coefficients = _merged(m.basis, m.coefficients)
    return np.concatenate(
        [
            [float(m.variable), float(m.basis), float(m.target), float(len(coefficients))],
            m.shape,
            m.place,
            m.wheels,
            coefficients,
        ]
    )


def _force(f: ForceTerm, model: Model) -> Array:
    height = model.inertia.com_height_m if f.height_m is None else f.height_m
    coefficients = np.stack([_merged(f.basis, row) for row in f.coefficients])
    return np.concatenate(
        [
            [float(f.variable), float(f.basis), float(f.frame), float(coefficients.shape[1])],
            f.shape,
            [height, f.lift_N],
            f.place_m - model.inertia.com_m,
            coefficients.ravel(),
        ]
    )


def _relief(r: Relief) -> Array:
    return np.array([float(r.profile), r.size, r.extent_m, r.edge_m, *r.place])


def _edges(model: Model) -> Array:
    """Instants at which a friction multiplier or a force over time jumps or kinks [s]."""
    found = [np.empty(0)]
    terms: tuple[Multiplier | ForceTerm, ...] = (*model.grip.multipliers, *model.external.terms)
    for term in terms:
        if term.variable is Variable.TIME and term.basis in (Basis.WINDOW, Basis.HATS):
            knots = 2 if term.basis is Basis.WINDOW else max(term.coefficients.shape[-1], 2)
            found.append(np.linspace(float(term.shape[0]), float(term.shape[1]), knots))
    return np.concatenate(found)


def _merged(basis: Basis, coefficients: Array) -> Array:
    if basis in _SINGLE:
        return np.array([math.fsum(coefficients)])
    return coefficients


assert len(Target) == 6 and len(Frame) == 4  # the kernel knows these and no others
