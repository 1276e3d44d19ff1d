"""A null in a result has its sentence."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from robot_files import broken

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.io.table import columns_text
from slipmargin.report.not_given import with_reasons


def test_what_is_not_finite_or_absurd_is_null_with_a_sentence() -> None:
    found = with_reasons(
        {
            "a": {"b": np.array([1.0, math.inf])},
            "c": [math.nan],
            "d": 1e290,
            "e": 2.0,
            "steady_use": [0.5, 2e5],
            "starting_m_s2": [1.6, 3e11],
            "time_s": 5.2e9,
            "normal": [3.5e14, 1.0],
        }
    )
    assert found["starting_m_s2"] == [1.6, None] and found["time_s"] is None
    assert found["normal"] == [None, 1.0]
    assert found["a"] == {"b": [1.0, None]}
    assert found["c"] == [None] and found["d"] is None and found["e"] == 2.0
    assert found["steady_use"] == [0.5, None]
    assert {"a.b", "c", "d", "steady_use", "starting_m_s2", "time_s", "normal"} == set(found["not_given"])
    assert all(found["not_given"].values())


def test_a_whole_result_has_no_such_key() -> None:
    assert "not_given" not in with_reasons({"a": 1.0, "b": ["x"], "c": {"d": True}})


def test_bounds_of_a_robot_whose_drag_leaves_no_grip(tmp_path: Path) -> None:
    """This gave -inf rad/s² in print, inf in the table and nulls without a word."""
    file = tmp_path / "r.toml"
    text = broken("transverse = 0.09", "transverse = 5.0").replace('grip = "box"', 'grip = "disc-strip"')
    file.write_text(text.split("[[effect]]")[0], encoding="utf-8")
    found = sm.bounds(file, "paper", step_deg=45.0)
    table = json.loads(found.to_json())
    assert table["steady_use"][0] is None and "drag" in table["not_given"]["steady_use"]
    assert "inf" not in found.table_text().lower()
    assert not any("inf" in line for line in found.lines())
    assert any("spinning    up none, it must slip" in line for line in found.lines())


def test_a_table_leaves_a_cell_empty_that_is_not_finite() -> None:
    assert columns_text({"a": [math.inf, -math.inf, math.nan, 1.0]}) == "a\n\n\n\n1\n"


def test_the_self_check_of_a_pull_that_is_none_is_no_astronomic_number(tmp_path: Path) -> None:
    """Where a nap leaves no grip the pull is 0 to rounding: this was 5e290."""
    tilt = '[[effect]]\nname = "floor_nap"\nnap_x = 0.9\nnap_y = -0.9\n'
    file = tmp_path / "r.toml"
    file.write_text(broken("[[effect]]", tilt + "[[effect]]", 1), encoding="utf-8")
    assert sm.sweep(file, "paper", step_deg=45.0).check < 1e-6


@pytest.mark.parametrize(("within_s", "far_m"), [(1e-6, 1e6), (0.8, 8e3)])
def test_a_trajectory_of_no_robot_is_refused(within_s: float, far_m: float) -> None:
    rows = np.column_stack([np.linspace(0.0, within_s, 9), far_m * np.arange(9.0) ** 2, np.zeros((9, 2))])
    with pytest.raises(InputError, match="no robot's motion"):
        sm.check("ohio-kiwi", "paper", rows)
