"""What a search found in a few runs, fitted to all that are not held out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from spoilt import good

from slipmargin.diagnosis import search
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.state import State


@pytest.mark.parametrize(
    ("speed_m_s", "more", "name"), [(0.002, 1.0, "friction_coefficients"), (0.1, 1.5, "stribeck")]
)
def test_a_name_stuck_at_a_bound_in_all_runs_gives_way_to_one_that_is_as_good(
    monkeypatch: pytest.MonkeyPatch, speed_m_s: float, more: float, name: str
) -> None:
    """Friction 1.5 times as large was called stribeck, with a speed that all runs put at its least."""
    problem = problem_of(good(3))
    every = np.arange(4, dtype=np.int64)
    plain = fitted(problem, (), np.zeros(0), every, every.tolist())
    labels = ("stribeck", "friction_coefficients")
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ()) if c.label in labels}

    def at(structure: tuple[Candidate, ...], x: Any) -> State:
        felt = np.ones((*plain.fit.residual.shape, len(x)))
        made = replace(plain.fit, structure=structure, x=np.asarray(x, dtype=float), jacobian=felt)
        return replace(plain, fit=made)

    law, factor = listed["stribeck"], listed["friction_coefficients"]
    speed = law.keys.index("stribeck_speed_m_s")
    few = np.array(law.starts[0])
    few[speed] = 0.01
    found, rival = at((law,), few), at((factor,), factor.starts[0])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=plain, screening=nothing, tried=(found, rival), best=found, taken=True)
    in_all = few.copy()
    in_all[speed] = speed_m_s
    in_all_rival = replace(rival, scores=more * rival.scores)
    monkeypatch.setattr(
        search,
        "fitted",
        lambda view, structure, *_: at(structure, in_all) if structure == (law,) else in_all_rival,
    )
    kept = search._in_all(found, [done], every, every.tolist(), lambda: False)
    assert kept.last.name == name


def test_names_that_few_runs_cannot_tell_apart_are_all_fitted_to_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """A nap was called a tilt: in fourteen runs it left less, and only the tilt was fitted to them."""
    problem = problem_of(good(3))
    every = np.arange(4, dtype=np.int64)
    plain = fitted(problem, (), np.zeros(0), every, every.tolist())
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}

    def at(label: str, scores: list[float]) -> State:
        own = listed[label]
        fit = replace(plain.fit, structure=(own,), x=own.starts[0])
        return replace(plain, fit=fit, scores=np.array(scores), samples=4000.0)

    few = {label: at(label, [1000.0, 1000.0]) for label in ("floor_tilt", "floor_nap")}
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    best = few["floor_tilt"]
    twins = (replace(best), replace(best))  # the same name from other starts takes no other name's place
    done = Round(
        before=plain, screening=nothing, tried=(best, *twins, few["floor_nap"]), best=best, taken=True
    )
    in_all = {"floor_tilt": [1008.0, 1004.0, 1006.0, 1007.0], "floor_nap": [1000.0, 1001.0, 999.0, 1000.0]}
    for nap, name in (
        ([1000.0, 1001.0, 999.0, 1000.0], "floor_nap"),
        ([1009.0, 1000.0, 1007.0, 1002.0], "floor_tilt"),
    ):
        in_all["floor_nap"] = nap
        monkeypatch.setattr(
            search, "fitted", lambda view, structure, *_: at(structure[0].label, in_all[structure[0].label])
        )
        kept = search._in_all(best, [done], every, every.tolist(), lambda: False)
        assert kept.last.name == name
