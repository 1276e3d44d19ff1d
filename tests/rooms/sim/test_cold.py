"""The first run compiles in two processes; later ones start none, and a missing second one is no matter."""

from __future__ import annotations

import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from slipmargin.sim import cold
from slipmargin.sim.batch import Batch
from slipmargin.sim.motion import run
from slipmargin.sim.signal import held
from slipmargin.sim.wheels import breakpoints


def test_the_signatures_are_those_of_a_run() -> None:
    signal = held(np.array([0.0, 1.0]), np.zeros((2, 3)))
    from slipmargin.io.robot_file import read_recipe
    from slipmargin.sim.pack import pack

    Batch([signal], [np.array([0.0, 1.0])]).run(
        pack(read_recipe("ohio-kiwi").build("paper")), np.zeros((1, 3))
    )
    written = dict(cold._APART)
    for function, kinds in ((run, cold._KERNEL), (breakpoints, f"({', '.join(written[breakpoints])})")):
        assert len(function.signatures) == 1  # type: ignore[attr-defined]
        function.compile(kinds)  # type: ignore[attr-defined]
        assert len(function.signatures) == 1  # type: ignore[attr-defined]


def test_a_warm_cache_starts_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a second process was started")

    assert any(Path(run.stats.cache_path).glob("*run-*.nbi"))  # type: ignore[attr-defined]
    monkeypatch.setattr(subprocess, "Popen", refuse)
    cold.warm_up.__wrapped__()


def test_without_a_second_process_the_first_call_compiles_by_itself(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[list[str]] = []

    def missing(words: list[str], **_: object) -> None:
        asked.append(words)
        raise OSError("no interpreter")

    monkeypatch.setattr(subprocess, "Popen", missing)
    monkeypatch.setattr(cold, "run", SimpleNamespace(stats=SimpleNamespace(cache_path=str(tmp_path))))
    cold.warm_up.__wrapped__()
    assert "compile_apart" in asked[0][-1]
