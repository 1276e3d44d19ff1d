"""Figs 6, 7, 9 and 10: displacements and sliding speeds over time, the path over the floor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slipmargin.checks import Array
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, PANEL, WHEELS, below, styled
from slipmargin.sim.run import Run


@styled
def run_figure(run: Run, title: str) -> Figure:
    """Displacements x, y [m], φ [rad] beside the drive sliding speeds of the wheels [m/s] (Figs 6 and 9)."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    figure.suptitle(title, fontsize=11, x=0.01, ha="left")
    left, right = figure.subplots(1, 2)
    draw_motion(left, run)
    draw_slip(right, run)
    return figure


@styled
def run_panels(run: Run) -> dict[str, Figure]:
    """The two panels, each a figure of its own."""
    motion, slip = (Figure(figsize=PANEL, layout="constrained") for _ in range(2))
    draw_motion(motion.add_subplot(), run)
    draw_slip(slip.add_subplot(), run)
    return {"motion": motion, "slip": slip}


def draw_motion(axes: Axes, run: Run) -> Axes:
    """Displacements x, y [m] and heading φ [rad] over time."""
    for k, (name, colour) in enumerate(
        zip(("x [m]", "y [m]", "φ [rad]"), (BLUE, ORANGE, GREEN), strict=True)
    ):
        axes.plot(run.t_s, run.pose[:, k], color=colour, label=name, lw=(4.2, 2.8, 1.4)[k])
    axes.axhline(0.0, color=GREY, lw=0.8)
    axes.set(xlabel="time [s]", ylabel="displacement [m], heading [rad]", title="Displacements")
    below(axes, 3)
    return axes


def draw_slip(axes: Axes, run: Run) -> Axes:
    """Sliding speed of each wheel along its drive direction [m/s] over time."""
    for i, name in enumerate(run.wheels):  # wheels that slide alike must all be seen
        axes.plot(
            run.t_s,
            run.slip[:, i, 0],
            color=WHEELS[i % len(WHEELS)],
            label=f"wheel {name}",
            lw=1.2 + 1.6 * (len(run.wheels) - 1 - i),
        )
    axes.set(xlabel="time [s]", ylabel="sliding speed, drive direction [m/s]", title="Drive slip")
    below(axes, 2)
    return axes


@styled
def path_figure(
    paths: Mapping[str, Run], title: str, goal: tuple[float, float], notes: Sequence[str] = ()
) -> Figure:
    """y over x on each surface (Figs 7 and 10); the goal is marked, measured points are not invented.

    Parameters
    ----------
    paths : panel title → run.
    goal : where the robot was told to go [m].
    notes : one line under each panel, what was measured there.
    """
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    figure.suptitle(title, fontsize=11, x=0.01, ha="left")
    panels = figure.subplots(1, len(paths), squeeze=False)[0]
    for k, (axes, (name, run)) in enumerate(zip(panels, paths.items(), strict=True)):
        axes.plot(run.pose[:, 0], run.pose[:, 1], color=BLUE, ls="--", label="simulated")
        _headings(axes, run)
        axes.plot(*goal, marker="+", ms=11, color=INK, ls="none", label="commanded end")
        low = min(-0.06, float(np.min(run.pose[:, 1])) - 0.01)
        axes.set(xlabel="x [m]", ylabel="y [m]", title=name, ylim=(low, 0.06), xlim=(-0.02, 0.44))
        axes.legend(loc="upper left")
        if k < len(notes):
            axes.annotate(notes[k], (0.01, 0.02), xycoords="axes fraction", color=GREY, fontsize=8.0)
    return figure


def _headings(axes: Axes, run: Run) -> None:
    """A short arrow along the robot's X every half second."""
    marks = np.searchsorted(run.t_s, np.arange(run.t_s[0], run.t_s[-1] + 1e-9, 0.5))
    marks = marks[marks < len(run.t_s)]
    pose = run.pose[marks]
    axes.quiver(
        pose[:, 0],
        pose[:, 1],
        np.cos(pose[:, 2]),
        np.sin(pose[:, 2]),
        color=ORANGE,
        width=0.004,
        scale=22.0,
        zorder=3,
    )


@styled
def spread_figure(
    ends: Mapping[str, Array], published: Mapping[str, Sequence[float]], goal_m: float
) -> Figure:
    """Where runs end from random rotor angles: y and φ over x, one colour a surface, mean marked.

    Parameters
    ----------
    ends : surface → end poses (R, 3).
    published : surface → headings that the paper measured or printed [rad], drawn as lines.
    """
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    figure.suptitle(
        "Random rotor angles: why the same command does not repeat", fontsize=11, x=0.01, ha="left"
    )
    left, right = figure.subplots(1, 2)
    for colour, (surface, end) in zip((BLUE, ORANGE, GREEN), ends.items(), strict=False):
        for axes, k in ((left, 1), (right, 2)):
            axes.scatter(
                end[:, 0], end[:, k], s=4, color=colour, alpha=0.35, lw=0, label=f"{surface}, {len(end)} runs"
            )
            axes.plot(
                end[:, 0].mean(), end[:, k].mean(), marker="o", mfc="white", mec=colour, ms=7, ls="none"
            )
        for value in published.get(surface, ()):
            right.axhline(value, color=colour, lw=0.9, ls=":")
    for axes, label in (
        (left, "y at the end [m]"),
        (right, "φ at the end [rad]; dotted: printed in the paper"),
    ):
        axes.axvline(goal_m, color=GREY, lw=0.8)
        axes.set(xlabel="x at the end [m]", ylabel=label)
        axes.legend(loc="best", markerscale=3)
    return figure
