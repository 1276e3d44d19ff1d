"""What ``slipmargin check`` computes, and its words."""

from __future__ import annotations

import math
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
from slipmargin.paths.check import Check, check
from slipmargin.paths.trajectory import Trajectory

NEEDED = ("t_s", "x_m", "y_m", "phi_rad")


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRun:
    """An audit with the poses it was made of."""

    model: Model
    check: Check
    pose: Array

    @property
    def rows(self) -> Trajectory:
        """The trajectory with everything that the audit added."""
        c = self.check
        return Trajectory(
            t_s=c.t_s,
            pose=self.pose,
            velocity=c.velocity,
            acceleration=c.acceleration,
            omega=c.omega,
            use=c.use,
            wheels=self.model.geometry.names,
        )

    def write(self, out: Path | None, plot: Path | None) -> None:
        """The CSV and the figure; the figure is drawn before the CSV is written."""
        if plot is not None:
            from slipmargin.plots.paths import check_figure
            from slipmargin.plots.style import save

            save(check_figure(self.model, self.check, self.rows), plot)
        if out is not None:
            write_text(out, columns_text(self.rows.columns(), digits=12))


def run_check(
    model: Model,
    file: Path,
    share: float,
    smooth: float,
    robust: bool,
    outputs: tuple[Path | str | None, ...],
) -> CheckRun:
    """Read and audit; outputs are checked before any work is done.

    Raises
    ------
    InputError
        Placed in the file.
    """
    check_writable(*outputs)
    if outputs[1] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[1])
    columns = read_columns(file, required=NEEDED, known=None, empty=None, least=1)
    try:
        found = check(
            model,
            columns["t_s"],
            columns.stack(NEEDED[1:]),
            share=share,
            smooth_s=smooth,
            contact=Contact.UNKNOWN if robust else Contact.ROLLERS,
        )
    except InputError as fault:
        raise fault.in_file(str(file)) from None
    return CheckRun(model=model, check=found, pose=columns.stack(NEEDED[1:]))


def report(run: CheckRun) -> list[str]:
    """Lines for stdout; the first is the verdict."""
    c, names = run.check, run.model.geometry.names
    t, x, y, k = c.worst
    verdict = "admissible" if c.admissible else "not admissible"
    lines = [
        f"{verdict}: uses at most {c.max_use:.4f} of a wheel's grip, {c.share:g} allowed",
        f"worst       wheel {names[k]} at t = {t:.4g} s (x {x:.4g} m, y {y:.4g} m)",
    ]
    if math.isfinite(run.model.drives.stall_torque_N_m or math.inf):
        lines.append(f"motors      at most {np.max(c.torque):.4f} of the torque they have")
    if run.model.drives.max_speed_rad_s is not None:
        lines.append(f"wheels      at most {np.max(c.speed):.4f} of their top speed")
    if np.min(c.load_N) < 0.0:
        lines.append(f"tips        wheel {names[int(np.argmin(c.load_N.min(axis=0)))]} lifts off")
    if math.isinf(c.time_scale_needed):
        lines.append("cure        none by slowing down: constant speed itself needs too much grip somewhere")
    elif not c.admissible:
        lines.append(f"cure        stretch time by {c.time_scale_needed:.4f}")
    return lines


def table(run: CheckRun) -> dict[str, Any]:
    """The contract's JSON: verdict, worst point, time scaling, and use per sample."""
    c = run.check
    t, x, y, k = c.worst
    return {
        "schema": 1,
        "robot": run.model.robot,
        "surface": run.model.surface,
        "margin": 1.0 - c.share,
        "admissible": c.admissible,
        "max_use": c.max_use,
        "time_scale_needed": c.time_scale_needed,
        "worst": {"t_s": t, "x_m": x, "y_m": y, "wheel": run.model.geometry.names[k]},
        "wheels": run.model.geometry.names,
        "t_s": c.t_s,
        "use": c.use,
        "torque": c.torque,
        "wheel_speed": c.speed,
        "min_load_N": float(np.min(c.load_N)),
    }
