"""The words of motion limits: the answer in a few lines, and the tables by direction and by curvature."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.limits.bounds_summary import Bounds
from slipmargin.report.text import columns, degrees


def answer(b: Bounds) -> list[str]:
    """Lines of the answer; the first four are traction, motor, isotropic and recommended."""
    full, lines = b.full, []
    weak, strong = int(np.argmin(full.starting_m_s2)), int(np.argmax(full.starting_m_s2))
    lines.append(
        f"traction    {b.traction_m_s2:.4g} m/s² in the weakest direction "
        f"({degrees(full.heading_rad[weak])}; {', '.join(full.starting.wheels[weak])}), "
        f"{full.starting_m_s2[strong]:.4g} m/s² in the "
        f"strongest ({degrees(full.heading_rad[strong])})"
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
    return lines + _sets(b)


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


def tables(b: Bounds) -> list[str]:
    """Limits by direction, then cornering speeds by curvature."""
    head = ["direction", "speed up", "turn", "brake [m/s²]", "steady use", "limited by"]
    pick = range(0, len(b.full.heading_rad), max(1, len(b.full.heading_rad) // 24))
    rows = [
        [
            degrees(b.full.heading_rad[k]),
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
