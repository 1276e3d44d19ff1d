"""One run of one model, told in full: the readable front of :class:`slipmargin.sim.batch.Batch`."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError, MotionStopped
from slipmargin.model import Model
from slipmargin.physics.frames import to_floor, velocity_at
from slipmargin.sim.batch import Batch, Ending, Outcome, Push
from slipmargin.sim.pack import pack
from slipmargin.sim.run import Run
from slipmargin.sim.signal import WheelSignal
from slipmargin.work import FACTOR

#: Error allowed a step; the pose then errs by a few 1e-8 of its size (tests/rooms/sim).
RTOL = 1e-7

#: Why a run ended early, and what to change.
REASONS = {
    Ending.TIPS: (
        "a wheel lifts off, and no three others carry the robot: it tips",
        "accelerate or push less, or lower the centre of mass",
    ),
    Ending.JAMS: (
        "a wheel lifts off, and friction presses another down so hard that it jams or tips",
        "accelerate or push less, or lower the centre of mass",
    ),
    Ending.NOT_FINITE: ("velocities or forces overflow", "give smaller wheel speeds, forces or coefficients"),
    Ending.STUCK: ("the step size fell to nothing", "smooth the commands or lower k_s_per_m"),
    Ending.TOO_LONG: (
        "it takes too many steps",
        f"lower k_s_per_m, shorten the run, or set {FACTOR}=10 to allow ten times as many",
    ),
}


def simulate(
    model: Model,
    signal: WheelSignal,
    times_s: Array,
    *,
    commanded: bool = False,
    start_pose: Array | None = None,
    start_twist: Array | None = None,
    push: Push | None = None,
    rtol: float = RTOL,
    max_steps: float | None = None,
) -> Run:
    """What the robot really does under a wheel signal.

    Parameters
    ----------
    model : Model
        The machine on its surface.
    signal : WheelSignal
        Wheel motion (:mod:`slipmargin.sim.signal`).
    times_s : array (T,)
        When to tell the state, ascending, within the signal [s].
    commanded : bool
        True: the signal is a command that the model's drives follow, as far as its motors' torque allows;
        False: what the wheels do.
    start_pose, start_twist : array (3,), optional
        Pose and floor-frame velocity of the body frame's origin at the start; zero by default.
    push : Push, optional
        External force on the body.
    rtol : float
        Relative error allowed a step.
    max_steps : float, optional
        Steps after which the motion is given up, fewer than :mod:`slipmargin.work` allows.

    Raises
    ------
    InputError
        If the signal does not fit the robot or the times, or commands more than the motors' top speed.
    MotionStopped
        If the robot tips (no three wheels carry it), jams, or the motion overflows, with the time.
    """
    pose = np.zeros(3) if start_pose is None else frozen("start_pose", start_pose, (3,))
    twist = np.zeros(3) if start_twist is None else frozen("start_twist", start_twist, (3,))
    if not 1e-13 <= rtol <= 0.1:
        raise InputError("rtol", f"is {rtol:g}", "give a relative error between 1e-13 and 0.1")
    if commanded:
        _reachable(model, signal)
    batch = Batch([signal], [times_s], commanded=commanded, pushes=[push])
    outcome = batch.run(pack(model), pose, start_twist=twist, tell=True, rtol=rtol, max_steps=max_steps)
    ending = Ending(int(outcome.ending[0]))
    if ending is not Ending.DONE:
        raise MotionStopped(float(signal.knots_s[0] + outcome.stopped_s[0]), *REASONS[ending])
    return as_run(model, np.asarray(times_s, dtype=float), outcome, 0, float(signal.knots_s[0]))


def as_run(model: Model, times_s: Array, outcome: Outcome, r: int, first_s: float = 0.0) -> Run:
    """Run ``r`` of an outcome (made with ``tell=True``) as a noun; it began at ``first_s``."""
    assert outcome.theta is not None and outcome.slip is not None
    assert outcome.force is not None and outcome.load is not None and outcome.utilisation is not None
    count = len(times_s)
    return Run(
        t_s=times_s,
        pose=outcome.pose[r, :count],
        velocity=floor_velocity(model, outcome.state[r, :count]),
        theta=outcome.theta[r, :count],
        slip=outcome.slip[r, :count],
        force=outcome.force[r, :count],
        load=outcome.load[r, :count],
        utilisation=outcome.utilisation[r, :count],
        wheels=model.geometry.names,
        in_air_s=outcome.in_air_s[r],
        lifts_s=outcome.lifted_s(r, first_s),
    )


def floor_velocity(model: Model, state: Array) -> Array:
    """(T, 3) floor-frame velocity of the origin and yaw rate from states (T, 6)."""
    w = state[:, 5]
    body = velocity_at(state[:, 3], state[:, 4], w, *-model.inertia.com_m)
    return np.stack([*to_floor(state[:, 2], *body), w], axis=1)


def _reachable(model: Model, signal: WheelSignal) -> None:
    """Refuse a command beyond the motors' top speed, which no wheel can follow."""
    top = model.drives.max_speed_rad_s
    if top is None:
        return
    asked = signal.peak_speed()
    if np.max(asked) > top * (1.0 + 1e-9):
        wheel = int(np.argmax(asked))
        raise InputError(
            f"wheel {model.geometry.names[wheel]}",
            f"is commanded to {asked[wheel]:.4g} rad/s, the motor reaches {top:g} rad/s",
            "command less, or correct motor.max_speed_rad_s",
        )
