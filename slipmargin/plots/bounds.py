"""Limits of motion by direction: polar plots as the robot sees them, forwards up."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from slipmargin.checks import Array
from slipmargin.limits.bounds_summary import Bounds
from slipmargin.limits.motion_rows import CAUSES, TIPS
from slipmargin.plots.polar import forwards_up, polar_axes
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, PANEL, RED, SKY, styled


@styled
def bounds_figure(found: Bounds) -> Figure:
    """Acceleration limits, the grip that constant speed needs, and cornering speed."""
    found = found.everywhere
    figure = Figure(figsize=(14.0, 5.0), layout="constrained")
    grid = figure.add_gridspec(1, 3, width_ratios=(1.1, 1.1, 1.0))
    for k, draw in enumerate((draw_limits, draw_steady)):
        draw(polar_axes(figure, grid[k]), found)
    draw_cornering(figure.add_subplot(grid[2]), found)
    return figure


@styled
def bounds_panels(found: Bounds) -> dict[str, Figure]:
    """The three panels, each a figure of its own."""
    found = found.everywhere
    limits, steady, corner = (Figure(figsize=PANEL, layout="constrained") for _ in range(3))
    draw_limits(polar_axes(limits), found)
    draw_steady(polar_axes(steady), found)
    draw_cornering(corner.add_subplot(), found)
    return {"limits": limits, "steady": steady, "cornering": corner}


def draw_limits(axes: PolarAxes, found: Bounds) -> PolarAxes:
    """Speeding up, turning and braking [m/s²] over the direction of motion."""
    full = found.full
    angle = found.model.convention.from_front(_round(full.heading_rad))
    for values, colour, label in (
        (full.braking_m_s2, GREEN, "braking"),
        (full.starting_m_s2, BLUE, "speeding up"),
        (full.turning_m_s2, ORANGE, "turning at speed"),  # often the same: dashes let it be seen
    ):
        held = np.where(np.isfinite(values) & (values > 0.0), values, np.nan)
        if np.all(np.isnan(held)):
            continue
        alone = np.isnan(np.roll(held, 1)) & np.isnan(np.roll(held, -1))
        axes.plot(angle, _shut(held), color=colour, label=label, ls=(0, (4, 3)) if colour == ORANGE else "-")
        if np.any(alone & np.isfinite(held)):  # a single direction has no line
            axes.plot(angle[:-1][alone], held[alone], color=colour, marker="o", ms=4, ls="none")
    if np.any(found.safe.starting_m_s2 > 0.0):
        axes.fill(
            angle,
            _shut(np.maximum(found.safe.starting_m_s2, 0.0)),
            color=SKY,
            alpha=0.3,
            lw=0,
            label=f"speeding up with margin {found.margin:g}",
        )
    tips = np.array([cause == CAUSES[TIPS] for cause in full.starting.cause])
    if np.any(tips):
        on = np.where(tips, np.maximum(full.starting_m_s2, 0.0), np.nan)
        axes.plot(angle, _shut(on), color=RED, lw=3.0, alpha=0.6, label="tips")
    must_slip, where = full.steady_use > 1.0, " on rigid sectors" if found.on_rigid_sectors else ""
    title = (
        f"{found.model.robot} on “{found.model.surface}”:\nacceleration limit [m/s²] by direction of motion"
    )
    if np.any(must_slip):
        title += f"\nmust slip{where} in {np.sum(must_slip)} of {len(must_slip)} directions"
    axes.set_title(title, pad=18)
    forwards_up(axes)
    axes.tick_params(axis="y", labelsize=8, labelcolor=GREY)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    return axes


def draw_steady(axes: PolarAxes, found: Bounds) -> PolarAxes:
    """Share of the grip that constant speed needs: on rollers and in the worst state of rigid sectors."""
    angle, rigid = found.model.convention.from_front(_round(found.full.heading_rad)), found.rigid_use
    both = np.concatenate([rigid, found.full.steady_use])
    top = 1.15 * float(np.max(both, where=np.isfinite(both), initial=1.0))
    axes.fill_between(angle, np.ones_like(angle), top, color=RED, alpha=0.10, lw=0)
    axes.plot(angle, np.ones_like(angle), color=RED, lw=1.0, label="outside it must slip")
    if float(np.max(rigid)) > float(np.max(found.full.steady_use)) * (1.0 + 1e-9):
        axes.plot(angle, _shut(rigid), color=INK, label="worst roller/rigid state")
    contact = "worst roller/rigid state" if found.on_rigid_sectors else "all wheels on rollers"
    axes.plot(angle, _shut(found.full.steady_use), color=BLUE, label=contact)
    axes.set_title("Share of the grip that constant speed needs\nby direction of motion", pad=18)
    axes.set_ylim(0.0, top)
    forwards_up(axes)
    axes.tick_params(axis="y", labelsize=8, labelcolor=GREY)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    return axes


def draw_cornering(axes: Axes, found: Bounds) -> Axes:
    """Fastest steady cornering [m/s] over curvature [1/m], from the slowest to the fastest heading."""
    corner = found.cornering
    k = corner.curvature_per_m
    lines = [(corner.held_m_s, BLUE, "heading held"), (corner.tangent_m_s, ORANGE, "turning with the path")]
    if np.allclose(corner.held_m_s, corner.tangent_m_s, rtol=1e-3):
        lines = [(corner.held_m_s, BLUE, "heading held or turning")]
    for values, colour, label in lines:
        shown = np.where(np.isfinite(values), values, np.nan)
        if np.all(np.isnan(shown)):
            continue
        axes.fill_between(
            k, np.nanmin(shown, axis=1), np.nanmax(shown, axis=1), color=colour, alpha=0.18, lw=0
        )
        axes.plot(k, np.nanmin(shown, axis=1), color=colour, label=f"{label}: worst heading")
        axes.plot(k, np.nanmax(shown, axis=1), color=colour, lw=1.0, ls=(0, (4, 2)), label=f"{label}: best")
    if not np.any(corner.held_m_s > 0.0) and not np.any(corner.tangent_m_s > 0.0):
        axes.text(0.5, 0.5, "none: it must slip at constant speed", ha="center", transform=axes.transAxes)
    axes.set(
        xlabel="curvature [1/m]",
        ylabel="cornering speed [m/s]",
        xscale="log",
        ylim=(0.0, None),
        title=f"Cornering, slip margin {found.margin:g}",
    )
    axes.set_xticks(k, [f"{v:g}" for v in k])
    axes.minorticks_off()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    return axes


def _round(angle: Array) -> Array:
    return np.append(angle, angle[0] + 2.0 * np.pi)


def _shut(values: Array) -> Array:
    return np.append(values, values[0])
