"""Polar axes as the robot sees them: forwards is up, angles run counter-clockwise."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from slipmargin.checks import Array
from slipmargin.physics.convention import Convention


def polar_axes(figure: Figure, place: SubplotSpec | None = None) -> PolarAxes:
    """New polar axes in a figure, at a place of its grid or filling it."""
    axes = (
        figure.add_subplot(projection="polar")
        if place is None
        else figure.add_subplot(place, projection="polar")
    )
    assert isinstance(axes, PolarAxes)
    return axes


def forwards_up(axes: PolarAxes) -> None:
    """Name the directions, turn forwards up, and keep the grid quiet.  Angles are counted from forwards."""
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(1)
    axes.set_thetagrids(range(0, 360, 45), ["forwards", "", "left", "", "backwards", "", "right", ""])
    axes.set_rlabel_position(22.5)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(color="#CFCFCF", lw=0.6)
    axes.spines["polar"].set_visible(False)


def of_pull(phi_rad: Array, convention: Convention) -> Array:
    """Orientations φ under a pull along the floor's +x as the pull's direction from forwards [rad].

    The pull points along −φ from the body's +x.
    """
    return convention.from_front(-np.asarray(phi_rad))
