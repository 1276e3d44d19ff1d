"""Pulls gathered by orientation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from slipmargin.data.pulls import PullGroups, Pulls, gather_pulls
from slipmargin.data.settings import SETTINGS
from slipmargin.errors import InputError


def test_repeated_pulls_become_mean_and_scatter() -> None:
    groups = gather_pulls(np.array([0.2, 0.0, 0.0001, 0.2, 0.2]), np.array([6.0, 5.0, 5.4, 6.3, 5.7]))
    np.testing.assert_allclose(groups.phi_rad, [0.00005, 0.2])
    np.testing.assert_allclose(groups.mean_N, [5.2, 6.0])
    np.testing.assert_allclose(groups.sd_N, [0.2 * np.sqrt(2), 0.3])
    assert groups.low_N.tolist() == [5.0, 5.7] and groups.high_N.tolist() == [5.4, 6.3]
    assert groups.count.tolist() == [2.0, 3.0]
    assert groups.nearest(0.2 + SETTINGS.same_rad / 2) == 1 and groups.nearest(0.1) is None


def test_one_pull_has_no_scatter() -> None:
    assert np.isnan(gather_pulls(np.array([0.1]), np.array([5.0])).sd_N[0])


def test_a_full_turn_apart_is_one_orientation_and_neighbours_do_not_chain() -> None:
    part = 0.9 * SETTINGS.same_rad
    groups = gather_pulls(np.array([0.3 * part, 2.0 * np.pi - 0.3 * part, 1.0]), np.array([5.0, 7.0, 6.0]))
    assert groups.count.tolist() == [1.0, 2.0] and groups.mean_N.tolist() == [6.0, 6.0]
    assert groups.nearest(0.0) == groups.nearest(2.0 * np.pi) == 1
    row = 1.0 + part * np.arange(40)
    assert len(gather_pulls(row, np.ones(40)).count) == 20


def test_groups_are_checked() -> None:
    one = np.array([1.0])
    with pytest.raises(InputError, match="mean_N"):
        PullGroups(phi_rad=one, mean_N=np.array([np.nan]), low_N=one, high_N=one, sd_N=one, count=one)


@given(st.lists(st.tuples(st.floats(-7.0, 7.0), st.floats(0.1, 100.0)), min_size=1, max_size=30))
def test_no_pull_is_lost(rows: list[tuple[float, float]]) -> None:
    phi, force = np.array(rows).T
    groups = gather_pulls(phi, force)
    assert groups.count.sum() == len(rows)
    assert np.sum(groups.mean_N * groups.count) == pytest.approx(force.sum())
    assert np.all(np.diff(groups.phi_rad) > 0)


def test_settings_gather_what_was_pulled_alike() -> None:
    pulls = Pulls(
        phi_rad=np.array([0.0, 2.0 * np.pi, 1.0, 0.001, 1.0]),
        force_N=np.ones(5),
        direction_rad=np.array([0.0, 0.0, 0.0, 0.0, np.pi]),
    )
    settings, which = pulls.settings()
    assert len(settings) == 3 and which[0] == which[1] == which[3] and which[2] != which[4]


@pytest.mark.parametrize(("key", "value"), [("height_m", [-0.1]), ("sigma_N", 0.0), ("point_m", [[1.0]])])
def test_pulls_that_cannot_be_are_refused(key: str, value: object) -> None:
    one = np.array([1.0])
    with pytest.raises(InputError, match=key):
        Pulls(phi_rad=one, force_N=one, **{key: np.array(value) if key != "sigma_N" else value})  # type: ignore[arg-type]
