"""The documented search for what the paper does not print: radius, β = m r²/I and three rotor angles.

Least squares over the printed results, each in units of what its printed digits resolve (1 mm, 1 mrad;
2 mm for the 14 mm of the initial model, whose reading at 3.5 s or after stopping is not stated).  The
heading on carpet enters by its size: eq. (10) gives it the other sign.  First the initial model, which
knows no rotor angles, ranks radius and β; then random rotor angles for the best of them; then a
simplex search from the best few.  Not unique: eight printed numbers, five unknowns, a rough landscape.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.paper.numbers import published
from slipmargin.paper.published import DISTANCE_M, PITCH_RAD, Unprinted, ends, paper_model

#: Printed end of the run (x short, y, φ) and what the digits resolve.
_KEYS = ("x_short", "y", "phi")
INITIAL, INITIAL_UNIT = (
    np.array([published(f"initial_paper_{k}") for k in _KEYS]),
    np.array([0.002, 0.001, 0.001]),
)
_IMPROVED, _IMPROVED_UNIT = (
    np.array([published(f"improved_paper_{k}") for k in _KEYS]),
    np.array([0.001, 0.001, 0.001]),
)
_CARPET_PHI, _CARPET_UNIT = published("improved_carpet_phi"), 0.003


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Calibration:
    """What the search found, its misfit (root mean square in printed digits) and how it looked."""

    unprinted: Unprinted
    misfit: float
    tried: int
    seed: int


def calibrate(*, seed: int = 0, draws: int = 2000, best: int = 3, refine: int = 300) -> Calibration:
    """Search again.

    Parameters
    ----------
    seed : int
        Of the random rotor angles.
    draws : int
        Sets of random rotor angles tried.
    best, refine : int
        How many of them a simplex search refines, and its steps.
    """
    from scipy.optimize import minimize

    rng = np.random.default_rng(seed)
    grid = [(r, b) for r in np.linspace(0.075, 0.115, 9) for b in np.linspace(0.6, 1.6, 11)]
    plain = initial_misfits(grid)
    ranked = [grid[k] for k in np.argsort(plain)[:8]]
    angles = rng.uniform(0.0, PITCH_RAD, (draws, 3))
    tries = np.column_stack([np.array([ranked[k % len(ranked)] for k in range(draws)]), angles])
    score = misfits(tries)
    found, tried = [], draws
    for k in np.argsort(score)[:best]:
        step = np.vstack([tries[k], tries[k] + np.diag([0.004, 0.08, 0.05, 0.05, 0.05])])
        done = minimize(
            lambda x: float(misfits(x[None, :])[0]),
            tries[k],
            method="Nelder-Mead",
            options={"maxfev": refine, "initial_simplex": step, "xatol": 1e-5, "fatol": 1e-6},
        )
        found.append((float(done.fun), done.x))
        tried += int(done.nfev)
    misfit, x = min(found, key=lambda pair: pair[0])
    unprinted = Unprinted(radius_m=float(x[0]), beta=float(x[1]), angles_rad=np.mod(x[2:], PITCH_RAD))
    return Calibration(unprinted=unprinted, misfit=misfit, tried=tried, seed=seed)


def initial_misfits(pairs: Sequence[tuple[float, float]]) -> Array:
    """Mean square misfit of the initial model, in printed digits, for each (radius [m], β)."""
    models = [
        paper_model(
            "paper",
            improved=False,
            unprinted=Unprinted(radius_m=r, beta=b, angles_rad=np.zeros(3)),
        )
        for r, b in pairs
    ]
    end = ends(models, np.zeros((len(pairs), 3)), which=np.arange(len(pairs)))
    return np.asarray(np.mean(((_short(end) - INITIAL) / INITIAL_UNIT) ** 2, axis=1))


def _short(end: Array) -> Array:
    """x short of the goal, y, φ from end poses (R, 3)."""
    return np.asarray(np.array([DISTANCE_M, 0.0, 0.0]) + np.array([-1.0, 1.0, 1.0]) * end)


def misfits(x: Array) -> Array:
    """Misfit of each row (radius, β, three angles); a simplex may step outside, where it is very large."""
    inside = (x[:, 0] > 0.03) & (x[:, 0] < 0.3) & (x[:, 1] > 0.2) & (x[:, 1] < 5.0)
    out = np.full(len(x), 1e6)
    if not inside.any():
        return out
    rows = x[inside]
    makers, which = np.unique(rows[:, :2], axis=0, return_inverse=True)
    unprinted = [Unprinted(radius_m=r, beta=b, angles_rad=np.zeros(3)) for r, b in makers]
    which = np.asarray(which, dtype=np.int64).reshape(-1)
    plain = initial_misfits([(float(r), float(b)) for r, b in makers])[which]
    found = {
        s: _short(
            ends([paper_model(s, improved=True, unprinted=u) for u in unprinted], rows[:, 2:], which=which)
        )
        for s in ("paper", "carpet")
    }
    paper = np.sum(((found["paper"] - _IMPROVED) / _IMPROVED_UNIT) ** 2, axis=1)
    carpet = ((np.abs(found["carpet"][:, 2]) - _CARPET_PHI) / _CARPET_UNIT) ** 2
    out[inside] = np.sqrt((3.0 * plain + paper + carpet) / 7.0)
    return out
