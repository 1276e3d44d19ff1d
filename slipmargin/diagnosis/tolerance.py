"""How finely a search simulates: as coarsely as what it compares allows.

How far errors of the steps grow differs a hundredfold from robot to robot, and from effect to effect, at one
tolerance.  The model as it is decides with which one a search begins; each fit is looked at once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, fit, misfit_of
from slipmargin.diagnosis.problem import FINE_RTOL, Problem
from slipmargin.effects import AnyEffect

#: Tolerances with which a search may begin [1], the coarsest first; a fit may need the final one.
_RTOLS = (1e-4, 3e-5, 1e-5)
#: The error that one may make in any run by the model as it is [noise, root mean square]: it adds half a
#: thousandth to a chi of one.
_ERROR = 0.03
#: … and by a fit, as a share of what this leaves [1]: half a hundredth of its chi.
_SHARE = 0.1


def eased(problem: Problem, trials: Index) -> Problem:
    """The same problem, simulated only as finely as these trials need by the model as it is."""
    return _fine_enough(replace(problem, rtol=_RTOLS[0]), (), trials, _ERROR, _RTOLS)


def fitted_finely(
    view: Problem,
    structure: tuple[Candidate, ...],
    x: Array,
    trials: Index,
    expired: Callable[[], bool] = lambda: False,
    give_up_above: float = np.inf,
) -> tuple[Problem, Fit]:
    """A structure fitted to trials from ``x``, and the view, simulated finely enough for it."""
    found = fit(view, structure, x, trials, give_up_above=give_up_above, expired=expired)
    while structure and not expired():
        error = _SHARE * np.sqrt(misfit_of(found.residual))
        finer = _fine_enough(view, found.effects, trials, error, (*_RTOLS, FINE_RTOL))
        if finer.rtol == view.rtol:
            break
        view = finer
        found = fit(view, structure, found.x, trials, give_up_above=give_up_above, expired=expired)
    return view, found


def _fine_enough(
    problem: Problem,
    effects: tuple[AnyEffect, ...],
    trials: Index,
    error: float,
    rtols: tuple[float, ...],
) -> Problem:
    """The problem, or at the first of ``rtols`` at which no run is off by more than ``error`` [noise].

    That is the difference to the next finer one; the last is taken as it is.
    """
    finer = [replace(problem, rtol=rtol) for rtol in rtols if rtol < problem.rtol]
    mine = problem.residuals([effects], [trials])[0] if finer else np.zeros((0, 0))
    for one, other in pairwise([problem, *finer]):
        known = other.residuals([effects], [trials])[0]
        counts = np.maximum(1, np.count_nonzero(known, axis=1))
        if np.max(np.sum((mine - known) ** 2, axis=1) / counts) <= error**2:
            return one
        mine = known
    return finer[-1] if finer else problem
