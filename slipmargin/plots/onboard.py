"""Pictures of what runs on the robot: stopping distances by direction, and a monitored log."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from slipmargin.checks import Array
from slipmargin.physics.convention import Convention
from slipmargin.plots.polar import forwards_up, polar_axes
from slipmargin.plots.style import GREY, INK, PANEL, RED, WHEELS, styled


@styled
def stop_figure(heading_rad: Array, speed_m_s: Array, distance_m: Array, convention: Convention) -> Figure:
    """Stopping distance [m] (H, S) over the direction of motion, a curve a speed."""
    figure = Figure(figsize=PANEL, layout="constrained")
    axes = polar_axes(figure)
    angle = convention.from_front(np.append(heading_rad, heading_rad[0] + 2.0 * np.pi))
    for k, speed in enumerate(speed_m_s):
        far = np.append(distance_m[:, k], distance_m[0, k])
        axes.plot(angle, far, color=WHEELS[k % len(WHEELS)], label=f"from {speed:.3g} m/s")
    axes.set_title("Stopping distance [m] by direction of motion", pad=18)
    forwards_up(axes)
    axes.set_rmin(0.0)
    axes.tick_params(axis="y", labelsize=8, labelcolor=GREY)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3)
    return figure


@styled
def monitor_figure(t_s: Array, probability: Array, events: Sequence[tuple[float, float]]) -> Figure:
    """Slip probability over time, the events shaded."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    axes = figure.add_subplot()
    step = float(np.median(np.diff(t_s))) if len(t_s) > 1 else 1.0
    for k, (start, end) in enumerate(events):
        axes.axvspan(start, end + step, color=RED, alpha=0.2, lw=0, label=None if k else "alarm")
    axes.plot(t_s, probability, color=INK, lw=0.9)
    axes.set(xlabel="time [s]", ylabel="slip probability", ylim=(0.0, 1.02))
    if events:
        axes.legend(loc="upper right")
    return figure
