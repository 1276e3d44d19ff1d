"""Forces on a robot at rest that are neither the pull nor friction (slope, cable), and the loads they shift.

Terms against the motion and terms of a velocity are zero at rest.  Rolling resistance can hold a robot,
but never moves it; leaving it out keeps the limit on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.ranges import span
from slipmargin.model import Model
from slipmargin.physics.frames import rotate_rows
from slipmargin.physics.terms import AGAINST, ForceTerm
from slipmargin.physics.variables import Frame, Variable

#: A load below minus this share of m g is a wheel off the floor [1].
LIFTED = 1e-9
#: Of a smooth curve so many values are taken, those that reach farthest.
_MOST = 12
_UNKNOWN = (Variable.POSITION_X, Variable.POSITION_Y, Variable.TIME)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bias:
    """External wrench (M, 3) at rest, body frame, and wheel loads (M or 1, N) under it [N, N, N m; N]."""

    wrench: Array
    load_N: Array


def height_m(model: Model, term: ForceTerm) -> float:
    """Height above the floor at which a term's force acts [m]."""
    return model.inertia.com_height_m if term.height_m is None else term.height_m


def lift_N(model: Model) -> float:
    """Upward force of all external terms [N]."""
    return float(sum(term.lift_N for term in model.external.terms))


def shifts_load(model: Model) -> bool:
    """Whether an external force acts above the floor."""
    return any(height_m(model, term) != 0.0 for term in model.external.terms)


def turns_with_floor(model: Model) -> bool:
    """Whether an external force at rest depends on how the floor lies under the robot."""
    terms = [t for t in model.external.terms if _acts(t)]
    return any(t.frame is Frame.FLOOR or t.variable is Variable.HEADING for t in terms)


def bias(model: Model, phi_rad: Array) -> Bias:
    """The external wrench at rest and the loads under it; unknown variables at v = 0."""
    force = _total(model, [t for t in model.external.terms if _acts(t)], None, phi_rad)
    return _bias(model, force)


def bias_wrench(model: Model, phi_rad: Array) -> Array:
    """(M, 3) wrench of the external forces at rest, body frame; unknown variables at v = 0 [N, N, N m]."""
    return bias(model, phi_rad).wrench


def loads_at_rest(model: Model, phi_rad: Array) -> Array:
    """(M, N) loads at rest, one row where no external force acts; unknown variables at v = 0 [N]."""
    return bias(model, phi_rad).load_N if model.external.terms else model.loads.rest_N[None]


def refuse_lifting(model: Model, load_N: Array, place: str, evidence: object) -> None:
    """NoSolution naming the wheel that external forces alone lift off the floor, with loads (..., N) [N]."""
    if float(np.min(load_N)) < -LIFTED * model.inertia.weight_N:
        wheel = int(np.argmin(load_N.reshape(-1, model.count).min(axis=0)))
        raise NoSolution(
            place,
            f"wheel {model.geometry.names[wheel]} lifts off the floor: it would carry {np.min(load_N):.3g} N",
            "lower the centre of mass, widen the wheelbase or make the floor less steep",
            evidence,
        )


def bias_extremes(
    model: Model, phi_rad: Array, normals: Array, per_load: Array | None = None
) -> tuple[Array, Array]:
    """Least and greatest n·w + p·N of the bias and its loads over what cannot be known (place, time).

    Parameters
    ----------
    normals : (K, 3)
    per_load : (M or 1, K, N), optional

    Returns
    -------
    two (M, K)
        Relative to their values in :func:`bias`: both zero where no term depends on place or time.
    """
    low = np.zeros((len(phi_rad), len(normals)))
    high = np.zeros_like(low)
    tilts = None if per_load is None else per_load @ model.loads.per_moment_1_per_m

    def along(force: Array) -> Array:
        out = force[:, :3] @ normals.T
        return np.asarray(out if tilts is None else out + (tilts @ force[:, 3:, None])[..., 0])

    for variable in _UNKNOWN:
        terms = _unknown_terms(model, variable)
        if terms:
            least = most = rest = along(_total(model, terms, 0.0, phi_rad))
            for v in _corners(terms, variable):
                at = along(_total(model, terms, float(v), phi_rad))
                least, most = np.minimum(least, at), np.maximum(most, at)
            low += least - rest
            high += most - rest
    return low, high


