"""The script that runs drawn tests under many seeds reports the seed that fails."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("seeds.py")
SPEC = importlib.util.spec_from_file_location("seeds", SCRIPT)
assert SPEC is not None and SPEC.loader is not None
seeds = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(seeds)

DRAWN = """
import hypothesis.core, os
from hypothesis import given, strategies as st

@given(st.integers())
def test_drawn(n):
    assert "CI" not in os.environ
    assert hypothesis.core.global_force_seed != 2

def test_not_drawn():
    assert False
"""


def test_numbers() -> None:
    assert seeds.numbers("3,17-19") == [3, 17, 18, 19]


def test_it_names_the_seed_that_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CI", "1")
    (tmp_path / "test_some.py").write_text(DRAWN, encoding="utf-8")
    status = seeds.main(["--seeds", "1-3", "--log", str(tmp_path / "log"), str(tmp_path)])
    told = capsys.readouterr().out
    assert status == 1 and "1 of 3 seeds failed" in told
    assert "--hypothesis-seed=2" in told and "test_some.py::test_drawn" in told
    assert [path.name for path in (tmp_path / "log").iterdir()] == ["seed-2.txt"]


def test_it_says_when_nothing_was_selected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "test_some.py").write_text("def test_plain():\n    pass\n", encoding="utf-8")
    assert seeds.main(["--seeds", "1", str(tmp_path)]) == 2
    assert "no test with drawn examples" in capsys.readouterr().err
