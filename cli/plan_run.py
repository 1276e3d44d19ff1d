"""What ``slipmargin plan`` computes, and its words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.table import columns_text, read_columns
from slipmargin.io.writes import check_writable, write_text
from slipmargin.limits.motion_state import Contact
from slipmargin.model import Model
from slipmargin.paths.along import Caps
from slipmargin.paths.path import Path as Way, corners, through
from slipmargin.paths.plan import Plan, Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.paths.trajectory import Trajectory
from slipmargin.paths.verify import Verified, on_rollers, verify

from .render import refuse

WAYPOINTS = ("x_m", "y_m", "phi_rad")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanRun:
    """A plan with its table and, where asked for, its proof on rollers and as the robot's file has it."""

    plan: Plan
    trajectory: Trajectory
    proofs: dict[str, Verified]

    def write(self, out: Path | None, plot: Path | None) -> None:
        """The CSV and the figure; the figure is drawn before the CSV is written."""
        if plot is not None:
            from slipmargin.plots.paths import plan_figure
            from slipmargin.plots.style import save

            save(plan_figure(self.plan, self.trajectory), plot)
        if out is not None:
            write_text(out, columns_text(self.trajectory.columns(), digits=12))


def ask(
    margin: float,
    points: int,
    speeds: tuple[float, float],
    caps: tuple[float | None, float | None],
    robust: bool,
) -> Request:
    """The request that the options make.

    Raises
    ------
    InputError
        Placed at ``--max-speed`` or ``--max-yaw-rate``.
    """
    for option, cap in (("--max-speed", caps[0]), ("--max-yaw-rate", caps[1])):
        if cap is not None and not 0.0 < cap < np.inf:
            refuse(option, f"is {cap:g}", "give a positive number, or leave it out")
    return Request(
        share=1.0 - margin,
        points=points,
        start_m_s=speeds[0],
        end_m_s=speeds[1],
        caps=Caps(speed_m_s=caps[0] or np.inf, yaw_rate_rad_s=caps[1] or np.inf),
        contact=Contact.UNKNOWN if robust else Contact.ROLLERS,
    )


def run_plan(
    model: Model,
    file: Path,
    request: Request,
    closed: bool,
    blend: float | None,
    step: float,
    proof: bool,
    outputs: tuple[Path | str | None, ...],
) -> PlanRun:
    """Plan, sample and, where asked for, simulate; outputs are checked before any work is done.

    Raises
    ------
    InputError
        Placed in the file of waypoints or at the option.
    NoSolution
        If there is no admissible motion.
    """
    check_writable(*outputs)
    if outputs[1] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[1])
    if closed and blend is not None:
        refuse(
            "--blend", "is given with --closed", "close the path with a spline, or repeat the first waypoint"
        )
    try:
        found = plan(model, way(model, file, closed, blend), request)
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(file)) from None
    rows = trajectory(found, step_s=step)
    proofs = {}
    if proof:
        proofs["on rollers"] = verify(on_rollers(model), rows)
        if np.any(model.grip.rigid_fraction > 0.0):
            proofs["with its rigid sectors"] = verify(model, rows)
    return PlanRun(plan=found, trajectory=rows, proofs=proofs)


def way(model: Model, file: Path, closed: bool, blend: float | None) -> Way:
    """The path through the waypoints of a file."""
    points = read_columns(file, required=WAYPOINTS, known=(), least=1).stack(WAYPOINTS)
    arm = _arm(model)
    try:
        return (
            through(points, arm=arm, closed=closed)
            if blend is None
            else corners(points, arm=arm, blend_m=blend)
        )
    except InputError as fault:
        raise fault.in_file(str(file)) from None


def _arm(model: Model) -> float:
    place: Array = model.geometry.position_m - model.inertia.com_m
    return float(np.mean(np.hypot(place[:, 0], place[:, 1])))


def report(run: PlanRun) -> list[str]:
    """Lines for stdout; the first is the answer."""
    p, share = run.plan, run.plan.request.share
    i, j, k = p.audit.worst
    speed = np.hypot(run.trajectory.velocity[:, 0], run.trajectory.velocity[:, 1])
    lines = [
        f"duration    {p.duration_s:.4f} s for {p.path.length:.4g} m, top speed {np.max(speed):.4g} m/s",
        f"grip        at most {p.max_use:.6f} of each wheel's grip, {share:g} allowed (checked at "
        f"{p.audit.speed.size} places); highest: wheel {p.model.geometry.names[k]} at "
        f"t = {p.audit.time_s[i, j]:.3f} s",
        f"limited by  {_limited(p)}",
    ]
    for name, proof in run.proofs.items():
        words = "slips" if proof.slips else "does not slip"
        lines.append(
            f"simulated   {name}: {words}; uses at most {proof.peak:.4f} of the grip (wheel {proof.wheel}), "
            f"drive slip up to {1e3 * np.max(proof.slip_m_s):.3g} mm/s; open loop it ends "
            f"{1e3 * proof.drift_m:.3g} mm and {np.rad2deg(proof.drift_rad):.3g}° away"
        )
    return lines


def _limited(p: Plan) -> str:
    """Share of the time that each wheel's grip (or a motor, a cap) sets the pace."""
    spent = np.diff(p.audit.time_s[:, [0, -1]], axis=1).ravel()
    who = limiting_wheel(p)
    names = [*p.model.geometry.names, "caps or motors"]
    shares = [(float(np.sum(spent[who == k])) / p.duration_s, name) for k, name in enumerate(names)]
    return ", ".join(
        f"{name} {100 * part:.0f} %" for part, name in sorted(shares, reverse=True) if part > 0.005
    )


def limiting_wheel(p: Plan) -> Array:
    """(n,) index of the wheel that uses most of its grip in each interval, N where none is near its limit."""
    most = p.audit.use.max(axis=1)
    return np.where(most.max(axis=1) > 0.98 * p.request.share, most.argmax(axis=1), p.model.count)


def table(run: PlanRun) -> dict[str, Any]:
    """Everything as numbers."""
    p = run.plan
    return {
        "schema": 1,
        "robot": p.model.robot,
        "surface": p.model.surface,
        "margin": 1.0 - p.request.share,
        "contact": p.request.contact.name.lower(),
        "duration_s": p.duration_s,
        "length_m": p.path.length,
        "max_use": p.max_use,
        "grid_points": len(p.x),
        "s_m": p.grid.s,
        "speed_m_s": np.sqrt(p.x),
        "speed_limit_m_s": np.sqrt(p.highest),
        "limiting": [(*p.model.geometry.names, "cap")[int(k)] for k in limiting_wheel(p)],
        "trajectory": run.trajectory.columns(),
        "simulated": {
            name: {
                "slips": v.slips,
                "max_share": v.peak,
                "wheel": v.wheel,
                "max_drive_slip_m_s": float(np.max(v.slip_m_s)),
                "end_position_m": v.drift_m,
                "end_heading_rad": v.drift_rad,
            }
            for name, v in run.proofs.items()
        },
    }
