"""What is left open: it answers what the diagnosis of the same runs answers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from diagnoses import taken_for_noise
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.searched import Searched
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.verdict import RunErrors
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import Trace
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.experiment import remaining as left
from slipmargin.experiment.remaining import Question


@pytest.mark.parametrize("near", [False, True])
def test_runs_that_are_unexplained_keep_their_leads_however_small_chi_is(near: bool) -> None:
    """Unseen runs were off, or errors larger than the noise: ``next-run`` said that nothing was missing."""
    loads = WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0)
    plant = Plant(name="loads", traces=(Trace.WHEEL_LOAD,), effects=(loads,))
    data = planted(smooth_kiwi(), plant, seed=2, count=4, duration_s=1.5, rate_hz=50.0)
    problem, everyone = problem_of(data), np.arange(4)
    named = {c.label: c for c in named_candidates(problem.nominal.geometry.names, False, ())}

    def state(*labels: str) -> State:
        structure = tuple(named[label] for label in labels)
        start: Sequence[object] = [np.zeros(0), *(c.starts[0] for c in structure)]
        return fitted(problem, structure, np.concatenate(start), everyone, [0, 1, 2, 3])

    tried, before = (state("wheel_loads"), state("friction_coefficients")), state()
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    first = Round(before=before, screening=nothing, tried=tried, best=None, taken=False)
    found = Searched(
        problem=problem,
        uncut=problem,
        runs=(0, 1, 2, 3),
        held=everyone[3:],
        seen=everyone[:3],
        seen_runs=everyone[:3],
        candidates=list(named.values()),
        state=before,
        rounds=[first],
    )
    errors = RunErrors(squares=np.full((4, 3), 100.0), counts=np.full((4, 3), 100.0))  # chi is 1
    checked = Checked(
        state=None,
        before=errors,
        after=errors,
        judgement=None,
        problem=problem,
        phased=False,
        rejected=(),
        near_noise=near,
    )
    question, _, fits = left._left(found, checked)
    if near:
        assert question is Question.ANYTHING
        assert [f.structure for f in fits] == [()]
    else:
        assert question is Question.WHICH
        assert next(f.structure[0].label for f in fits if f.structure) == "wheel_loads"


def test_what_noise_that_lasts_had_hidden_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """``diagnose`` looked once more with white noise and found it; ``next-run`` did not."""
    monkeypatch.setattr(left, "ready", taken_for_noise(left.ready))
    worn = FrictionCoefficients(drive_factor=0.8, transverse_factor=0.9)
    plant = Plant(name="worn", traces=(Trace.COEFFICIENT,), effects=(worn,))
    data = planted(smooth_kiwi(), plant, seed=3, count=7, duration_s=2.5, rate_hz=100.0)
    found = left.remaining(data, None, 1, Watch(report=no_progress))
    assert found.verdict is Verdict.EFFECT_FOUND and found.question is not Question.ANYTHING
    assert found.data_set.lasting is None and found.misfit < 1.1
