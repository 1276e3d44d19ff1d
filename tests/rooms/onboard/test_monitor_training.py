"""What a slip monitor learns from the runs of a data set."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from planting import planted, smooth_kiwi
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis.sense import measure
from slipmargin.diagnosis.turned import data_set_in
from slipmargin.effects import Effect
from slipmargin.effects.camera import camera_effects
from slipmargin.effects.clock_rate import ClockRate
from slipmargin.effects.heading_gain import HeadingGain
from slipmargin.effects.marker_offset import MarkerOffset
from slipmargin.errors import InputError
from slipmargin.io.data_set_write import write_data_set
from slipmargin.physics.convention import Convention


@pytest.fixture(scope="module")
def runs() -> DataSet:
    return planted(smooth_kiwi(), None, 1, count=4)


def seen_by(camera: tuple[Effect, ...], runs: DataSet) -> DataSet:
    """The same runs as a camera sees them, and the camera in their robot file."""
    recipe = runs.recipe.with_effects(*camera)
    sensing = recipe.build(runs.surface).measurement
    trials = tuple(replace(t, pose=measure(sensing, [t.since_s], t.pose[None])[0]) for t in runs.trials)
    return replace(runs, recipe=recipe, trials=trials)


def test_a_camera_that_the_data_set_knows_of_is_no_slip(runs: DataSet, tmp_path: Path) -> None:
    """Its scale became the body's gain, and its delay was learned as slip."""
    camera = (
        *camera_effects(0.93, 0.2, 0.1),
        HeadingGain(gain=1.1),
        MarkerOffset(marker_x_m=0.05, marker_y_m=-0.1),
    )
    watches = []
    for name, data in (("true", runs), ("seen", seen_by(camera, runs))):
        write_data_set(tmp_path / name, data)
        watches.append(sm.SlipMonitor(runs.recipe, runs.surface, gyro=True, training=tmp_path / name))
    true, seen = (watch.ratio for watch in watches)
    # The camera's last 0.1 s are missing; the scale alone is 0.07 of the gain.
    for one, other in ((true.grips, seen.grips), (true.slips, seen.slips)):
        np.testing.assert_allclose(other.gain, one.gain, atol=0.01)


def test_runs_of_another_floor_are_said(runs: DataSet, tmp_path: Path) -> None:
    write_data_set(tmp_path / "runs", runs)
    other = replace(runs.recipe.robot.surface(runs.surface), name="other")
    robot = replace(runs.recipe.robot, surfaces=(*runs.recipe.robot.surfaces, other))
    for surface in (runs.surface, "other"):
        said = sm.SlipMonitor(robot, surface, training=tmp_path / "runs").warnings
        assert any("are of surface" in s for s in said) == (surface == "other")


def test_what_cannot_be_undone_is_refused(runs: DataSet, tmp_path: Path) -> None:
    slow = replace(runs, recipe=runs.recipe.with_effects(ClockRate(period_factor=1.02)))
    for name, data, said in (
        ("slow", slow, "effect: a clock or a general form of the measurement cannot be undone"),
        ("ros", data_set_in(runs, Convention.ROS), "convention: is ros, the robot's is paper"),
    ):
        write_data_set(tmp_path / name, data)
        with pytest.raises(InputError, match=said):
            sm.SlipMonitor(runs.recipe, runs.surface, training=tmp_path / name)


@pytest.mark.parametrize(("seed", "said"), [(5, "has no effect"), (-1, "is -1, give a whole number from 0")])
def test_a_seed_beside_runs_to_train_on_is_refused(
    seed: int, said: str, runs: DataSet, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It was ignored without a word, one below zero too."""
    log = tmp_path / "log.csv"
    log.write_text("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,3\n", encoding="utf-8")
    write_data_set(tmp_path / "runs", runs)
    words = ["ohio-kiwi", str(log), "--surface", "paper", "--train", str(tmp_path / "runs")]
    assert status(["monitor", *words, "--seed", str(seed)]) == 2
    assert f"--seed: {said}" in capsys.readouterr().err
