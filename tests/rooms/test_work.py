"""Work that grows with the input has a limit, a message and an option that raises it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from fuzz import mutate
from real_logs import EXCERPT

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.study.measure import _refuse_undecided
from slipmargin.work import FACTOR, allow


def many_wheels(folder: Path, count: int, grip: str = "box") -> Path:
    """A ring of wheels whose rigid sectors hold more along and less across."""
    wheels = [
        {
            "name": f"w{i}",
            "position_m": [
                0.3 * math.cos(2.0 * math.pi * i / count),
                0.3 * math.sin(2.0 * math.pi * i / count),
            ],
            "drive_direction_deg": 360.0 * i / count + 90.0,
            "radius_m": 0.05,
            "rigid_fraction": 0.1,
        }
        for i in range(count)
    ]
    material = {"roller": {"drive": 0.3, "transverse": 0.1}, "rigid": {"drive": 0.5, "transverse": 0.05}}
    table = {
        "schema": 1,
        "name": "ring",
        "body": {"mass_kg": 5.0, "inertia_kg_m2": 0.2},
        "friction": {"law": "atan", "k_s_per_m": 1000.0, "grip": grip},
        "wheel": wheels,
        "surface": {"floor": material},
    }
    file = folder / "ring.toml"
    file.write_text(mutate.toml(table))
    return file


def test_a_limit_is_said_with_its_cure_and_raised_by_a_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"asks for 300 rows, and at most 100 .* SLIPMARGIN_WORK=3 to allow"):
        allow("step", 300, 100, "rows", "take a longer step")
    monkeypatch.setenv(FACTOR, "3")
    allow("step", 300, 100, "rows", "take a longer step")
    for bad in ("much", "0.5", "nan", "inf"):
        monkeypatch.setenv(FACTOR, bad)
        with pytest.raises(InputError, match="SLIPMARGIN_WORK: is"):
            allow("step", 300, 100, "rows", "take a longer step")


@pytest.mark.parametrize("grip", ["box", "ellipse"])
def test_contact_states_of_many_wheels_are_refused_not_waited_for(tmp_path: Path, grip: str) -> None:
    file = many_wheels(tmp_path, 16, grip)
    with pytest.raises(InputError, match="contact states"):
        sm.sweep(file, "floor", step_deg=30.0)
    with pytest.raises(InputError, match="contact states"):
        sm.bounds(file, "floor", step_deg=45.0, robust=True)


def test_bounds_of_many_wheels_say_what_was_left_out(tmp_path: Path) -> None:
    found = sm.bounds(many_wheels(tmp_path, 16), "floor", step_deg=45.0)
    assert np.all(np.isnan(found.bounds.rigid_use))
    assert any("not computed" in line for line in found.lines())
    assert "steady_use_rigid" in found.to_json().partition("not_given")[2]


def test_one_wrong_time_stamp_makes_no_table_of_ages(tmp_path: Path) -> None:
    """It made arrays of 535 GiB, or took 80 s."""
    lines = (EXCERPT / "gray_0.1" / "heading_005.csv").read_text().rstrip("\n").split("\n")
    cells = lines[-1].split(";")
    lines[-1] = ";".join([str(1e9 * float(cells[0])), *cells[1:]])
    (tmp_path / "l.csv").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"rows on an even clock.* where it jumps by"):
        sm.import_logs([tmp_path / "l.csv"], "robotino", "robotino")


def test_a_robot_that_holds_no_pull_measures_no_floor() -> None:
    """Slopes were divided by the largest pull, and singular values of what is not finite not found."""
    with pytest.raises(InputError, match="hold any pull"):
        _refuse_undecided(("omni",), np.array([0.3, 0.1]), np.zeros(5), lambda mu: np.zeros(5))
