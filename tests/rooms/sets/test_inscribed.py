"""Largest box and ellipsoid in a polytope: known answers, and many nearly parallel rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from slipmargin.errors import NoSolution
from slipmargin.sets import inscribed
from slipmargin.sets.inscribed import largest_box, largest_ellipsoid


def test_by_hand() -> None:
    assert largest_box(np.array([[1.0, 1.0], [0.5, 0.0]])) == pytest.approx([0.5, 0.5])
    assert largest_box(np.array([[2.0, 0.0], [0.0, 0.25]])) == pytest.approx([0.5, 4.0])
    assert largest_box(np.array([[2.0, 0.0]]))[1] == np.inf
    cube = np.vstack([np.eye(3), -np.eye(3)])
    assert largest_ellipsoid(cube) == pytest.approx(np.eye(3), abs=1e-8)


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(3, 400), st.floats(-5.0, 0.0))
def test_nearly_parallel_rows(seed: int, count: int, thin: float) -> None:
    """Cone solvers gave up where thousands of rows were alike, or where the set was thin."""
    rng = np.random.default_rng(seed)
    one = rng.normal(size=(1, 3)) + 10.0**thin * rng.normal(size=(count, 3))
    rows = np.vstack([one, rng.normal(size=(6, 3))]) * rng.uniform(0.5, 2.0, (count + 6, 1))
    E = largest_ellipsoid(rows)
    reach = np.linalg.norm(rows @ E, axis=1)
    assert 1.0 - 1e-6 <= np.max(reach) <= 1.0
    box = largest_box(np.abs(rows))
    assert 1.0 - 1e-6 <= np.max(np.abs(rows) @ box) <= 1.0
    for _ in range(50):  # nothing larger fits
        other = box * np.exp(0.3 * rng.normal(size=3))
        if np.prod(other) > np.prod(box) * (1.0 + 1e-6):
            assert np.max(np.abs(rows) @ other) > 1.0
        change = E @ (np.eye(3) + 0.1 * (turn := rng.normal(size=(3, 3))) + 0.1 * turn.T)
        if abs(np.linalg.det(change)) > np.linalg.det(E) * (1.0 + 1e-6):
            assert np.max(np.linalg.norm(rows @ change, axis=1)) > 1.0


def test_rows_that_leave_a_direction_free_are_refused() -> None:
    """Such rows gave eigenvalues that did not converge."""
    flat = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 1e-12]])
    for rows in (flat, np.full((4, 3), np.inf), np.zeros((4, 3))):
        with pytest.raises(NoSolution, match="free"):
            largest_ellipsoid(rows)


def test_rows_that_another_exceeds_in_every_column_change_nothing() -> None:
    draw = np.random.default_rng(8)
    rows = np.abs(draw.normal(size=(40, 4)))
    within = rows[draw.integers(0, 40, 3000)] * draw.uniform(0.0, 1.0, (3000, 1))
    assert np.array_equal(largest_box(np.vstack([within, rows, rows])), largest_box(rows))
    assert np.array_equal(largest_box(rows), largest_box(rows[::-1]))


def test_of_very_many_rows_a_part_gives_the_same_sets(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = np.random.default_rng(3)
    rows = draw.normal(size=(6000, 3)) * (1.0, 3.0, 0.2)
    found = inscribed.largest_ellipsoid(rows), inscribed.largest_box(np.abs(rows))
    monkeypatch.setattr(inscribed, "_PART", len(rows))
    of_all = inscribed.largest_ellipsoid(rows), inscribed.largest_box(np.abs(rows))
    assert np.max(np.linalg.norm(rows @ found[0], axis=1)) <= 1.0 + 1e-9
    for one, other in zip(found, of_all, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-5)
    assert np.linalg.det(found[0]) == pytest.approx(np.linalg.det(of_all[0]), rel=1e-7)
    assert np.prod(found[1]) == pytest.approx(np.prod(of_all[1]), rel=1e-7)
