"""The proof of a plan by simulation: its wheel speeds, open loop, through the slip simulator.

Limits say what share of the grip a motion uses; the simulator knows nothing of limits.  They meet in
force, not in slip, since near the limit a force error of 2 % changes the creep by half: the share a
simulated wheel used is its drive force over what its coefficient and its transverse force left it, with
every multiplier of friction in force at that instant.  A contact that slides sideways as a whole (rigid
material, where the grip is coupled) has nothing left however little it drives: its share is what the
friction law gives at its drive slip.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import MotionStopped
from slipmargin.model import Model
from slipmargin.paths.trajectory import Trajectory
from slipmargin.physics.friction_laws import law_share
from slipmargin.sim.batch import Batch, Ending
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import REASONS

#: Spacing of the samples of the simulated run [s].
FINE_S = 5e-4
#: A share above it is gross slip: by eq. (11) its creep is 42/k, 42 mm/s at k = 1000 s/m [1].
GROSS = 0.985


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verified:
    """What the simulated wheels did: T times, N wheels.

    ``share`` (T, N) of the drive grip used, ``slip_m_s`` (T, N) drive slip, ``pose`` (T, 3) simulated,
    ``drift_m``, ``drift_rad`` at the end against the plan; ``ending`` how the run ended; ``stopped`` when,
    why and what to change where it ended early (else None): it then proves nothing, and the drift is NaN;
    ``lifts_s`` when the first wheel lifted (None: none did), ``in_air_s`` (N,) for how long each hung in the
    air.
    """

    t_s: Array
    share: Array
    slip_m_s: Array
    pose: Array
    drift_m: float
    drift_rad: float
    ending: Ending
    stopped: MotionStopped | None
    wheels: tuple[str, ...]
    lifts_s: float | None
    in_air_s: Array

    @property
    def peak(self) -> float:
        """Largest share of any wheel."""
        return float(np.max(self.share))

    @property
    def wheel(self) -> str:
        """The wheel with the largest share."""
        return self.wheels[int(np.argmax(np.max(self.share, axis=0)))]

    @property
    def slips(self) -> bool:
        """Whether a wheel slipped grossly, as far as the run went."""
        return self.peak > GROSS


def on_rollers(model: Model) -> Model:
    """The same machine without rigid sectors: what a plan for rollers assumes."""
    return replace(model, grip=replace(model.grip, rigid_fraction=np.zeros(model.count)))


def verify(model: Model, planned: Trajectory, *, stretch: float = 1.0) -> Verified:
    """Simulate the planned wheel speeds, open loop, from the planned start.

    Where the model has a stall torque they are commands that its motors follow as far as they can.

    Parameters
    ----------
    model : Model
        The machine (:func:`on_rollers` of it where the plan was made for rollers).
    stretch : float
        Drive the same motion slower (above 1) or faster (below 1).
    """
    t = planned.t_s * stretch
    omega = planned.omega / stretch
    signal = linear(t, omega, spin=omega[0])
    motors = model.drives.stall_torque_N_m is not None
    fine = np.linspace(t[0], t[-1], max(2, int(np.ceil((t[-1] - t[0]) / FINE_S)) + 1))
    run = Batch([signal], [fine], commanded=motors).run(
        pack(model), planned.pose[0], start_twist=planned.velocity[0] / stretch, tell=True
    )
    assert run.slip is not None and run.utilisation is not None and run.steepness is not None
    slip = np.abs(run.slip[0, :, :, 0])
    at_slip = law_share(model.grip.law, run.steepness[0, :, :, 0] * slip)
    ending, stopped = Ending(int(run.ending[0])), None
    off = run.pose[0, -1] - planned.pose[-1]
    if ending is not Ending.DONE:
        stopped, off = MotionStopped(float(t[0] + run.stopped_s[0]), *REASONS[ending]), np.full(3, np.nan)
    return Verified(
        t_s=fine,
        share=np.minimum(run.utilisation[0], at_slip),
        slip_m_s=slip,
        pose=run.pose[0],
        drift_m=float(np.hypot(off[0], off[1])),
        drift_rad=float(abs(off[2])),
        ending=ending,
        stopped=stopped,
        wheels=model.geometry.names,
        lifts_s=run.lifted_s(0, float(t[0])),
        in_air_s=run.in_air_s[0],
    )
