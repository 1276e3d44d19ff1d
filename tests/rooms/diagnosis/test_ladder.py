"""What the search proposes and what may be claimed: the largest part that unseen runs bear out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.ladder import Checked, Court, check
from slipmargin.diagnosis.left_out import folds
from slipmargin.diagnosis.loop import no_progress
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.search import Round, State, fitted, nothing_sure
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import Trace
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.physics.frames import rotated

SIGMA = np.array([5e-4, 5e-4, 2e-3])
COUNT = 8
SEEN = np.arange(6)


@pytest.fixture(scope="module")
def court() -> Court:
    truth = WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0)
    plant = Plant(name="loads", traces=(Trace.WHEEL_LOAD,), effects=(truth,))
    data = planted(smooth_kiwi(), plant, seed=2, count=COUNT, duration_s=2.0, rate_hz=50.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    return Court(
        problem=Problem.of(data.recipe, data.surface, trials, SIGMA, False),
        runs=tuple(range(COUNT)),
        held=np.array([6, 7]),
        seen=SEEN,
        records=data.trials,
        seed=0,
    )


def proposed(court: Court, *labels: str) -> State:
    named = {c.label: c for c in named_candidates(court.problem.nominal.geometry.names, False, ())}
    structure: tuple[Candidate, ...] = tuple(named[label] for label in labels)
    start = np.concatenate([np.zeros(0), *(c.starts[0] for c in structure)])
    return fitted(court.problem, structure, start, SEEN, court.seen_runs)


def checked(court: Court, *labels: str) -> Checked:
    return check(court, proposed(court, *labels), [], Watch(report=no_progress))


def labels_of(found: Checked) -> list[str]:
    return [] if found.state is None else [c.label for c in found.state.structure]


def test_the_truth_holds(court: Court) -> None:
    found = checked(court, "wheel_loads")
    assert labels_of(found) == ["wheel_loads"] and not found.rejected
    assert found.judgement is not None and found.judgement.holds
    assert found.before.chi() > 3.0 and found.after.chi() < 1.15
    assert len(found.before.squares) == COUNT


def test_a_superfluous_last_effect_is_dropped(court: Court) -> None:
    found = checked(court, "wheel_loads", "camera_delay")
    assert labels_of(found) == ["wheel_loads"]
    (no,) = found.rejected
    assert no.labels == ("wheel_loads", "camera_delay")
    assert "contains the value that does nothing" in no.failures[0]


def test_what_does_not_hold_is_not_claimed(court: Court) -> None:
    found = checked(court, "camera_scale")
    assert found.state is None and found.judgement is None
    assert found.after is found.before
    assert found.rejected[0].labels == ("camera_scale",) and found.rejected[0].failures


def test_another_candidate_is_asked_where_the_proposal_fails(court: Court) -> None:
    wrong, right = proposed(court, "camera_scale"), proposed(court, "wheel_loads")
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=proposed(court), screening=nothing, tried=(right, wrong), best=wrong, taken=True)
    found = check(court, wrong, [done], Watch(report=no_progress))
    assert labels_of(found) == ["wheel_loads"] and found.rejected[0].labels == ("camera_scale",)


def knocked(problem: Problem, effects: tuple[WheelLoads, ...], runs: tuple[int, ...]) -> Problem:
    """Each of these runs turned midway by what makes the base model look best beside these effects."""
    measured, first = np.array(problem.measured), 40
    wrong, right = problem.predict([(), effects], [np.arange(COUNT)] * 2)
    for row in runs:
        tried = []
        for angle in np.linspace(-0.5, 0.5, 41):
            turned = measured[row].copy()
            arm = measured[row, first:, :2] - measured[row, first, :2]
            turned[first:, :2] = measured[row, first, :2] + np.column_stack(
                rotated(angle, arm[:, 0], arm[:, 1])
            )
            turned[first:, 2] += angle
            one = replace(
                problem, measured=np.where(np.arange(COUNT)[:, None, None] == row, turned, measured)
            )
            gaps = (one.gaps(pose[[row]], np.array([row]))[1] for pose in (right, wrong))
            tried.append((float(np.divide(*(np.sum(gap**2) for gap in gaps))), turned))
        measured[row] = max(tried, key=lambda pair: pair[0])[1]
    return replace(problem, measured=measured)


def test_far_above_the_noise_runs_are_judged_in_pieces(court: Court) -> None:
    truth = proposed(court, "wheel_loads")
    effects = (WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0),)
    rough = replace(court, problem=knocked(court.problem, effects, (1, 4)))
    whole = replace(truth, view=rough.problem)
    pieces = replace(truth, view=rough.problem.in_pieces(SETTINGS.piece_s))
    assert check(rough, whole, [], Watch(report=no_progress)).state is None
    found = check(rough, pieces, [], Watch(report=no_progress))
    assert found.state is pieces
    plain = court.believed(pieces).errors
    assert np.array_equal(found.before.squares[0], plain.squares[0]), "whole runs are reported"


def test_far_above_the_noise_no_interval_speaks_against_an_effect(court: Court) -> None:
    state = proposed(court, "wheel_loads", "camera_delay")
    assert nothing_sure(state) == [False, True]
    assert nothing_sure(replace(state, view=court.problem.in_pieces(SETTINGS.piece_s))) == [False, False]


def test_folds_hold_whole_runs_and_every_trial_once() -> None:
    runs = [0, 0, 1, 2, 3, 3, 4, 5]
    parts = folds(runs, 4)
    assert sorted(np.concatenate(parts).tolist()) == list(range(8))
    for part in parts:
        inside = {runs[i] for i in part}
        assert all(i in part for i, run in enumerate(runs) if run in inside)
    assert len(folds([0, 1, 2], 4)) == 3
