"""How far an acceleration can grow until some wheel's *realised* share reaches what may be used.

Wheels that follow a speed do not choose their forces: all share one creep twist ε
(docs/theory.md, section 4, four wheels and more).  Along a ray of accelerations a + t d the grip c(t) and
the wrench w(t) that the wheels must give are affine in t, so with full drag the limit is the solution of
four equations in (ε, t), j the wheel that uses the share λ first:

    Σ_i b_i c_i(t) σ(k_i b_i·ε) + w(t) = 0,        k_j b_j·ε = ± σ⁻¹(λ).

Newton's method solves them, from the solution at the neighbouring ray or else from a search over t.  Only
the ratios of the k_i count.  For three wheels the distribution is unique and the facets say the same; at
λ = 1 the realised and the best distribution end at the same wrench.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.creep import BEYOND, FAITHFUL, SCALE, TABLES, WHEEL, knee
from slipmargin.limits.motion_external import External
from slipmargin.limits.motion_friction import Friction, material_states
from slipmargin.limits.motion_realised import LIGHTEST, comparable
from slipmargin.limits.realised_newton import leave_share
from slipmargin.model import Model
from slipmargin.physics.friction_laws import law_inverse


def decided_by_creep(model: Model, share: float) -> bool:
    """Whether the realised distribution can use more than the best one: four wheels, not all of the grip."""
    return model.count > 3 and share < 1.0


def slip_at(law: int, share: float) -> float:
    """k u at which a wheel uses a share of its grip, as an audit counts it (continued above 0.98)."""
    if share <= FAITHFUL:
        return float(law_inverse(law, share))
    return knee(law) + (share - FAITHFUL) / BEYOND


def realised_limit(
    model: Model,
    friction: Friction,
    external: External,
    start: Array,
    direction: Array,
    low: Array,
    high: Array,
    *,
    share: float,
) -> tuple[Array, NDArray[np.int64]]:
    """Largest t in [low, high] with which start + t·direction keeps every wheel within the share.

    Parameters
    ----------
    start, direction : (R, M, 3)
        R rays for each of M states: accelerations of the centre of mass and yaw acceleration.
    low, high : (R, M)
        Where any distribution, motors and tipping allow the acceleration; what is not finite is returned.

    Returns
    -------
    (R, M) t, −∞ where none is found, and (R, M) the limiting wheels as bits (:func:`wheels_of`), none where
    ``high`` is returned.
    """
    law, n = model.grip.law, model.count
    flat = low.size
    best, wheels = high.ravel().copy(), np.zeros(flat, dtype=np.int64)
    k = _repeated(friction.drive_stiffness / np.mean(friction.drive_stiffness), low.shape)
    t, code = np.empty(flat), np.empty(flat, dtype=np.int64)
    forces = np.ascontiguousarray(np.concatenate(model.wrench_maps()))
    asked = np.append(np.zeros(SCALE), comparable(model))
    work = forces, np.zeros((n, WHEEL)), asked, np.zeros(TABLES)
    rule = law, knee(law), slip_at(law, share)
    for c0, c1, light, w0, w1 in _cases(model, friction, external, start, direction):
        rays, wrench = np.stack([k, c0, c1, light], axis=2), np.concatenate([w0, w1], axis=1)
        leave_share(rule, work, rays, wrench, low.ravel(), best, t, code)
        less = t < best
        best[less], wheels[less] = t[less], code[less]
    return best.reshape(low.shape), wheels.reshape(low.shape)


def wheels_of(code: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """(…, N) the wheels whose bits are set in ``code`` (…)."""
    return np.asarray((code[..., None] >> np.minimum(np.arange(count), 62) & 1) != 0)


def _cases(
    model: Model, friction: Friction, external: External, start: Array, direction: Array
) -> Iterator[tuple[Array, Array, Array, Array, Array]]:
    """Grip c₀ + t c₁ and its least, and asked wrench w₀ + t w₁, each (R·M, …).

    One case for every combination of materials and, where a wrench is not known, for its extremes.
    """
    across, mass = model.wrench_maps()[1], model.inertia.diagonal
    shape = start.shape[:2]
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    load1 = direction[..., :2] @ model.loads.per_acceleration_kg.T
    moved = start[..., :2] @ model.loads.per_acceleration_kg.T
    middle = 0.5 * (friction.drag_low + friction.drag_high)
    for pick in material_states(friction.possible):
        mu = np.where(pick, friction.drive[1], friction.drive[0])
        drag = np.where(pick, middle[1], middle[0])
        for low, high, load in external.cases(np.zeros(2)):
            for wrench in _corners(low, high):
                load0 = load + moved
                w0 = start * mass - wrench + (drag * load0) @ across.T
                w1 = direction * mass + (drag * load1) @ across.T
                parts = (
                    mu * load0,
                    mu * load1,
                    np.broadcast_to(mu * lightest, (*shape, model.count)),
                    w0,
                    w1,
                )
                yield tuple(np.ascontiguousarray(p.reshape(-1, p.shape[-1])) for p in parts)  # type: ignore


def _corners(low: Array, high: Array) -> Iterator[Array]:
    """The corners of boxes of wrenches (M, 3): one where nothing is unknown."""
    open_ = [j for j in range(3) if np.any(low[:, j] < high[:, j])]
    for sides in product((False, True), repeat=len(open_)):
        corner = low.copy()
        for j, up in zip(open_, sides, strict=True):
            if up:
                corner[:, j] = high[:, j]
        yield corner


def _repeated(values: Array, shape: tuple[int, ...]) -> Array:
    return np.ascontiguousarray(
        np.broadcast_to(values, (*shape, values.shape[-1])).reshape(-1, values.shape[-1])
    )
