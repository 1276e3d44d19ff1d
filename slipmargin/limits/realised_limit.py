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

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.creep import BEYOND, FAITHFUL, SCALE, TABLES, WHEEL, knee
from slipmargin.limits.motion_compiled import fill_rays, own
from slipmargin.limits.motion_external import External
from slipmargin.limits.motion_friction import Friction, material_states
from slipmargin.limits.motion_realised import LIGHTEST, comparable
from slipmargin.limits.realised_newton import RAY, leave_share
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
    t, code = np.empty(flat), np.empty(flat, dtype=np.int64)
    forces = np.ascontiguousarray(np.concatenate(model.wrench_maps()))
    asked = np.append(np.zeros(SCALE), comparable(model))
    work = forces, np.zeros((n, WHEEL)), asked, np.zeros(TABLES)
    rule = law, knee(law), slip_at(law, share)
    for rays, wrench in _cases(model, friction, external, start, direction):
        leave_share(rule, work, rays, wrench, low.ravel(), best, t, code)
        less = t < best
        best[less], wheels[less] = t[less], code[less]
    return best.reshape(low.shape), wheels.reshape(low.shape)


def wheels_of(code: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """(…, N) the wheels whose bits are set in ``code`` (…)."""
    return np.asarray((code[..., None] >> np.minimum(np.arange(count), 62) & 1) != 0)


def _cases(
    model: Model, friction: Friction, external: External, start: Array, direction: Array
) -> Iterator[tuple[Array, Array]]:
    """Slopes, grip c₀ + t c₁ and its least (R·M, N, RAY), and asked wrench w₀ + t w₁ (R·M, 6).

    One case for every combination of materials and, where a wrench is not known, for its extremes; both
    arrays are filled anew for each.
    """
    shape, states = start.shape[:2], start.shape[1]
    across, mass, per = (
        own(x) for x in (model.wrench_maps()[1], model.inertia.diagonal, model.loads.per_acceleration_kg)
    )
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    middle = 0.5 * (friction.drag_low + friction.drag_high)
    slope = own(friction.drive_stiffness / np.mean(friction.drive_stiffness))
    rays, wrench = np.empty((*shape, model.count, RAY)), np.empty((*shape, 6))
    start, direction = own(start), own(direction)
    for pick in material_states(friction.possible):
        mu = np.where(pick, friction.drive[1], friction.drive[0])
        drag = np.where(pick, middle[1], middle[0])
        for pushed, load in external.corners():
            loads = own(np.broadcast_to(load, (states, model.count)))
            fill_rays(
                rays,
                wrench,
                across,
                mass,
                per,
                (mu, drag, slope),
                loads,
                own(pushed),
                start,
                direction,
                lightest,
            )
            yield rays.reshape(-1, model.count, RAY), wrench.reshape(-1, 6)
