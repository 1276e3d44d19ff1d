"""How finely a search simulates: as coarsely as what it compares allows.

How far errors of the steps grow differs a hundredfold from robot to robot, and from effect to effect, at one
tolerance.  The model as it is decides with which one a search begins; each fit is looked at once more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, fit, misfit_of
from slipmargin.diagnosis.problem import FINE_RTOL, Problem

#: Tolerances with which a search may begin [1], the coarsest first; a fit may need the final one.
_RTOLS = (1e-4, 3e-5, 1e-5)
#: The error that one may make in any run by the model as it is [noise, root mean square]: it adds half a
#: thousandth to a chi of one.
_ERROR = 0.03
#: … and by a fit, as a share of what this leaves [1]: its chi is then right to 4 %, where chis that differ by
#: 6 % may be as good.  With a third of it a search on a real robot took twice as long.
_SHARE = 0.3


def eased(problem: Problem, trials: Index) -> Problem:
    """The same problem, simulated only as finely as each of these trials needs by the model as it is."""
    view = replace(problem, rtol=_RTOLS[0])
    residual = view.residuals([()], [trials])[0]
    while (finer := _finer(view, _RTOLS)) is not None:
        known = finer.residuals([()], [trials])[0]
        if np.max(_off(residual, known)) <= _ERROR**2:
            break
        view, residual = finer, known
    return view


def fitted_finely(
    view: Problem,
    structure: tuple[Candidate, ...],
    x: Array,
    trials: Index,
    expired: Callable[[], bool] = lambda: False,
    give_up_above: float = np.inf,
) -> tuple[Problem, Fit]:
    """A structure fitted to trials from ``x``, and the view, simulated finely enough for what it leaves."""
    found = fit(view, structure, x, trials, give_up_above=give_up_above, expired=expired)
    while structure and not expired() and (finer := _finer(view, (*_RTOLS, FINE_RTOL))) is not None:
        known = finer.residuals([found.effects], [trials])[0]
        if np.mean(_off(found.residual, known)) <= _SHARE**2 * misfit_of(found.residual):
            break
        view = finer
        found = fit(view, structure, found.x, trials, give_up_above=give_up_above, expired=expired)
    return view, found


def _finer(problem: Problem, rtols: tuple[float, ...]) -> Problem | None:
    """The same problem at the next finer tolerance, None where there is none."""
    return next((replace(problem, rtol=rtol) for rtol in rtols if rtol < problem.rtol), None)


def _off(residual: Array, known: Array) -> Array:
    """Mean square (R,) of the difference of two residuals (R, K) of each run."""
    counts = np.maximum(1, np.count_nonzero(known, axis=1))
    return np.asarray(np.sum((residual - known) ** 2, axis=1) / counts)
