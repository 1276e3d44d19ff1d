"""Everything about a robot's motion limits on one surface, and the few numbers to remember."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

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
from slipmargin.limits.bounds_inside import PACE, Inside, inside
from slipmargin.limits.every_motion import turning_points
from slipmargin.limits.motion import steady_share
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.grips import GripShape
from slipmargin.work import MOVING_STATES, ROBUST_STATES, allow_states, fits

#: Curvatures of the cornering table [1/m].
CURVATURES = np.array([0.2, 0.5, 1.0, 2.0, 5.0])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bounds:
    """The motion limits of a model.

    ``full`` uses all of the grip and asks no motor; ``safe``, ``spin``, ``cornering`` and ``inside`` use
    1 − margin of it, and of the motors' torque at half their top speed.
    ``rigid`` is the share of the grip that constant speed needs in the worst roller/rigid state; above 1 even
    constant speed must slip.  ``motor_m_s2`` and ``top_m_s`` (H,) are the motors' limits (infinite: none).
    ``weakest_m_s2`` is the least safe speeding up over directions every degree and on both sides of those in
    which a wheel's drag turns round.
    ``inside`` is None where ``why_not`` says so.  On an uneven floor all of them are the worst of the loads'
    band, and ``even`` says what an even floor allows with all of the grip.  ``rolling_m_s2`` is the traction
    limit of rollers that turn freely (disc-strip), where the grip is the box.  ``contact`` is what the wheels
    were taken to stand on.
    """

    model: Model
    margin: float
    full: Directions
    safe: Directions
    spin: Spin
    cornering: Cornering
    rigid_use: Array
    motor_m_s2: Array
    top_m_s: Array
    weakest_m_s2: float
    inside: Inside | None
    why_not: str
    even: Directions | None = None
    rolling_m_s2: float | None = None
    contact: Contact = Contact.ROLLERS

    @property
    def traction_m_s2(self) -> float:
        """Traction limit: the weakest direction of speeding up with all of the grip [m/s²]."""
        return float(np.min(self.full.starting_m_s2))

    @property
    def motor_limit_m_s2(self) -> float:
        """Motor limit: the weakest direction at stall torque [m/s²], infinite where no torque is stated."""
        return float(np.min(self.motor_m_s2))

    @property
    def smaller(self) -> str:
        """Which of the two limits."""
        return "traction" if self.traction_m_s2 <= self.motor_limit_m_s2 else "motor"

    @property
    def recommended_m_s2(self) -> float:
        """Speeding up that is safe in every direction of motion with the margin [m/s²].

        Up to half of the motors' top speed.
        """
        return max(0.0, min(self.weakest_m_s2, float(np.min(self.safe.starting_m_s2))))

    @property
    def speeds(self) -> tuple[float, float, float, float]:
        """Speeds at which the safe sets are there: forward, sideways, any way [m/s] and turning [rad/s].

        Each alone, infinite where nothing limits it.
        """
        if self.inside is None or self.inside.pace is None:
            turn = np.inf if self.inside is None else self.inside.yaw_rate_rad_s
            return np.inf, np.inf, np.inf, turn
        front = self.model.convention.front_rad
        fastest = self.model.geometry.rolling_rows()[:, :2]  # a wheel turns fastest along its row
        ways = np.append(np.arctan2(fastest[:, 1], fastest[:, 0]), [front, front - 0.5 * np.pi])
        top = self.inside.pace * top_speed(self.model, ways)
        turn = min(self.inside.pace * self.spin.top_rad_s, self.inside.yaw_rate_rad_s)
        return float(top[-2]), float(top[-1]), float(np.min(top)), turn

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


def bounds(
    model: Model,
    *,
    margin: float = 0.1,
    step_deg: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    sets: bool = True,
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
    sets : bool
        Also find the largest box and ellipsoid (about a second, mostly to load the solver).
    yaw_rad_s2 : float, optional
        Yaw acceleration that the sets keep in reserve (:func:`~slipmargin.limits.bounds_inside.inside`).
    """
    heading, share = headings(step_deg), 1.0 - margin
    if contact is Contact.UNKNOWN:
        allow_states("wheel", int(np.count_nonzero(model.grip.rigid_fraction > 0.0)), ROBUST_STATES)
    even = None
    if len(model.loads.uneven_N):
        level = replace(model, loads=replace(model.loads, uneven_N=np.zeros((0, model.count))))
        even = directions(level, heading, contact=contact, motor=False)
    full = directions(model, heading, contact=contact, motor=False)
    found, why = None, ""
    if sets:
        try:
            found = inside(model, share=share, contact=contact, yaw_rad_s2=yaw_rad_s2)
        except NoSolution as fault:
            why = str(fault)
    fine = np.concatenate([headings(1.0), turning_points(model, 0.0) % (2.0 * np.pi)])
    weakest = directions(model, np.sort(fine), share=share, contact=contact, pace=PACE).starting_m_s2
    return Bounds(
        model=model,
        margin=margin,
        full=full,
        safe=directions(model, heading, share=share, contact=contact, pace=PACE),
        spin=spin(model, share=share, contact=contact),
        cornering=cornering(model, CURVATURES, heading, share=share, contact=contact),
        rigid_use=_rigid_use(model, heading),
        motor_m_s2=starting_by_motor(model, heading),
        top_m_s=top_speed(model, heading),
        weakest_m_s2=float(np.min(weakest)),
        inside=found,
        why_not=why,
        even=even,
        rolling_m_s2=_rolling(model, heading, contact),
        contact=contact,
    )


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
