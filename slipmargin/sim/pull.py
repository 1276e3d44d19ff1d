"""A virtual pull test: wheels locked, a force that grows until the robot runs away.

With locked wheels a steady creep balances the pull: eq. (11) is the gradient of a convex potential,
so a creep exists exactly for pulls inside the wrench set (docs/theory.md, section 2).  The rope keeps its
direction relative to the robot, as a hand that follows it would.  Near the limit each sliding contact
still lacks (2/π)/(k u) of its friction, so the pull at creep s is F_e (1 − A/s): two creeps s and s/2
on one slow ramp give F_e without the lag, 2 F(s) − F(s/2), and the contacts that slide are those
whose slip doubled with s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError, NoSolution
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.sim.batch import Batch, Outcome
from slipmargin.sim.pack import pack, stack
from slipmargin.sim.signal import held

#: Creep at which the robot is taken to run away, in units of 1/k: eq. (11) is then within 1 % of its limit.
CREEP = 64.0
#: How many times slower the second ramp is than the robot takes to run away.
PATIENCE = 1000.0
_SAMPLES = 4000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullTest:
    """Breakaway forces ``force_N`` (M,) at orientations ``phi_rad`` (M,), pulled along the floor's +x.

    ``sliding`` (M, N, 2): which contacts slide at breakaway, along ĝ and f̂.
    """

    phi_rad: Array
    force_N: Array
    sliding: NDArray[np.bool_]


def standing(model: Model, rigid: tuple[bool, ...]) -> Model:
    """The model with every wheel held on a roller (False) or on rigid material (True)."""
    if len(rigid) != model.count:
        raise InputError(
            "rigid", f"names {len(rigid)} wheels, the robot has {model.count}", "give one value a wheel"
        )
    mask = np.array(rigid, dtype=bool)[:, None]
    grip = replace(
        model.grip,
        roller=np.where(mask, model.grip.rigid, model.grip.roller),
        rigid_fraction=np.zeros(model.count),
    )
    return replace(model, grip=grip)


def pull_test(model: Model, phi_rad: Array, *, rigid: tuple[bool, ...] | None = None) -> PullTest:
    """Pull the robot at each orientation until it runs away.

    Parameters
    ----------
    model : Model
        The machine on its surface.
    phi_rad : array (M,)
        Orientation φ of the robot under a pull along +x of the floor, through the centre of mass [rad].
    rigid : tuple of bool, optional
        Which wheels stand on rigid material; all on rollers by default.

    Raises
    ------
    NoSolution
        If the robot does not run away at any force tried, or tips first.
    """
    phi = frozen("phi_rad", phi_rad, (None,))
    still = standing(model, (False,) * model.count if rigid is None else rigid)
    grip, n = still.grip, still.count
    most = float(np.sum(still.loads.rest_N * np.hypot(*grip.roller.T)))
    creep = CREEP / grip.k_s_per_m
    first = _ramp(
        still,
        phi,
        np.zeros(len(phi)),
        np.full(len(phi), 1.5 * most),
        40.0 * _escape(still, np.full(len(phi), 0.3 * most)),
    )
    force, _ = _breakaway(first, np.zeros(len(phi)), np.full(len(phi), 1.5 * most), creep, n)
    low, high = 0.8 * force, 1.03 * force
    second = _ramp(still, phi, low, high, PATIENCE * _escape(still, force))
    force, sliding = _breakaway(second, low, high, creep, n)
    return PullTest(phi_rad=phi, force_N=force, sliding=sliding)


def _escape(model: Model, force: Array) -> Array:
    """Time to run away to the creep at a pull right at the limit [s]: m v̇ = (2/π) F/(k v)."""
    return np.asarray(0.25 * np.pi * model.inertia.mass_kg * CREEP**2 / (model.grip.k_s_per_m * force))


def _ramp(model: Model, phi: Array, low: Array, high: Array, seconds: Array) -> Outcome:
    models, signals, times = [], [], []
    for angle, a, b, span in zip(phi, low, high, seconds, strict=True):
        along = np.array([np.cos(angle), -np.sin(angle), 0.0])  # R(φ)ᵀ x̂
        pull = ForceTerm(
            variable=Variable.TIME,
            basis=Basis.HATS,
            shape=np.array([0.0, span]),
            frame=Frame.BODY,
            coefficients=np.outer(along, [a, b]),
        )
        models.append(replace(model, external=replace(model.external, terms=(*model.external.terms, pull))))
        signals.append(held(np.array([0.0, span]), np.zeros((2, model.count))))
        times.append(np.linspace(0.0, span, _SAMPLES))
    batch = Batch(signals, times)
    return batch.run(stack([pack(m) for m in models]), np.zeros(3), which=np.arange(len(phi)), tell=True)


def _breakaway(
    outcome: Outcome, low: Array, high: Array, creep: float, n: int
) -> tuple[Array, NDArray[np.bool_]]:
    assert outcome.slip is not None
    runs = len(low)
    force, sliding = np.empty(runs), np.zeros((runs, n, 2), dtype=bool)
    for r in range(runs):
        slip = np.abs(outcome.slip[r])
        speed = np.max(slip, axis=(1, 2))
        past = np.flatnonzero(speed > creep)
        if not len(past):
            raise NoSolution(
                "pull test", "the robot does not run away", "check its friction and loads", outcome.ending[r]
            )
        at = [_crossing(speed, level) for level in (creep, 0.5 * creep)]
        pull = [low[r] + (high[r] - low[r]) * x / (_SAMPLES - 1) for x in at]
        force[r] = 2.0 * pull[0] - pull[1]
        there, half = (_between(slip, x) for x in at)
        sliding[r] = there > 1.5 * half
    return force, sliding


def _crossing(speed: Array, level: float) -> float:
    """Sample number (with fraction) at which the creep first passes a level; 1/speed is nearly straight."""
    k = max(int(np.argmax(speed > level)), 1)
    a, b = 1.0 / max(speed[k - 1], 1e-12), 1.0 / speed[k]
    return float(k - 1 + (a - 1.0 / level) / (a - b))


def _between(slip: Array, x: float) -> Array:
    k = min(int(x), len(slip) - 2)
    return np.asarray(slip[k] + (x - k) * (slip[k + 1] - slip[k]))
