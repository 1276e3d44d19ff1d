"""What a pull test itself may have wrong: the scale, the zero of the orientations, a drift in the session.

Each is one number, fitted to the model as believed.  None is an effect of the robot, and several cannot be
told from one: coefficients that are all larger by a factor pull as a scale does that reads too much.  So none
is claimed; one that explains the pulls as well as what was found cannot be told from it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import Fit, misfit_of
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.settings import SETTINGS

#: Farthest that each number is looked for: a share of the force, of its mean, an angle [rad], a share again.
_FARTHEST = (0.5, 0.5, 0.3, 0.5)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One thing that may be wrong with a pull test, and the sum of squares that it leaves.

    ``share`` is its number: a share of the force or of the mean force [1], or an angle [rad].
    """

    said: str
    share: float
    cost: float

    def as_good_as(self, found: Fit, pulls: int) -> bool:
        """Whether it leaves no more than what was found, each parameter of that counted as ln n.

        Source: the Bayesian information criterion (G. Schwarz, Annals of Statistics 6, 461, 1978).
        """
        worth = misfit_of(found.residual) * np.log(pulls)
        return bool(self.cost + worth <= found.cost + len(found.x) * worth)


def explaining(problem: PullProblem, found: Fit | None) -> list[Fault]:
    """What explains the pulls as well as what was ``found``, or, without that, down to the noise."""
    pulls = problem.count(problem.everyone)
    least = pulls * SETTINGS.noise_chi**2
    return [f for f in faults(problem) if (f.cost <= least if found is None else f.as_good_as(found, pulls))]


def faults(problem: PullProblem) -> list[Fault]:
    """What explains the pulls by itself beside the model as believed, best first."""
    from scipy.optimize import least_squares

    found = []
    for (wrong, told), farthest in zip(_KINDS, _FARTHEST, strict=True):

        def residual(x: Array, wrong: _Wrong = wrong) -> Array:
            moved = wrong(problem, float(x[0]))
            return moved.residuals([()], [moved.everyone])[0].ravel()

        fitted = least_squares(residual, np.zeros(1), bounds=(-farthest, farthest), x_scale=0.01)
        x = float(fitted.x[0])
        found.append(Fault(said=told(problem, x), share=x, cost=2.0 * float(fitted.cost)))
    return sorted(found, key=lambda f: f.cost)


#: A problem as it were if an instrument had been wrong by a number.
_Wrong = Callable[[PullProblem, float], PullProblem]


def _with_forces(problem: PullProblem, force_N: Array) -> PullProblem:
    return replace(problem, pulls=replace(problem.pulls, force_N=force_N))


def _gain(problem: PullProblem, x: float) -> PullProblem:
    return _with_forces(problem, problem.pulls.force_N / (1.0 + x))


def _tare(problem: PullProblem, x: float) -> PullProblem:
    return _with_forces(problem, problem.pulls.force_N - _tare_N(problem, x))


def _tare_N(problem: PullProblem, x: float) -> float:
    return x * float(np.mean(problem.pulls.force_N))


def _zero(problem: PullProblem, x: float) -> PullProblem:
    settings = problem.settings.copy()
    settings[:, 0] -= x
    return replace(problem, settings=settings)


def _drift(problem: PullProblem, x: float) -> PullProblem:
    force_N = problem.pulls.force_N
    return _with_forces(problem, force_N / (1.0 + x * np.linspace(0.0, 1.0, len(force_N))))


def _gain_said(problem: PullProblem, x: float) -> str:
    return f"a scale that reads {1.0 + x:.3g} times what pulls (or a mass that is as much off)"


def _tare_said(problem: PullProblem, x: float) -> str:
    offset_N = _tare_N(problem, x)
    return f"a scale that reads {abs(offset_N):.2g} N too {'much' if offset_N > 0.0 else 'little'}"


def _zero_said(problem: PullProblem, x: float) -> str:
    return f"a zero of the orientations that is {abs(np.rad2deg(x)):.2g}° off"


def _drift_said(problem: PullProblem, x: float) -> str:
    way = "grows" if x > 0.0 else "falls"
    return f"a force that {way} by {100.0 * abs(x):.2g} % from the first row to the last (as a floor wears)"


_KINDS: Sequence[tuple[_Wrong, Callable[[PullProblem, float], str]]] = (
    (_gain, _gain_said),
    (_tare, _tare_said),
    (_zero, _zero_said),
    (_drift, _drift_said),
)
