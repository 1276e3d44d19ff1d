"""Timed motions: from rest to rest, within the share of the grip of every model, no longer than asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import smooth_kiwi

from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.experiment.motions import Space, library
from slipmargin.experiment.timing import Pace, drives
from slipmargin.model import Model
from slipmargin.paths.along import Caps
from slipmargin.paths.sample import use_along

RECIPE = smooth_kiwi()
MODEL = RECIPE.build("paper")
PACE = Pace(share=0.9, caps=Caps(), step_s=0.01, longest_s=6.0)
MOTIONS = {m.kind: m for m in library(Space(middle_m=(0.0, 0.0), size_m=(2.0, 1.5)), MODEL)}


def slippery() -> Model:
    effect = FrictionCoefficients(drive_factor=0.8, transverse_factor=1.0, steepness_factor=1.0)
    return replace(RECIPE, effects=(effect,)).build("paper")


@pytest.mark.parametrize("kind", ["spin", "line-y", "turning-circle-left", "square"])
def test_runs_begin_and_end_at_rest_and_keep_the_limits(kind: str) -> None:
    found = drives(MOTIONS[kind], [MODEL], PACE)
    assert found
    for drive in found:
        rows = drive.trajectory
        assert not rows.omega[0].any() and not rows.omega[-1].any() and not rows.velocity[-1].any()
        assert np.allclose(rows.pose[0, :2], rows.pose[-1, :2]) and drive.duration_s <= PACE.longest_s
        assert np.allclose(np.diff(rows.t_s), PACE.step_s) and np.max(rows.use) <= PACE.share
        rolled = MODEL.geometry.no_slip_map() @ rows.omega.T  # wheel speeds are those of the path
        speed = np.hypot(rolled[0], rolled[1])
        assert np.allclose(speed, np.hypot(rows.velocity[:, 0], rows.velocity[:, 1]), atol=1e-9)


def test_slower_paces_are_slower_and_repeats_fill_the_time() -> None:
    hard, *others = drives(MOTIONS["quarter-turns"], [MODEL], PACE)
    assert hard.repeats > 1 and f"{hard.repeats} times" in hard.words
    top = float(np.max(np.abs(hard.trajectory.omega)))
    for drive in others:
        assert float(np.max(np.abs(drive.trajectory.omega))) < 0.6 * top


def test_the_weakest_model_decides() -> None:
    """With four fifths of the grip the same line takes longer, and both models keep their share."""
    alone = drives(MOTIONS["line-y"], [MODEL], PACE)[0].trajectory
    both = drives(MOTIONS["line-y"], [MODEL, slippery()], PACE)[0].trajectory
    for model in (MODEL, slippery()):
        use = use_along(model, both.t_s, both.pose, both.velocity, both.acceleration, held=True)
        assert float(np.max(use)) <= PACE.share + 1e-6
    fastest, slower = (float(np.max(np.abs(r.acceleration))) for r in (alone, both))
    assert slower < 0.95 * fastest
    over = use_along(slippery(), alone.t_s, alone.pose, alone.velocity, alone.acceleration, held=True)
    assert float(np.max(over)) > PACE.share


def test_caps_are_kept() -> None:
    capped = replace(PACE, caps=Caps(speed_m_s=0.2, yaw_rate_rad_s=1.0))
    for kind in ("line-y", "turning-line-y"):
        for drive in drives(MOTIONS[kind], [MODEL], capped):
            rows = drive.trajectory
            assert float(np.max(np.hypot(*rows.velocity[:, :2].T))) <= 0.2 + 1e-9
            assert float(np.max(np.abs(rows.velocity[:, 2]))) <= 1.0 + 1e-9


def test_what_no_model_can_drive_is_left_out() -> None:
    assert drives(MOTIONS["line-x"], [MODEL], replace(PACE, share=0.3)) == []  # its drag alone takes 0.53
    assert drives(MOTIONS["line-y"], [MODEL], replace(PACE, longest_s=0.4)) == []
