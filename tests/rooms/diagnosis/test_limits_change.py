"""Limits before and after are extras: where one cannot be computed, it is said and the rest stands."""

from __future__ import annotations

import json

import numpy as np
import pytest
from diagnoses import diagnosis

from slipmargin.diagnosis import limits_change as module
from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.effects import Recipe
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.io.robot_file import read_recipe
from slipmargin.plots.limits_change import limits_figure
from slipmargin.report.diagnosis_details import limits
from slipmargin.report.diagnosis_json import report_text
from slipmargin.report.diagnosis_words import summary_lines
from slipmargin.report.page import Table, Text


def recipes() -> tuple[Recipe, Recipe]:
    before = read_recipe("ohio-kiwi")
    return before, before.with_effects(WheelLoads(shift_x_m=0.01, shift_y_m=0.0, com_share=1.0))


def test_a_plan_that_fails_costs_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(module, "plan_change", broken)
    change = limits_change(*recipes(), "paper")
    assert change.plan is None and change.moved and np.isfinite(change.after.start_m_s2).all()
    (sentence,) = change.missing
    assert sentence == "Could not be computed: the plan before and after (division by zero)."
    assert sentence in " ".join(summary_lines(diagnosis(), change))
    assert json.loads(report_text(diagnosis(), change))["not_computed"] == [sentence]


def test_accelerations_that_fail_are_no_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    good, calls = module.directions, []

    def sometimes(*args: object, **options: object) -> object:
        calls.append(1)
        if len(calls) > 2:  # the corrected robot's
            raise FloatingPointError
        return good(*args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "directions", sometimes)
    change = limits_change(*recipes(), "paper")
    assert np.isnan(change.after.start_m_s2).all() and np.isfinite(change.before.start_m_s2).all()
    assert np.isfinite(change.after.f_max_N).all() and len(change.missing) == 2
    from slipmargin.plots.style import image

    drawn = image(limits_figure(change), png=True)
    blocks = limits(change, {"limits": drawn})
    (table,) = (b for b in blocks if isinstance(b, Table))
    assert any("not computed" in row[2] for row in table.rows)
    assert sum(isinstance(b, Text) and "Could not be computed" in b.text for b in blocks) == 2
    saved = json.loads(report_text(diagnosis(), change))["limits"]["after"]
    assert saved["start_min_m_s2"] is None and saved["f_max_min_N"] > 0.0
