"""Sums over wheels and samples that the rows of motion are made of (compiled).

NumPy takes as long over a row of four wheels as over one of a hundred, and there is a row for every state and
facet.  Arrays are contiguous and own (:func:`own`), so that each function is compiled once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.realised_newton import GRIP_0, GRIP_1, LEAST, SLOPE
from slipmargin.physics.compiled import kernel


def own(values: Any) -> Any:
    """A contiguous array that may be written to, which compiled code knows by one type."""
    return np.array(values, order="C")


@kernel
def facet_worth(
    drive: Array,
    across: Array,
    possible: NDArray[np.bool_],
    grip: Array,
    low: Array,
    high: Array,
    worth: Array,
) -> None:
    """κ (M, K, N) = grip |n·b_i| − max over D of (n·t_i) D, the least over the materials that are possible.

    drive, across (K, N) are |n·b_i| and n·t_i; the others (2, M, N).
    """
    count, facets, wheels = worth.shape
    for m in range(count):
        for k in range(facets):
            for i in range(wheels):
                least = np.inf
                for s in range(2):
                    if possible[s, m, i]:
                        drag = max(across[k, i] * low[s, m, i], across[k, i] * high[s, m, i])
                        least = min(least, drive[k, i] * grip[s, m, i] - drag)
                worth[m, k, i] = least


@kernel
def torque_by_drag(
    on_drag: Array, possible: NDArray[np.bool_], low: Array, high: Array, most: Array, least: Array
) -> None:
    """Greatest and least torque (M, N, N) of wheel i by the drag of wheel j, per newton of j's load.

    on_drag (N, N): torque of i per newton of j's drag; low and high (2, M, N) bound it on each material,
    and possible (2, M, N) says which materials j may stand on.
    """
    count, wheels, _ = most.shape
    for m in range(count):
        for j in range(wheels):
            lower, upper = np.inf, -np.inf
            for s in range(2):
                if possible[s, m, j]:
                    lower, upper = min(lower, low[s, m, j]), max(upper, high[s, m, j])
            for i in range(wheels):
                one, two = on_drag[i, j] * lower, on_drag[i, j] * upper
                most[m, i, j], least[m, i, j] = max(one, two), min(one, two)


@kernel
def fill_rows(force: Array, per_load: Array, per_acceleration: Array, A: Array) -> None:
    """Rows A (M, K, 3) over the acceleration: its force (K, 3) less what the loads it shifts are worth.

    per_load (M, K, N): what a newton of each load is worth; per_acceleration (N, 2) [kg].
    """
    count, rows, wheels = per_load.shape
    for m in range(count):
        for k in range(rows):
            x, y = force[k, 0], force[k, 1]
            for i in range(wheels):
                x -= per_load[m, k, i] * per_acceleration[i, 0]
                y -= per_load[m, k, i] * per_acceleration[i, 1]
            A[m, k, 0], A[m, k, 1], A[m, k, 2] = x, y, force[k, 2]


@kernel
def fill_rays(
    rays: Array,
    wrench: Array,
    across: Array,
    mass: Array,
    per_acceleration: Array,
    friction: tuple[Array, Array, Array],
    load: Array,
    pushed: Array,
    start: Array,
    direction: Array,
    lightest: float,
) -> None:
    """Slopes, grip c₀ + t c₁ and its least in ``rays`` (R, M, N, RAY), and w₀ and w₁ in ``wrench`` (R, M, 6).

    friction (M, N) are drive grip and drag per load, and slopes; load (M, N) without acceleration [N]; pushed
    (M, 3) the external wrench; across (3, N), mass (3,), per_acceleration (N, 2) the model's; start and
    direction (R, M, 3) accelerations; lightest [N] the load that a lifted wheel is taken to carry.
    """
    mu, drag, slope = friction
    for r in range(len(start)):
        for m in range(len(mu)):
            a, d, out = start[r, m], direction[r, m], wrench[r, m]
            for c in range(3):
                out[c], out[3 + c] = a[c] * mass[c] - pushed[m, c], d[c] * mass[c]
            for i in range(mu.shape[1]):
                ray, px, py = rays[r, m, i], per_acceleration[i, 0], per_acceleration[i, 1]
                load0, load1 = load[m, i] + px * a[0] + py * a[1], px * d[0] + py * d[1]
                ray[SLOPE], ray[LEAST] = slope[m, i], mu[m, i] * lightest
                ray[GRIP_0], ray[GRIP_1] = mu[m, i] * load0, mu[m, i] * load1
                for c in range(3):
                    out[c] += across[c, i] * drag[m, i] * load0
                    out[3 + c] += across[c, i] * drag[m, i] * load1
