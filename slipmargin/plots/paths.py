"""A plan and an audit as figures: the path by limiting wheel, speed under its limit, use per wheel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from slipmargin.model import Model
from slipmargin.paths.check import Check
from slipmargin.paths.plan import Plan
from slipmargin.paths.trajectory import NEAR, TIED, Trajectory
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import directions
from slipmargin.plots.style import BLUE, GREY, INK, PALE, PANEL, RED, WHEELS, below, outside, styled

_DASHES = ("-", (0, (4, 1.5)), (0, (1, 1)))


@styled
def plan_figure(plan: Plan, rows: Trajectory) -> Figure:
    """Path coloured by limiting wheel, speed profile under its limit curve, use of every wheel over time."""
    figure = Figure(figsize=(11.0, 6.8), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.15))
    _plan_path(figure.add_subplot(grid[:, 0]), plan, rows)
    _profile(figure.add_subplot(grid[0, 1]), plan)
    _use(figure.add_subplot(grid[1, 1]), rows, plan.request.share, "Grip that each wheel uses")
    return figure


@styled
def plan_panels(plan: Plan, rows: Trajectory) -> dict[str, Figure]:
    """The three panels, each a figure of its own."""
    path, speed, use = (Figure(figsize=PANEL, layout="constrained") for _ in range(3))
    _plan_path(path.add_subplot(), plan, rows)
    _profile(speed.add_subplot(), plan)
    _use(use.add_subplot(), rows, plan.request.share, "Grip that each wheel uses")
    return {"path": path, "speed": speed, "use": use}


@styled
def check_figure(model: Model, found: Check, rows: Trajectory) -> Figure:
    """Path coloured by the wheel that uses most, use of every wheel over time, and the worst point."""
    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.3))
    _check_path(figure.add_subplot(grid[0]), model, found, rows)
    _check_use(figure.add_subplot(grid[1]), found, rows)
    return figure


@styled
def check_panels(model: Model, found: Check, rows: Trajectory) -> dict[str, Figure]:
    """The two panels, each a figure of its own."""
    path, use = (Figure(figsize=PANEL, layout="constrained") for _ in range(2))
    _check_path(path.add_subplot(), model, found, rows)
    _check_use(use.add_subplot(), found, rows)
    return {"path": path, "use": use}


def _plan_path(axes: Axes, plan: Plan, rows: Trajectory) -> None:
    title = f"{plan.model.robot} on “{plan.model.surface}”: {plan.duration_s:.3f} s"
    _path(axes, rows, plan.request.share, title, plan.model.convention)


def _check_path(axes: Axes, model: Model, found: Check, rows: Trajectory) -> None:
    verdict = "within what is allowed" if found.admissible else "asks more than is allowed"
    _, x, y, k = found.worst
    ring: dict[str, Any] = {"marker": "o", "ms": 9, "mfc": "none", "mec": RED, "mew": 1.6, "ls": "none"}
    worst = Line2D([], [], label=f"worst: {model.geometry.names[k]}, {found.max_use:.3g}", **ring)
    title = f"{model.robot} on “{model.surface}”: {verdict}"
    _path(axes, rows, found.share, title, model.convention, [worst])
    axes.plot([x], [y], zorder=5, **ring)


def _check_use(axes: Axes, found: Check, rows: Trajectory) -> None:
    cure = found.time_scale_needed
    words = (
        ""
        if found.admissible
        else ": slowing down is no cure"
        if not np.isfinite(cure)
        else f": stretch time by {cure:.4g}"
    )
    _use(axes, rows, found.share, f"Grip that each wheel needs{words}")
    axes.plot([found.worst[0]], [found.max_use], marker="o", ms=9, mfc="none", mec=RED, mew=1.6, ls="none")


def _path(
    axes: Axes,
    rows: Trajectory,
    share: float,
    title: str,
    convention: Convention,
    more: Sequence[Line2D] = (),
) -> None:
    kinds, who = np.unique(limiting(rows, share), axis=0, return_inverse=True)
    tones = _tones(kinds)
    points = rows.pose[:, :2]
    segments = np.stack([points[:-1], points[1:]], axis=1)
    colours = [tones[int(k)] for k in who.ravel()[:-1]]
    axes.add_collection(LineCollection(list(segments), colors=colours, linewidths=3.2, capstyle="round"))
    span = max(float(np.ptp(points[:, 0])), float(np.ptp(points[:, 1])), 1e-3)
    at = np.linspace(0, len(points) - 1, 13).astype(int)
    front = directions(convention.yaw_of_phi(rows.pose[at, 2]))
    axes.quiver(
        points[at, 0],
        points[at, 1],
        front[:, 0],
        front[:, 1],
        color=INK,
        angles="xy",
        scale_units="xy",
        scale=14.0 / span,
        width=0.004,
        headwidth=4.0,
        zorder=4,
    )
    axes.plot(*points[0], marker="o", ms=6, color=INK, zorder=5)
    marks = [
        Line2D([], [], color=tone, lw=3.2, label=_named(rows.wheels, near))
        for tone, near in zip(tones, kinds, strict=True)
        if np.any(near)
    ]
    marks.append(Line2D([], [], color=GREY, lw=3.2, label="no wheel near its limit of grip"))
    marks.append(Line2D([], [], color=INK, lw=0, marker=">", ms=7, label="front of the robot"))
    marks.append(Line2D([], [], color=INK, lw=0, marker="o", ms=6, label="start"))
    marks += more
    figure = axes.get_figure(root=True)
    assert isinstance(figure, Figure)
    outside(figure, marks)
    axes.set(xlabel="x [m]", ylabel="y [m]", title=title)
    low, high = points.min(axis=0), points.max(axis=0)
    half = np.maximum(0.5 * (high - low) + 0.12 * span, 0.45 * span)
    axes.update_datalim(np.stack([0.5 * (low + high) - half, 0.5 * (low + high) + half]))
    axes.margins(0.0)
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.locator_params(nbins=5)


def _profile(axes: Axes, plan: Plan) -> None:
    along = plan.profile()
    s, speed = along.way_m, along.speed_m_s
    highest = np.minimum(along.highest_m_s, 100.0)
    top = 1.25 * float(np.max(speed))
    axes.fill_between(s, np.minimum(highest, top), top, color=PALE, lw=0)
    axes.plot(
        s,
        np.where(highest <= top, highest, np.nan),
        color=GREY,
        lw=1.2,
        label="highest from which the rest can be driven",
    )
    axes.plot(s, speed, color=BLUE, label="planned")
    axes.set(
        xlabel="way, turning counted at the wheels [m]",
        ylabel="speed, turning counted [m/s]",
        ylim=(0.0, top),
        xlim=(s[0], s[-1]),
        title="Speed under its limit",
    )
    below(axes, 2)


def _use(axes: Axes, rows: Trajectory, share: float, title: str) -> None:
    for k, name in enumerate(rows.wheels):
        axes.plot(
            rows.t_s,
            rows.use[:, k],
            color=WHEELS[k % len(WHEELS)],
            lw=1.4,
            ls=_DASHES[k // len(WHEELS) % len(_DASHES)],
            label=name,
        )
    axes.axhline(share, color=INK, lw=1.0, ls=(0, (6, 3)))
    axes.annotate(
        f"allowed: {share:g}",
        (rows.t_s[-1], share),
        xytext=(-2, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        fontsize=8.5,
        color=INK,
        zorder=6,
        bbox={"fc": "white", "ec": "none", "pad": 0.8, "alpha": 0.85},
    )
    axes.set(
        xlabel="time [s]",
        ylabel="share of the wheel's grip [1]",
        xlim=(rows.t_s[0], rows.t_s[-1]),
        ylim=(0.0, max(1.12 * share, 1.08 * float(np.max(rows.use)))),
        title=title,
    )
    below(axes, 4)


def limiting(rows: Trajectory, share: float) -> NDArray[np.bool_]:
    """(T, N) the wheel near its limit at every sample, of several all that tie; none where none is near."""
    most = rows.use.max(axis=1, keepdims=True)
    return np.asarray((most > NEAR * share) & (rows.use >= (1.0 - TIED) * most))


def _tones(kinds: NDArray[np.bool_]) -> list[str]:
    """A colour for each set of wheels (K, N): a wheel's own, for several together one that no wheel has."""
    together = iter(range(kinds.shape[1], kinds.shape[1] + len(kinds)))
    numbers = [int(np.argmax(near)) if near.sum() == 1 else next(together) for near in kinds]
    return [WHEELS[k % len(WHEELS)] if np.any(near) else GREY for k, near in zip(numbers, kinds, strict=True)]


def _named(wheels: Sequence[str], near: NDArray[np.bool_]) -> str:
    if np.all(near):
        return "all wheels"
    return f"wheel{'s' if near.sum() > 1 else ''} {', '.join(np.array(wheels)[near])}"
