"""The numbers a limiter needs, taken once from a model: a few small tables and no solver.

Body-frame acceleration a = (a_x, a_y, α) of the centre of mass; wheel i:

    f(a) = L (M a − w + B_T D N(a)),      |f_i(a)| ≤ λ μ_i N_i(a),      N(a) = N₀ + P a

L shares a wrench between wheels in proportion to their grip, as they do while they creep little
(docs/theory.md, section 4): exact for three wheels, and for more the first order of the realised
distribution, whose most loaded wheel then uses less than this says.
D_j is the drag of a wheel by its lateral slip.  What depends on something a robot does not know while it
drives (place, time, load, creep) counts with its worst value.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen, rounded_down
from slipmargin.errors import InputError
from slipmargin.limits.bias import height_m, lift_N
from slipmargin.limits.bounds import ahead_of
from slipmargin.limits.creep_states import Balance
from slipmargin.limits.motion import steady_share
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_friction import friction_range
from slipmargin.limits.motion_realised import SLOW_CREEP, comparable, settles_slowly
from slipmargin.limits.motion_rows import even_distribution
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.constants import CRAWL_M_S
from slipmargin.physics.grips import GripShape, rise_across
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable

#: Fastest speed [m/s] that is tried where the robot file gives no top speed of its motors.
FASTEST_M_S = 3.0
#: Share of the grip kept back because a change of acceleration changes the creep, which overshoots [1]:
#: simulated robots exceeded the share they were limited to by up to 0.03 without it.
CREEPS = 0.015
#: States over which the worst of what depends on the motion is taken.
_STATES = 600


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LimitTable:
    """Everything :class:`~slipmargin.onboard.limiter.Rows` and the C header are made of; N wheels, C cases.

    Parameters
    ----------
    coupling : float
        Part of the grip in which drag takes from the drive grip: 0 for a box.
    margin, uneven : float
        Shares of the grip kept back: the margin, and what creeping wheels use more than the tables take.
    mass : (3,)
        (m, m, I) [kg, kg, kg m²].
    com_m : (2,)
        Centre of mass in the body frame.
    spread : (N, 3)
        L, drive forces per wrench [1, 1, 1/m].
    along, across : (3, N)
        B_W and B_T: the wrench of a unit force of each wheel along and across its grip.
    lateral, rolling : (N, 3)
        Lateral slip [m/s] and wheel speed [rad/s] per body twist.
    drive : (N,)
        Drive coefficient μ_i, the least.
    drag, slope : (2, N)
        Transverse coefficient and slope k of the friction law across the rollers [s/m], the least and the
        greatest.
    coupled_drag, coupled_slope : (2, N)
        The same of the coupled part of the grip (:func:`~slipmargin.physics.grips.rise_across`).
    rest_low_N, rest_high_N : (C, N)
        Loads without acceleration; one case for each corner of an uneven floor's band.
    per_acceleration_kg : (N, 2)
        P.
    wrench_low, wrench_high : (3,)
        External wrench on the body, body frame; a box where it depends on something unknown.
    floor_wrench : (3,)
        External wrench in floor axes (a slope).
    floor_moment_N_m : (2,)
        Sum of height × force of what makes up that wrench, in floor axes.
    floor_loads : (N, 2)
        Change of the loads by that moment, seen in the body frame [1/m].
    viscous : (3, 3)
        Wrench per body twist of the viscous lateral friction.
    spin : (N, 3)
        Torque that wheels and rotors take per rate of the body twist.
    stall_torque_N_m : float, optional
        At the wheel, of the weakest motor.
    """

    robot: str
    surface: str
    names: tuple[str, ...]
    axes: str
    margin: float
    uneven: float
    law: int
    shape: GripShape
    coupling: float
    mass: Array
    com_m: Array
    spread: Array
    along: Array
    across: Array
    lateral: Array
    rolling: Array
    drive: Array
    drag: Array
    slope: Array
    coupled_drag: Array
    coupled_slope: Array
    rest_low_N: Array
    rest_high_N: Array
    per_acceleration_kg: Array
    wrench_low: Array
    wrench_high: Array
    floor_wrench: Array
    floor_moment_N_m: Array
    floor_loads: Array
    viscous: Array
    torque_force: Array
    torque_drag: Array
    spin: Array
    stall_torque_N_m: float | None
    top_speed_rad_s: float | None

    def __post_init__(self) -> None:
        n, c = len(self.names), len(np.asarray(self.rest_low_N))
        shapes: dict[str, tuple[int | None, ...]] = {
            "mass": (3,), "com_m": (2,), "spread": (n, 3), "along": (3, n), "across": (3, n),
            "lateral": (n, 3), "rolling": (n, 3), "drive": (n,),
            "drag": (2, n), "slope": (2, n), "coupled_drag": (2, n), "coupled_slope": (2, n),
            "rest_low_N": (c, n), "rest_high_N": (c, n),
            "per_acceleration_kg": (n, 2), "wrench_low": (3,), "wrench_high": (3,), "floor_wrench": (3,),
            "floor_moment_N_m": (2,), "floor_loads": (n, 2), "viscous": (3, 3),
            "torque_force": (n,), "torque_drag": (n,), "spin": (n, 3),
        }  # fmt: skip
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(name, getattr(self, name), shape))

    @property
    def share(self) -> float:
        """λ, the share of the grip that may be used."""
        return 1.0 - self.margin - (CREEPS + self.uneven)

    @property
    def count(self) -> int:
        """Number of wheels N."""
        return len(self.names)

    @property
    def transfers(self) -> bool:
        """Whether accelerating shifts load."""
        return bool(np.any(self.per_acceleration_kg))

    @property
    def shares_by_load(self) -> bool:
        """Whether the loads decide how the wheels share a wrench: more than three, with load transfer."""
        return self.count > 3 and self.transfers

    @property
    def mean_load_N(self) -> float:
        """Mean load of a wheel at rest [N]."""
        return float(np.mean(self.rest_low_N[0]))

    @property
    def coupled(self) -> bool:
        """Whether a wheel's drag takes from its drive grip."""
        return self.coupling > 0.0

    @property
    def most_beside(self) -> Array:
        """Drag per load (N,) beside which the coupled part of the grip has nothing left to drive."""
        return np.maximum(self.drag[1], 1e-30) if self.shape is GripShape.ELLIPSE else self.drive

    @property
    def turned(self) -> bool:
        """Whether the heading matters."""
        return bool(np.any(self.floor_wrench) or np.any(self.floor_moment_N_m))

    @property
    def pull_m_s2(self) -> float:
        """Acceleration that the drive grip alone would give [m/s²]: the scale of errors."""
        return float(self.share * np.max(self.drive) * np.sum(self.rest_low_N[0]) / self.mass[0])


