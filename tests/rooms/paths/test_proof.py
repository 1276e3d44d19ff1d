"""The proof: planned wheel speeds, open loop, through a simulator that knows nothing of limits.

Twelve drawn robots here; two hundred in ``benchmarks/paths.py``.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from slipmargin.limits.motion_friction import sigma
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import at_use, trajectory
from slipmargin.study.verify import on_rollers, verify


@pytest.fixture(scope="module")
def bench() -> ModuleType:
    file = Path(__file__).parents[3] / "benchmarks" / "paths.py"
    spec = importlib.util.spec_from_file_location("benchmarks_paths", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_drawn_robots_keep_their_margin_in_the_simulator(bench: ModuleType) -> None:
    found = bench.proof(12, 7)
    assert found["worst_over"] <= 1e-6  # planned use, 20 times finer than the grid
    assert found["worst_excess"] <= 0.02  # simulated share above λ
    assert found["sped_up_slips"] >= 8  # asked for 105 % of a wheel's grip for half a second
    assert found["at_named_wheel"] == found["sped_up_slips"]
    assert {row["wheels"] for row in found["rows"]} == {3, 4, 6}


@pytest.mark.parametrize("share", [0.6, 0.8, 0.9, 0.95])
def test_the_papers_robot_uses_the_share_it_was_given(bench: ModuleType, share: float) -> None:
    model = bench.kiwi()
    rows = trajectory(
        plan(model, bench.benchmark_paths()["diagonal"], Request(share=share, points=120)), step_s=0.002
    )
    run = verify(model, rows)
    assert run.peak == pytest.approx(share, abs=0.02)
    assert not run.slips
    # theory section 4: the creep bound tan(π λ/2)/k
    assert sigma(1000.0 * np.max(run.slip_m_s)) <= share + 0.02


def test_faster_than_the_limit_slips_at_the_limiting_wheel(bench: ModuleType) -> None:
    model = bench.kiwi()
    rows = trajectory(
        plan(model, bench.benchmark_paths()["straight"], Request(share=0.9, points=120)), step_s=0.002
    )
    run = verify(model, at_use(model, rows, 1.05, hold_s=0.5))
    assert run.slips and run.wheel == "rear"
    assert run.drift_m > 1.5 * verify(model, rows).drift_m


def test_rigid_sectors_that_the_plan_ignored_show(bench: ModuleType) -> None:
    from slipmargin.io.robot_file import read_recipe

    whole = read_recipe("ohio-kiwi").build("paper")
    assert np.all(on_rollers(whole).grip.rigid_fraction == 0.0)
    rows = trajectory(
        plan(whole, bench.benchmark_paths()["straight"], Request(share=0.9, points=120)), step_s=0.002
    )
    assert verify(whole, rows).peak > verify(on_rollers(whole), rows).peak + 0.02


def test_direction_dependent_limits_are_never_slower_than_safe_boxes(bench: ModuleType) -> None:
    for name, row in bench.gains().items():
        assert row["gain_over_best"] > 0.1, name
        assert row["convex_ratio"] == pytest.approx(1.0, abs=1e-3), name
        assert row["max_use"] <= 0.9 * (1.0 + 1e-6), name
