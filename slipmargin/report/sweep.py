"""The words of a sweep: four lines of answer, one of proof, and the table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits import Isotropic, Sweep
from slipmargin.limits.uncertainty import SlipChance
from slipmargin.report.text import ROWS, columns, degrees, left_out, thinned


def answer(
    sweep: Sweep,
    limiting: Sequence[Sequence[str]],
    claim: Isotropic,
    weight_N: float,
    recommended_N: float,
    margin: float,
) -> list[str]:
    """Weakest and strongest orientation, what one coefficient would claim, and the recommended pull."""
    (weak, least), (strong, most) = sweep.weakest, sweep.strongest
    at = int(np.argmin(sweep.f_max_N))
    excess = claim.force_N / least - 1.0 if least > 0.0 else math.inf
    return [
        f"weakest     {least:.2f} N ({least / weight_N:.4f} m g) at φ = {degrees(weak)}; "
        f"slipping: {', '.join(limiting[at])}",
        f"strongest   {most:.2f} N ({most / weight_N:.4f} m g) at φ = {degrees(strong)}",
        f"isotropic   {claim.force_N:.2f} N (μ m g with μ = {claim.coefficient:.3g}), {_too_much(excess)}",
        f"recommended {recommended_N:.2f} N: a margin of {100 * margin:g} % below "
        f"{float(np.min(sweep.f_low_N)):.2f} N, the lowest over roller and rigid{_and_loads(sweep)}",
    ]


def _and_loads(sweep: Sweep) -> str:
    return " and over the loads of an uneven floor" if len(sweep.model.loads.uneven_N) else ""


def _too_much(excess: float) -> str:
    if math.isinf(excess):
        return "where the robot slips by itself"
    way = "more" if excess >= 0 else "less"
    return f"{100 * abs(excess):.0f} % {way} than the weakest direction holds"


def proof(method: str, difference: float) -> str:
    """How far two methods differ."""
    other = "the support function" if method in ("facets", "cones") else "facets"
    return f"two methods ({method}, {other}) differ by {difference:.0e} of the pull"


def chance_line(found: SlipChance, recommended: float, unit: str) -> str:
    """The chance of slip at the recommended number, and the number for the chosen chance."""
    share = found.at_recommended
    form, least = (".2f", "the least pull") if unit == "N" else (".4g", "constant speed")

    def at(value: float) -> str:
        return f"{value:{form}} {unit}" if value > 0.0 else least

    # No slip in n draws: with 95 % confidence the chance is below 3/n.
    said = f"{100 * share:.3g} %" if share > 0.0 else f"below {300 / found.draws:.2g} %"
    return (
        f"chance      {said} of {found.draws} draws of the uncertain numbers slip at {at(recommended)}; "
        f"{100 * found.chance:g} % slip at {at(found.value)}"
    )


def measured_line(residual_N: Array, pulls: int, outside: int) -> str:
    """Measured pulls against the limit on rollers."""
    gap = residual_N[np.isfinite(residual_N)]
    left = f", {outside} pulls outside --from … --to left out" if outside else ""
    return (
        f"measured    {pulls} pulls at {len(gap)} orientations: residual {gap.mean():+.2f} N on average, "
        f"{np.sqrt(np.mean(gap**2)):.2f} N root mean square (measured minus all on rollers){left}"
    )


def table(sweep: Sweep, limiting: Sequence[Sequence[str]], measured: Mapping[str, Array]) -> list[str]:
    """A row an orientation, as many as a terminal shows; every measured one where pulls were measured."""
    most = max(ROWS, int(np.count_nonzero(_was_measured(measured))))
    head, shown = rows(sweep, limiting, measured, most)
    return [*columns(head, shown), *left_out(len(shown), len(sweep.phi_rad))]


def rows(
    sweep: Sweep, limiting: Sequence[Sequence[str]], measured: Mapping[str, Array], most: int
) -> tuple[list[str], list[list[str]]]:
    """Head and at most ``most`` rows: measured orientations, the weakest and the strongest, others evenly."""
    ends = [int(np.argmin(sweep.f_max_N)), int(np.argmax(sweep.f_max_N))]
    always = np.flatnonzero(_was_measured(measured)).tolist()
    pick = thinned(len(sweep.phi_rad), most, [*always, *ends][:most])
    head = ["φ [deg]", "on rollers [N]", "lowest [N]", "highest [N]"]
    cells = [
        [f"{math.degrees(p) + 0.0:.6g}" for p in sweep.phi_rad],
        *([f"{v:.3f}" for v in column] for column in (sweep.f_max_N, sweep.f_low_N, sweep.f_high_N)),
    ]
    for name, column in measured.items():
        unit = "" if name == "pulls" else " [N]"
        head.append(name.removesuffix("_N") + unit)
        form = "{:.0f}" if name == "pulls" else "{:+.3f}" if name == "residual_N" else "{:.3f}"
        cells.append(["" if math.isnan(v) else form.format(v) for v in column])
    head.append("slipping")
    cells.append(["+".join(names) for names in limiting])
    return head, [[column[k] for column in cells] for k in pick]


def _was_measured(measured: Mapping[str, Array]) -> Array:
    return np.isfinite(measured.get("measured_N", np.zeros(0)))
