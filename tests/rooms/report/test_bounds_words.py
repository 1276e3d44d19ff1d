"""What the answer and the page of ``bounds`` say of the number that they recommend."""

from __future__ import annotations

from pathlib import Path

import pytest
from slipmargin_cli.main import status

import slipmargin as sm


def rover(folder: Path, *changes: tuple[str, str]) -> Path:
    """The draft of a mecanum car, with some of its text changed."""
    file = folder / "rover.toml"
    assert status(["robots", "new", str(file), "--type", "mecanum", "--force"]) == 0
    text = file.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    file.write_text(text, encoding="utf-8")
    return file


def page(result: sm.BoundsResult, folder: Path) -> str:
    result.write(folder / "report.html")
    return (folder / "report.html").read_text(encoding="utf-8").replace("\xa0", " ")


def test_motors_that_decide_are_named(tmp_path: Path) -> None:
    """``motor`` was above ``traction``, and the motors set the number all the same, without a word."""
    slippery = sm.bounds(rover(tmp_path), "floor")
    assert not slippery.bounds.motors_decide and slippery.to_dict()["recommended_limited_by"] == "grip"
    assert "the motors at half" not in "\n".join(slippery.lines())
    weak = ("stall_torque_N_m = 2.3", "stall_torque_N_m = 1.0")
    file = rover(tmp_path, weak, ("drive = 0.4", "drive = 0.8"))
    found = sm.bounds(file, "floor")
    assert found.bounds.motor_limit_m_s2 > found.bounds.traction_m_s2 and found.bounds.motors_decide
    line = found.lines()[3]
    assert line.startswith("recommended") and "the motors at half of their top speed" in line
    assert found.to_dict()["recommended_limited_by"] == "motor torque"
    text = page(found, tmp_path)
    assert "depends on the motors, not on friction" in text and "depends most on friction" not in text
    same = sm.bounds(rover(tmp_path, weak, ("drive = 0.4", "drive = 0.9")), "floor").recommended_m_s2
    assert same == pytest.approx(found.recommended_m_s2, rel=0.01)  # more friction does not raise it


def test_a_robot_that_must_slip_is_said_to_slip(tmp_path: Path) -> None:
    """Of draws that slip at constant speed none was counted, and the page named a direction that holds."""
    sticky = 'roller = { drive = "0.45 ± 0.005", transverse = "0.33 ± 0.005" }'
    file = rover(tmp_path, ("roller = { drive = 0.4, transverse = 0.06 }", sticky))
    found = sm.bounds(file, "floor")
    assert found.recommended_m_s2 == 0.0 and found.slip_chance is not None
    assert found.slip_chance.at_recommended > 0.9
    assert "m/s² in any direction, it must slip" in found.summary()
    chance = next(line for line in found.lines() if line.startswith("chance"))
    assert chance.endswith("slip at constant speed; 1 % slip at constant speed") and "below" not in chance
    text = page(found, tmp_path)
    assert "a wheel slips even at constant speed in 358 of 360 directions" in text
    assert "driving forwards, a wheel slips" not in text


def test_constant_speed_that_takes_the_reserve_is_not_called_slip(tmp_path: Path) -> None:
    file = rover(tmp_path, ("drive = 0.4, transverse = 0.06", "drive = 0.4, transverse = 0.235"))
    found = sm.bounds(file, "floor", margin=0.3)
    assert found.recommended_m_s2 == 0.0 < found.bounds.traction_m_s2
    text = page(found, tmp_path)
    assert "constant speed alone needs more than 70 % of the grip in" in text
    assert "slips even at constant speed" not in text


def test_a_new_robot_says_to_pull_in_many_directions(tmp_path: Path) -> None:
    """It said to pull forwards and to change one coefficient: a car with more drag got too bold a number."""
    text = rover(tmp_path).read_text(encoding="utf-8")
    assert "slipmargin measure" in text and "drive and transverse" in text and "all round" in text
