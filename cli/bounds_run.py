"""What ``slipmargin bounds`` computes, and its words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.io.exports import TOOLS, bounds_table, export_text
from slipmargin.io.table import columns_text
from slipmargin.io.writes import check_writable, write_text
from slipmargin.limits.bounds_summary import Bounds, bounds
from slipmargin.limits.motion_state import Contact
from slipmargin.model import Model

from .render import columns, refuse


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundsRun:
    """Limits with the text of an export, made before any file is written."""

    bounds: Bounds
    export: tuple[Path, str] | None

    def write(self, out: Path | None, plot: Path | None) -> None:
        """Figure, export and table, in this order."""
        if plot is not None:
            from slipmargin.plots.bounds import bounds_figure
            from slipmargin.plots.style import save

            save(bounds_figure(self.bounds), plot)
        if self.export is not None:
            write_text(*self.export)
        if out is not None:
            write_text(out, columns_text(self._columns()))

    def as_json(self) -> dict[str, Any]:
        """Everything as numbers."""
        return bounds_table(self.bounds)

    def _columns(self) -> dict[str, Any]:
        full, safe = self.bounds.full, self.bounds.safe
        return {
            "heading_rad": full.heading_rad,
            "starting_m_s2": full.starting_m_s2,
            "turning_m_s2": full.turning_m_s2,
            "braking_m_s2": full.braking_m_s2,
            "safe_starting_m_s2": safe.starting_m_s2,
            "safe_turning_m_s2": safe.turning_m_s2,
            "safe_braking_m_s2": safe.braking_m_s2,
            "steady_use": full.steady_use,
            "steady_use_rigid": self.bounds.rigid_use,
            "limiting": ["+".join(w) for w in full.starting.wheels],
            "cause": list(full.starting.cause),
        }


def run_bounds(
    model: Model,
    margin: float,
    step: float,
    robust: bool,
    export: tuple[str, Path] | None,
    outputs: tuple[Path | str | None, ...],
) -> BoundsRun:
    """Everything the command needs, with its options checked before any work is done.

    Raises
    ------
    InputError
        Placed at the option.
    NoSolution
        If an export is asked for and nothing is safe in every direction.
    """
    if not (math.isfinite(step) and 0.0 < step <= 90.0):
        refuse("--step", f"is {step:g}", "give a step up to 90 degrees")
    if export is not None and export[0] not in TOOLS:
        refuse("--export", f"is {export[0]!r}", f"use one of: {', '.join(TOOLS)}")
    check_writable(*outputs, None if export is None else export[1])
    if outputs[1] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[1])
    found = bounds(
        model, margin=margin, step_deg=step, contact=Contact.UNKNOWN if robust else Contact.ROLLERS
    )
    text = None if export is None else (export[1], export_text(export[0], found))
    return BoundsRun(bounds=found, export=text)


def report(run: BoundsRun, *, table: bool) -> list[str]:
    """Lines for stdout; the first four are the answer."""
    b = run.bounds
    full, lines = b.full, []
    weak, strong = int(np.argmin(full.starting_m_s2)), int(np.argmax(full.starting_m_s2))
    lines.append(
        f"traction    {b.traction_m_s2:.4g} m/s² in the weakest direction ({_deg(full.heading_rad[weak])}; "
        f"{', '.join(full.starting.wheels[weak])}), {full.starting_m_s2[strong]:.4g} m/s² in the "
        f"strongest ({_deg(full.heading_rad[strong])})"
    )
    lines.append(
        "motor       "
        + (
            f"{b.motor_limit_m_s2:.4g} m/s² at stall torque"
            if math.isfinite(b.motor_limit_m_s2)
            else "no limit in the robot file"
        )
        + f"; the smaller is {b.smaller}"
    )
    lines.append(_isotropic(b))
    lines.append(f"recommended {b.recommended_m_s2:.4g} m/s² in any direction, slip margin {b.margin:g}")
    lines.append(
        f"braking     {np.min(full.braking_m_s2):.4g} to {np.max(full.braking_m_s2):.4g} m/s²; turning at "
        f"speed {np.min(full.turning_m_s2):.4g} to {np.max(full.turning_m_s2):.4g} m/s²"
    )
    lines.append(
        f"spinning    up {b.spin.starting_rad_s2:.4g} rad/s², down {b.spin.braking_rad_s2:.4g} rad/s² "
        "(with the margin)"
    )
    lines.append(_steady(b))
    lines += _sets(b)
    return [*lines, "", *_table(b)] if table else lines


def _isotropic(b: Bounds) -> str:
    least = b.traction_m_s2
    if least <= 0.0:
        return f"isotropic   μ g = {b.isotropic_m_s2:.4g} m/s², where the robot slips at constant speed"
    return (
        f"isotropic   μ g = {b.isotropic_m_s2:.4g} m/s², {b.isotropic_m_s2 / least:.3g} times what the "
        "weakest "
        f"direction holds"
    )


def _steady(b: Bounds) -> str:
    spent = int(np.count_nonzero(np.isinf(b.full.steady_use)))
    if spent:
        return (
            f"steady      constant speed must slip in {spent} of {len(b.full.steady_use)} directions: "
            "drag uses the whole grip of a wheel and leaves none to drive"
        )
    use = f"constant speed uses up to {100 * np.max(b.full.steady_use):.0f} % of the grip"
    rigid = b.rigid_use
    if np.max(rigid) <= np.max(b.full.steady_use) * (1.0 + 1e-9):
        return f"steady      {use}"
    if len(b.slipping_rad) == len(rigid):
        return f"steady      {use}; on rigid sectors it must slip in every direction"
    if len(b.slipping_rad):
        return (
            f"steady      {use}; on rigid sectors it must slip in {len(b.slipping_rad)} of {len(rigid)} "
            f"directions"
        )
    return f"steady      {use}, on rigid sectors up to {100 * np.max(rigid):.0f} %"


def _sets(b: Bounds) -> list[str]:
    s = b.inside
    if s is None:
        return [f"box         none: {b.why_not}"]
    return [
        f"box         speed up {_three(s.fast)}, slow down {_three(s.slow)}"
        " (right, forward m/s², yaw rad/s²)",
        f"ellipsoid   {s.circle_m_s2:.4g} m/s² in any direction of motion and of acceleration",
    ]


def _table(b: Bounds) -> list[str]:
    head = ["direction", "speed up", "turn", "brake [m/s²]", "steady use", "limited by"]
    pick = range(0, len(b.full.heading_rad), max(1, len(b.full.heading_rad) // 24))
    rows = [
        [
            _deg(b.full.heading_rad[k]),
            f"{b.full.starting_m_s2[k]:.4f}",
            f"{b.full.turning_m_s2[k]:.4f}",
            f"{b.full.braking_m_s2[k]:.4f}",
            f"{b.full.steady_use[k]:.3f}",
            f"{b.full.starting.cause[k]}: {'+'.join(b.full.starting.wheels[k])}",
        ]
        for k in pick
    ]
    corner = columns(
        ["curvature [1/m]", "heading held [m/s]", "along the path [m/s]"],
        [
            [f"{k:g}", f"{np.min(h):.3f} … {np.max(h):.3f}", f"{np.min(t):.3f} … {np.max(t):.3f}"]
            for k, h, t in zip(
                b.cornering.curvature_per_m, b.cornering.held_m_s, b.cornering.tangent_m_s, strict=True
            )
        ],
    )
    return [*columns(head, rows), "", *corner]


def _three(values: Any) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in values) + ")"


def _deg(rad: float) -> str:
    return f"{math.degrees(rad) + 0.0:.4g}°"
