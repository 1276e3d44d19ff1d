"""Remarks: a name that takes off less than what is still left is said to be unsure."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest
from diagnoses import wheel_loads

from slipmargin.diagnosis.remarks import of_small_shares
from slipmargin.diagnosis.state import State


def judged(piece: int | None) -> State:
    return cast(State, SimpleNamespace(view=SimpleNamespace(piece=piece)))


def test_names_that_take_off_less_than_what_is_left_are_said() -> None:
    """Of four names for one wheel that also heard another's command, three took off next to nothing.

    7.24 − 4.84 of the mean square is less than 4.84 − 1, and 16 − 4.84 is more.
    """
    large, small, doubted = (
        wheel_loads(chi_with=2.2, chi_without=4.0),
        wheel_loads(label="camera_scale", chi_with=2.2, chi_without=2.69),
        wheel_loads(label="tether", chi_with=2.2, chi_without=2.3, doubts=("it may do nothing",)),
    )
    (said,) = of_small_shares([large, small, doubted], judged(None), 2.2)
    assert said.startswith("`camera_scale` takes off less than what is still left")
    (said,) = of_small_shares([small, small], judged(100), 1.0)
    assert said.startswith("`camera_scale`, `camera_scale` each take off less")


@pytest.mark.parametrize("chi_with", [1.0, 1.25])
def test_near_the_noise_nothing_is_left_to_be_behind_them(chi_with: float) -> None:
    assert (
        of_small_shares([wheel_loads(chi_with=chi_with, chi_without=chi_with + 0.1)], judged(None), 1.1) == ()
    )


def test_what_is_left_is_what_runs_that_nothing_has_seen_show() -> None:
    """Four names left 1.5 in the runs they were fitted to, and 2.7 in the others.

    In pieces the errors of whole runs say nothing of it.
    """
    name = wheel_loads(chi_with=1.54, chi_without=2.54)
    assert of_small_shares([name], judged(None), 1.6) == ()
    assert len(of_small_shares([name], judged(None), 2.69)) == 1
    assert of_small_shares([name], judged(100), 2.69) == ()
