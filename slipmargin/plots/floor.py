"""The floor as a diagnosis found it: where its friction differs, and where the runs went."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from slipmargin.checks import Array
from slipmargin.diagnosis.result import Diagnosis
from slipmargin.physics.terms import OF_PLACE, Multiplier, place_variable
from slipmargin.physics.variables import Target, Variable
from slipmargin.plots.style import INK, styled

#: Points along each side of the map, and how far it reaches beyond the wheels of the runs [m].
_POINTS, _AROUND_M = 301, 0.05
#: Colours span this many times the largest change, so that lines stay visible on the darkest of them.
_SPAN = 1.8
#: Changes of friction below this are drawn as pale as they are [1].
_LEAST_CHANGE = 0.05


def floor_terms(diagnosis: Diagnosis) -> list[Multiplier]:
    """Friction that the findings make depend on the place of a contact."""
    before = diagnosis.recipe.build(diagnosis.surface)
    after = diagnosis.corrected.build(diagnosis.surface)
    new = after.grip.multipliers[len(before.grip.multipliers) :]
    everywhere = [t for t in new if t.variable in OF_PLACE and np.all(t.wheels == 1.0)]
    return [t for t in everywhere if t.target < Target.STIFFNESS]


@styled
def floor_figure(diagnosis: Diagnosis) -> Figure:
    """Friction of the floor over that elsewhere, seen from above, with the paths of the runs."""
    wheels = diagnosis.recipe.build(diagnosis.surface).geometry.position_m
    paths = [t.measured[:, :2] for t in diagnosis.trials]
    every, around = np.concatenate(paths), float(np.max(np.hypot(*wheels.T))) + _AROUND_M
    low, high = np.nanmin(every, axis=0) - around, np.nanmax(every, axis=0) + around
    x, y = np.meshgrid(*(np.linspace(a, b, _POINTS) for a, b in zip(low, high, strict=True)))
    factor = floor_factor(floor_terms(diagnosis), x, y)
    figure = Figure(figsize=(6.4, 5.2), layout="constrained")
    axes = figure.subplots()
    change = max(float(np.max(np.abs(factor - 1.0))), _LEAST_CHANGE)
    image = axes.imshow(
        factor,
        cmap="RdBu",
        vmin=1.0 - _SPAN * change,
        vmax=1.0 + _SPAN * change,
        origin="lower",
        extent=(low[0], high[0], low[1], high[1]),
        interpolation="bilinear",
    )
    around_line = withStroke(linewidth=2.6, foreground="white")
    for k, path in enumerate(paths):
        name = "path of the robot's origin" if k == 0 else None
        axes.plot(path[:, 0], path[:, 1], color=INK, lw=1.0, path_effects=[around_line], label=name)
    bar = figure.colorbar(image, ax=axes, label="friction, times that elsewhere")
    bar.ax.set_ylim(
        min(float(factor.min()), 1.0 - 0.2 * change), max(float(factor.max()), 1.0 + 0.2 * change)
    )
    axes.set(xlabel="x [m]", ylabel="y [m]", title="The floor as found, and where the runs went")
    axes.grid(visible=False)
    figure.legend(loc="outside lower left")
    return figure


def floor_factor(terms: list[Multiplier], x: Array, y: Array) -> Array:
    """Factor on friction of contacts at (x, y) [m], same shape."""
    factor = np.ones(np.shape(x))
    for term in terms:
        at_x, at_y, direction = term.place
        line = term.variable is Variable.BEFORE_LINE
        factor = factor * term.factor(place_variable(line, at_x, at_y, direction, x, y))
    return factor
