"""CSV columns: strict in, exact out."""

from __future__ import annotations

import csv
import os
import threading
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from slipmargin.errors import InputError
from slipmargin.io.source import lines_of
from slipmargin.io.table import columns_from_text, columns_text, read_columns

WANT = ("t_s", "x_m")


def fault(text: str, **options: object) -> InputError:
    with pytest.raises(InputError) as caught:
        columns_from_text(text, **{"required": WANT, **options})  # type: ignore[arg-type]
    return caught.value


def test_columns_are_found_by_name() -> None:
    table = columns_from_text("x_m, t_s\n1,2\n\n3,4\n", required=WANT)
    assert table["t_s"].tolist() == [2.0, 4.0]
    assert table.stack(("t_s", "x_m")).tolist() == [[2.0, 1.0], [4.0, 3.0]]
    assert table.lines.tolist() == [2, 4]
    with pytest.raises(ValueError, match="read-only"):
        table.values[0, 0] = 1.0


@pytest.mark.parametrize(
    ("text", "place", "problem"),
    [
        ("", "1:1", "there is no header"),
        ("t_s,,x_m\n1,2,3\n", "1:2", "no name"),
        ("t_s,x_m,t_s\n1,2,3\n", "1:3", "given twice"),
        ("t_s,y_m\n1,2\n", "1:1", "'x_m' is missing"),
        ("t_s,x_m\n1\n", "2:2", "1 cells"),
        ("t_s,x_m\n1,2\n3,4,5\n", "3:3", "3 cells"),
        ("t_s,x_m\n1,two\n", "2:2", "not a number"),
        ("t_s,x_m\n1,\n", "2:2", "is empty"),
        ("t_s,x_m\n1,nan\n", "2:2", "'nan'"),
        ("t_s,x_m\n1,-inf\n", "2:2", "'-inf'"),
        ("t_s,x_m\n", "2:1", "0 rows"),
        ("t_s;x_m\n1;2\n", "1:1", "separated by semicolons"),
        ("t_s,x_m\n1_0,2\n", "2:1", "t_s is '1_0', not a number"),
    ],
)
def test_a_fault_has_line_and_column(text: str, place: str, problem: str) -> None:
    found = fault(text)
    assert found.place == place and problem in found.problem


def test_what_exists_is_listed_and_what_was_meant_is_guessed() -> None:
    assert "the file has: time, x_m" in fault("time,x_m\n1,2\n").cure
    assert fault("t_s,x_m,phi\n1,2,3\n", known=("phi_rad",)).cure == "did you mean 'phi_rad'?"
    assert "known: t_s, x_m, phi_rad" in fault("t_s,x_m,colour\n1,2,3\n", known=("phi_rad",)).cure


def test_empty_cells_are_nan_only_where_allowed() -> None:
    table = columns_from_text("t_s,x_m\n1,\n2,3\n", required=WANT, empty=("x_m",))
    assert np.isnan(table["x_m"][0]) and table["x_m"][1] == 3.0
    assert fault("t_s,x_m\n,1\n", empty=("x_m",)).place == "2:1"
    assert np.isnan(columns_from_text("t_s,x_m\n,1\n", required=WANT, empty=None)["t_s"][0])


def test_files_of_other_systems(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xef\xbb\xbft_s,x_m\r\n1,2\r\n")
    assert read_columns(path, required=WANT)["x_m"].tolist() == [2.0]
    path.write_bytes(b"t_s,x_m\n1,2\n\xff,3\n")
    with pytest.raises(InputError, match=r"a\.csv: 3:1: byte 0xff is not UTF-8"):
        read_columns(path, required=WANT)
    with pytest.raises(InputError, match="there is no such file"):
        read_columns(tmp_path / "b.csv")
    with pytest.raises(InputError, match="is a folder"):
        read_columns(tmp_path)


@given(st.lists(st.tuples(st.floats(-1e12, 1e12), st.floats(-1e-3, 1e-3)), min_size=1, max_size=20))
@settings(deadline=None)
def test_what_is_written_reads_back(rows: list[tuple[float, float]]) -> None:
    values = np.array(rows)
    text = columns_text({"t_s": values[:, 0], "x_m": values[:, 1]}, digits=17)
    assert np.array_equal(columns_from_text(text, required=WANT).stack(WANT), values)


def test_names_that_hold_commas_are_quoted() -> None:
    text = columns_text({"a": [1.0], "limiting": ['front, "left"']})
    assert list(csv.reader(text.splitlines())) == [["a", "limiting"], ["1", 'front, "left"']]


def test_nan_is_written_as_an_empty_cell_and_minus_zero_as_zero() -> None:
    assert columns_text({"a": [float("nan"), -0.0], "b": ["x", "y"]}) == "a,b\n,x\n0,y\n"


@given(st.text(alphabet=st.sampled_from('tx_sm,\n\r0123456789.e-+ "naif\0é'), max_size=120))
@settings(max_examples=300, deadline=None)
def test_any_text_is_read_or_refused(text: str) -> None:
    for prefix in ("", "t_s,x_m\n"):
        try:
            columns_from_text(prefix + text, required=WANT)
        except InputError as found:
            assert "\n" not in str(found)


def test_a_pipe_of_any_length_is_read(tmp_path: Path) -> None:
    """A pipe has no place to tell: after 20 000 lines it was said not to be readable."""
    pipe = tmp_path / "pipe"
    if not hasattr(os, "mkfifo"):
        pytest.skip("no named pipes on this machine")
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_text, args=("t_s\n" + "1\n" * 45_000,))
    writer.start()
    assert sum(1 for _ in lines_of(pipe)) == 45_001
    writer.join()
