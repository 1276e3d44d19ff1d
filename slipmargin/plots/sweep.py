"""Fig. 8 and its polar form: F_emax over the robot's orientation, with the band and measured pulls."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from slipmargin.data.pulls import PullGroups
from slipmargin.limits import Sweep
from slipmargin.plots.machine import draw_machine
from slipmargin.plots.polar import forwards_up, of_pull, polar_axes
from slipmargin.plots.style import BLUE, GREY, INK, PANEL, RED, SKY, below, styled


@styled
def sweep_figure(
    sweep: Sweep, circle: Sweep, pulls: PullGroups | None = None, recommended_N: float | None = None
) -> Figure:
    """Fig. 8's axes beside the polar plot.

    Parameters
    ----------
    sweep : the orientations asked for.
    circle : the same robot over all orientations, for the polar plot.
    """
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.15, 1.0))
    draw_sweep(figure.add_subplot(grid[0]), sweep, pulls, recommended_N)
    draw_polar(polar_axes(figure, grid[1]), circle, pulls)
    return figure


@styled
def sweep_panels(
    sweep: Sweep, circle: Sweep, pulls: PullGroups | None = None, recommended_N: float | None = None
) -> dict[str, Figure]:
    """The two panels, each a figure of its own."""
    line, polar = (Figure(figsize=PANEL, layout="constrained") for _ in range(2))
    draw_sweep(line.add_subplot(), sweep, pulls, recommended_N)
    draw_polar(polar_axes(polar), circle, pulls)
    return {"sweep": line, "polar": polar}


def draw_sweep(
    axes: Axes, sweep: Sweep, pulls: PullGroups | None = None, recommended_N: float | None = None
) -> Axes:
    """F_emax [N] over orientation [deg]: all on rollers, the band, measured means with their scatter."""
    deg = np.rad2deg(sweep.phi_rad)
    if np.any(sweep.f_high_N > sweep.f_low_N * (1 + 1e-9)):
        axes.fill_between(
            deg,
            sweep.f_low_N,
            sweep.f_high_N,
            color=SKY,
            alpha=0.3,
            lw=0,
            label="roller or rigid under each wheel",
        )
    axes.plot(deg, sweep.f_max_N, color=BLUE, label="all wheels on rollers")
    if pulls is not None:
        _scatter(axes, np.rad2deg(pulls.phi_rad), pulls)
    if recommended_N is not None and recommended_N > 0.0:
        axes.axhline(recommended_N, color=GREY, lw=1.0, ls=(0, (6, 3)))
        axes.annotate(
            f"recommended {recommended_N:.3g} N",
            (deg[-1], recommended_N),
            xytext=(-2, -4),
            textcoords="offset points",
            ha="right",
            va="top",
            color=GREY,
            fontsize=8.5,
        )
    axes.set(
        xlabel="orientation φ under a pull along the floor’s +x [deg]",
        ylabel="largest pull without slip [N]",
        ylim=(0, None),
        title=f"Pull before a wheel slips:\n{sweep.model.robot}, surface “{sweep.model.surface}”",
    )
    if len(deg) > 1:
        axes.set_xlim(deg[0], deg[-1])
        axes.locator_params(axis="x", steps=[1, 1.5, 3, 4.5, 9, 10])
    below(axes, 1 if pulls is None else 2)
    return axes


def draw_polar(axes: PolarAxes, circle: Sweep, pulls: PullGroups | None = None) -> PolarAxes:
    """The same over the direction of the pull as the robot sees it: up is forwards, radius in newtons.

    The legend has what the plot beside it does not explain.
    """
    angle = of_pull(circle.phi_rad, circle.model.convention)
    if np.any(circle.f_high_N > circle.f_low_N * (1 + 1e-9)):
        axes.fill_between(
            angle,
            circle.f_low_N,
            circle.f_high_N,
            color=SKY,
            alpha=0.3,
            lw=0,
            label="roller or rigid under each wheel",
        )
    axes.plot(angle, circle.f_max_N, color=BLUE, label="all wheels on rollers")
    phi, force = circle.weakest
    weakest = axes.plot(
        [float(of_pull(np.array(phi), circle.model.convention))],
        [force],
        marker="o",
        ms=5,
        mfc="white",
        mec=INK,
        ls="none",
        zorder=6,
        label=f"weakest: {force:.3g} N",
    )
    if pulls is not None:
        _scatter(axes, of_pull(pulls.phi_rad, circle.model.convention), pulls)
    axes.legend(handles=weakest, loc="lower left", bbox_to_anchor=(-0.12, -0.08))
    axes.set_ylim(0, 1.06 * float(np.max(circle.f_high_N)))
    forwards_up(axes)
    axes.set_title("By direction of the pull, seen from the robot [N]")
    inset = axes.inset_axes((0.385, 0.385, 0.23, 0.23))
    draw_machine(inset, circle.model, forwards_up=True)
    inset.set_aspect("equal")
    inset.margins(0.12)
    inset.set_axis_off()
    inset.patch.set_alpha(0.0)
    return axes


def _scatter(axes: Axes, at: np.ndarray[tuple[int, ...], np.dtype[np.float64]], pulls: PullGroups) -> None:
    spread = [pulls.mean_N - pulls.low_N, pulls.high_N - pulls.mean_N]
    axes.errorbar(
        at,
        pulls.mean_N,
        yerr=spread,
        fmt="o",
        ms=4.5,
        color=RED,
        ecolor=RED,
        elinewidth=1.2,
        capsize=2.5,
        label="measured: mean, least and greatest pull",
        zorder=5,
    )
