"""What a run would tell: how far explanations differ in it, and what it adds to an interval.

Two explanations predict the same wheels' motion; the difference of their poses, whitened by the noise of the
data set and freed of the unknown start pose, is what a run can tell.  A rival whose parameters are free takes
a part of it up.  With a difference d (K,) in the new runs, the rival's tangents J (K, P) there and its
information A (P, P) from the runs that there are, the rise of its sum of squares after the best refit is

    T = min over δ of δᵀ A δ + |d + J δ|² = dᵀd − gᵀ (A + JᵀJ)⁻¹ g,   g = Jᵀd

(T-optimality for discriminating between models: A. C. Atkinson and V. V. Fedorov, Biometrika 62, 57, 1975).
For an interval information adds up: the covariance becomes (A + JᵀJ)⁻¹.  All is linear in the parameters;
what is reported in the end is a fit by simulation (:mod:`~slipmargin.experiment.refit`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.diagnosis.fit import Fit, GaussianPrior, evaluate, limits_of
from slipmargin.diagnosis.prepare import Trial, clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.experiment.timing import Drive
from slipmargin.physics.kinematics import integrated


def information(slopes: Array, scale: Array, misfit: float) -> Array:
    """JᵀJ (R, P, P) per scale²: what each run says of the parameters, noise counted ``misfit`` times."""
    scaled = slopes * scale / misfit
    return np.asarray(np.einsum("rkp,rkq->rpq", scaled, scaled))


def known(found: Fit, misfit: float) -> Array:
    """Information (P, P) per scale² of all the runs of a fit, with the prior's."""
    prior = GaussianPrior.of(found.structure, found.residual)
    own = information(found.jacobian, limits_of(found.structure)[2], misfit)
    total = own.sum(axis=0) + prior.precision / misfit**2
    return np.asarray(total + (1e-10 * np.trace(total) + 1e-12) * np.eye(len(total)))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contrast:
    """How an explanation that is right differs from a rival in each of R runs.

    ``square`` (R,) is dᵀd, ``pull`` (R, P) is Jᵀd and ``normal`` (R, P, P) is JᵀJ of the rival, per scale;
    ``before`` (P, P) is what the runs that there are say of the rival.
    """

    square: Array
    pull: Array
    normal: Array
    before: Array

    @staticmethod
    def of(right: Fit, rival: Fit, before: Array, misfit: float) -> Contrast:
        """From both, evaluated on the same new runs; ``before`` is the rival's :func:`known`."""
        apart = (rival.residual - right.residual) / misfit
        scale = limits_of(rival.structure)[2]
        return Contrast(
            square=np.einsum("rk,rk->r", apart, apart),
            pull=np.einsum("rkp,rk->rp", rival.jacobian * scale / misfit, apart),
            normal=information(rival.jacobian, scale, misfit),
            before=before,
        )

    def gain(self, runs: Sequence[int]) -> float:
        """T of these runs driven together: by how much the rival's χ² will rise."""
        rows = list(runs)
        pull, square = self.pull[rows].sum(axis=0), float(self.square[rows].sum())
        if not len(pull):
            return square
        total = self.before + self.normal[rows].sum(axis=0)
        return max(0.0, square - float(pull @ np.linalg.solve(total, pull)))


def problem_of_drives(problem: Problem, drives: Sequence[Drive], seed: int) -> Problem:
    """The runs that would be logged if the wheels did as each drive says, poses as planned.

    Wheels start at angles that nobody knows: drawn.
    """
    rng = np.random.default_rng([seed, 6])
    held = problem.commanded and any(t.record.commands_held for t in problem.trials)
    angles = not problem.commanded and any(t.record.theta is not None for t in problem.trials)
    trials = []
    for k, drive in enumerate(drives):
        t, omega = drive.trajectory.t_s, drive.trajectory.omega
        theta = rng.uniform(0.0, 2.0 * np.pi, omega.shape[1]) + integrated(t, omega)
        record = Record(
            name=f"next-{k:03d}",
            t_s=t,
            pose=drive.trajectory.pose,
            omega=None if problem.commanded else omega,
            theta=theta if angles else None,
            omega_cmd=omega if problem.commanded else None,
            commands_held=held,
        )
        trials.append(clean(record, problem.sigma))
    return _with_trials(problem, trials)


def _with_trials(problem: Problem, trials: Sequence[Trial]) -> Problem:
    """Other runs, compared as those of a problem are."""
    made = Problem.of(problem.recipe, problem.surface, tuple(trials), problem.sigma, problem.commanded)
    return replace(made, lasting=problem.lasting, piece=problem.piece).with_rough()


def only(problem: Problem, rows: Sequence[int]) -> Problem:
    """The same problem with some of its runs."""
    return _with_trials(problem, [problem.trials[k] for k in rows])


def evaluated(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    """Each explanation on new runs: residuals against the plan, and tangents."""
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    return [evaluate(problem, f.structure, f.x, everyone) for f in fits]
