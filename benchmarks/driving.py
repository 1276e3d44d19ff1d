"""Random aggressive commands, what a limiter makes of them, and the robot that follows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import slipmargin as sm
from slipmargin.model import Model
from slipmargin.sim.run import Run
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate

#: Time between commands [s], and how many of them one wish lasts.
TICK_S, WISH = 0.01, 25
Limit = Callable[[np.ndarray, np.ndarray], np.ndarray]


def on_rollers(model: Model) -> Model:
    """The model with wheels that never stand on rigid material."""
    return replace(model, grip=replace(model.grip, rigid_fraction=np.zeros(model.count)))


def wishes(model: Model, seed: int, ticks: int) -> np.ndarray:
    """(ticks, 3) wanted body twists that jump every 0.25 s, one in seven a stop."""
    rng = np.random.default_rng(seed)
    arm = float(np.mean(np.abs(model.wrench_maps()[0][2])))
    top = model.drives.max_speed_rad_s
    fastest = 2.0 if top is None else min(2.0, 0.8 * top * float(np.min(model.geometry.radius_m)))
    out = []
    for _ in range(-(-ticks // WISH)):
        way = rng.normal(size=3)
        way *= fastest / np.linalg.norm(way) * np.array([1.0, 1.0, 0.5 / arm]) * rng.uniform(0.2, 1.2)
        out.append(np.zeros(3) if rng.uniform() < 0.15 else way)
    return np.repeat(out, WISH, axis=0)[:ticks]


def slip_limit(limiter: sm.Limiter) -> Limit:
    """The limiter as a function of the last and the wanted twist."""
    return lambda now, wanted: limiter.limit_twist(now, wanted, TICK_S)[0]


def axis_limit(most: np.ndarray) -> Limit:
    """Each axis cut on its own to ``most`` (3,) [m/s², m/s², rad/s²], as velocity smoothers do."""
    return lambda now, wanted: now + np.clip(wanted - now, -most * TICK_S, most * TICK_S)


def ellipse_limit(most: np.ndarray) -> Limit:
    """A change of velocity cut back along its direction to an ellipsoid with semi-axes ``most``."""

    def limited(now: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        size = float(np.linalg.norm((wanted - now) / (most * TICK_S)))
        return now + (wanted - now) / max(1.0, size)

    return limited


def commanded(limit: Limit, wanted: np.ndarray) -> np.ndarray:
    """(ticks + 1, 3) twists that a limit makes of wanted ones, from rest."""
    twists = [np.zeros(3)]
    for wish in wanted:
        twists.append(limit(twists[-1], wish))
    return np.array(twists)


def driven(model: Model, twists: np.ndarray) -> Run:
    """The simulated robot whose wheels follow the twists along straight lines, four samples a tick."""
    t = TICK_S * np.arange(len(twists))
    signal = linear(t, model.geometry.wheel_speeds(twists))
    return simulate(model, signal, np.linspace(0.0, t[-1], 4 * (len(t) - 1) + 1), rtol=1e-6)


def compared(model: Model, limiter: sm.Limiter, seed: int, ticks: int) -> dict[str, Any]:
    """Largest share of the grip with the limiter, and with per-axis clipping of the same strength.

    The same strength: what the limiter itself changed the velocity by, on the average of its working ticks.
    """
    wanted = wishes(model, seed, ticks)
    twists = commanded(slip_limit(limiter), wanted)
    change = np.abs(np.diff(twists, axis=0)) / TICK_S
    busy = np.max(np.abs(wanted - twists[1:]), axis=1) > 1e-6
    most = np.mean(change[busy], axis=0) if np.any(busy) else np.ones(3)
    out: dict[str, Any] = {"share": float(limiter.table.share)}
    for name, path in (("limiter", twists), ("per axis", commanded(axis_limit(most), wanted))):
        out[name] = peak(model, path)
    return out


def peak(model: Model, twists: np.ndarray) -> float:
    """Largest share of a wheel's grip on the way; infinite where the robot tips."""
    try:
        return float(np.max(driven(model, twists).utilisation))
    except sm.errors.MotionStopped:
        return float("inf")
