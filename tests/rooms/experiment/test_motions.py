"""The library of motions: inside the space, there and back, refused where the robot does not fit."""

from __future__ import annotations

import numpy as np
import pytest
from planting import smooth_kiwi

from slipmargin.errors import InputError
from slipmargin.experiment.motions import Space, checked_space, library, reach_m

MODEL = smooth_kiwi().build("paper")


@pytest.mark.parametrize("size", [(3.0, 2.0), (1.0, 4.0), (0.5, 0.5), (2.0, 0.25)])
def test_every_motion_stays_inside_and_ends_where_it_began(size: tuple[float, float]) -> None:
    space = Space(middle_m=(1.0, -0.5), size_m=size)
    found = library(space, MODEL)
    assert {"spin", "quarter-turns"} <= {m.kind for m in found}
    for motion in found:
        assert max(space.excess_m(leg, reach_m(MODEL)) for leg in motion.legs) == 0.0, motion.words
        for one, two in zip(motion.legs, [*motion.legs[1:], motion.legs[0]], strict=True):
            gap = two[0] - one[-1]
            assert np.allclose(gap[:2], 0.0) and np.isclose(np.sin(0.5 * gap[2]), 0.0, atol=1e-9), (
                motion.words
            )


def test_motions_need_the_room_that_they_take() -> None:
    narrow = {m.kind for m in library(Space(middle_m=(0.0, 0.0), size_m=(2.0, 0.25)), MODEL)}
    wide = {m.kind for m in library(Space(middle_m=(0.0, 0.0), size_m=(2.0, 2.0)), MODEL)}
    assert "line-x" in narrow and not {"line-y", "circle", "square", "diagonal"} & narrow
    assert {"line-x", "line-y", "circle", "eight", "square", "diagonal"} <= wide


def test_the_outline_counts() -> None:
    """Wheels 95 mm from the middle with a radius of 25.4 mm take a circle of 241 mm."""
    assert reach_m(MODEL) == pytest.approx(0.095 + 0.0254, abs=1e-3)
    with pytest.raises(InputError, match=r"space: is 0\.2 m x 3 m and the robot .* takes 0\.241 m"):
        library(Space(middle_m=(0.0, 0.0), size_m=(0.2, 3.0)), MODEL)
    with pytest.raises(InputError, match=r"0\.341 m in one direction"):
        library(Space(middle_m=(0.0, 0.0), size_m=(0.25, 0.25)), MODEL)


@pytest.mark.parametrize("size", [(0.0, 1.0), (1.0, -2.0), (float("nan"), 1.0), (1e9, 1.0), ("3", 2.0)])
def test_a_space_is_two_lengths(size: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="give two sides in metres, 3x2"):
        checked_space("space", size)


def test_a_smaller_motion_turns_as_far() -> None:
    motion = next(
        m for m in library(Space(middle_m=(1.0, 2.0), size_m=(3.0, 2.0)), MODEL) if m.kind == "eight"
    )
    half = motion.sized(0.5)
    assert half.extent_m == pytest.approx(0.5 * motion.extent_m)
    one, two = (np.concatenate(m.legs) for m in (motion, half))
    assert np.array_equal(one[:, 2], two[:, 2])
    assert np.allclose(one[:, :2].mean(axis=0) - two[:, :2].mean(axis=0), 0.0, atol=0.02)


def test_a_motion_that_ran_away_is_outside() -> None:
    space = Space(middle_m=(0.0, 0.0), size_m=(3.0, 2.0))
    assert space.excess_m(np.array([[1.5, 0.0, 0.0]]), 0.1) == pytest.approx(0.1)
    assert space.excess_m(np.array([[0.0, np.nan, 0.0]]), 0.1) == np.inf
