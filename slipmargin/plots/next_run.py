"""Proposed runs on the floor."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle

from slipmargin.experiment.result import NextRuns
from slipmargin.plots.style import BLUE, GREY, INK, PALE, RED, outside, styled

#: Headings that are drawn along a path.
_MARKS = 8
#: Width of a floor on paper, and height of a row of what its lines mean [inch].
_WIDE, _ROW = 2.6, 0.25
#: The path that is asked for, and those by the two best explanations.
_ASKED: dict[str, Any] = {"color": BLUE, "lw": 1.6}
_EXPLAINED: tuple[dict[str, Any], ...] = (
    {"color": RED, "lw": 0.9, "ls": ":"},
    {"color": INK, "lw": 0.9, "ls": "--"},
)


@styled
def next_runs_figure(found: NextRuns) -> Figure:
    """Each run from above: its path, the robot's circle at the start, headings along the way."""
    assert found.space is not None
    count = max(1, len(found.runs))
    columns = min(3, count)
    rows = -(-count // columns)
    (x, y), (a, b) = found.space.middle_m, found.space.size_m
    tall = min(6.0, 0.9 + _WIDE * b / a)  # title and axis, and the floor as it is
    drawn = max((len(run.predicted[: len(_EXPLAINED)]) for run in found.runs), default=0)
    legend = _ROW * -(-(3 + drawn) // columns)
    figure = Figure(figsize=((_WIDE + 0.8) * columns, tall * rows + legend), layout="constrained")
    panels = np.atleast_1d(figure.subplots(rows, columns, squeeze=False)).ravel()
    for axes in panels[count:]:
        axes.set_axis_off()
    for axes, run in zip(panels, found.runs, strict=False):
        axes.add_patch(Rectangle((x - 0.5 * a, y - 0.5 * b), a, b, fill=False, ec=GREY, lw=1.2))
        pose = run.trajectory.pose
        for there, style in zip(run.predicted, _EXPLAINED, strict=False):
            axes.plot(there[:, 0], there[:, 1], **style)
        axes.plot(pose[:, 0], pose[:, 1], **_ASKED)
        axes.add_patch(
            Circle((float(pose[0, 0]), float(pose[0, 1])), found.reach_m, fc=PALE, ec=INK, lw=0.8, alpha=0.6)
        )
        marks = np.linspace(0, len(pose) - 1, _MARKS).astype(int)
        axes.quiver(
            pose[marks, 0],
            pose[marks, 1],
            np.cos(pose[marks, 2] + found.front_rad),
            np.sin(pose[marks, 2] + found.front_rad),
            color=BLUE,
            width=0.006,
            scale=16.0,
        )
        axes.plot(*pose[0, :2], "o", color=INK, ms=4)
        axes.set(
            title=f"{run.name}: {run.trajectory.duration_s:.3g} s",
            xlabel="x [m]",
            ylabel="y [m]",
            aspect="equal",
        )
        axes.margins(0.06)
    named = [
        Line2D([], [], label="path to drive, arrows where the front looks", **_ASKED),
        Line2D([], [], color=INK, marker="o", ms=4, ls="none", label="start, and the circle of the wheels"),
        *(
            Line2D([], [], label=f"where it goes if {name} is right", **style)
            for name, style in zip(found.explanations[:drawn], _EXPLAINED, strict=False)
        ),
        Line2D([], [], color=GREY, lw=1.2, label="floor"),
    ]
    outside(figure, named, columns)
    return figure
