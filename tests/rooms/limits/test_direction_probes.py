"""Friction over the direction in which a wheel slides: what an unknown heading allows is found cheaply."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_weave import FloorWeave
from slipmargin.limits.motion_friction import creep_bound, friction_in_motion
from slipmargin.limits.motion_probes import probes
from slipmargin.limits.motion_state import Motion

WEAVE = FloorWeave(cosine=0.3, sine=0.2)
GRAIN = FloorGrain(cosine=0.2, sine=-0.3)


@pytest.mark.parametrize("effect", [WEAVE, GRAIN], ids=["weave", "grain"])
def test_any_direction_is_possible_where_the_heading_is_not_known(effect: FloorWeave | FloorGrain) -> None:
    plain = Recipe(robot=kiwi()).build("paper")
    model = Recipe(robot=kiwi(), effects=(effect,)).build("paper")
    velocity = np.array([[0.3, 0.1, 0.5], [0.0, -0.7, 0.2], [0.1, 0.0, -3.0]])
    known = friction_in_motion(plain, Motion(velocity=velocity))
    found = friction_in_motion(model, Motion(velocity=velocity))
    least = 1.0 - np.hypot(effect.cosine, effect.sine)
    assert found.drive == pytest.approx(least * known.drive, rel=1e-4)


def test_the_directions_that_are_probed_do_not_grow_with_the_motions() -> None:
    """17 slips of every wheel at 73 headings of every motion made a study of two robots take 46 seconds."""
    model = Recipe(robot=kiwi(), effects=(WEAVE,)).build("paper")
    (term,) = model.grip.multipliers
    for count in (1, 50):
        motion = Motion(velocity=np.tile([0.3, 0.1, 0.5], (count, 1)))
        slide = motion.velocity @ model.geometry.lateral_rows().T
        values = probes(model, motion, slide, creep_bound(model, motion, 1.0), term)
        assert values.size == len(values) < 2000


def test_a_known_heading_leaves_the_directions_that_its_slips_have() -> None:
    model = Recipe(robot=kiwi(), effects=(WEAVE,)).build("paper")
    velocity, heading = np.array([[0.3, 0.1, 0.5]]), np.array([0.4])
    motion = Motion(velocity=velocity, heading=heading)
    slide, (term,) = velocity @ model.geometry.lateral_rows().T, model.grip.multipliers
    creep = creep_bound(model, motion, 1.0)
    values = probes(model, motion, slide, creep, term)
    grip, free = model.geometry.grip, model.geometry.free
    for i in range(model.count):
        for share in (-1.0, 0.25, 1.0):
            u = share * creep[0, i] * grip[i] + slide[0, i] * free[i]
            towards = 0.4 + np.arctan2(u[1], u[0])
            assert np.min(np.abs(np.exp(1j * values[:, 0, i]) - np.exp(1j * towards))) < 1e-9
