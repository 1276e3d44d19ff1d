"""Cameras turned against each other: seen in runs that drive alike, however wrong the model is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.campaign import Part, joined
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.mounted import _apart, rotations_of, turned
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.state import State
from slipmargin.effects import AnyEffect, Trace
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.friction_coefficients import FrictionCoefficients

RUNS = 10


def recorded(name: str, *effects: AnyEffect) -> Part:
    """The same ten motions, of a robot whose grip is not what is believed."""
    grip = FrictionCoefficients(drive_factor=0.95, transverse_factor=1.1)
    plant = Plant(name="x", traces=(Trace.COEFFICIENT,), effects=(grip, *effects))
    made = planted(smooth_kiwi(), plant, seed=4, count=RUNS, duration_s=2.0, rate_hz=50.0)
    return Part(data_set=replace(made, name=name), floor="a", loading="bare", instrument=name)


def compared(second: float) -> tuple[State, tuple[Candidate, ...]]:
    whole = joined("both", [recorded("one"), recorded("two", CameraRotation(rotation_rad=second))])
    known = in_groups(named_candidates(("1", "2", "3"), False, ()), whole.members)
    loads = next(c for c in known if c.label == "wheel_loads")
    trials, problem = np.arange(2 * RUNS), problem_of(whole)
    state = fitted(problem, (loads,), loads.starts[0], trials, trials.tolist())
    return state, rotations_of(problem.nominal, whole.members)


@pytest.mark.parametrize("angle", [0.0, 0.02])
def test_a_camera_turned_against_another_shows_beside_whatever_the_model_lacks(angle: float) -> None:
    state, rotations = compared(angle)
    assert state.chi > 3.0 and len(rotations) == 2, "much is left"
    both = turned(state, rotations, state.fit.trials)
    for (p_value, found), sign in zip(both, (-1.0, 1.0), strict=True):
        assert abs(found - sign * angle) < 0.004
        assert p_value < 0.005 if angle else p_value > 0.005


def test_runs_beside_one_and_the_same_share_its_accident() -> None:
    """Eight runs straight ahead under one camera, one under the other: its slip looked like a rotation."""
    angle = np.append(np.random.default_rng(1).normal(scale=1e-3, size=8), 0.01)
    inside = np.append(np.full(8, True), False)
    assert _apart(angle, np.ones((9, 9)), inside) == (1.0, 0.0)


def test_a_camera_that_moved_is_found_beside_the_rotation_that_is_declared() -> None:
    """The first recording is as declared; the search itself asks nothing that the robot file declares."""
    whole = joined("both", [recorded("one"), recorded("two", CameraRotation(rotation_rad=0.02))])
    declared = CameraRotation(rotation_rad=1e-4)
    whole = replace(
        whole,
        recipe=whole.recipe.with_effects(declared),
        members=tuple(replace(m, recipe=m.recipe.with_effects(declared)) for m in whole.members),
    )
    found = {f.label: f for f in diagnose(whole).findings}
    assert set(found) == {"friction_coefficients", "camera_rotation in instrument two"}
    angle = found["camera_rotation in instrument two"].parameters[0]
    assert angle.low < 0.02 < angle.high and angle.high - angle.low < 0.002
