"""Outputs are written whole or not at all."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slipmargin.errors import InputError
from slipmargin.io import writes
from slipmargin.io.data_set_write import check_new
from slipmargin.io.folder import check_folder, write_folder
from slipmargin.io.json_text import json_text
from slipmargin.io.writes import check_format, check_writable, write_bytes, write_text, write_together


def test_text_and_bytes_arrive(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "µ\n")
    write_bytes(tmp_path / "b.bin", b"\0\1")
    assert (tmp_path / "a.txt").read_bytes() == "µ\n".encode()
    assert (tmp_path / "b.bin").read_bytes() == b"\0\1"
    assert sorted(os.listdir(tmp_path)) == ["a.txt", "b.bin"]


def test_several_files_arrive_together_and_old_readers_keep_what_they_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("before", encoding="utf-8")
    with (tmp_path / "a").open() as reader:
        write_together({tmp_path / "a": "after", tmp_path / "b": b"new"})
        assert reader.read() == "before"  # renamed over, not written into
    assert {p.name: p.read_text(encoding="utf-8") for p in tmp_path.iterdir()} == {"a": "after", "b": "new"}


def test_an_interrupted_run_leaves_every_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").write_text("before", encoding="utf-8")
    (tmp_path / "b").write_text("before", encoding="utf-8")
    calls = []

    def stop(handle: int) -> None:
        calls.append(handle)
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(writes.os, "fsync", stop)
    with pytest.raises(KeyboardInterrupt):
        write_together({tmp_path / "a": "after", tmp_path / "b": "after"})
    assert {p.name: p.read_text(encoding="utf-8") for p in tmp_path.iterdir()} == {
        "a": "before",
        "b": "before",
    }


def test_nothing_is_written_where_one_place_is_impossible(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no folder"):
        write_together({tmp_path / "a": "x", tmp_path / "no" / "b": "x"})
    with pytest.raises(InputError, match="is a folder"):
        write_together({tmp_path / "a": "x", tmp_path: "x"})
    with pytest.raises(InputError, match="not an ordinary file"):
        write_text("/dev/null", "x")
    with pytest.raises(InputError, match="not a possible path"):
        write_text(tmp_path / "a\0b", "x")
    assert list(tmp_path.iterdir()) == []


def test_two_runs_may_end_in_one_folder(tmp_path: Path) -> None:
    """The second found the folder that was not there when it began, and its results were lost."""
    place = tmp_path / "new" / "results"

    class Slow(dict[str, str | bytes]):
        def items(self) -> Any:
            if not place.exists():
                write_folder(place, {"a.txt": "first", "b.txt": "first"})
            return super().items()

    write_folder(place, Slow({"a.txt": "second"}))
    assert {p.name: p.read_text(encoding="utf-8") for p in place.iterdir()} == {
        "a.txt": "second",
        "b.txt": "first",
    }
    assert [p.name for p in place.parent.iterdir()] == ["results"]


@pytest.mark.parametrize("check", [check_writable, check_folder, check_new, lambda p: write_text(p, "x")])
@pytest.mark.parametrize(
    ("name", "problem"),
    [("loop", "leads to itself"), ("loop/in", "leads to itself"), (250 * "a", "too long"),
     (9999 * "a", "too long"), ("a\0b", "not a possible path")],
    ids=lambda word: word[:12],
)  # fmt: skip
def test_a_place_where_nothing_can_be_is_refused_before_any_work(
    check: Callable[[Path], None], name: str, problem: str, tmp_path: Path
) -> None:
    """A link to itself was an internal error, and a name without room for its stage cost the finding."""
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(InputError, match=problem):
        check(tmp_path / name)
    assert [p.name for p in tmp_path.iterdir()] == ["loop"]


def test_a_link_is_written_through_and_rights_are_kept(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("before", encoding="utf-8")
    (tmp_path / "real").chmod(0o640)
    (tmp_path / "link").symlink_to("real")
    write_text(tmp_path / "link", "after")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "real").read_text(encoding="utf-8") == "after"
    assert (tmp_path / "real").stat().st_mode & 0o777 == 0o640


def test_places_are_checked_before_any_work(tmp_path: Path) -> None:
    check_writable(None, "-", tmp_path / "new.csv")
    for bad in (tmp_path, tmp_path / "no" / "f.csv", Path("/dev/null"), "a\0b"):
        with pytest.raises(InputError):
            check_writable(bad)


@pytest.mark.parametrize(
    ("kind", "right", "wrong"),
    [
        ("picture", ("f.png", "f.SVG"), ("f.html", "f")),
        ("page", ("f.html", "f.HTM"), ("f.pdf", "f")),
        ("CSV table", ("f.csv", "f.txt", "f"), ("f.xlsx", "f.json")),
        ("JSON text", ("f.json", "f.txt", "f"), ("f.csv", "f.yaml")),
    ],
)
def test_a_name_says_what_the_file_holds(kind: str, right: tuple[str, ...], wrong: tuple[str, ...]) -> None:
    for name in right:
        check_format(name, kind)
    for name in wrong:
        with pytest.raises(InputError, match=f"{name}: ends in .*, which is no {kind}, use one of: [.]"):
            check_format(name, kind)


class Word(Enum):
    ONE = "one"


def test_json_holds_plain_values_only() -> None:
    value = {
        "a": np.array([1.0, math.nan]),
        "b": np.int64(2),
        "c": (True, np.bool_(False)),
        "d": Word.ONE,
        "e": None,
        1: math.inf,
    }
    assert json.loads(json_text(value)) == {
        "a": [1.0, None],
        "b": 2,
        "c": [True, False],
        "d": "one",
        "e": None,
        "1": None,
    }
    with pytest.raises(TypeError, match="no form in JSON"):
        json_text({"a": object()})


def test_json_has_a_line_for_each_key_and_one_for_each_list_of_numbers() -> None:
    value = {"x_m": np.array([1.0, np.nan]), "wheels": [{"name": "left", "at_m": [0.1, 0.2]}], "none": {}}
    assert json_text(value).splitlines() == [
        "{",
        ' "x_m": [1.0, null],',
        ' "wheels": [',
        "  {",
        '   "name": "left",',
        '   "at_m": [0.1, 0.2]',
        "  }",
        " ],",
        ' "none": {}',
        "}",
    ]
    assert json_text(value, indent=None).count("\n") == 1
    assert json.loads(json_text(value)) == json.loads(json_text(value, indent=None))
