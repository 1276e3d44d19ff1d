"""Far above the noise, names that a round can hardly tell apart are each followed by a round of their own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis import rivals, search
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.ranges import ranges
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.restated import reformed
from slipmargin.diagnosis.rivals import cannot_be_told, origin
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.search import screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.wheel_loads import WheelLoads

SIGMA = np.array([5e-4, 5e-4, 2e-3])
TRIALS = np.arange(6)
WATCH = Watch(report=no_progress)
SOUGHT = search.Sought(seen=TRIALS, trials=TRIALS, runs=list(TRIALS), candidates=[], seed=0, progress=WATCH)


class Bench:
    """Fits to runs of a robot that lacks two effects, and the round in which they were tried alone."""

    def __init__(self) -> None:
        effects = (SlipRatioFriction(share=1.0, steepness=8.0), WheelLoads(shift_x_m=0.02, shift_y_m=0.01))
        data = planted(
            smooth_kiwi(),
            Plant(name="two", traces=(), effects=effects),
            seed=4,
            count=6,
            duration_s=1.5,
            rate_hz=50.0,
        )
        trials = tuple(clean(record, SIGMA) for record in data.trials)
        self.problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
        names = named_candidates(self.problem.nominal.geometry.names, False, ())
        forms = general_candidates(self.problem.model(()), ranges(trials), False)
        self.known: dict[str, Candidate] = {c.label: c for c in (*names, *forms)}
        self.plain = self.state()
        self.screening = screened(self.plain, list(TRIALS), names[:4], 0, WATCH)

    def state(self, *labels: str) -> State:
        structure = tuple(self.known[label] for label in labels)
        start = np.concatenate([np.zeros(0), *(c.starts[0] for c in structure)])
        return fitted(self.problem, structure, start, TRIALS, list(TRIALS))

    def round(self, before: State, *tried: State) -> Round:
        best = tried[0] if tried else None
        return Round(before=before, screening=self.screening, tried=tried, best=best, taken=best is not None)


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench()


def followed(bench: Bench, first: State, second: State, after: dict[str, State], patch: Any) -> State:
    """Which of two additions is kept, when the next round finds ``after`` beside them."""

    def take_step(before: State, *_: Any) -> Round:
        found = after.get(before.last.label)
        return bench.round(before, *(() if found is None else (found,)))

    patch.setattr(search, "take_step", take_step)
    step = bench.round(bench.plain, first, second)
    kept, beside = SOUGHT.followed(step, standing(bench, first, second))
    assert kept.state is kept.best and (kept.ahead is not None) == (kept.best.last.label in after)
    assert not beside
    return kept.best


def standing(bench: Bench, *found: State) -> list[search.Standing]:
    return [search.Standing(best=s, problem=bench.problem, state=s) for s in found]


def test_the_one_is_kept_beside_which_the_next_round_finds_most(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    tilt, loads = bench.state("floor_tilt"), bench.state("wheel_loads")
    both = bench.state("wheel_loads", "slip_ratio_friction")
    assert both.chi < 0.5 * min(tilt.chi, loads.chi)
    assert followed(bench, tilt, loads, {"wheel_loads": both}, monkeypatch) is loads


def test_the_first_is_kept_where_what_follows_is_as_good(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    slip, loads = bench.state("slip_ratio_friction"), bench.state("wheel_loads")
    one = bench.state("slip_ratio_friction", "wheel_loads")
    two = bench.state("wheel_loads", "slip_ratio_friction")
    after = {"slip_ratio_friction": one, "wheel_loads": two}
    assert followed(bench, slip, loads, after, monkeypatch) is slip
    assert followed(bench, loads, slip, after, monkeypatch) is loads


def test_an_addition_that_the_next_one_makes_superfluous_leads_no_further(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The effects of both rounds leave less than the first alone; without the idle one nothing is gained."""
    slip, roller = bench.state("slip_ratio_friction"), bench.state("stiff_roller[1]")
    both = bench.state("stiff_roller[1]", "slip_ratio_friction")
    assert both.chi < 0.8 * slip.chi
    assert followed(bench, slip, roller, {"stiff_roller[1]": both}, monkeypatch) is slip


def test_what_is_followed_are_names_of_other_variables(bench: Bench) -> None:
    form = bench.state("unnamed_velocity: force across the velocity")
    loads = bench.state("wheel_loads")
    stated = bench.state("wheel_loads with the centre of mass where stated")
    one = bench.round(bench.plain, form, loads, stated)
    assert one.others()[:1] == [loads] and stated not in one.others()
    two = bench.round(bench.plain, loads, stated)
    assert two.others() == []
    assert bench.round(bench.plain).others() == []


@pytest.mark.parametrize(("share", "is_followed"), [(0.6, True), (0.4, False)])
def test_a_name_that_takes_off_half_as_much_is_followed_though_the_round_tells_it_apart(
    bench: Bench, share: float, is_followed: bool
) -> None:
    """Loads that shift, beside which the fast robot's load transfer shows, were 11 % above another name."""
    loads = leaving(bench, "wheel_loads", 0.5)
    slip = leaving(bench, "slip_ratio_friction", 1.0 - 0.5 * share)
    step = bench.round(bench.plain, loads, slip)
    assert step.rivals() == [] and step.others() == ([slip] if is_followed else [])


