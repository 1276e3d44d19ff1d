"""report.json holds what the contract promises, for every verdict, and nothing that is no JSON."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from diagnoses import diagnosis, unnamed, wheel_loads
from hypothesis import given, settings, strategies as st

from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.result import Diagnosis, Estimate, Verdict
from slipmargin.effects import Trace
from slipmargin.report.diagnosis_json import report_text, trial_chi


def read(d: Diagnosis) -> dict[str, Any]:
    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    text = report_text(d, limits_change(d.recipe, d.corrected, d.surface))
    found: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return found


@pytest.mark.parametrize("verdict", Verdict)
def test_contract_keys(verdict: Verdict) -> None:
    found = read(diagnosis(verdict))
    assert found["schema"] == 1 and found["verdict"] == verdict.value
    assert found["noise"]["x_m"] == 5e-4 and found["noise"]["phi_rad"] == 2e-3
    for side in ("before", "after"):
        assert set(found[side]) == {"rmse_position_m", "rmse_heading_rad", "chi"}
        assert {"f_max_min_N", "f_max_mean_N"} <= set(found["limits"][side])
        assert 0.0 < found["limits"][side]["f_max_min_N"] <= found["limits"][side]["f_max_mean_N"]


def test_without_an_effect_after_is_before() -> None:
    found = read(diagnosis(Verdict.NO_MISSING_EFFECT))
    assert found["effects"] == [] and found["after"] == found["before"]
    assert found["limits"]["after"] == found["limits"]["before"]


def test_effect_entry() -> None:
    (effect,) = read(diagnosis())["effects"]
    assert effect["name"] == "wheel_loads" and effect["traced_to"] == "wheel_load"
    assert effect["wheels"] == ["right", "left", "rear"]  # all, spelled out
    assert effect["parameters"]["shift_x_m"] == {
        "value": 0.012,
        "low": 0.0115,
        "high": 0.0125,
        "unit": "m",
        "at_bound": False,
    }
    assert effect["derived"]["load_fraction1"]["value"] == 0.41
    assert effect["evidence"] | {"separated_by": {}} == {
        "chi_without": 24.0,
        "chi_with": 1.06,
        "p_value": 0.001,
        "candidates_tried": 41,
        "confused_with": [],
        "separated_by": {},
    }


def test_wheels_of_a_finding_on_one_wheel() -> None:
    (effect,) = read(diagnosis(findings=(wheel_loads(wheels=("left",)),)))["effects"]
    assert effect["wheels"] == ["left"]


def test_confused_effects_come_with_the_trial_that_separates_them() -> None:
    (effect,) = read(diagnosis(findings=(unnamed(),)))["effects"]
    evidence = effect["evidence"]
    assert evidence["confused_with"] == ["floor_nap", "unnamed_heading: friction"]
    assert all(evidence["separated_by"][name] for name in evidence["confused_with"])
    assert effect["at_bound"] == ["c3"]


def test_limits_move_with_the_effect() -> None:
    limits = read(diagnosis())["limits"]
    assert limits["after"]["f_max_min_N"] < limits["before"]["f_max_min_N"]


def test_infinite_numbers_become_null() -> None:
    found = read(diagnosis(excitation=(float("nan"), 3.0)))
    assert found["excitation"] == [None, 3.0]
    assert [t["chi"] for t in found["steps"][0]["tried"]][-1] is None  # a fit that went wild
    wide = Estimate(name="c1", value=0.1, low=-math.inf, high=math.inf, unit="1")
    (effect,) = read(diagnosis(findings=(wheel_loads(parameters=(wide,)),)))["effects"]
    assert effect["parameters"]["c1"]["low"] is None


def test_trial_chi_is_the_root_mean_square_of_what_was_seen() -> None:
    d = diagnosis()
    trial = replace(d.trials[0], measured=d.trials[0].before + 3.0 * d.noise)
    assert trial_chi(trial, trial.before, d) == pytest.approx(3.0)
    holes = np.array(trial.measured)
    holes[::2] = np.nan
    assert trial_chi(replace(trial, measured=holes), trial.before, d) == pytest.approx(3.0)
    assert math.isnan(trial_chi(replace(trial, measured=np.full_like(holes, np.nan)), trial.before, d))


@settings(max_examples=15, deadline=None)
@given(st.lists(st.sampled_from(list(Trace)), max_size=3), st.floats(0.0, 1.0))
def test_any_finding_is_json(traces: list[Trace], p_value: float) -> None:
    found = read(diagnosis(findings=tuple(wheel_loads(traced_to=t, p_value=p_value) for t in traces)))
    assert [e["traced_to"] for e in found["effects"]] == [t.value for t in traces]
    assert all(0.0 <= e["evidence"]["p_value"] <= 1.0 for e in found["effects"])
