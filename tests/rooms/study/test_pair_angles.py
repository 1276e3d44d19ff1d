"""Front and rear angle of a robot with four omni wheels, and ties said as ties."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.plots.study import second_objective
from slipmargin.report.design import best_at
from slipmargin.robot.layout import pair_angle_deg, with_pair_angle

ROBOT = sm.read_robot("omni4").robot


@pytest.mark.parametrize("front", [True, False])
@pytest.mark.parametrize("angle", [20.0, 45.0, 70.0])
def test_an_angle_reads_back_and_moves_its_pair_only(front: bool, angle: float) -> None:
    turned = with_pair_angle(ROBOT, angle, front=front)
    assert pair_angle_deg(turned, front=front) == pytest.approx(angle)
    assert pair_angle_deg(turned, front=not front) == pytest.approx(45.0)
    for old, new in zip(ROBOT.wheels, turned.wheels, strict=True):
        assert np.hypot(*new.position_m) == pytest.approx(np.hypot(*old.position_m))
        # still driving at right angles to its axle, which points at the centre
        axle = np.degrees(np.arctan2(new.position_m[1], new.position_m[0]))
        assert np.cos(np.radians(new.drive_direction_deg - axle)) == pytest.approx(0.0, abs=1e-9)


def test_at_its_own_angle_nothing_changes() -> None:
    same = with_pair_angle(ROBOT, pair_angle_deg(ROBOT, front=True), front=True)
    for old, new in zip(ROBOT.wheels, same.wheels, strict=True):
        assert new.position_m == pytest.approx(old.position_m)


def test_the_angle_means_the_same_in_both_conventions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert status(["robots", "new", "ssl", "--type", "ssl"]) == 0
    robot = sm.read_robot(tmp_path / "ssl.toml").robot
    turned = with_pair_angle(robot, 33.0, front=True)
    ahead = [robot.convention.right_forward(*w.position_m) for w in turned.wheels]
    assert sum(y > 0.0 for _, y in ahead) == 2
    assert all(np.arctan2(abs(x), y) == pytest.approx(np.radians(33.0)) for x, y in ahead if y > 0.0)


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4"])
def test_other_layouts_have_no_such_angle(name: str) -> None:
    with pytest.raises(InputError, match="front_angle_deg: means nothing for robot"):
        with_pair_angle(sm.read_robot(name).robot, 30.0, front=True)


def test_ties_are_said_as_ties() -> None:
    """Mirrored pairs hold the same; a quantity that does nothing has no winner."""
    found = sm.design("omni4", "floor", ["front_angle_deg=30,60", "rear_angle_deg=30,60"], static=True)
    assert best_at(found.study, "f_worst").endswith(" (1 other is as good)")
    alike = sm.design("mecanum4", "floor", "com_height_m=0.02:0.08:0.02", static=True)
    assert best_at(alike.study, "f_worst") == "every design alike"
    assert "every design alike" in alike.summary() and "com_height_m = 0.02" not in alike.summary()
    assert "it makes no difference" in alike.page().lead


@pytest.mark.parametrize("objective", ["f_worst", "start_worst_m_s2"])
def test_two_maps_are_never_the_same(objective: str) -> None:
    found = sm.design(
        "omni4", "floor", ["front_angle_deg=30,60", "rear_angle_deg=30,60"], objective=objective
    )
    assert second_objective(found.study) != objective
