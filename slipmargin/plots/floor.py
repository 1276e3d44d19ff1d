"""The floor as a diagnosis found it: where its friction differs, and where the runs went."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from slipmargin.checks import Array
from slipmargin.diagnosis.result import Diagnosis
from slipmargin.physics.terms import OF_PLACE, Multiplier, place_variable
from slipmargin.physics.variables import Target, Variable
from slipmargin.plots.style import GREY, styled

#: Points along each side of the map, and how far it reaches beyond the runs [m].
_POINTS, _AROUND_M = 301, 0.15


def floor_terms(diagnosis: Diagnosis) -> list[Multiplier]:
    """Friction that the findings make depend on the place of a contact."""
    before = diagnosis.recipe.build(diagnosis.surface)
    after = diagnosis.corrected.build(diagnosis.surface)
    new = after.grip.multipliers[len(before.grip.multipliers) :]
    return [term for term in new if term.variable in OF_PLACE and term.target < Target.STIFFNESS]


@styled
def floor_figure(diagnosis: Diagnosis) -> Figure:
    """Friction of the floor over that elsewhere, seen from above, with the paths of the runs."""
    terms = floor_terms(diagnosis)
    paths = [t.measured[:, :2] for t in diagnosis.trials]
    every = np.concatenate(paths)
    low, high = np.nanmin(every, axis=0) - _AROUND_M, np.nanmax(every, axis=0) + _AROUND_M
    x, y = np.meshgrid(*(np.linspace(a, b, _POINTS) for a, b in zip(low, high, strict=True)))
    factor = floor_factor(terms, x, y)
    figure = Figure(figsize=(6.4, 5.2), layout="constrained")
    axes = figure.subplots()
    least, most = float(factor.min()), float(factor.max())
    image = axes.pcolormesh(
        x, y, factor, cmap="RdBu", vmin=min(2.0 - most, least), vmax=max(2.0 - least, most), rasterized=True
    )
    for path in paths:
        axes.plot(path[:, 0], path[:, 1], color=GREY, lw=0.8)
    figure.colorbar(image, ax=axes, label="friction, times that elsewhere")
    axes.set(xlabel="x [m]", ylabel="y [m]", title="The floor as found, and where the runs went")
    axes.set_aspect("equal")
    axes.grid(visible=False)
    return figure


def floor_factor(terms: list[Multiplier], x: Array, y: Array) -> Array:
    """Factor on friction of contacts at (x, y) [m], same shape."""
    factor = np.ones(np.shape(x))
    for term in terms:
        at_x, at_y, direction = term.place
        line = term.variable is Variable.BEFORE_LINE
        factor = factor * term.factor(place_variable(line, at_x, at_y, direction, x, y))
    return factor