def load_extremes(model: Model, phi_rad: Array) -> tuple[Array, Array]:
    """Least and greatest change of the loads (M, N) [N] over what cannot be known (place, time)."""
    n = model.count
    return bias_extremes(model, phi_rad, np.zeros((n, 3)), np.eye(n)[None])


def bias_samples(model: Model, phi_rad: Array) -> list[Bias]:
    """The different biases at the ends of what cannot be known; the one at v = 0 comes first.

    The largest pull is a concave function of the bias, so it is least at an end.  A force along one line has
    two, one of hats no more than its knots; of smooth curves so many are taken, those that reach farthest.
    """
    out = [_total(model, [t for t in model.external.terms if _acts(t)], None, phi_rad)]
    for variable in _UNKNOWN:
        terms = _unknown_terms(model, variable)
        if terms:
            values = _farthest(terms, _corners(terms, variable), _MOST)
            rest = _total(model, terms, 0.0, phi_rad)
            change = [_total(model, terms, float(v), phi_rad) - rest for v in (0.0, *values)]
            out = [w + step for w in out for step in change]
    different = {(force + 0.0).tobytes(): force for force in out}
    return [_bias(model, force) for force in different.values()]


def _acts(term: ForceTerm) -> bool:
    return term.frame not in AGAINST


def _unknown_terms(model: Model, variable: Variable) -> list[ForceTerm]:
    return [t for t in model.external.terms if t.variable is variable and _acts(t)]


def _total(model: Model, terms: list[ForceTerm], v: float | None, phi_rad: Array) -> Array:
    """(M, 5) sum of wrench and height × force over terms at v; None: the heading, and zero for the rest."""
    out = np.zeros((len(phi_rad), 5))
    for term in terms:
        at = phi_rad if v is None and term.variable is Variable.HEADING else np.full(len(phi_rad), v or 0.0)
        wrench = term.wrench(at)
        if term.frame is Frame.FLOOR:
            wrench = rotate_rows(phi_rad, wrench, inverse=True)
        out[:, :3] += wrench
        out[:, 3:] += height_m(model, term) * wrench[:, :2]
    return out


def _bias(model: Model, force: Array) -> Bias:
    return Bias(wrench=force[:, :3], load_N=model.loads.at(np.zeros(2), force[:, 3:], lift_N(model)))


#: Wrenches that differ by less than this share of the largest change are one, or lie on one line [1].
_SAME = 1e-9


def _wrenches(terms: list[ForceTerm], values: Array) -> Array:
    """(S, 3 T) wrenches of all terms, each in its own frame, in shares of the largest change of any."""
    own = np.hstack([t.wrench(values) for t in terms])
    own = own - own[0]
    return np.asarray(own / max(float(np.max(np.abs(own))), 1e-300))


def _corners(terms: list[ForceTerm], variable: Variable) -> Array:
    """Values among which every linear function of the terms' wrenches is least and greatest.

    Of a force along one line these are its two ends; else the values at which it does not go straight on.
    """
    spans = [span(t.basis, t.shape, variable, t.coefficients.shape[1]) for t in terms]
    grid = np.unique(np.concatenate([np.zeros(1), *spans]))
    own = _wrenches(terms, grid)
    way = own[int(np.argmax(np.sum(own**2, axis=1)))]
    along = own @ way / max(float(way @ way), 1e-300)
    if np.max(np.abs(own - along[:, None] * way)) <= _SAME:
        return np.asarray(grid[[int(np.argmin(along)), int(np.argmax(along))]])
    share = ((grid[1:-1] - grid[:-2]) / (grid[2:] - grid[:-2]))[:, None]
    off = np.abs(own[1:-1] - (own[:-2] + share * (own[2:] - own[:-2])))
    return np.asarray(grid[np.concatenate([[True], np.max(off, axis=1) > _SAME, [True]])])


def _farthest(terms: list[ForceTerm], values: Array, most: int) -> Array:
    """At most so many of the values: those whose wrenches lie farthest from each other."""
    own, kept = _wrenches(terms, values), [0]
    away = np.linalg.norm(own - own[0], axis=1)
    while len(kept) < most and np.max(away) > _SAME:
        kept.append(int(np.argmax(away)))
        away = np.minimum(away, np.linalg.norm(own - own[kept[-1]], axis=1))
    return np.asarray(values[np.sort(kept)])
