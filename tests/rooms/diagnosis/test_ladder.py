"""What the search proposes and what may be claimed: the largest part that unseen runs bear out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Index
from slipmargin.diagnosis import all_runs, court as bench, ladder
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.court import Checked, Court, larger
from slipmargin.diagnosis.findings import doubted
from slipmargin.diagnosis.held_out import Prediction
from slipmargin.diagnosis.ladder import check
from slipmargin.diagnosis.left_out import folds
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import fitted, nothing_sure
from slipmargin.diagnosis.result import Score
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.search import take_step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.verdict import RunErrors
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import AnyEffect
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.physics.frames import to_floor

SIGMA = np.array([5e-4, 5e-4, 2e-3])
COUNT = 8
SEEN = np.arange(6)


def court_of(*effects: AnyEffect) -> Court:
    """A court over runs of a robot that has these effects."""
    plant = Plant(name="planted", traces=(), effects=effects)
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
    structure = tuple(candidates(court, *labels))
    start = np.concatenate([np.zeros(0), *(c.starts[0] for c in structure)])
    return fitted(court.problem, structure, start, court.seen, court.seen_runs)


def checked(court: Court, *labels: str) -> Checked:
    return check(court, proposed(court, *labels), [], Watch(report=no_progress))


@pytest.fixture(scope="module")
def court() -> Court:
    return court_of(WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0))


def candidates(court: Court, *labels: str) -> list[Candidate]:
    named = {c.label: c for c in named_candidates(court.problem.nominal.geometry.names, False, ())}
    return [named[label] for label in labels]


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
    assert no.failures[0] == "the runs leave it open that camera_delay does nothing" and no.borne_out


def test_what_does_not_hold_is_not_claimed(court: Court) -> None:
    found = checked(court, "camera_scale")
    assert found.state is None and found.judgement is None
    assert found.after is found.before
    no = found.rejected[0]
    assert no.labels == ("camera_scale",) and no.failures and not no.borne_out


def test_another_candidate_is_asked_where_the_proposal_fails(court: Court) -> None:
    wrong, right = proposed(court, "camera_scale"), proposed(court, "wheel_loads")
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=proposed(court), screening=nothing, tried=(right, wrong), best=wrong, taken=True)
    found = check(court, wrong, [done], Watch(report=no_progress))
    assert labels_of(found) == ["wheel_loads"] and found.rejected[0].labels == ("camera_scale",)


def test_a_name_that_was_passed_over_is_asked_where_a_simpler_one_fails() -> None:
    """A ramp that left less than a seam, with a parameter more, was never asked: both are of the position."""
    late = court_of(CameraDelay(delay_s=0.03))
    before, right, wrong = proposed(late), proposed(late, "camera_delay"), proposed(late, "camera_scale")
    assert right.last.trace == wrong.last.trace and right.chi < wrong.chi
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=before, screening=nothing, tried=(right, wrong), best=wrong, taken=True)
    found = check(late, wrong, [done], Watch(report=no_progress))
    assert labels_of(found) == ["camera_delay"] and found.rejected[0].labels == ("camera_scale",)


def test_names_that_their_round_cannot_tell_apart_are_asked_before_an_effect_is_dropped() -> None:
    late = court_of(WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0), CameraDelay(delay_s=0.02))
    loads, right = proposed(late, "wheel_loads"), proposed(late, "wheel_loads", "camera_delay")
    wrong = replace(proposed(late, "wheel_loads", "heading_gain"), scores=right.scores)
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=loads, screening=nothing, tried=(wrong, right), best=wrong, taken=True)
    found = check(late, wrong, [done], Watch(report=no_progress))
    assert labels_of(found) == ["wheel_loads", "camera_delay"] and found.after.chi() < 1.15
    assert found.rejected[0].labels == ("wheel_loads", "heading_gain")


def test_other_forms_are_asked_before_an_effect_is_dropped() -> None:
    rollers = {"steepness": 40.0, "transverse_factor": 2.0, "transverse_coefficient_factor": 8.0}
    creep = court_of(SlipRatioFriction(share=1.0, crawl_m_s=1e-3, **rollers))
    first, across = "slip_ratio_friction", "slip_ratio_friction with its own constants across"
    assert labels_of(checked(creep, first)) == []
    watch = Watch(report=no_progress)
    step = take_step(proposed(creep), creep.seen_runs, candidates(creep, first, across), 0, watch)
    found = check(creep, proposed(creep, first), [replace(step, tried=())], watch)
    assert labels_of(found) == [across] and found.rejected[0].labels == (first,)
    assert found.after.chi() < 1.15


def test_the_search_goes_on_in_longer_pieces(court: Court, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thick carpet's pieces of two seconds held much that no effect explains, whole runs one that does."""
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))

    def find_nothing(before: State, *_: object) -> Round:
        return Round(before=before, screening=nothing, tried=(), best=None, taken=False)

    monkeypatch.setattr(ladder, "take_step", find_nothing)
    loud = replace(court, problem=replace(court.problem, sigma=0.02 * SIGMA))
    held = proposed(loud, "wheel_loads")
    pieces = fitted(loud.problem.in_pieces(0.12), held.structure, held.fit.x, SEEN, loud.seen_runs)
    rounds = [find_nothing(proposed(loud))]
    check(loud, pieces, rounds, Watch(report=no_progress))
    tried = [r.before.view.piece_s for r in rounds[1:]]
    assert tried == pytest.approx([0.12, 0.24, 0.48, 0.96], rel=0.1)


