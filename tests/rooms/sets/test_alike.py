"""Equal rows are found as numpy.unique finds them, whatever their bits mix into."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from slipmargin.sets import alike as module
from slipmargin.sets.alike import alike

ROWS = st.lists(st.lists(st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-300, 0.1]), min_size=3, max_size=3),
                min_size=1, max_size=30)  # fmt: skip


def same_as_numpy(rows: list[list[float]]) -> None:
    table = np.array(rows)
    kinds, first = alike(table)
    _, wanted = np.unique(table, axis=0, return_inverse=True)
    wanted = wanted.ravel()
    assert np.array_equal(kinds[:, None] == kinds, wanted[:, None] == wanted)
    assert np.array_equal(kinds[first], np.arange(kinds.max() + 1))


@given(rows=ROWS)
def test_rows_are_alike_where_numpy_says_so(rows: list[list[float]]) -> None:
    same_as_numpy(rows)


@pytest.mark.parametrize("constant", ["_ONE", "_TWO"])
def test_rows_that_mix_into_one_number_are_told_apart(constant: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, constant, 0)  # everything mixes into the same number
    same_as_numpy([[0.0, 1.0, 2.0], [3.0, 1.0, 2.0], [0.0, 1.0, 2.0], [5.0, 5.0, 5.0]])
