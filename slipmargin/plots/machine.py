"""A robot seen from above: wheels with numbers, drive directions, the front, the centre of mass."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from slipmargin.checks import Array
from slipmargin.model import Model
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import moment, to_floor
from slipmargin.plots.style import BLUE, GREY, INK, ORANGE, PALE, styled

#: What the arrow at a wheel means.
_ARROW = {
    Convention.PAPER: "drive direction ŝ: the contact’s way when θ̇ > 0",
    Convention.ROS: "drive direction: the robot’s way when θ̇ > 0",
}


@styled
def machine_figure(model: Model) -> Figure:
    """The robot with everything named, for ``slipmargin robots show``."""
    figure = Figure(figsize=(5.6, 5.6), layout="constrained")
    axes = figure.add_subplot()
    draw_machine(axes, model)
    contacts, reach, convention = model.geometry, _reach(model), model.convention
    for number, (name, place, drive) in enumerate(
        zip(contacts.names, contacts.position_m, convention.contact_sign * contacts.drive, strict=True), 1
    ):
        axes.annotate(
            "",
            place + 0.42 * reach * drive,
            place,
            arrowprops={"arrowstyle": "-|>", "color": BLUE, "shrinkA": 0, "shrinkB": 0},
        )
        out = _outwards(place, contacts.position_m)
        side = "left" if out[0] > 0.3 else "right" if out[0] < -0.3 else "center"
        axes.annotate(
            f"{number}  {name}" if name != str(number) else name,
            place + 0.36 * reach * out,
            ha=side,
            va="center",
            color=INK,
        )
    axes.plot(*model.inertia.com_m, marker="o", ms=7, mfc="white", mec=INK, ls="none", zorder=5)
    axes.plot(*model.inertia.com_m, marker="+", ms=7, color=INK, ls="none", zorder=6, label="centre of mass")
    axes.plot([], [], color=BLUE, marker=">", label=_ARROW[convention])
    if np.any(np.abs(moment(*contacts.grip.T, *contacts.drive.T)) > 1e-9):
        axes.plot([], [], color=GREY, lw=1.4, label="axle of the roller on the floor (white)")
    mid, far = contacts.position_m.mean(axis=0), 1.9 * reach
    axes.set(
        xlim=(mid[0] - far, mid[0] + far),
        ylim=(mid[1] - far, mid[1] + far),
        aspect="equal",
        xlabel=f"x, {convention.axes[0]} [m]",
        ylabel=f"y, {convention.axes[1]} [m]",
        title=model.robot,
    )
    axes.legend(loc="lower left")
    return figure


def draw_machine(axes: Axes, model: Model, *, forwards_up: bool = False) -> Axes:
    """Body, wheels (mecanum: with their rollers' axles) and a wedge at the front, in metres.

    In the axes of the robot's own convention, or turned so that forwards is up.
    """
    contacts, reach = model.geometry, _reach(model)
    turn = 0.5 * np.pi - model.convention.front_rad if forwards_up else 0.0
    places, drives, grips = (
        np.stack(to_floor(turn, *way.T), axis=1)
        for way in (contacts.position_m, contacts.drive, contacts.grip)
    )
    mid = places.mean(axis=0)
    arm = places - mid
    order = np.argsort(np.arctan2(arm[:, 1], arm[:, 0]))
    axes.add_patch(Polygon(places[order], closed=True, fc=PALE, ec=GREY, lw=1.0, alpha=0.6))
    corners = [model.convention.from_right_forward(*p) for p in ((-0.13, 0.22), (0.13, 0.22), (0.0, 0.48))]
    wedge = mid + reach * np.stack(to_floor(turn, *np.array(corners).T), axis=1)
    axes.add_patch(Polygon(wedge, closed=True, fc=ORANGE, ec="none"))
    for place, drive, grip in zip(places, drives, grips, strict=True):
        across = np.array([-drive[1], drive[0]])
        long, wide = 0.25 * reach * drive, 0.09 * reach * across
        axes.add_patch(
            Polygon(
                [place + long + wide, place + long - wide, place - long - wide, place - long + wide],
                closed=True,
                fc=INK,
                ec="none",
                zorder=3,
            )
        )
        if abs(grip @ across) > 1e-6:  # a mecanum wheel: the roller axle that touches the floor
            along = 0.12 * reach * grip
            axes.plot(*np.stack([place - along, place + along]).T, color="white", lw=1.4, zorder=4)
    return axes


def _reach(model: Model) -> float:
    arm = model.geometry.position_m - model.geometry.position_m.mean(axis=0)
    return float(np.max(np.hypot(arm[:, 0], arm[:, 1])))


def _outwards(place: Array, places: Array) -> Array:
    arm = place - places.mean(axis=0)
    size = float(np.hypot(*arm))
    return arm / size if size > 1e-12 else np.array([0.0, 1.0])
