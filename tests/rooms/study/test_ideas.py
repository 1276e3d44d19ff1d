"""Several robots side by side: who is best is what ``bounds`` says, and who cannot be told apart is alike."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.robot import Robot
from slipmargin.robot.uncertain import Uncertain

FLOOR = "paper"


def idea(name: str, **body: object) -> Robot:
    """A kiwi robot whose loads follow the acceleration."""
    robot = sm.read_robot("ohio-kiwi-symmetric", load_model="quasi-static").robot
    return replace(robot, name=name, body=replace(robot.body, **body))


def with_drive(robot: Robot, drive: float) -> Robot:
    floor = robot.surface(FLOOR)
    new = replace(floor, roller=replace(floor.roller, drive=drive), library=None)
    return replace(robot, surfaces=tuple(new if s.name == FLOOR else s for s in robot.surfaces))


LOW, HIGH = idea("low", com_height_m=0.05), idea("high", com_height_m=0.12)
BACK = idea("back", com_m=np.array([0.0, -0.03]))


def test_the_best_at_starting_is_the_one_that_bounds_says() -> None:
    found = sm.compare([HIGH, LOW], FLOOR)
    starts = [sm.bounds(robot, FLOOR, margin=0.0).recommended_m_s2 for robot in (HIGH, LOW)]
    assert found.best() == ["low"] and starts[1] > starts[0]
    assert found.lines()[0].startswith("starting    low is best: ")
    values = [one.values["start_worst_m_s2"] for one in found.ideas]
    full = [sm.bounds(robot, FLOOR).bounds.traction_m_s2 for robot in (HIGH, LOW)]
    assert values == pytest.approx(full, rel=1e-9)


def test_the_same_robot_twice_is_alike_at_everything() -> None:
    found = sm.compare([LOW, replace(LOW, name="twin")], FLOOR)
    for question in found.to_dict()["questions"]:
        assert found.best(question["key"]) == ["low", "twin"]
    assert found.lines()[0].startswith("starting    all alike: ")


def test_the_battery_goes_where_starting_is_best() -> None:
    """A mass moved backwards is told to go forward; there it starts as well as the one in the middle."""
    found = sm.compare([LOW, replace(BACK, body=replace(BACK.body, com_height_m=0.05))], FLOOR)
    middle, back = found.ideas
    assert found.best("place_share") == ["low"]
    assert back.place is not None and back.place.best_m_s2 > 1.05 * back.place.own_m_s2
    best = replace(back.design.robot, body=replace(back.design.robot.body, com_m=np.array(back.place.best_m)))
    reached = sm.bounds(best, FLOOR, step_deg=1.0).bounds.traction_m_s2
    assert reached == pytest.approx(middle.values["start_worst_m_s2"], rel=0.02)
    assert any("back: " in line and "mm further forward" in line for line in found.lines())


def test_loads_that_do_not_follow_the_mass_say_nothing_about_the_battery() -> None:
    robots = [sm.read_robot(LOW, load_model="equal").robot, sm.read_robot(HIGH, load_model="equal").robot]
    found = sm.compare(robots, FLOOR)
    assert found.best("place_share") == []
    assert any(line.startswith("battery     not compared: ") for line in found.lines())


def test_one_floor_under_both_cancels_and_two_floors_do_not() -> None:
    """The same spread under both moves both; an independent one as large makes them alike."""
    mu = float(LOW.surface(FLOOR).roller.drive)
    same = Uncertain((mu, mu), 0.1 * mu)
    heavier = idea("heavier", com_height_m=0.08)
    shared = sm.compare([with_drive(LOW, same), with_drive(heavier, same)], FLOOR)
    assert shared.best() == ["low"]
    other = Uncertain((mu, mu), 0.099 * mu)
    apart = sm.compare([with_drive(LOW, same), with_drive(heavier, other)], FLOOR)
    assert apart.best() == ["low", "heavier"]
    assert "the uncertain friction makes more than they differ" in apart.lines()[0]


def test_the_spread_is_that_of_the_value() -> None:
    mu = float(LOW.surface(FLOOR).roller.drive)
    found = sm.compare([with_drive(LOW, Uncertain((mu, mu), 0.05)), HIGH], FLOOR)
    at = [sm.compare([with_drive(LOW, mu + d), HIGH], FLOOR).ideas[0] for d in (-0.05, 0.05)]
    for key in ("start_worst_m_s2", "spin_rad_s2", "push_N"):
        half = 0.5 * (at[1].values[key] - at[0].values[key])
        assert found.ideas[0].deviation(key) == pytest.approx(half, rel=1e-9)
    assert found.ideas[1].deviation("push_N") == 0.0


def test_the_command_says_it_in_sentences_and_writes_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["design", "mecanum4", "omni4", "robotino", "--surface", "floor"]
    files = ["--out", "i.csv", "--plot", "i.png", "--report", "i.html"]
    assert status([*words, *files]) == 0
    out = capsys.readouterr().out
    assert "turning     robotino is best: " in out and "written: i.html" in out
    assert Path("i.csv").read_text(encoding="utf-8").splitlines()[0].startswith("idea,start_worst_m_s2,sd_")
    page = Path("i.html").read_text(encoding="utf-8")
    assert "3 ideas on floor" in page and "robotino" in page
    assert status([*words, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["best"]["spin_rad_s2"] == ["robotino"] and len(data["ideas"]) == 3


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["mecanum4", "omni4", "--vary", "mass_kg=1,2"], "--vary: has no effect on several robots"),
        (["mecanum4", "omni4", "--static"], "--static: has no effect on several robots"),
        (["mecanum4", "mecanum4"], "ROBOT: 'mecanum4' is given twice"),
        (
            ["mecanum4", "ohio-kiwi"],
            "command line: --surface: is 'floor', which ohio-kiwi has not, use one of: paper, carpet",
        ),
        (["mecanum4"], "--vary: is missing"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(["design", *words, "--surface", "floor"]) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1 and says in told.err


def test_one_robot_is_nothing_to_compare() -> None:
    with pytest.raises(InputError, match="give 2 to 12 robots"):
        sm.compare(["mecanum4"], "floor")


def test_motors_without_torque_left_are_not_called_slip() -> None:
    """At half of their top speed weak motors have nothing left: it said that a wheel slips."""
    strong = sm.read_robot("mecanum4").robot
    assert strong.motor is not None
    weak = replace(strong, name="weak", motor=replace(strong.motor, stall_torque_N_m=0.12))
    found = sm.compare([strong, weak], "floor")
    (said,) = (line for line in found.lines() if line.startswith("driving"))
    assert "with weak the motors have no torque left at half of their top speed" in said
    assert not any("slips at constant speed" in line for line in found.lines())
