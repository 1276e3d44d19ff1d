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


@pytest.mark.parametrize(("speed_m_s", "name"), [(0.002, "friction_coefficients"), (0.1, "stribeck")])
def test_a_name_stuck_at_a_bound_in_all_runs_gives_way_to_one_that_is_as_good(
    monkeypatch: pytest.MonkeyPatch, speed_m_s: float, name: str
) -> None:
    """Friction 1.5 times as large was called stribeck, with a speed that all runs put at its least."""
    problem = problem_of(good(3))
    every = np.arange(4, dtype=np.int64)
    plain = fitted(problem, (), np.zeros(0), every, every.tolist())
    labels = ("stribeck", "friction_coefficients")
    listed = {c.label: c for c in named_candidates(("1", "2", "3"), False, ()) if c.label in labels}

    def at(structure: tuple[Candidate, ...], x: Any) -> State:
        return replace(plain, fit=replace(plain.fit, structure=structure, x=np.asarray(x, dtype=float)))

    law, factor = listed["stribeck"], listed["friction_coefficients"]
    speed = law.keys.index("stribeck_speed_m_s")
    few = np.array(law.starts[0])
    few[speed] = 0.01
    found, rival = at((law,), few), at((factor,), factor.starts[0])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    done = Round(before=plain, screening=nothing, tried=(found, rival), best=found, taken=True)
    in_all = few.copy()
    in_all[speed] = speed_m_s
    monkeypatch.setattr(
        search,
        "fitted",
        lambda view, structure, *_: at(structure, in_all if structure == (law,) else rival.fit.x),
    )
    kept = search._in_all(found, [done], every, every.tolist(), lambda: False)
    assert kept.last.name == name
