"""Proposed runs in the axes of ROS: wheel speeds stay, places turn by a quarter, and back again exactly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from planting import smooth_kiwi
from proposals import next_runs

from slipmargin.effects.turned import recipe_in
from slipmargin.experiment.motions import Space, library
from slipmargin.experiment.timing import Pace, drives
from slipmargin.experiment.turned import next_runs_in
from slipmargin.paths.along import Caps
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import rotate_rows

PAPER, ROS = Convention.PAPER, Convention.ROS


def test_there_and_back_is_the_same() -> None:
    found = next_runs()
    again = next_runs_in(next_runs_in(found, PAPER, ROS), ROS, PAPER)
    assert next_runs_in(found, PAPER, PAPER) is found
    assert again.space == found.space and again.narrowings == found.narrowings
    assert np.array_equal(again.noise, found.noise) and again.front_rad == found.front_rad
    one, two = found.runs[0], again.runs[0]
    assert two.words == one.words and np.array_equal(two.trajectory.pose, one.trajectory.pose)


def test_what_has_axes_is_turned() -> None:
    turned = next_runs_in(next_runs(), PAPER, ROS)
    assert turned.space == Space(middle_m=(0.2, -0.5), size_m=(2.0, 3.0))
    assert turned.runs[0].words.startswith("straight along the floor's y")
    assert [n.parameter for n in turned.narrowings] == ["floor_tilt.tilt_y_rad", "floor_tilt.tilt_x_rad"]
    assert turned.noise.tolist() == [6e-4, 5e-4, 2e-3] and turned.front_rad == 0.0


def test_the_robot_of_the_file_drives_the_same_run() -> None:
    """Wheel speeds of a turned run are those by which the turned robot follows the turned path."""
    recipe = smooth_kiwi()
    model, other = recipe.build("paper"), recipe_in(recipe, ROS).build("paper")
    pace = Pace(share=0.9, caps=Caps(), step_s=0.02, longest_s=4.0)
    motion = next(
        m for m in library(Space(middle_m=(0.0, 0.0), size_m=(2.0, 2.0)), model) if m.kind == "turning-line-y"
    )
    rows = drives(motion, [model], pace)[0].trajectory
    base = next_runs()
    found = replace(base, runs=(replace(base.runs[0], trajectory=rows, predicted=()),))
    turned = next_runs_in(found, PAPER, ROS).runs[0].trajectory
    body = rotate_rows(turned.pose[:, 2], turned.velocity, inverse=True)
    assert np.allclose(other.geometry.wheel_speeds(body), turned.omega, atol=1e-9)
    assert np.max(np.abs(turned.omega)) > 1.0