def test_what_is_left_is_looked_for_in_all_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """The contact ahead of the axle showed in 72 runs of a robot and not in the eight that were searched."""
    late = court_of(WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0), CameraDelay(delay_s=0.02))
    known = candidates(late, "camera_delay", "camera_scale", "wheel_loads")
    few = fitted(late.problem, (), np.zeros(0), SEEN[:3], late.seen_runs[:3])
    first = take_step(few, late.seen_runs[:3], known, 0, Watch(report=no_progress))
    others = tuple(e for e in first.screening.entries if "camera_delay" not in e.label)
    last = replace(first.screening, entries=others)  # the eight put a thousand others before it

    def hides_it(before: State, runs: Sequence[int], screened: list[Candidate], *others: Any) -> Round:
        if len(before.fit.trials) == len(SEEN):
            assert all(c.named for c in screened) and others[-1] == 1
            return take_step(before, runs, screened, *others)
        return Round(before=before, screening=last, tried=(), best=None, taken=False)

    monkeypatch.setattr(ladder, "take_step", hides_it)
    rounds = [first]
    found = check(late, proposed(late, "wheel_loads"), rounds, Watch(report=no_progress))
    assert labels_of(found) == ["wheel_loads", "camera_delay"] and found.after.chi() < 1.15
    assert [r.names_only for r in rounds if r.taken][-1]


def test_what_a_law_acts_over_is_asked_again_in_all_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a thick carpet it hung on the search's last round, and with it a sixth of the error."""
    late = court_of(SlipRatioFriction(share=1.0, steepness=1.5, tread_share=0.5))
    few = fitted(late.problem, (), np.zeros(0), SEEN[:3], late.seen_runs[:3])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    stood = Round(before=few, screening=nothing, tried=(), best=None, taken=False)
    monkeypatch.setattr(all_runs, "take_step", lambda before, *_: replace(stood, before=before))
    held = bench.put(late, proposed(late, "slip_ratio_friction"), [])
    assert held is not None and held.after.chi() > SETTINGS.noise_chi
    found = all_runs.in_all_runs(late, held, [stood], [], Watch(report=no_progress))
    assert labels_of(found) == ["slip_ratio_friction tread_share 0.5"]
    assert found.after.chi() < 1.15 < held.after.chi()


def test_the_search_goes_on_from_what_holds() -> None:
    late = court_of(WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0), CameraDelay(delay_s=0.02))
    watch = Watch(report=no_progress)
    known = candidates(late, "camera_delay", "wheel_loads", "camera_scale")
    first = take_step(proposed(late), late.seen_runs, known, 0, watch)
    second = take_step(proposed(late, "camera_delay"), late.seen_runs, known, 0, watch)
    rounds = [first, second]
    found = check(late, proposed(late, "wheel_loads"), rounds, watch)
    assert labels_of(found) == ["wheel_loads", "camera_delay"] and len(rounds) > 2
    assert found.judgement is not None and found.after.chi() < 1.15
    stood = [first, replace(second, before=proposed(late, "wheel_loads"))]
    assert labels_of(check(late, proposed(late, "wheel_loads"), stood, watch)) == ["wheel_loads"]
    assert len(stood) == 2, "the search stood there before"