def threes(along: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """How every three of N wheels would share a wrench alone: wheels (T, 3), weights (T,), spreads (T, 3, 3).

    With weights g the forces f that make a wrench with the least Σ f²/g are the mean of the forces of every
    three wheels alone, weighted by the product of their g and their squared determinant (A. Ben-Tal and
    M. Teboulle, Linear Algebra Appl. 139, 165, 1990): with p the product of the grips of three wheels

        L = Σ p · spreads / Σ p · weights,

    in which no two large numbers cancel however light a wheel is.
    """
    wheels = np.array(list(combinations(range(along.shape[1]), 3)), dtype=np.intp)
    three = along.T[wheels]  # (T, wheel, component)
    spread = np.stack([np.cross(three[:, (k + 1) % 3], three[:, (k + 2) % 3]) for k in range(3)], axis=1)
    size = np.sum(spread[:, 0] * three[:, 0], axis=1)
    largest = float(np.max(np.abs(size)))
    kept = np.abs(size) > 1e-9 * largest  # the others push along one line or through one point
    size, spread = size[kept], spread[kept]
    return wheels[kept], (size / largest) ** 2, (size / largest**2)[:, None, None] * spread


def limit_table(model: Model, margin: float) -> LimitTable:
    """The table of a model that keeps ``margin`` of every wheel's grip.

    Raises
    ------
    InputError
        Where a wheel's drag leaves it no grip to drive.
    """
    uneven = max(0.0, _uneven(model, 1.0 - margin))
    share = 1.0 - margin - (CREEPS + uneven)
    if share <= 0.0:
        most = rounded_down(1.0 - CREEPS - uneven)
        raise InputError(
            "margin", f"is {margin:g}: creep takes the rest of the grip", f"give less than {most:g}"
        )
    motion = _states(model)
    known = friction_range(model, motion, share=share)
    drive, transverse = _least_and_most(known.drive[:, 0]), _least_and_most(known.transverse[:, 0])
    steep, slope = _least_and_most(known.drive_stiffness), _least_and_most(known.stiffness)
    grip = model.grip  # an ellipse is the flatter the more it drives
    opposite = drive[::-1] if grip.shape is GripShape.ELLIPSE else drive
    size, rise = rise_across(grip.shape, opposite, transverse, steep)
    geometry, (along, across) = model.geometry, model.wrench_maps()
    low, high, floor, moment, change = _external(model, motion)
    rest = model.loads.at(np.zeros(2), lift_N=lift_N(model)) + model.loads.shifts()
    on_grip, on_free = geometry.torque_arms()
    rolling = geometry.rolling_rows() / geometry.radius_m[:, None]
    drives = model.drives
    if np.min(drive[0]) <= 0.0:
        wheel = geometry.names[int(np.argmin(drive[0]))]
        raise InputError("margin", f"wheel {wheel} may have no drive grip at all", "correct its coefficients")
    return LimitTable(
        robot=model.robot,
        surface=model.surface,
        names=geometry.names,
        axes=f"+x {model.convention.axes[0]}, +y {model.convention.axes[1]}",
        margin=margin,
        uneven=uneven,
        law=model.grip.law,
        shape=model.grip.shape,
        coupling=model.grip.coupled_part,
        mass=model.inertia.diagonal,
        com_m=model.inertia.com_m,
        spread=even_distribution(model),
        along=along,
        across=across,
        lateral=geometry.lateral_rows(),
        rolling=rolling,
        drive=drive[0],
        drag=transverse,
        slope=slope,
        coupled_drag=size,
        coupled_slope=rise,
        rest_low_N=rest + change[0],
        rest_high_N=rest + change[1],
        per_acceleration_kg=model.loads.per_acceleration_kg,
        wrench_low=low,
        wrench_high=high,
        floor_wrench=floor,
        floor_moment_N_m=moment,
        floor_loads=model.loads.per_moment_1_per_m,
        viscous=-model.grip.viscous_N_s_per_m[1] * across @ geometry.lateral_rows(),
        torque_force=-on_grip,
        torque_drag=on_free,
        spin=(drives.wheel_inertia_kg_m2 or 0.0) * rolling,
        stall_torque_N_m=drives.weakest_N_m,
        top_speed_rad_s=drives.max_speed_rad_s,
    )


def _least_and_most(values: Array) -> Array:
    """Least and greatest (2, N) over states of lower and upper ends (2, M, N)."""
    return np.stack([values[0].min(axis=0), values[1].max(axis=0)])


def _states(model: Model) -> Motion:
    """Twists up to the motors' top speed, evenly over directions and speeds; everything else unknown.

    Translations and pure turns, where what grows with the speed is greatest, are taken exactly: at full speed
    and at a crawl.
    """
    draw = np.random.default_rng(0)
    way = draw.normal(size=(_STATES, 3))
    arm = model.geometry.reach_m
    way /= np.linalg.norm(way, axis=1, keepdims=True) * np.array([1.0, 1.0, arm])
    course, turns = np.deg2rad(np.arange(0.0, 360.0, 5.0)), np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    exact = np.vstack([ahead_of(course), turns / arm])
    part = np.append(draw.uniform(0.0, 1.0, _STATES) ** 2, np.ones(len(exact)))
    way = np.vstack([way, exact])
    top = model.drives.max_speed_rad_s
    speed = np.full(len(way), FASTEST_M_S)
    if top is not None:
        speed = top / np.max(np.abs(model.geometry.wheel_speeds(way)), axis=1)
    return Motion(velocity=np.vstack([way * (speed * part)[:, None], CRAWL_M_S * exact]))


def _uneven(model: Model, share: float) -> float:
    """How much more of a wheel's grip is used where all creep than where forces follow grip in proportion.

    The greatest over wrenches in every direction that take ``share`` in proportion; 0 for three wheels,
    whose forces a wrench decides.
    """
    along = np.ascontiguousarray(model.wrench_maps()[0])
    grip = model.grip.roller[:, 0] * model.loads.rest_N
    if model.count == 3 or np.min(grip) <= 0.0:
        return 0.0
    way = np.random.default_rng(0).normal(size=(_STATES, 3)) * np.array([1.0, 1.0, np.mean(np.abs(along[2]))])
    force = way @ even_distribution(model).T
    way *= share / np.max(np.abs(force) / grip, axis=1, keepdims=True)
    none = np.zeros((_STATES, model.count))
    steep = np.full_like(none, model.grip.k_s_per_m)
    balance = Balance(
        law=model.grip.law,
        along=along,
        across=along,
        grip=none + grip,
        drag=none,
        steep=steep,
        steep_across=steep,
        slide=none,
        need=way,
        carried=np.zeros((_STATES, 4)),
        scale=comparable(model),
    )
    return float(np.max(balance.rest()[1])) - share


def _exact(term: ForceTerm) -> bool:
    """Whether a term is a constant in body or floor axes."""
    constant = term.variable is Variable.UNITY and term.basis is Basis.CONSTANT
    return constant and term.frame in (Frame.BODY, Frame.FLOOR)


def _external(model: Model, motion: Motion) -> tuple[Array, Array, Array, Array, Array]:
    """Box of body wrenches; floor wrench and its sum of height × force; load changes (2, N) of the rest."""
    terms = model.external.terms
    exact = [t for t in terms if _exact(t)]
    others = replace(model, external=replace(model.external, terms=tuple(t for t in terms if t not in exact)))
    still = replace(others, grip=replace(model.grip, viscous_N_s_per_m=np.zeros(2)))
    seen = external_in_motion(still, motion)
    low, high = seen.low.sum(axis=0).min(axis=0), seen.high.sum(axis=0).max(axis=0)
    change = np.stack([seen.load_change_N[0].min(axis=0), seen.load_change_N[1].max(axis=0)])
    floor, tilt, per = np.zeros(3), np.zeros(2), model.loads.per_moment_1_per_m
    for term in exact:
        wrench, height = term.coefficients.sum(axis=1), height_m(model, term)
        if term.frame is Frame.BODY:
            low, high, change = low + wrench, high + wrench, change + height * per @ wrench[:2]
        else:
            floor, tilt = floor + wrench, tilt + height * wrench[:2]
    return low, high, floor, tilt, change


def steady_warnings(model: Model, margin: float) -> tuple[str, ...]:
    """What to say of creep that settles slowly, unequal motors, and constant speed that uses the reserve."""
    slow = (f"creep: {SLOW_CREEP}",) if settles_slowly(model) else ()
    weakest = model.drives.weakest_N_m
    if weakest is not None and np.any(model.drives.stall_torques(model.count) > weakest):
        said = f"motors: the limiter counts every motor as the weakest, {weakest:.3g} N m at standstill"
        slow = (*slow, said)
    heading = np.deg2rad(np.arange(0.0, 360.0, 5.0))
    way = ahead_of(heading)
    steady = steady_share(model, Motion.full_drag(way))
    worst = int(np.argmax(steady))
    if steady[worst] <= 1.0 - margin:
        return slow
    return (
        *slow,
        f"constant speed towards {np.rad2deg(heading[worst]):.0f}° alone uses {steady[worst]:.2f} of a "
        f"wheel's grip, {1.0 - margin:.2f} may be used: the limiter hardly lets the robot move that way",
    )
