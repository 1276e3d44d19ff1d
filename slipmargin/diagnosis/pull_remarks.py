"""What a report on pulls says beside its numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.diagnosis.pull_instrument import Fault
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.pull_search import PullState
from slipmargin.diagnosis.pull_unseen import Unseen
from slipmargin.diagnosis.settings import PULLS


def remarks(
    problem: PullProblem,
    state: PullState,
    unseen: Unseen,
    noise_from: str,
    wrong: Sequence[Fault],
    *,
    taken: bool,
) -> tuple[str, ...]:
    """Sentences on the noise, on what is left, and on what the pulls do not say."""
    said = []
    if taken and unseen.misfit_after:
        said.append(
            f"What was found leaves a residual of {unseen.after.chi:.2f} times the noise on orientations "
            "left out: something is still missing, or a form is only approximate."
        )
    if state.structure and not taken:
        names = " + ".join(c.label for c in state.structure)
        why = (
            f"one orientation, left out, is then predicted worse by {unseen.worst:.1f} times the noise"
            if unseen.worst > PULLS.worse
            else f"orientations left out of the search gain too little (chi {unseen.before.chi:.3g} → "
            f"{unseen.after.chi:.3g}, p = {unseen.p_value:.2g})"
        )
        said.append(f"Fitted to all pulls, {names} would be taken, but {why}.")
    said += _of_the_test(problem, state, wrong, taken=taken)
    if noise_from == "residual":
        said.append(
            "The noise is what the model found leaves of all pulls: its chi is near 1, whatever it misses. "
            "State force_N under [sigma] to have it judged."
        )
    if noise_from == "neighbours":
        said.append(
            "No orientation was pulled often enough to show the noise; differences between neighbouring "
            "orientations stand in for it and may be too large. Pull each orientation twice, or state "
            "force_N under [sigma]."
        )
    if problem.pulls.theta_rad is None and np.any(problem.model(state.fit.effects).grip.rigid_fraction > 0.0):
        said.append(
            "The wheel angles are not given: each wheel is taken to stand on rigid material as often as its "
            "share of the circumference. With theta1_rad … every pull says much more."
        )
    stuck = state.fit.at_bound() if taken else []
    if stuck:
        said.append("At the edge of its range: " + ", ".join(stuck) + ".")
    return tuple(said)


def _of_the_test(problem: PullProblem, state: PullState, wrong: Sequence[Fault], *, taken: bool) -> list[str]:
    """What may be wrong with the test itself."""
    pulls = problem.count(problem.everyone)
    than = f" as well as {' + '.join(c.label for c in state.structure)}" if taken else ""
    said = [f"{f.said} explains these pulls{than} (chi {np.sqrt(f.cost / pulls):.3g})" for f in wrong]
    return [f"{one[0].upper()}{one[1:]}: rule that out first." for one in said]
