"""The band: a wheel may stand on a roller or on rigid material, so one pull test sees one of 2^N states.

F_emax never falls when a coefficient rises.  A wheel whose rigid coefficients are both at least its
roller's therefore stands on a roller in the lowest state and on rigid material in the highest, and
only wheels where they cross need trying both ways: the band is exact without 2^N sweeps.

On an uneven floor the loads of four wheels and more are a band too.  F_emax is concave in the loads (they
stand on the right-hand side of a linear or cone program), so its least value is at a corner; its greatest
value is taken over the corners and the even floor.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bias import bias_samples
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import facet_rows, largest, pull_geometry
from slipmargin.model import Model
from slipmargin.physics.grips import polyhedral
from slipmargin.work import CONE_WHEELS, STANDING_STATES, allow, allow_states


def states(model: Model, extreme: Extreme) -> list[Array]:
    """Contact states (N,) bool among which the extreme limit is found; True: on rigid material.

    A wheel without rigid sectors stands on rollers, one that is all rigid stands on rigid material.
    """
    choices: list[tuple[bool, ...]] = []
    for fraction, roller, rigid in zip(
        model.grip.rigid_fraction, model.grip.roller, model.grip.rigid, strict=True
    ):
        if fraction <= 0.0:
            choices.append((False,))
        elif fraction >= 1.0:
            choices.append((True,))
        elif np.all(rigid >= roller):
            choices.append((extreme is Extreme.HIGH,))
        elif np.all(rigid <= roller):
            choices.append((extreme is Extreme.LOW,))
        else:
            choices.append((False, True))
    allow_states("wheel", sum(len(c) == 2 for c in choices), STANDING_STATES)
    return [np.array(state) for state in product(*choices)]


def band(model: Model, phi_rad: Array, pull: Pull) -> tuple[Array, Array]:
    """Lowest and highest F_emax (M,) over contact states, unknown variables and the loads' band [N]."""
    ends = [_even_band(at, phi_rad, pull) for at in load_corners(model)]
    return np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)


def load_corners(model: Model) -> list[Model]:
    """The model on an even floor, and with its loads at each corner of their band."""
    loads = model.loads
    none = np.zeros((0, model.count))
    return [
        replace(model, loads=replace(loads, rest_N=np.maximum(loads.rest_N + shift, 0.0), uneven_N=none))
        for shift in loads.shifts()
    ]


def _even_band(model: Model, phi_rad: Array, pull: Pull) -> tuple[Array, Array]:
    if polyhedral(model.grip.shape, model.grip.coupling):
        geometry = pull_geometry(model, phi_rad, pull)

        def one(state: Array, extreme: Extreme) -> Array:
            mu = coefficients(model, state, phi_rad, extreme)
            return largest(*facet_rows(geometry, mu, extreme))
    else:
        from slipmargin.limits.cones import cone_extreme  # clarabel is loaded only where a cone needs it

        biases = bias_samples(model, phi_rad)
        programs = len(phi_rad) * len(biases) * (2 if model.external.terms else 1)
        size = sum(len(states(model, extreme)) for extreme in (Extreme.LOW, Extreme.HIGH)) * programs
        cure = "ask for fewer orientations (--step), or give sectors to fewer wheels"
        allow("wheel", size * model.count, CONE_WHEELS, "wheels in cone programs", cure)

        def one(state: Array, extreme: Extreme) -> Array:
            return cone_extreme(model, phi_rad, pull, state, extreme, biases)

    low = np.min([np.nan_to_num(one(s, Extreme.LOW), nan=0.0) for s in states(model, Extreme.LOW)], axis=0)
    high = np.max([np.nan_to_num(one(s, Extreme.HIGH), nan=0.0) for s in states(model, Extreme.HIGH)], axis=0)
    return low, high
