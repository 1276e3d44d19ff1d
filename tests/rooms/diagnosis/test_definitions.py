"""What a quantity is taken to be is asked once all else is found: other definitions are no candidates."""

from __future__ import annotations

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.data_set import Member
from slipmargin.diagnosis.candidate import Candidate, named_candidate, named_candidates
from slipmargin.diagnosis.definitions import redefined
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.loop import no_progress
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.search import fitted
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import AnyEffect, Effect, Recipe
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.wheel_loads import WheelLoads

SIGMA = np.array([5e-4, 5e-4, 2e-3])
COUNT = 8
LAW = named_candidate(SlipRatioFriction, SlipRatioFriction.variants[0])


def lost_way(*effects: AnyEffect) -> State:
    """The law over the floor's own speed, fitted to runs of a robot that has these effects."""
    data = planted(
        smooth_kiwi(),
        Plant(name="lost way", traces=(), effects=effects),
        seed=5,
        count=COUNT,
        duration_s=1.5,
        rate_hz=50.0,
    )
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
    return fitted(problem, (LAW,), np.array([2.0]), np.arange(COUNT), list(range(COUNT)))


def asked(state: State) -> State:
    return redefined(state, list(range(COUNT)), Watch(report=no_progress))


def test_the_mean_rolling_speed_is_told_from_the_floors_where_much_of_the_way_is_lost() -> None:
    before = lost_way(SlipRatioFriction(share=1.0, steepness=1.5, tread_share=0.5))
    after = asked(before)
    (law,) = after.fit.effects
    assert isinstance(law, SlipRatioFriction) and law.tread_share == 0.5
    assert after.structure[0].label == "slip_ratio_friction tread_share 0.5"
    assert after.chi < before.chi and len(after.fit.x) == len(before.fit.x)
    assert law.steepness == pytest.approx(1.5, rel=0.1)


def test_the_floors_own_speed_stays_where_it_is_meant_and_something_else_is_left() -> None:
    before = lost_way(SlipRatioFriction(share=1.0, steepness=1.5), WheelLoads(shift_x_m=0.02, shift_y_m=0.01))
    assert before.chi > 1.3, "nothing is left to decide by"
    assert asked(before) is before


def test_what_explains_the_runs_is_not_asked_again() -> None:
    before = lost_way(SlipRatioFriction(share=1.0, steepness=8.0))
    assert before.chi <= 1.3 and asked(before) is before


def test_definitions_are_no_candidates_and_have_the_parameters_of_theirs() -> None:
    found = named_candidates(("a", "b", "c"), True, ())
    labels = {c.label for c in found}
    recipe = Recipe(robot=smooth_kiwi())
    members = [
        Member(name=s, recipe=recipe, surface="paper", floor=s, loading="", instrument="")
        for s in ("one", "two")
    ]
    for candidate in (*found, *in_groups(found, members)):
        for other in candidate.definitions:
            assert other.label not in labels and other.keys == candidate.keys
            assert other.subject == candidate.subject and not other.definitions
            assert changed(candidate, other)
    assert sum(bool(c.definitions) for c in found) == len(SlipRatioFriction.variants)


def changed(one: Candidate, other: Candidate) -> bool:
    return one.build(one.starts[0]) != other.build(one.starts[0])


@pytest.mark.parametrize("kind", [k for k in CATALOGUE if k.definitions], ids=lambda k: k.name)
def test_definitions_are_values_in_bounds_that_no_fit_varies(kind: type[Effect]) -> None:
    known = {p.name: p for p in kind.parameters}
    for name, values in kind.definitions.items():
        assert all(known[name].low <= v <= known[name].high and v != known[name].null for v in values)
        assert all(name not in v.free and name not in v.fixed for v in kind.variants)
