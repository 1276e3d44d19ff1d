"""The same effects in the axes of the other convention.

A named effect's parameters ``…_x…`` and ``…_y…`` are the components of a vector or, where doing nothing is
1, a factor along each axis; ``direction_rad`` is a direction.  A general form's terms are turned one by one.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.effects.confined import Confined
from slipmargin.effects.effect import Effect
from slipmargin.effects.general import GeneralEffect, Term
from slipmargin.effects.recipe import AnyEffect, Recipe
from slipmargin.effects.sliding_direction import SlidingDirection
from slipmargin.physics.convention import Convention
from slipmargin.physics.terms import AGAINST, OF_PLACE, ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Variable
from slipmargin.robot.turned import quarter_rad, robot_in, vectors

DIRECTION = "direction_rad"
_X, _Y = re.compile(r"_x(?=_|$)"), re.compile(r"_y(?=_|$)")
#: Variables that are one component of a vector: (along x, along y).
_COMPONENTS: tuple[tuple[Variable, Variable], ...] = (
    (Variable.VELOCITY_X, Variable.VELOCITY_Y),
    (Variable.ACCELERATION_X, Variable.ACCELERATION_Y),
    (Variable.POSITION_X, Variable.POSITION_Y),
)


def recipe_in(recipe: Recipe, new: Convention) -> Recipe:
    """The same machine with the same effects in a convention; itself where it is in it already."""
    old = recipe.robot.convention
    if old is new:
        return recipe
    effects = tuple(effect_in(effect, old, new) for effect in recipe.effects)
    return Recipe(robot=robot_in(recipe.robot, new), effects=effects)


def effect_in(effect: AnyEffect, old: Convention, new: Convention) -> AnyEffect:
    """The same effect in another convention's axes."""
    if isinstance(effect, Confined):
        own = (effect_in(e, old, new) for e in effect.effects)
        return replace(effect, effects=tuple(e for e in own if not isinstance(e, Confined)))
    if isinstance(effect, GeneralEffect):
        return replace(effect, terms=tuple(_term(term, old, new) for term in effect.terms))
    changes: dict[str, Any] = {}
    for x, y, factors in axes_of(effect):
        pair = [getattr(effect, x), getattr(effect, y)]
        turned = pair[::-1] if factors else vectors(np.array(pair), old, new).tolist()
        changes |= {x: turned[0], y: turned[1]}
    if isinstance(effect, SlidingDirection):
        for name, (there, reverse) in waves_in(effect, old, new).items():
            changes[there] = (0.0 - getattr(effect, name)) if reverse else getattr(effect, name)
    if hasattr(effect, DIRECTION):
        changes[DIRECTION] = direction(getattr(effect, DIRECTION), old, new)
    return replace(effect, **changes) if changes else effect  # type: ignore[type-var]


def waves_in(effect: SlidingDirection, old: Convention, new: Convention) -> dict[str, tuple[str, bool]]:
    """What ``cosine`` and ``sine`` over a direction are in the other axes, and whether their sign changes."""
    phase = effect.repeats * quarter_rad(old, new)
    c, s = round(math.cos(phase)), round(math.sin(phase))
    if c:
        return {"cosine": ("cosine", c < 0), "sine": ("sine", c < 0)}
    return {"cosine": ("sine", s < 0), "sine": ("cosine", s > 0)}


def direction(angle_rad: float, old: Convention, new: Convention, repeats: int = 1) -> float:
    """A direction in another convention's axes, within ±π [rad], or its part of a turn if it ``repeats``."""
    return math.remainder(angle_rad + quarter_rad(old, new), 2.0 * math.pi / repeats)


def axes_of(effect: Effect) -> list[tuple[str, str, bool]]:
    """Pairs of parameters along x and y, and whether each is a factor instead of a component."""
    names = {p.name: p for p in effect.parameters}
    pairs = [(name, _X.sub("_y", name)) for name in names if _X.search(name)]
    return [(x, y, names[x].null == 1.0) for x, y in pairs if y in names]


def _term(term: Term, old: Convention, new: Convention) -> Term:
    changes: dict[str, Any] = {}
    if isinstance(term, Multiplier):
        coefficients = term.coefficients
        if term.variable in OF_PLACE:
            place = vectors(term.place, old, new)
            place[2] = direction(float(place[2]), old, new)
            changes["place"] = place
    elif isinstance(term, ForceTerm) and term.frame in AGAINST:
        coefficients = term.coefficients  # along and across the velocity
        changes["place_m"] = vectors(term.place_m, old, new)
    else:
        coefficients = vectors(term.coefficients.T, old, new).T
    shape = term.shape
    for x, y in _COMPONENTS:
        if term.variable in (x, y):
            along = np.array([1.0, 0.0] if term.variable is x else [0.0, 1.0])
            turned = vectors(along, old, new)
            changes["variable"] = x if turned[0] else y
            if turned.sum() < 0.0:
                shape, coefficients = _mirrored(term.basis, shape, coefficients)
            break
    if term.variable in (Variable.SLIP_HEADING, Variable.SLIP_DIRECTION):
        shape, coefficients = _shifted(term.basis, shape, coefficients, quarter_rad(old, new))
    return replace(term, shape=shape, coefficients=coefficients, **changes)


def _mirrored(basis: Basis, shape: Array, coefficients: Array) -> tuple[Array, Array]:
    """The same function of −v."""
    a, b = float(shape[0]), float(shape[1])
    count = np.arange(coefficients.shape[-1])
    if basis is Basis.POLYNOMIAL:
        return shape, coefficients * np.where(count % 2 == 0, -1.0, 1.0)
    if basis is Basis.FOURIER:
        return shape, coefficients * np.where(count % 2 == 0, 1.0, -1.0)
    if basis is Basis.HATS:
        return np.array([-b, -a]), coefficients[..., ::-1]
    if basis is Basis.WINDOW:
        return np.array([-b, -a]), coefficients
    if basis is Basis.ODD:
        return shape, -coefficients
    if basis in (Basis.RECIPROCAL, Basis.STEP):
        return -shape, coefficients
    if basis is Basis.LOBE:
        return np.array([-a, b]), coefficients
    return shape, coefficients  # constants, and what depends on |v|


def _shifted(basis: Basis, shape: Array, coefficients: Array, by: float) -> tuple[Array, Array]:
    """The same function of an angle v that is larger by ``by``."""
    if basis is Basis.FOURIER:
        if coefficients.shape[-1] % 2:  # a cosine alone: its sine is none
            coefficients = np.concatenate([coefficients, np.zeros((*coefficients.shape[:-1], 1))], axis=-1)
        turned = np.array(coefficients)
        for j in range(coefficients.shape[-1] // 2):
            phase = 2.0 * math.pi * (j + 1) * by / float(shape[0])
            c, s = round(math.cos(phase), 15), round(math.sin(phase), 15)
            even, odd = coefficients[..., 2 * j], coefficients[..., 2 * j + 1]
            turned[..., 2 * j], turned[..., 2 * j + 1] = c * even - s * odd, s * even + c * odd
        return shape, turned
    if basis in (Basis.HATS, Basis.WINDOW):
        return shape + by, coefficients
    if basis is Basis.LOBE:
        return shape + np.array([by, 0.0]), coefficients
    return shape, coefficients
