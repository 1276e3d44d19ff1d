"""The script that halves and doubles constants: what it changes, notes and counts."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

from judged.constants import CONSTANTS, GROUPS, asked, changed, changes, table, unread

ROOT = Path(__file__).resolve().parents[3]


def test_shares_near_one_keep_below_it() -> None:
    assert changed(0.3, 2.0) == 0.6 and changed(3, 0.5) == 2 and changed(1, 0.5) is None
    assert changed(0.95, 2.0) == 1.0 - 2.0 * (1.0 - 0.95) and changed(0.95, 0.5) == 1.0 - 0.5 * (1.0 - 0.95)


def test_of_several_numbers_each_is_changed() -> None:
    assert changed((0.01, 0.1, 1.0), 2.0) == (0.02, 0.2, 2.0)
    by_name = {str(constant): constant for constant in CONSTANTS}
    assert changes(by_name["diagnosis.ridges"]) == ["diagnosis.ridges 0.5", "diagnosis.ridges 2"]
    assert changes(by_name["data.piece_s"]) == ["data.piece_s 0.5", "data.piece_s 2"]


def test_every_constant_has_its_unit_and_its_reason() -> None:
    """Three shared the comment of the constant above them."""
    for group, settings in GROUPS.items():
        told = [constant for constant in CONSTANTS if constant.group == group]
        assert [constant.name for constant in told] == [f.name for f in fields(settings)]
        assert all(constant.unit and constant.reason for constant in told)


def test_a_changed_constant_reaches_the_modules_and_is_noted() -> None:
    code = (
        "from judged.constants import watched\n"
        "read = watched('data.jump_rows 2')\n"
        "from slipmargin.data import checks\n"
        "assert checks.SETTINGS.jump_rows == 100.0, checks.SETTINGS.jump_rows\n"
        "from slipmargin.diagnosis import verdict\n"
        "assert verdict.SETTINGS.level == 0.05\n"
        "assert read >= {'data.jump_rows', 'diagnosis.level'}, read\n"
        "assert 0.0 < verdict.SETTINGS.least_lead_of_squares < 1.0, 'what follows from others'\n"
        "assert read >= {'diagnosis.least_lead'}, read\n"
    )
    words = [sys.executable, "-c", code]
    done = subprocess.run(words, cwd=ROOT / "benchmarks", capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert GROUPS["data"].jump_rows == 50.0, "the settings themselves are as they were"


def test_sets_are_counted_as_lost_and_gained() -> None:
    def row(name: str, chi: float) -> dict[str, Any]:
        error = {"rmse_position_m": chi, "rmse_heading_rad": chi, "chi": chi}
        effect = {"name": name, "traced_to": "load", "parameters": {}}
        return {
            "verdict": "effect-found",
            "before": dict.fromkeys(error, 9.0),
            "after": error,
            "effects": [effect],
        }

    truth = {
        name: {"planted": True, "catalogue": "wheel_loads", "variable": "load", "also": []}
        for name in ("a", "b")
    }
    held = {
        "a:": row("wheel_loads", 1.0),
        "b:": row("stribeck", 1.0),
        "a:data.misses 2": row("stribeck", 1.5),
        "b:data.misses 2": row("wheel_loads", 0.5),
        "a:data.misses 0.5": row("wheel_loads", 1.0),
    }
    double, half = sorted(table({"sets": held}, truth), key=lambda r: r["constant"], reverse=True)
    assert double == {
        "constant": "data.misses 2",
        "sets": 2,
        "lost": ["a"],
        "gained": ["b"],
        "worst_chi_factor": 1.5,
    }
    assert half["lost"] == [] and half["gained"] == [] and half["sets"] == 1


def test_each_constant_is_asked_of_the_sets_that_read_it_and_answer_soonest() -> None:
    def row(seconds: float, *read: str) -> dict[str, Any]:
        return {"seconds": seconds, "read": list(read)}

    plain = {
        "a": row(9.0, "data.misses", "data.piece_s"),
        "b": row(3.0, "data.misses"),
        "c": row(5.0, "data.misses", "data.piece_s"),
    }
    assert asked(plain, {"data.misses 2", "data.piece_s 0.5"}, 2) == [
        *(("c", "data.piece_s 2"), ("a", "data.piece_s 2")),
        *(("b", "data.misses 0.5"), ("c", "data.misses 0.5")),
    ]


def test_a_constant_that_no_set_reads_moves_no_answer() -> None:
    plain = {"a": {"read": ["data.misses"]}, "b": {"read": ["data.piece_s"]}}
    earlier = [
        {"constant": change, "sets": 0 if str(constant) == "data.as_good" else 3, "unread_in": 7}
        for constant in CONSTANTS
        if str(constant) != "data.misses"
        for change in changes(constant)
    ]
    half, double = unread(plain, earlier)
    assert [half["constant"], double["constant"]] == ["data.as_good 0.5", "data.as_good 2"]
    assert half["unread_in"] == 9 and half["sets"] == 0 and not half["lost"]
