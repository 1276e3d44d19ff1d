"""Limits before and after are extras: where one cannot be computed, it is said and the rest stands."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from diagnoses import diagnosis
from json_schemas import faults
from matplotlib.figure import Figure

from slipmargin.diagnosis import limits_change as module
from slipmargin.diagnosis.limits_change import Limits, limits_change
from slipmargin.effects import Effect, Recipe
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_nap import FloorNap
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.yaw_inertia import YawInertia
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit_or_zero
from slipmargin.plots.limits_change import limits_figure
from slipmargin.plots.style import image
from slipmargin.report.diagnosis_details import limits
from slipmargin.report.diagnosis_json import report_text
from slipmargin.report.diagnosis_page import page
from slipmargin.report.diagnosis_words import summary_lines
from slipmargin.report.page import Facts, Image, Table, Text


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
    drawn = image(limits_figure(change), png=True)
    blocks = limits(change, {"limits": drawn})
    (table,) = (b for b in blocks if isinstance(b, Table))
    assert any("not computed" in row[2] for row in table.rows)
    assert sum(isinstance(b, Text) and "Could not be computed" in b.text for b in blocks) == 2
    saved = json.loads(report_text(diagnosis(), change))["limits"]["after"]
    assert saved["start_min_m_s2"] is None and saved["f_max_min_N"] > 0.0


@pytest.mark.parametrize(
    "lies",
    [
        lambda a: FloorTilt(tilt_x_rad=0.03 * np.cos(a), tilt_y_rad=0.03 * np.sin(a)),
        lambda a: FloorNap(nap_x=0.2 * np.cos(a), nap_y=0.2 * np.sin(a)),
        lambda a: FloorGrain(cosine=0.2 * np.cos(2.0 * a), sine=0.2 * np.sin(2.0 * a)),
    ],
)
def test_the_weakest_pull_is_that_of_every_direction_of_the_floor(lies: Callable[[float], Effect]) -> None:
    """The same floor, its frame rotated by 1 rad: −3.8 % or −7.0 %."""
    believed = read_recipe("ohio-kiwi")
    one, other = (limits_change(believed, believed.with_effects(lies(a)), "paper") for a in (0.0, 1.0))
    for name in Limits.__slots__:
        np.testing.assert_allclose(getattr(one.after, name), getattr(other.after, name), rtol=5e-3, atol=5e-4)
    assert one.after.f_max_min_N == pytest.approx(other.after.f_max_min_N, rel=1e-3)
    assert one.before.f_max_min_N == recipes_limit() and one.after.f_max_min_N < one.before.f_max_min_N
    said = " ".join(summary_lines(diagnosis(), one))
    assert "each orientation in the floor's worst direction" in said
    facts = page(diagnosis(), one, images()).sections[0].blocks[0]
    assert isinstance(facts, Facts)
    assert facts.facts[-1].note == "over all orientations and directions of the floor, on rollers"
    text = report_text(diagnosis(), one)
    assert json.loads(text)["limit_curves"]["floor_directions"] == 36 and faults("diagnose", text) == []


def test_a_floor_without_directions_is_asked_along_one() -> None:
    change = limits_change(*recipes(), "paper")
    assert change.floor_directions == 1 and change.before.f_max_min_N == recipes_limit()
    facts = page(diagnosis(), change, images()).sections[0].blocks[0]
    assert isinstance(facts, Facts) and facts.facts[-1].note == "over all orientations, on rollers"
    assert "floor_directions" not in json.loads(report_text(diagnosis(), change))["limit_curves"]


def recipes_limit() -> float:
    """Weakest pull of the robot as believed, along the floor's +x alone."""
    phi = np.deg2rad(np.arange(360.0))
    return float(np.min(limit_or_zero(recipes()[0].build("paper"), phi, Pull())))


def images() -> dict[str, Image]:
    drawn = image(Figure(), png=True)
    return dict.fromkeys(("residual", "where", "candidates", "held-out", "limits"), drawn)


def test_a_robot_that_is_harder_to_turn_turns_more_slowly_and_pulls_as_before() -> None:
    """It was said that no limit changes, and that what was found is in how the motion is measured."""
    believed = read_recipe("ohio-kiwi")
    change = limits_change(believed, believed.with_effects(YawInertia(inertia_factor=2.0)), "paper")
    assert change.moved
    np.testing.assert_array_equal(change.after.f_max_N, change.before.f_max_N)
    for name in ("spin_rad_s2", "spin_worst_rad_s2"):
        assert getattr(change.after, name) == pytest.approx(0.5 * getattr(change.before, name), rel=1e-9)
    assert any(
        "turning on the spot" in line and "−50 %" in line for line in summary_lines(diagnosis(), change)
    )
    text = report_text(diagnosis(), change)
    assert faults("diagnose", text) == []
    rows = json.loads(text)["limits"]
    assert rows["after"]["spin_rad_s2"] == pytest.approx(0.5 * rows["before"]["spin_rad_s2"])
