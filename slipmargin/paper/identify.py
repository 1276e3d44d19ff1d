"""How far the printed results determine what the paper does not print, and the sign of φ on carpet.

Two studies over thousands of simulated runs.  The first asks which pairs of centre-to-wheel radius r and
β = m r²/I reproduce the printed results equally well.  The second asks whether any unprinted quantity turns
φ on carpet positive, as printed: r, β and rotor angles; wheels that stay on rigid material or on rollers;
other layouts of the sectors; other loads on the rear wheel.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.model import Model, nominal_model
from slipmargin.paper.published import FOUND, PITCH_RAD, Unprinted, ends, paper_model, paper_robot
from slipmargin.paper.search import initial_misfits, misfits
from slipmargin.robot import LoadRule

#: Draws of r [m], β and rotor angles, and of sector layouts.
DRAWS, LAYOUTS = 2500, 3000
#: Ranges of the draws: radius [m], β, load on the rear wheel as a share of the weight.
RADII_M, BETAS, REAR = (0.06, 0.13), (0.3, 3.0), (0.15, 0.60)
#: Radii at which the ridge of the valley is reported, with rotor angles fitted to the improved model [m].
RIDGE_M = (0.075, 0.085, 0.095, 0.1025)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RidgePoint:
    """The β that suits a radius best, with root mean square misfits in printed digits.

    ``initial`` is over the three numbers of the initial model alone, ``all_results`` over all seven after a
    search for rotor angles.
    """

    radius_m: float
    beta: float
    initial: float
    all_results: float


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SignRange:
    """Final φ of the improved model on carpet over one set of runs [rad]."""

    varied: str
    runs: int
    low_rad: float
    high_rad: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identifiability:
    """Both studies: the misfit of the initial model over (r, β), its ridge, and the ranges of φ."""

    radii_m: Array
    betas: Array
    misfit: Array
    ridge: tuple[RidgePoint, ...]
    signs: tuple[SignRange, ...]
    seed: int


def identifiability(
    *, seed: int = 0, runs: float = 1.0, advance: Callable[[], object] = lambda: None
) -> Identifiability:
    """Both studies; the same seed gives the same result.

    Parameters
    ----------
    seed : int
        Of all random draws.
    runs : float
        Share of the full number of runs: 0.1 for a quick look.
    advance : callable
        Called after each of :data:`STEPS` steps.
    """
    radii = np.linspace(0.06, 0.12, max(5, round(25 * runs)))
    betas = np.geomspace(0.2, 3.2, max(9, round(49 * runs)))
    misfit = np.sqrt(initial_misfits([(r, b) for r in radii for b in betas])).reshape(len(radii), len(betas))
    advance()
    ridge = []
    for radius in RIDGE_M:
        ridge.append(_ridge(radius, seed, runs))
        advance()
    signs = []
    for study in (_unprinted_draws, _constant_states, _sector_layouts, _rear_loads, _all_at_once):
        signs.append(study(np.random.default_rng(seed), runs))
        advance()
    return Identifiability(
        radii_m=radii, betas=betas, misfit=misfit, ridge=tuple(ridge), signs=tuple(signs), seed=seed
    )


#: How often :func:`identifiability` calls ``advance``.
STEPS = 1 + len(RIDGE_M) + 5


def _ridge(radius_m: float, seed: int, runs: float) -> RidgePoint:
    """The best β by the initial model, then the best rotor angles by the improved one."""
    from scipy.optimize import minimize

    betas = np.geomspace(0.2, 3.2, 113)
    plain = np.sqrt(initial_misfits([(radius_m, b) for b in betas]))
    beta = float(betas[np.argmin(plain)])
    draws = max(20, round(400 * runs))
    angles = np.random.default_rng(seed).uniform(0.0, PITCH_RAD, (draws, 3))

    def misfit(a: Array) -> Array:
        return misfits(np.column_stack([np.full(len(a), radius_m), np.full(len(a), beta), a]))

    score = misfit(angles)
    start = angles[np.argmin(score)]
    done = minimize(
        lambda a: float(misfit(a[None, :])[0]),
        start,
        method="Nelder-Mead",
        options={
            "maxfev": max(20, round(250 * runs)),
            "initial_simplex": np.vstack([start, start + 0.05 * np.eye(3)]),
        },
    )
    return RidgePoint(radius_m=radius_m, beta=beta, initial=float(plain.min()), all_results=float(done.fun))


def _carpet(rigid: Array, rollers: NDArray[np.int64], rear: float | None) -> Model:
    """The robot on carpet with these rigid shares and numbers of rollers; ``rear``: load share of wheel 3."""
    robot = paper_robot(improved=True)
    wheels = tuple(
        replace(w, rigid_fraction=float(f), rollers=int(n))
        for w, f, n in zip(robot.wheels, rigid, rollers, strict=True)
    )
    if rear is not None:
        front = (1.0 - rear) / 2.0
        fixed = np.array([front, front, rear])
        robot = replace(robot, load_rule=LoadRule.FIXED, load_fractions=fixed)
    return nominal_model(replace(robot, wheels=wheels), "carpet")


def _range(varied: str, models: list[Model], angles_rad: Array) -> SignRange:
    phi = ends(models, angles_rad, which=np.arange(len(models)))[:, 2]
    return SignRange(varied=varied, runs=len(phi), low_rad=float(phi.min()), high_rad=float(phi.max()))


def _unprinted_draws(rng: np.random.Generator, runs: float) -> SignRange:
    count = max(20, round(DRAWS * runs))
    radius, beta = rng.uniform(*RADII_M, count), rng.uniform(*BETAS, count)
    still = np.zeros(3)
    models = [
        paper_model("carpet", improved=True, unprinted=Unprinted(radius_m=r, beta=b, angles_rad=still))
        for r, b in zip(radius, beta, strict=True)
    ]
    what = f"r {RADII_M[0]:g} to {RADII_M[1]:g} m, β {BETAS[0]:g} to {BETAS[1]:g}, rotor angles"
    return _range(what, models, rng.uniform(0.0, PITCH_RAD, (count, 3)))


def _constant_states(rng: np.random.Generator, runs: float) -> SignRange:
    states = list(itertools.product((0.0, 1.0), repeat=3))
    models = [_carpet(np.array(s), np.full(3, 8), None) for s in states]
    what = "each wheel constantly on rollers or on rigid material"
    return _range(what, models, np.tile(FOUND.angles_rad, (len(models), 1)))


def _layouts(rng: np.random.Generator, count: int) -> tuple[Array, NDArray[np.int64], Array]:
    """Rigid shares 0 to 1, 4 to 12 rollers and start angles, for each wheel on its own."""
    return (
        rng.uniform(0.0, 1.0, (count, 3)),
        rng.integers(4, 13, (count, 3)),
        rng.uniform(0.0, 2.0 * np.pi, (count, 3)),
    )


def _sector_layouts(rng: np.random.Generator, runs: float) -> SignRange:
    rigid, rollers, angles = _layouts(rng, max(20, round(LAYOUTS * runs)))
    models = [_carpet(f, n, None) for f, n in zip(rigid, rollers, strict=True)]
    return _range("sector layouts: rigid share 0 to 1, 4 to 12 rollers, start angles", models, angles)


def _rear_loads(rng: np.random.Generator, runs: float) -> SignRange:
    count = max(20, round(500 * runs))
    rear = np.linspace(*REAR, count)
    models = [_carpet(np.full(3, 0.1), np.full(3, 8), q) for q in rear]
    what = f"load on the rear wheel {100 * REAR[0]:g} to {100 * REAR[1]:g} %, rotor angles"
    return _range(what, models, rng.uniform(0.0, PITCH_RAD, (count, 3)))


def _all_at_once(rng: np.random.Generator, runs: float) -> SignRange:
    rigid, rollers, angles = _layouts(rng, max(20, round(LAYOUTS * runs)))
    states = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    rigid[: len(states)] = states
    rear = rng.uniform(*REAR, len(rigid))
    rear[: len(states)] = REAR[1]
    models = [_carpet(f, n, q) for f, n, q in zip(rigid, rollers, rear, strict=True)]
    return _range("sector layouts, constant states and rear loads at once", models, angles)
