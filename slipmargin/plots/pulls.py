"""Figures of a diagnosis of pulls: measured and predicted force over the robot's orientation."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slipmargin.checks import Array
from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.pull_diagnosis import PullDiagnosis
from slipmargin.plots.limits_change import AFTER, BEFORE, limits_figure
from slipmargin.plots.style import GREY, INK, styled


def figures(diagnosis: PullDiagnosis, change: LimitsChange) -> dict[str, Figure]:
    """Every figure by name: pulls, and limits where effects were found that move them."""
    drawn = {"pulls": pulls_figure(diagnosis)}
    if diagnosis.findings and change.moved:
        drawn["limits"] = limits_figure(change)
    return drawn


@styled
def pulls_figure(diagnosis: PullDiagnosis) -> Figure:
    """Force over φ as measured and as predicted, and below it measured minus predicted in noise units."""
    d = diagnosis
    figure = Figure(figsize=(8.5, 5.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1.0))
    deg = np.rad2deg(np.mod(d.phi_rad, 2.0 * np.pi))
    above.plot(deg, d.force_N, "o", ms=4.5, color=INK, label="measured", zorder=4)
    _prediction(above, deg, d.before_N, BEFORE, "as believed", "s")
    if d.findings:
        _prediction(above, deg, d.after_N, AFTER, "corrected (orientation left out)", "D")
    above.set(ylabel="pull [N]", title="Pull before a wheel slips, measured and predicted")
    above.legend(loc="best")
    below.axhspan(-2.0, 2.0, color=GREY, alpha=0.15, lw=0)
    below.plot(deg, (d.force_N - d.before_N) / d.sigma_N, "s", ms=3.5, mfc="none", color=BEFORE)
    if d.findings:
        below.plot(deg, (d.force_N - d.after_N) / d.sigma_N, "D", ms=3.5, color=AFTER)
    below.set(ylabel="measured −\npredicted [σ]", xlabel="orientation φ of the robot [deg]")
    return figure


def _prediction(axes: Axes, deg: Array, force_N: Array, colour: str, label: str, marker: str) -> None:
    order = np.argsort(deg, kind="stable")
    axes.plot(
        deg[order], force_N[order], marker=marker, ms=3.5, lw=1.0, alpha=0.85, color=colour, label=label
    )
