"""Everything about a robot's motion limits on one surface, and the few numbers to remember."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import (
    Cornering,
    Directions,
    Spin,
    ahead_of,
    cornering,
    directions,
    headings,
    spin,
    starting_by_motor,
    top_speed,
)
from slipmargin.limits.bounds_inside import YAW_SHARE, Inside, inside
from slipmargin.limits.bounds_pace import held_speed
from slipmargin.limits.bounds_states import PACE
from slipmargin.limits.motion import steady_share
from slipmargin.limits.motion_rows import CAUSES, MOTOR
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.still_rollers import StillRollers, still_rollers
from slipmargin.limits.weakest_start import BRISK_M_S, WeakestStart, weakest_start
from slipmargin.model import Model
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.grips import GripShape
from slipmargin.work import MOVING_STATES, ROBUST_STATES, WHEEL_DIRECTIONS, allow, allow_states, fits

#: Curvatures of the cornering table [1/m].
CURVATURES = np.array([0.2, 0.5, 1.0, 2.0, 5.0])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SafeSets:
    """The safe sets of accelerations of a model and the speeds at which they are there: what is exported.

    ``inside`` is None where ``refusal`` says why.  ``reserved_rad_s2`` is the yaw acceleration kept in
    reserve, ``contact`` what the wheels were taken to stand on.
    """

    model: Model
    margin: float
    spin: Spin
    reserved_rad_s2: float
    inside: Inside | None
    refusal: NoSolution | None
    contact: Contact = Contact.ROLLERS

    @property
    def why_not(self) -> str:
        """Why there are no safe sets, and what to do; empty where there are."""
        return "" if self.refusal is None else str(self.refusal)

    @property
    def speeds(self) -> tuple[float, float, float, float]:
        """Speeds at which the safe sets are there: forward, sideways, any way [m/s] and turning [rad/s].

        Each alone, infinite where nothing limits it.
        """
        if self.inside is None or self.inside.pace is None:
            turn = np.inf if self.inside is None else self.inside.yaw_rate_rad_s
            return np.inf, np.inf, np.inf, turn
        front = self.model.convention.front_rad
        ways = np.append(self._slowest_rad, [front, front - 0.5 * np.pi])
        top = self.inside.pace * top_speed(self.model, ways)
        turn = min(self.inside.pace * self.spin.top_rad_s, self.inside.yaw_rate_rad_s)
        return float(top[-2]), float(top[-1]), float(np.min(top)), turn

    @property
    def held_m_s(self) -> float:
        """Fastest straight motion in the slowest direction [m/s] that the whole motors hold against drag.

        The motors' top speed under load; without a stall torque their free one, infinite without motors.
        """
        even = headings(1.0)
        return held_speed(
            self.model, np.concatenate([even, self._slowest_rad, self._slowest_rad + np.pi]), self.contact
        )

    @property
    def _slowest_rad(self) -> Array:
        """Directions in which some wheel turns fastest: along its row."""
        fastest = self.model.geometry.rolling_rows()[:, :2]
        return np.asarray(np.arctan2(fastest[:, 1], fastest[:, 0]))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bounds:
    """The motion limits of a model.

    ``full`` uses all of the grip and asks no motor; ``safe``, ``cornering`` and ``sets`` use 1 − margin of
    it, and of the motors' torque at half their top speed.
    ``rigid`` is the share of the grip that constant speed needs in the worst roller/rigid state; above 1 even
    constant speed must slip.  ``motor_m_s2`` and ``top_m_s`` (H,) are the motors' limits (infinite: none).
    ``weakest`` is the least safe speeding up over all directions.
    On an uneven floor all of them are the worst of the loads' band, and ``even`` says what an even floor
    allows with all of the grip.  ``rolling_m_s2`` is the traction limit of rollers that turn freely
    (disc-strip), where the grip is the box.  ``still_rollers`` is there where no roller turns in the
    strongest direction of ``full``.  ``contact`` is what the wheels were taken to stand on.
    Where directions are more than a degree apart, ``all_round`` holds the same limits at least every degree:
    what is said of all directions is said of those.
    """

    model: Model
    margin: float
    full: Directions
    safe: Directions
    sets: SafeSets
    cornering: Cornering
    rigid_use: Array
    motor_m_s2: Array
    top_m_s: Array
    weakest: WeakestStart
    even: Directions | None = None
    rolling_m_s2: float | None = None
    still_rollers: StillRollers | None = None
    contact: Contact = Contact.ROLLERS
    all_round: Bounds | None = None

    def extremes(self) -> Motion:
        """Speeding up and braking as fast as is safe where a direction can be driven, at most at 1 m/s."""
        every = self.everywhere
        fast = np.concatenate([every.safe.starting_m_s2, -every.safe.braking_m_s2])
        can = np.isfinite(fast)
        ahead = np.tile(ahead_of(every.safe.heading_rad), (2, 1))[can]
        speed = np.minimum(BRISK_M_S, np.tile(every.top_m_s, 2)[can])
        return Motion(velocity=speed[:, None] * ahead, acceleration=fast[can, None] * ahead)

    @property
    def everywhere(self) -> Bounds:
        """The limits in directions no more than a degree apart: these, or :attr:`all_round`."""
        return self.all_round or self

    @property
    def inside(self) -> Inside | None:
        """The safe sets; None where :attr:`why_not` says so."""
        return self.sets.inside

    @property
    def why_not(self) -> str:
        """Why there are no safe sets."""
        return self.sets.why_not

    @property
    def spin(self) -> Spin:
        """Limits of turning on the spot, with the margin."""
        return self.sets.spin

    @property
    def speeds(self) -> tuple[float, float, float, float]:
        """Speeds at which the safe sets are there: forward, sideways, any way [m/s] and turning [rad/s]."""
        return self.sets.speeds

    @property
    def traction_m_s2(self) -> float:
        """Traction limit: the weakest direction of speeding up with all of the grip [m/s²]."""
        return float(np.min(self.everywhere.full.starting_m_s2))

    @property
    def motor_limit_m_s2(self) -> float:
        """Motor limit: the weakest direction at stall torque [m/s²], infinite where no torque is stated."""
        return float(np.min(self.everywhere.motor_m_s2))

    @property
    def smaller(self) -> str:
        """Which of the two limits."""
        return "traction" if self.traction_m_s2 <= self.motor_limit_m_s2 else "motor"

    @property
    def recommended_m_s2(self) -> float:
        """Speeding up that is safe in every direction of motion with the margin [m/s²].

        Up to half of the motors' top speed; what resists motion is taken up to 1 m/s.
        """
        return _recommended(self.weakest, self.safe)

    @property
    def recommended_cause(self) -> str:
        """What allows no more than the recommended acceleration: grip, tips, motor torque or drag."""
        safe = self.safe.starting
        least = int(np.argmin(safe.value))
        weak = self.weakest
        return weak.cause if weak.lowest_m_s2 <= safe.value[least] else safe.cause[least]

    @property
    def motors_decide(self) -> bool:
        """Whether the recommended acceleration is what the motors leave at half of their top speed."""
        return self.recommended_m_s2 > 0.0 and self.recommended_cause == CAUSES[MOTOR]

    @property
    def isotropic_m_s2(self) -> float:
        """μ g of the drive direction: what a tool with one friction coefficient believes [m/s²]."""
        return float(np.mean(self.model.grip.roller[:, 0])) * GRAVITY_M_S2

    @property
    def on_rigid_sectors(self) -> bool:
        """Whether the limits are those of the worst state of rollers and rigid sectors."""
        return self.contact is Contact.UNKNOWN and bool(np.any(self.model.grip.rigid_fraction > 0.0))

    @property
    def slipping_rad(self) -> Array:
        """Directions in which even constant speed must slip on rigid sectors."""
        return np.asarray(self.full.heading_rad[self.rigid_use > 1.0])


def safe_sets(
    model: Model,
    *,
    margin: float = 0.1,
    contact: Contact = Contact.ROLLERS,
    yaw_rad_s2: float | None = None,
    yaw_share: float = YAW_SHARE,
    ellipsoid: bool = True,
) -> SafeSets:
    """The safe sets of a model, without its limits by direction: what tools that plan are told.

    Parameters
    ----------
    yaw_rad_s2 : float, optional
        Yaw acceleration that the sets keep in reserve; ``yaw_share`` of spinning on the spot if left out.
    ellipsoid : bool
        Whether the ellipsoid is looked for, which takes a third of the time and which no tool reads.
    """
    turn, found, refusal = spin(model, share=1.0 - margin, contact=contact), None, None
    if yaw_rad_s2 is None:
        yaw_rad_s2 = yaw_share * turn.weaker_rad_s2
    try:
        found = inside(
            model, share=1.0 - margin, contact=contact, yaw_rad_s2=yaw_rad_s2, with_ellipsoid=ellipsoid
        )
    except NoSolution as fault:
        refusal = fault.with_traceback(None)  # a result holds no frames
    return SafeSets(
        model=model,
        margin=margin,
        spin=turn,
        reserved_rad_s2=yaw_rad_s2,
        inside=found,
        refusal=refusal,
        contact=contact,
    )


def bounds(
    model: Model,
    *,
    margin: float = 0.1,
    step_deg: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    yaw_rad_s2: float | None = None,
) -> Bounds:
    """All motion limits of a model.

    Parameters
    ----------
    margin : float
        Slip margin: 1 − the share of the grip that may be used.
    step_deg : float
        Step of the directions [deg].
    contact : Contact
        What the wheels stand on (UNKNOWN: the worst of rollers and rigid sectors).
    yaw_rad_s2 : float, optional
        Yaw acceleration that the sets keep in reserve (:func:`~slipmargin.limits.bounds_inside.inside`).
    """
    states = 1.0
    if contact is Contact.UNKNOWN:
        unknown = int(np.count_nonzero(model.grip.rigid_fraction > 0.0))
        allow_states("wheel", unknown, ROBUST_STATES)
        states = 2.0**unknown
    what = "wheels times contact states times directions"
    size = model.count * states * 360.0 / max(step_deg, 1e-300)
    allow("step_deg", size, WHEEL_DIRECTIONS, what, "take a longer step")
    heading, share = headings(step_deg), 1.0 - margin

    def towards(heading: Array) -> dict[str, Any]:
        even = None
        if len(model.loads.uneven_N):
            level = replace(model, loads=replace(model.loads, uneven_N=np.zeros((0, model.count))))
            even = directions(level, heading, contact=contact, motor=False)
        return {
            "full": directions(model, heading, contact=contact, motor=False),
            "safe": directions(model, heading, share=share, contact=contact, pace=PACE),
            "rigid_use": _rigid_use(model, heading),
            "motor_m_s2": starting_by_motor(model, heading, contact=contact),
            "top_m_s": top_speed(model, heading),
            "even": even,
            "cornering": cornering(model, CURVATURES, heading, share=share, contact=contact),
        }

    finer = heading if step_deg <= 1.0 else headings(step_deg / np.ceil(step_deg))
    found = towards(finer)
    everywhere = Bounds(
        **found,
        model=model,
        margin=margin,
        sets=safe_sets(model, margin=margin, contact=contact, yaw_rad_s2=yaw_rad_s2),
        weakest=weakest_start(model, share=share, contact=contact),
        rolling_m_s2=_rolling(model, finer, contact),
        still_rollers=still_rollers(model, found["full"], contact),
        contact=contact,
    )
    return everywhere if finer is heading else replace(everywhere, **towards(heading), all_round=everywhere)


def recommended(model: Model, *, share: float = 1.0, contact: Contact = Contact.ROLLERS) -> float:
    """:attr:`Bounds.recommended_m_s2` alone [m/s²], at a ``share`` of the grip."""
    safe = directions(model, headings(1.0), share=share, contact=contact, pace=PACE)
    return _recommended(weakest_start(model, share=share, contact=contact), safe)


def _recommended(weakest: WeakestStart, safe: Directions) -> float:
    return max(0.0, min(weakest.lowest_m_s2, float(np.min(safe.starting_m_s2))))


def _rigid_use(model: Model, heading: Array) -> Array:
    """Share of the grip at constant speed, whatever the wheels stand on; NaN where the cases are too many."""
    if not fits(2.0 ** np.count_nonzero(model.grip.rigid_fraction > 0.0), MOVING_STATES):
        return np.full(len(heading), np.nan)
    return steady_share(model, Motion.full_drag(ahead_of(heading)), contact=Contact.UNKNOWN)


def _rolling(model: Model, heading: Array, contact: Contact) -> float | None:
    """Weakest starting limit with the grip disc-strip [m/s²]; None where the grip is not the box."""
    if model.grip.shape is not GripShape.BOX:
        return None
    free = replace(model, grip=replace(model.grip, shape=GripShape.DISC_STRIP))
    return float(np.min(directions(free, heading, contact=contact, motor=False).starting_m_s2))
