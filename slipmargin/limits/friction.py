"""The coefficients a wheel at rest can call on, as far as they can be known.

Every multiplier of the grip (physics/terms.py) multiplies a coefficient by max(0, 1 + Σ c φ(v)).  At rest
the slip, the velocities and the accelerations are zero; the heading of a sweep and the loads at rest
are known; where the wheel stands (angle, place, time, direction of a slip that has not begun) is not:
there the nominal value takes v = 0 and the band takes the interval.
"""

from __future__ import annotations

from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bias import load_extremes, loads_at_rest, turns_with_floor
from slipmargin.limits.ranges import span
from slipmargin.model import Model
from slipmargin.physics.frames import wrapped
from slipmargin.physics.terms import OF_PLACE, Multiplier, basis_values, place_variable
from slipmargin.physics.variables import Target, Variable

_UNKNOWN = (
    Variable.WHEEL_ANGLE,
    Variable.SLIP_ANGLE,
    Variable.POSITION_X,
    Variable.POSITION_Y,
    Variable.TIME,
    *sorted(OF_PLACE),
)
#: What a wheel at rest knows of how the floor lies under it.
_OF_FLOOR = (Variable.HEADING, Variable.SLIP_HEADING, Variable.SLIP_DIRECTION)
_COLUMNS = {Target.DRIVE: (0,), Target.TRANSVERSE: (1,), Target.BOTH: (0, 1)}


@final
class Extreme(Enum):
    """Which value an unknown variable takes."""

    NEUTRAL = "v = 0"
    LOW = "the least friction in the variable's range"
    HIGH = "the most friction in the variable's range"


def floor_has_directions(model: Model) -> bool:
    """Whether friction or a force on the robot at rest depends on how the floor lies under it."""
    grip = (t for t in model.grip.multipliers if t.target in _COLUMNS)
    return turns_with_floor(model) or any(t.variable in _OF_FLOOR for t in grip)


def coefficients(model: Model, rigid: Array, phi_rad: Array, extreme: Extreme = Extreme.NEUTRAL) -> Array:
    """Friction coefficients of wheels at rest.

    Parameters
    ----------
    rigid : (N,) bool
        Wheels that stand on rigid material; the others stand on a roller.
    phi_rad : (M,)
        Headings.

    Returns
    -------
    (M or 1, N, 2, 2)
        ``[m, i, j, s]``: component j (0 drive ĝ, 1 transverse f̂), s = 0 limits the force along −, s = 1
        along +.  The first axis has length one where no heading matters.
    """
    base = np.where(np.asarray(rigid, dtype=bool)[:, None], model.grip.rigid, model.grip.roller)
    out = np.repeat(base[None, :, :, None], 2, axis=3)
    terms = [t for t in model.grip.multipliers if t.target in _COLUMNS]
    for term in terms:
        if term.variable not in _UNKNOWN:
            out = out * _known(term, model, phi_rad, extreme)
    for variable in _UNKNOWN:
        same = [t for t in terms if t.variable is variable]
        # Terms over one variable move together; those measured from places of their own do not.
        for together in [[t] for t in same] if variable in OF_PLACE else [same] if same else []:
            out = out * _interval(together, variable, model.count, extreme)
    return out


def _known(term: Multiplier, model: Model, phi_rad: Array, extreme: Extreme) -> Array:
    n = model.count
    if term.variable is Variable.WHEEL_LOAD:
        return _by_load(term, model, phi_rad, extreme)
    if term.variable in (Variable.SLIP_HEADING, Variable.SLIP_DIRECTION):
        # A force along +ĝ answers a slip along −ĝ, whose heading is φ + arg ĝ + π.  The contact may slide
        # along f̂ as well: the band of SLIP_DIRECTION takes every direction.
        axes = np.stack([model.geometry.grip, model.geometry.free], axis=1)
        arg = np.arctan2(axes[..., 1], axes[..., 0])
        v = phi_rad[:, None, None, None] + arg[None, :, :, None] + np.array([0.0, np.pi])
        v = wrapped(v)
    elif term.variable is Variable.HEADING:
        v = np.broadcast_to(phi_rad[:, None, None, None], (len(phi_rad), n, 1, 1))
    else:
        v = np.zeros((1, n, 1, 1))  # slip, velocities, accelerations: zero at rest
    factors = _factors(term, v, n)
    if term.variable is Variable.SLIP_DIRECTION and extreme is not Extreme.NEUTRAL:
        anywhere = _interval([term], term.variable, n, extreme)
        return np.asarray((np.maximum if extreme is Extreme.HIGH else np.minimum)(factors, anywhere))
    return factors


def _by_load(term: Multiplier, model: Model, phi_rad: Array, extreme: Extreme) -> Array:
    """The load is known at rest, but for a force above the floor that depends on place or time."""
    loads = [loads_at_rest(model, phi_rad)]
    if extreme is not Extreme.NEUTRAL:
        low, high = load_extremes(model, phi_rad)
        loads += [loads[0] + low + part * (high - low) for part in np.linspace(0.0, 1.0, 9)]
    n, pick = model.count, np.max if extreme is Extreme.HIGH else np.min
    scale = n / model.inertia.weight_N
    factors = [_factors(term, (x * scale - 1.0)[..., None, None], n) for x in loads]
    return np.asarray(pick(np.stack(np.broadcast_arrays(*factors)), axis=0))


def _factors(term: Multiplier, v: Array, n: int) -> Array:
    change = basis_values(term.basis, term.shape, len(term.coefficients), v) @ term.coefficients
    factor = np.maximum(0.0, 1.0 + term.wheels.reshape(1, n, 1, 1) * change)
    full = np.ones(np.broadcast_shapes(factor.shape, (1, n, 2, 2)))
    for column in _COLUMNS[term.target]:
        full[:, :, column] = factor[:, :, column if factor.shape[2] == 2 else 0]
    return full


def _at_origin(term: Multiplier, variable: Variable) -> float:
    """v where nothing else is known: zero, or at the floor's origin."""
    line = variable is Variable.BEFORE_LINE
    x, y, direction = term.place
    return float(place_variable(line, x, y, direction, 0.0, 0.0)) if variable in OF_PLACE else 0.0


def _interval(terms: list[Multiplier], variable: Variable, n: int, extreme: Extreme) -> Array:
    # The product of terms that move together is searched, not each alone.
    grid = (
        np.array([_at_origin(terms[0], variable)])
        if extreme is Extreme.NEUTRAL
        else np.unique(
            np.concatenate(
                [np.zeros(1), *(span(t.basis, t.shape, variable, len(t.coefficients)) for t in terms)]
            )
        )
    )
    v = np.broadcast_to(grid[:, None, None, None], (len(grid), n, 1, 1))
    product = np.ones((len(grid), n, 2, 2))
    for term in terms:
        product = product * _factors(term, v, n)
    pick = np.max if extreme is Extreme.HIGH else np.min
    return np.asarray(pick(product, axis=0, keepdims=True))
