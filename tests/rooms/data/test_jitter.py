"""Jitter of camera frames: recovered with an interval, absent where there is none."""

from __future__ import annotations

import numpy as np
import pytest

from slipmargin.data.jitter import jitter
from slipmargin.data.record import Record


def runs(jitter_s: float, count: int = 12, noise_m: float = 1e-3, speed: float = 2.0) -> tuple[Record, ...]:
    """Runs on large circles, seen at instants that differ from the rows' times."""
    random = np.random.default_rng(3)
    made = []
    for k in range(count):
        t = np.arange(0.0, 4.0, 1.0 / 60.0)
        at = t + jitter_s * random.standard_normal(len(t))
        turn = 0.5 * speed * at + k
        place = 2.0 * np.column_stack([np.cos(turn), np.sin(turn)])
        place += noise_m * random.standard_normal(place.shape)
        made.append(Record(name=f"r{k}", t_s=t, pose=np.column_stack([place, 0.0 * t])))
    return tuple(made)


@pytest.mark.parametrize("true_s", [0.5e-3, 2e-3, 5e-3])
def test_jitter_is_recovered_within_its_interval(true_s: float) -> None:
    found = jitter(runs(true_s))
    assert found is not None and found.low_s <= true_s <= found.high_s
    assert found.value_s == pytest.approx(true_s, rel=0.25)


def test_noise_that_is_the_same_in_all_directions_is_no_jitter() -> None:
    found = jitter(runs(0.0))
    assert found is not None and found.low_s == 0.0 and found.high_s < 5e-4
    assert "ms" in found.sentence


def test_without_motion_nothing_is_said() -> None:
    t = np.arange(0.0, 1.0, 0.02)
    still = Record(name="a", t_s=t, pose=np.zeros((len(t), 3)))
    assert jitter((still, still, still)) is None and jitter(runs(1e-3)[:2]) is None
