"""The words of ``slipmargin sweep``: four lines of answer, one of proof, and the table."""

from __future__ import annotations

import math

import numpy as np

from .render import columns
from .sweep_run import SweepRun


def report(run: SweepRun, *, table: bool) -> list[str]:
    """Lines for stdout; the first four are the answer."""
    lines = [*_answer(run), _proof(run)]
    if run.pulls is not None:
        gap = run.measured()["residual_N"]
        gap = gap[np.isfinite(gap)]
        outside = f", {run.outside} pulls outside --from … --to left out" if run.outside else ""
        lines.append(
            f"measured    {int(run.pulls.count.sum())} pulls at {len(gap)} orientations: residual "
            f"{gap.mean():+.2f} N on average, {np.sqrt(np.mean(gap**2)):.2f} N root mean square "
            f"(measured minus all on rollers){outside}"
        )
    return [*lines, "", *_table(run)] if table else lines


def _answer(run: SweepRun) -> list[str]:
    sweep, weight = run.sweep, run.weight_N
    (weak, least), (strong, most) = sweep.weakest, sweep.strongest
    at = int(np.argmin(sweep.f_max_N))
    claim = run.isotropic
    excess = claim.force_N / least - 1.0 if least > 0.0 else math.inf
    return [
        f"weakest     {least:.2f} N ({least / weight:.4f} m g) at φ = {_deg(weak)}; "
        f"slipping: {', '.join(run.limiting[at])}",
        f"strongest   {most:.2f} N ({most / weight:.4f} m g) at φ = {_deg(strong)}",
        f"isotropic   {claim.force_N:.2f} N (μ m g with μ = {claim.coefficient:.3g}), {_too_much(excess)}",
        f"recommended {run.recommended_N:.2f} N: a margin of {100 * run.margin:g} % below "
        f"{float(np.min(sweep.f_low_N)):.2f} N, the lowest over roller and rigid",
    ]


def _too_much(excess: float) -> str:
    if math.isinf(excess):
        return "where the robot slips by itself"
    way = "more" if excess >= 0 else "less"
    return f"{100 * abs(excess):.0f} % {way} than the weakest direction holds"


def _proof(run: SweepRun) -> str:
    other = "the support function" if run.method in ("facets", "cones") else "facets"
    return f"self-check  {run.method} against {other}: {run.check:.0e} relative"


def _deg(rad: float) -> str:
    return f"{math.degrees(rad) + 0.0:.4g}°"


def _table(run: SweepRun) -> list[str]:
    s = run.sweep
    head = ["φ [deg]", "F_max [N]", "low [N]", "high [N]"]
    cells = [
        [f"{math.degrees(p) + 0.0:.6g}" for p in s.phi_rad],
        *([f"{v:.3f}" for v in column] for column in (s.f_max_N, s.f_low_N, s.f_high_N)),
    ]
    for name, column in run.measured().items():
        unit = "" if name == "pulls" else " [N]"
        head.append(name.removesuffix("_N") + unit)
        form = "{:.0f}" if name == "pulls" else "{:+.3f}" if name == "residual_N" else "{:.3f}"
        cells.append(["" if math.isnan(v) else form.format(v) for v in column])
    head.append("slipping")
    cells.append(["+".join(names) for names in run.limiting])
    return columns(head, zip(*cells, strict=True))
