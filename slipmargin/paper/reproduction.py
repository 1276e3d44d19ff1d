"""The whole reproduction in one call: rows, values of Fig. 8, spread over rotor angles, studies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from slipmargin.paper.figure8 import Curve, fig8_curves
from slipmargin.paper.identify import STEPS as STUDY_STEPS, Identifiability, identifiability
from slipmargin.paper.published import FOUND, Spread, Unprinted, spread
from slipmargin.paper.recompute import recompute
from slipmargin.paper.rows import Row
from slipmargin.paper.search import Calibration, calibrate
from slipmargin.paper.simulated import Runs, paper_runs

#: Rotor angles drawn for each surface.
RUNS = 1000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reproduction:
    """What ``slipmargin reproduce`` reports; ``calibration`` and ``studies`` are None if not asked for."""

    unprinted: Unprinted
    calibration: Calibration | None
    runs: Runs
    numbers: tuple[Row, ...]
    claims: tuple[Row, ...]
    fig8: tuple[Curve, ...]
    spreads: tuple[Spread, ...]
    studies: Identifiability | None
    seed: int


def steps(*, search: bool, study: bool) -> int:
    """How often :func:`reproduce_paper` calls ``advance``."""
    return 4 + int(search) + (STUDY_STEPS if study else 0)


def reproduce_paper(
    *,
    seed: int = 0,
    search: bool = False,
    study: bool = False,
    advance: Callable[[], object] = lambda: None,
) -> Reproduction:
    """Compute every printed number and claim again.

    Parameters
    ----------
    seed : int
        Of all random draws.
    search : bool
        Whether to search again for what the paper does not print.
    study : bool
        Whether to run :func:`slipmargin.paper.identify.identifiability`, about 20 000 runs.
    advance : callable
        Called after each of :func:`steps` steps.
    """
    found = calibrate(seed=seed) if search else None
    unprinted = FOUND if found is None else found.unprinted
    if search:
        advance()
    runs = paper_runs(unprinted)
    advance()
    numbers, claims = recompute(unprinted, runs)
    advance()
    spreads = []
    for surface in ("paper", "carpet"):
        spreads.append(spread(surface, runs=RUNS, seed=seed, unprinted=unprinted))
        advance()
    return Reproduction(
        unprinted=unprinted,
        calibration=found,
        runs=runs,
        numbers=numbers,
        claims=claims,
        fig8=fig8_curves(),
        spreads=tuple(spreads),
        studies=identifiability(seed=seed, advance=advance) if study else None,
        seed=seed,
    )
