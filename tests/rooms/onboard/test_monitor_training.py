"""What a slip monitor learns from the runs of a data set."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from planting import planted, smooth_kiwi

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


def test_what_cannot_be_undone_is_refused(runs: DataSet, tmp_path: Path) -> None:
    slow = replace(runs, recipe=runs.recipe.with_effects(ClockRate(period_factor=1.02)))
    for name, data, said in (
        ("slow", slow, "effect: a clock or a general form of the measurement cannot be undone"),
        ("ros", data_set_in(runs, Convention.ROS), "convention: is ros, the robot's is paper"),
    ):
        write_data_set(tmp_path / name, data)
        with pytest.raises(InputError, match=said):
            sm.SlipMonitor(runs.recipe, runs.surface, training=tmp_path / name)
