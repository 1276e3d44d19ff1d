"""Leads: what unseen runs bear out, the map, what repeats with a wheel, what fits; each once, with why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnoses import residual_map
from spoilt import good

from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.leads import followed, leads
from slipmargin.diagnosis.left_over import left_over, like
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.result import LeadSource, Rejected
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.search import screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.telling import enough
from slipmargin.diagnosis.watch import Watch, clock_s, no_progress
from slipmargin.effects import Trace

TURN = Periodicity(per_turn=1, wheels=("2",), p_value=0.003)


@pytest.fixture(scope="module")
def state() -> State:
    problem = problem_of(good(3))
    every = np.arange(4, dtype=np.int64)
    return fitted(problem, (), np.zeros(0), every, every.tolist())


def round_of(state: State, before: list[float], tried: dict[str, list[float]]) -> Round:
    """A round from ``before`` whose candidates, by label, left these sums of squares of each of four runs."""
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}
    return Round(
        before=replace(state, scores=np.array(before)),
        screening=Screening(entries=(), total=1.0, chance=np.zeros(199)),
        tried=tuple(
            replace(state, fit=replace(state.fit, structure=(listed[label],)), scores=np.array(scores))
            for label, scores in tried.items()
        ),
        best=None,
        taken=False,
    )


def test_the_map_leads_and_what_it_does_not_support_does_not() -> None:
    made = leads(residual_map(), [TURN], None, [], [])
    assert [x.traced_to for x in made] == [Trace.ACCELERATION, Trace.WHEEL_ANGLE]
    assert [x.source for x in made] == [LeadSource.MAP, LeadSource.ORDER]
    assert "40 % off the squared residual" in made[0].why and "p = 0.005" in made[0].why
    assert all(x.next_run for x in made)


def test_near_the_noise_only_what_chance_hardly_makes_stands_out() -> None:
    rare = MapEntry(traced_to=Trace.POSITION, form="over position", share=0.2, p_value=0.005)
    common = replace(rare, traced_to=Trace.HEADING, p_value=0.04)
    stands_out = {x.traced_to: x.stands_out for x in leads([rare, common], [TURN], None, [], [])}
    assert stands_out == {Trace.POSITION: True, Trace.HEADING: False, Trace.WHEEL_ANGLE: False}


def test_a_variable_is_listed_once_and_not_if_it_was_found() -> None:
    angle = MapEntry(traced_to=Trace.WHEEL_ANGLE, form="once a turn", share=0.1, p_value=0.005)
    assert [x.source for x in leads([angle], [TURN], None, [], [])] == [LeadSource.MAP]
    assert leads([angle], [TURN], None, [], [Trace.WHEEL_ANGLE]) == ()
    assert leads((), (), None, (), ()) == ()


def test_leads_come_from_the_round_that_began_with_what_was_kept(state: State) -> None:
    def begun(*labels: str) -> Round:
        kept = tuple(c for c in named_candidates(("1", "2", "3"), False, ()) if c.label in labels)
        at = replace(state, fit=replace(state.fit, structure=kept))
        nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
        return Round(before=at, screening=nothing, tried=(), best=None, taken=False)

    rounds = [begun(), begun("floor_tilt"), begun("floor_tilt", "wheel_toe[1]")]
    assert like(None, rounds) is rounds[0]
    assert like(begun("floor_tilt").before, rounds) is rounds[1]
    assert like(begun("wheel_toe[1]").before, rounds) is None, "the first effect was dropped: look again"
    at = begun("wheel_toe[1]").before
    names = replace(begun("wheel_toe[1]"), names_only=True)
    assert like(at, [*rounds, names]) is None, "a list of names alone is no map"


def test_what_no_round_began_with_is_looked_at_again(state: State) -> None:
    known = named_candidates(("1", "2", "3"), False, ())
    tilt = next(c for c in known if c.label == "floor_tilt")
    kept = fitted(state.view, (tilt,), tilt.null, state.fit.trials, state.fit.trials.tolist())
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    first = Round(before=state, screening=nothing, tried=(), best=None, taken=False)
    watch = Watch(report=no_progress)
    found = left_over(kept, [first], state.fit.trials.tolist(), known[:4], 0, watch)
    assert found.before.structure == (tilt,) and not found.taken
    assert {e.traced_to for e in found.map()} >= {c.trace for c in known[:4]}


def test_a_list_whose_time_is_long_over_is_cut(state: State) -> None:
    """With a budget of one second the list of a stiff robot took fifteen more."""
    known = named_candidates(("1", "2", "3"), False, ())
    runs = state.fit.trials.tolist()
    now = clock_s()
    for late_s, cut in ((0.0, False), (SETTINGS.list_s + 1.0, True)):
        watch = Watch(report=no_progress, until_s=now - late_s)
        list_ = screened(state, runs, known[:4], 0, watch)
        assert cut is (not any(part.candidate for entry in list_.entries for part in entry.parts))


def test_searched_trials_are_those_that_say_something_and_some_that_are_quiet() -> None:
    seen = np.arange(16, dtype=np.int64)
    loud = np.isin(seen, [1, 4, 9, 14])
    plain = enough(seen, 100.0)
    some = enough(seen, 100.0, loud)
    assert len(some) == len(plain) == 8 and set(seen[loud]) <= set(some.tolist())
    assert np.array_equal(enough(seen, 100.0, np.zeros(16, dtype=bool)), plain)
    assert np.count_nonzero(np.isin(enough(seen, 100.0, seen > 3), [0, 1, 2, 3])) == 2, "a fold is quiet"


def test_many_runs_outweigh_the_one_that_is_farthest_off(state: State) -> None:
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}

    def tried(label: str, scores: list[float]) -> State:
        kept = replace(state.fit, structure=(listed[label],))
        return replace(state, fit=kept, scores=np.array(scores))

    before = replace(state, scores=np.array([1000.0, 10.0, 10.0, 10.0]))
    one_run = tried("floor_nap", [300.0, 10.0, 10.0, 10.0])
    every_run = tried("floor_tilt", [900.0, 3.0, 3.0, 3.0])
    hurting = tried("rolling_resistance", [1.0, 15.0, 15.0, 15.0])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(199))
    last = Round(
        before=before, screening=nothing, tried=(hurting, one_run, every_run), best=None, taken=False
    )
    assert [f.label for f in followed(last)] == ["floor_tilt", "floor_nap", "rolling_resistance"]
    made = leads(last.map(), (), last, (), ())
    assert [x.candidate for x in made] == ["floor_tilt", "floor_nap", "rolling_resistance"]
    assert "3 get clearly better, 0 worse" in made[0].why and "1 get clearly better, 3 worse" in made[2].why


def test_what_leaves_nothing_but_noise_leads(state: State) -> None:
    """A patch that took 95 % off stood after a nap that took 24: it was looked for at many places."""
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}
    samples = state.samples

    def tried(label: str, scores: list[float]) -> State:
        own = np.array(scores) * samples / 4.0
        return replace(state, fit=replace(state.fit, structure=(listed[label],)), scores=own)

    before = replace(state, scores=np.array([1.0, 1.0, 24.0, 1.0]) * samples / 4.0)
    nap, patch = tried("floor_nap", [0.8, 0.8, 18.0, 0.8]), tried("floor_patch", [1.0, 1.0, 1.2, 1.0])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(199))
    last = Round(before=before, screening=nothing, tried=(patch, nap), best=None, taken=False)
    assert [f.label for f in followed(last)] == ["floor_nap", "floor_patch"]
    assert [x.candidate for x in leads(last.map(), (), last, (), ())] == ["floor_patch", "floor_nap"]


def test_leads_of_one_run_are_those_of_a_fit_to_it() -> None:
    """They were said to be of runs left out, of which there are none."""
    data = good(3)
    problem = problem_of(data, data.trials[:1], (0,))
    only = np.zeros(1, dtype=np.int64)
    before = fitted(problem, (), np.zeros(0), only, [0])
    [tilt] = (c for c in named_candidates(("1", "2", "3"), False, ()) if c.label == "floor_tilt")
    fits = replace(before, fit=replace(before.fit, structure=(tilt,)), scores=0.25 * before.scores)
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(199))
    last = Round(before=before, screening=nothing, tried=(fits,), best=None, taken=False)
    [entry] = last.map()
    [lead] = leads([entry], (), last, (), ())
    assert "off the squared residual of the one run, which it was fitted to" in lead.why
    assert lead.why.endswith("; its chi gets 50 % lower")
    [other] = leads((), (), last, (), ())
    assert other.why.endswith("on the run it was searched with")


def test_where_nothing_stands_out_the_nearest_is_given_and_said_to_be_weak() -> None:
    faint = MapEntry(traced_to=Trace.POSITION, form="floor_patch", share=0.05, p_value=0.3)
    [lead] = leads([replace(faint, traced_to=Trace.TIME, share=0.01), faint], (), None, (), ())
    assert lead.traced_to is Trace.POSITION and lead.why.startswith("weak")


def test_what_unseen_runs_bear_out_comes_first(state: State) -> None:
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}

    def tried(label: str, score: float) -> State:
        return replace(
            state,
            fit=replace(state.fit, structure=(listed[label],)),
            scores=np.full(len(state.scores), score),
        )

    nothing = Screening(entries=(), total=1.0, chance=np.zeros(199))
    fits = (tried("floor_nap", 3.0), tried("floor_tilt", 5.0))
    before = replace(state, scores=np.full(len(state.scores), 10.0))
    last = Round(before=before, screening=nothing, tried=fits, best=None, taken=False)
    idle = "the runs leave it open that floor_tilt does nothing"
    no = Rejected(labels=("floor_tilt",), failures=(idle,), chi_before=2.0, chi_after=1.2, borne_out=True)
    first = leads((), (), last, (no,), ())[0]
    assert first.candidate == "floor_tilt" and first.source is LeadSource.BORNE_OUT
    assert first.why.endswith(f"from 2 to 1.2; not claimed: {idle}")
    again = replace(no, borne_out=False)
    assert leads((), (), last, (no, again), ())[0] == first, "asked once more in another way, it still holds"
    # beside another effect, or where something was found, that is no evidence of its own
    for others in ((replace(no, labels=("floor_nap", "floor_tilt")),), (replace(no, borne_out=False),)):
        assert leads((), (), last, others, ())[0].candidate == "floor_nap"
    assert leads((), (), last, (no,), (Trace.TIME,))[0].candidate == "floor_nap"


def test_of_what_the_map_supports_what_lowers_the_error_of_unseen_runs_comes_first(state: State) -> None:
    """Seen on a slope of the floor: it lowered chi from 4.3 to 1.7, narrowly missed, and came second."""
    forms = {Trace.HEADING: "floor_nap", Trace.POSITION: "floor_ramp"}
    entries = [MapEntry(traced_to=t, form=f, share=0.5, p_value=0.005) for t, f in forms.items()]
    last = round_of(state, [10.0] * 4, {"floor_nap": [3.0] * 4, "floor_ramp": [5.0] * 4})
    no = Rejected(
        labels=("floor_ramp",),
        failures=("20 %",),
        chi_before=4.3,
        chi_after=1.7,
        lowers=True,
        traced_to=(Trace.POSITION,),
    )
    assert [m.traced_to for m in leads(entries, (), last, (no,), ())] == [Trace.POSITION, Trace.HEADING]
    for other in (replace(no, lowers=False), replace(no, labels=("floor_ramp", "push"))):
        assert leads(entries, (), last, (other,), ())[0].traced_to is Trace.HEADING


def test_what_takes_off_more_and_hurts_no_run_comes_before_what_lowers_the_error(state: State) -> None:
    """A tilted camera: a patch of floor that took off 24 % stood before a form that took off 65 %."""
    entries = [
        MapEntry(traced_to=Trace.MEASUREMENT, form="camera_scale", share=0.65, p_value=0.005),
        MapEntry(traced_to=Trace.POSITION, form="floor_patch", share=0.24, p_value=0.035),
    ]
    no = Rejected(
        labels=("floor_patch",),
        failures=("25 %",),
        chi_before=6.8,
        chi_after=5.4,
        lowers=True,
        traced_to=(Trace.POSITION,),
    )
    for worst, first in ((3.0, Trace.MEASUREMENT), (12.0, Trace.POSITION)):
        scores = {"camera_scale": [3.0, 3.0, 3.0, worst], "floor_patch": [7.0, 9.0, 9.0, 9.0]}
        last = round_of(state, [10.0] * 4, scores)
        assert leads(entries, (), last, (no,), ())[0].traced_to is first


def test_what_makes_more_runs_worse_comes_last(state: State) -> None:
    """A push that made three runs of ten worse and none better was the first place to look."""
    scores = {"push": [40.0, 13.0, 13.0, 13.0], "floor_tilt": [70.0, 8.0, 8.0, 8.0]}
    last = round_of(state, [90.0, 10.0, 10.0, 10.0], scores)
    push = MapEntry(traced_to=Trace.TIME, form="push", share=0.3, p_value=0.005)
    assert [x.candidate for x in leads([push], (), last, (), ())] == ["floor_tilt", "push"]
