"""The compiled kernel at one instant, for Python."""

from __future__ import annotations

import numpy as np
from numba import njit
from oracles.plain_simulator import acceleration

from slipmargin.sim import layout as at
from slipmargin.sim.body import evaluate, slopes, wheel_rate
from slipmargin.sim.columns import ALPHA, BODY, CONTACT, JAMMED, LOAD, OMEGA, RIGID, SLIP_W, THETA
from slipmargin.sim.pack import pack


@njit(error_model="numpy")  # not kept on disk: numba would not see the kernel change
def instant(P, t, y, C, B, acc, J, driven, rate):
    """Everything the kernel knows of one instant, for Python."""
    W = P[at.HEAD : at.HEAD + len(C) * at.WHEEL].reshape(len(C), at.WHEEL)
    evaluate(P, W, t, y, C, B, acc)
    for i in range(driven):
        rate[i] = wheel_rate(P, W[i], C[i], 3.0, 0.0)
    slopes(P, W, t, y, C, B, J, driven)


def compiled(model, t, y, wheels, rigid, push):
    """(a, ω̇), slip and loads by the compiled road."""
    acc, C, _ = tables(model, t, y, wheels, rigid, push)
    return acc, C[:, SLIP_W : SLIP_W + 2].T, C[:, LOAD]


def tables(model, t, y, wheels, rigid, push):
    """(a, ω̇), what is known of the wheels and of the body, by the compiled road."""
    C, B, acc = np.zeros((model.count, CONTACT)), np.zeros(BODY), np.zeros(3)
    C[:, THETA], C[:, OMEGA], C[:, ALPHA], C[:, RIGID] = *wheels, rigid
    B[:3] = push
    instant(np.array(pack(model)), t, y, C, B, acc, np.zeros((3, 7)), 0, np.zeros(1))
    return acc, C, B


def same_acceleration(model, found, want):
    """Asserts that two (a, ω̇) agree: in one unit, since each sums up forces that may cancel in the others.

    Returns what they may differ by [m/s²].
    """
    arm = np.mean(np.hypot(*(model.geometry.position_m - model.inertia.com_m).T))
    found, want = (np.asarray(each) * [1.0, 1.0, arm] for each in (found, want))
    allowed = 1e-9 * (1.0 + np.abs(want).max())
    np.testing.assert_allclose(found, want, rtol=0.0, atol=allowed)
    return allowed


def agrees(model, seed, speed=0.05):
    """Asserts that both roads give the same acceleration, slip and loads in some state.

    A robot that tips may have several accelerations that agree with their own loads: the readable road begins
    at the one that was found.  Where the compiled road says that it found none it gives none out.
    """
    y, wheels, rigid, push = somewhere(model.count, seed, speed)
    acc, C, B = tables(model, 0.1, y, wheels, rigid, push)
    if B[JAMMED] > 0.0:
        return
    slip, load = C[:, SLIP_W : SLIP_W + 2].T, C[:, LOAD]
    want, want_slip, _, want_load = acceleration(model, 0.1, y, wheels, rigid, push, guess=acc[:2])
    allowed = same_acceleration(model, acc, want)
    np.testing.assert_allclose(slip, want_slip, rtol=1e-12, atol=1e-14)
    # Loads follow the acceleration: where that is of 300 m/s², its last digits move 1e-8 N.
    moved = allowed * np.abs(model.loads.per_acceleration_kg).max()
    np.testing.assert_allclose(load, want_load, rtol=1e-8, atol=1e-9 + moved)


def somewhere(count, seed, speed=0.05):
    """A state, a wheel motion and sectors in which wheels slide at about ``speed``."""
    rng = np.random.default_rng(seed)
    y = np.concatenate(
        [
            rng.uniform(-0.3, 0.3, 2),
            rng.uniform(-2.0, 2.0, 1),
            speed * rng.uniform(-1.0, 1.0, 2),
            speed * 5.0 * rng.uniform(-1.0, 1.0, 1),
        ]
    )
    wheels = (rng.uniform(-7.0, 7.0, count), rng.uniform(-3.0, 3.0, count), rng.uniform(-9.0, 9.0, count))
    return y, wheels, rng.integers(0, 2, count).astype(bool), rng.uniform(-2.0, 2.0, 3)