def test_a_name_gives_way_to_another_of_its_round_once_what_hid_that_is_known(bench: Bench) -> None:
    """On a real carpet the law of creep came third; beside the loads it left a fifth less."""
    wrong, law = "friction_coefficients with their steepness", "slip_ratio_friction"
    both = bench.state(wrong, "wheel_loads")
    first, second = leaving(bench, wrong, 0.5), leaving(bench, law, 0.6)
    after = reformed(both, list(TRIALS), [], [bench.round(bench.plain, first, second)], WATCH)
    assert [c.label for c in after.structure] == [law, "wheel_loads"] and after.chi < 0.3 * both.chi


def test_a_name_that_took_off_much_less_or_is_no_better_takes_no_place(bench: Bench) -> None:
    wrong, law = "friction_coefficients with their steepness", "slip_ratio_friction"
    both = bench.state(wrong, "wheel_loads")
    first, less = leaving(bench, wrong, 0.5), leaving(bench, law, 0.9)
    assert reformed(both, list(TRIALS), [], [bench.round(bench.plain, first, less)], WATCH) is both
    tilt = leaving(bench, "floor_tilt", 0.5)
    assert reformed(both, list(TRIALS), [], [bench.round(bench.plain, first, tilt)], WATCH) is both
    loads = leaving(bench, "wheel_loads", 0.5)
    assert reformed(both, list(TRIALS), [], [bench.round(bench.plain, first, loads)], WATCH) is both


def test_the_second_of_two_is_compared_with_other_names_beside_the_first(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of hundreds of pairs few are fitted: one named a wheel ten degrees askew, and no rival of it."""
    both, alone = bench.state("slip_ratio_friction", "wheel_loads"), bench.state("slip_ratio_friction")
    rival = bench.state("slip_ratio_friction", "floor_tilt")
    beside = bench.round(alone, both, rival)
    monkeypatch.setattr(search, "take_step", lambda before, *_: replace(beside, before=before))
    step = bench.round(bench.plain, both, alone)
    assert step.part_alone() == [alone] and bench.round(bench.plain, alone, both).part_alone() == []
    kept, rounds = SOUGHT.followed(step, standing(bench, both, alone))
    assert kept.best is both and [r.before for r in rounds] == [alone]
    assert rounds[0].names_only and not rounds[0].taken
    law, loads = both.structure
    assert origin(loads, both.structure, [step, *rounds]) == (rounds[0], both)
    assert origin(law, both.structure, [step, *rounds]) == (step, alone)


@pytest.mark.parametrize("order", [1, -1])
def test_of_two_the_one_that_takes_off_more_alone_stands_first(bench: Bench, order: int) -> None:
    names = [e.structure[0] for e in bench.screening.entries if e.stands_alone][::order]
    listed = screened(bench.plain, list(TRIALS), names, 0, WATCH).entries
    gains = {e.label: e.gain for e in listed}
    pairs = [e.structure for e in listed if len(e.structure) == 2]
    assert len(pairs) > 3
    assert all(gains[first.label] >= gains[second.label] for first, second in pairs)


def leaving(bench: Bench, label: str, share: float) -> State:
    """A state with one name whose chi is set to a share of that of the model as it is."""
    state = bench.state(label)
    return replace(state, scores=state.scores * (share * bench.plain.chi / state.chi) ** 2)


def test_two_at_once_are_tried_only_where_there_is_room_for_both(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    entries = bench.screening.entries
    one, two = (next(e for e in entries if len(e.structure) == many) for many in (1, 2))
    names = [e.structure[0] for e in entries if e.stands_alone]
    monkeypatch.setattr(search, "finalists", lambda *_: [one, two])
    for most, sizes in ((2, {1, 2}), (1, {1})):
        monkeypatch.setattr(search, "SETTINGS", replace(SETTINGS, most_effects=most))
        step = search.take_step(bench.plain, list(TRIALS), names, 0, WATCH, 1)
        assert {len(s.structure) for s in step.tried} == sizes


def test_names_that_were_level_before_a_second_effect_was_known_are_compared_beside_it(
    bench: Bench,
) -> None:
    """A rigid sector, proved beside a tilt to 0.1 %, was called one of eight names; seven left twenty times
    as much there."""
    law = "slip_ratio_friction"
    both = bench.state(law, "wheel_loads")
    step = bench.round(bench.plain, leaving(bench, law, 0.5), leaving(bench, "floor_tilt", 0.5))
    assert cannot_be_told(both, [step], list(TRIALS), lambda: False) == [(), ()]
    late = cannot_be_told(both, [step], list(TRIALS), lambda: True)
    assert late == [("floor_tilt",), ()]  # no time is left to compare them


@pytest.mark.parametrize(("more", "is_one"), [(1.001, True), (1.3, False)])
def test_what_explains_as_much_beside_the_others_stays_a_rival(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, more: float, is_one: bool
) -> None:
    law, other = "slip_ratio_friction", "elliptic_grip"
    both = bench.state(law, "wheel_loads")
    step = bench.round(bench.plain, leaving(bench, law, 0.5), leaving(bench, other, 0.5))
    asked = []

    def refitted(state: State, structure: tuple[Candidate, ...], *_: Any) -> State:
        asked.append([c.label for c in structure])
        return replace(state, scores=more**2 * state.scores)

    monkeypatch.setattr(rivals, "refitted", refitted)
    told = cannot_be_told(both, [step], list(TRIALS), lambda: False)
    assert asked == [["wheel_loads", other]] and told == [(other,) * is_one, ()]