def test_a_name_that_gave_way_where_the_search_has_stood_is_not_lost(
    court: Court, monkeypatch: pytest.MonkeyPatch
) -> None:
    watch, view = Watch(report=no_progress), court.problem.in_pieces(SETTINGS.piece_s)
    wrong, right = (
        fitted(view, (one,), one.starts[0], SEEN, court.seen_runs)
        for one in candidates(court, "camera_scale", "wheel_loads")
    )
    plain = court.errors(None)
    held = Checked(
        state=wrong,
        before=plain.errors,
        after=plain.errors,
        judgement=None,
        problem=plain.problem,
        phased=plain.phased,
        rejected=(),
        near_noise=False,
    )
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    stood = [
        Round(before=before, screening=nothing, tried=(), best=None, taken=False)
        for before in (proposed(court), right)
    ]
    monkeypatch.setattr(ladder, "reformed", lambda *_, **__: right)
    found = ladder._further(court, held, stood, [], watch)
    assert labels_of(found) == ["wheel_loads"] and len(stood) == 2
    assert found.after.chi() < 1.15


def test_other_first_effects_are_stood_beside(court: Court, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 1.9516 and 1.9524 it took the first, which failed; only beside the other showed what was meant."""
    wrong, both = proposed(court, "camera_scale"), proposed(court, "wheel_loads", "camera_delay")
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    others = [replace(proposed(court, one), scores=wrong.scores) for one in ("wheel_loads", "camera_delay")]
    before = replace(proposed(court), scores=2.0 * wrong.scores)
    done = Round(before=before, screening=nothing, tried=(wrong, *others), best=wrong, taken=True)
    monkeypatch.setattr(ladder, "worthwhile", lambda *_: True)
    monkeypatch.setattr(ladder, "take_step", lambda *_: replace(done, best=both))
    # One: the delay is of the camera, as the scale is from which the search went on.
    (found,) = ladder._beside_others(court, [done], Watch(report=no_progress))
    assert found.structure == both.structure and len(found.fit.trials) == len(court.seen)


def test_no_list_begins_twice_at_one_place(court: Court, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pieces that were as long as a run allows were asked for again, twice as long: the forms with them."""
    view, watch = court.problem.in_pieces(SETTINGS.piece_s), Watch(report=no_progress)
    right = proposed(court, "wheel_loads")
    held = bench.put(court, right, [])
    assert held is not None
    held = replace(held, state=replace(right, view=view))
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    stood = Round(before=proposed(court), screening=nothing, tried=(), best=None, taken=False)
    begun: list[State] = []

    def reformed(state: State, *_: Any, **__: Any) -> State:
        begun.append(state)
        return state

    monkeypatch.setattr(ladder, "reformed", reformed)
    monkeypatch.setattr(ladder, "longer", lambda problem, state, *_: state)
    monkeypatch.setattr(ladder, "worthwhile", lambda *_: True)
    monkeypatch.setattr(ladder, "take_step", lambda before, *_: replace(stood, before=before))
    ladder._further(court, held, [stood], [], watch)
    assert len(begun) == 1


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
                to_floor(angle, arm[:, 0], arm[:, 1])
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
    plain = court.errors(None, like=pieces).errors
    assert np.array_equal(found.before.squares[0], plain.squares[0]), "whole runs are reported"


def test_far_above_the_noise_no_interval_speaks_against_an_effect(court: Court) -> None:
    state = proposed(court, "wheel_loads", "camera_delay")
    runs = court.seen_runs
    assert nothing_sure(state, runs) == [False, True]
    pieces = court.problem.in_pieces(SETTINGS.piece_s)
    assert nothing_sure(replace(state, view=pieces), runs) == [False, False]


def test_where_whole_runs_leave_much_runs_left_out_speak_for_an_effect(court: Court) -> None:
    """Its interval held nothing at all, wide by what was still missing; 7 % less error did not count."""
    eight = replace(court, held=np.zeros(0, dtype=np.int64), seen=np.arange(COUNT))
    state, runs = proposed(eight, "wheel_loads", "camera_delay"), eight.seen_runs
    for much, shares, idle in ((9.0, [1.1], False), (9.0, [1.1, 0.95], True), (1.0, [1.1], True)):
        left = replace(state, scores=much * state.scores / state.chi**2)
        grown = np.resize(shares, len(left.scores)) * left.scores
        left.fewer[1, tuple(runs)] = replace(left, scores=grown)
        assert nothing_sure(left, runs) == [False, idle]


def test_a_name_that_only_runs_left_out_speak_for_is_not_claimed(court: Court) -> None:
    """The court no longer asks each effect's interval, so that what is reported does."""
    assert not doubted(court.problem, proposed(court, "wheel_loads").fit)
    idle = proposed(court, "wheel_loads", "floor_tilt")
    assert nothing_sure(idle, court.seen_runs) == [False, True] and not idle.fit.at_bound()
    assert doubted(court.problem, idle.fit)


def test_folds_hold_whole_runs_and_every_trial_once() -> None:
    runs = [0, 0, 1, 2, 3, 3, 4, 5]
    parts = folds(runs, 4)
    assert sorted(np.concatenate(parts).tolist()) == list(range(8))
    for part in parts:
        inside = {runs[i] for i in part}
        assert all(i in part for i, run in enumerate(runs) if run in inside)
    assert len(folds([0, 1, 2], 4)) == 3


def test_an_error_that_grows_beyond_rounding_is_not_called_found(
    court: Court, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a thousandth of itself, which no test over runs would call worse."""
    one = Score(rmse_position_m=2.823e-3, rmse_heading_rad=44e-3, chi=3.49)
    assert larger(one, replace(one, rmse_heading_rad=8.8e-3, chi=1.03)) == ()
    # A camera's scale moved the steps of the simulation, and with them the headings: by 5e-5 of their error.
    assert larger(one, replace(one, rmse_heading_rad=(1.0 + 5e-5) * one.rmse_heading_rad)) == ()
    (said,) = larger(one, Score(rmse_position_m=2.826e-3, rmse_heading_rad=8.8e-3, chi=1.03))
    assert said.endswith("the position error grows from 2.823 to 2.826 mm")
    assert checked(court, "wheel_loads").state is not None
    real, scores = bench.score, []

    def grown(errors: RunErrors, runs: Index) -> Score:
        scores.append(real(errors, runs))
        return replace(
            scores[-1], rmse_position_m=scores[0].rmse_position_m * (1.0 + 1e-3 * (len(scores) - 1))
        )

    monkeypatch.setattr(bench, "score", grown)
    found = checked(court, "wheel_loads")
    assert found.state is None and "the position error grows" in found.rejected[0].failures[-1]


@pytest.mark.parametrize(("without_it", "kept"), [(0.9, 1), (1.5, 2)])
def test_a_last_effect_has_to_make_unseen_runs_better(
    court: Court, monkeypatch: pytest.MonkeyPatch, without_it: float, kept: int
) -> None:
    """Both were claimed on the strength of the first."""
    plain = Court.errors

    def errors(self: Court, state: State | None, *, like: State | None = None, **how: bool) -> Prediction:
        found = plain(self, state, like=like, **how)
        if state is None or like is None:
            return found
        squares = without_it * plain(self, like).errors.squares
        return replace(found, errors=RunErrors(squares=squares, counts=found.errors.counts))

    monkeypatch.setattr(Court, "errors", errors)
    monkeypatch.setattr(bench, "nothing_sure", lambda state, _: [False] * len(state.structure))
    found = checked(court, "wheel_loads", "camera_delay")
    assert labels_of(found) == ["wheel_loads", "camera_delay"][:kept]
    assert [r.labels for r in found.rejected] == [("wheel_loads", "camera_delay")] * (2 - kept)
    assert all("no better with camera_delay" in r.failures[0] for r in found.rejected)
