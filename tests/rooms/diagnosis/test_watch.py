"""A time budget: when it is over, loops finish what they began and the best so far is kept."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis import tolerance
from slipmargin.diagnosis.fit import _LADDER, Fit, fit
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import Trace
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.errors import InputError
from slipmargin.physics.compiled import compiling


def test_texts_begin_with_their_stage_and_time_runs_out() -> None:
    told: list[str] = []
    watch = Watch.of(lambda text, share: told.append(text), None)
    watch.staged("round 1").staged("pairs")("fitting", 0.5)
    assert told == ["round 1: pairs: fitting"] and not watch.expired
    assert Watch.of(lambda *_: None, 1e-9).staged("x").expired
    assert not Watch.of(lambda *_: None, 1e9).expired


def test_no_budget_is_spent_on_compiling() -> None:
    """Seen on a fresh installation: the compiler took the whole budget, and a lead was all that was left."""
    watch = Watch.of(lambda *_: None, 0.2)
    with compiling():
        time.sleep(0.3)
    assert not watch.expired
    time.sleep(0.3)
    assert watch.expired


@pytest.mark.parametrize("budget", [0.0, -1.0, np.nan])
def test_a_budget_is_a_positive_time(budget: float) -> None:
    with pytest.raises(InputError, match="budget_s"):
        Watch.of(lambda *_: None, budget)


def test_a_search_out_of_time_gives_its_best_answer_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0)
    plant = Plant(name="loads", traces=(Trace.WHEEL_LOAD,), effects=(truth,))
    data = planted(smooth_kiwi(), plant, seed=2, count=3, duration_s=1.0, rate_hz=50.0)
    tried: list[str] = []
    fits: list[Fit] = []

    def watched(*args: Any, **options: Any) -> Fit:
        made = fit(*args, **options)
        if "expired" in options:
            fits.append(made)
        return made

    monkeypatch.setattr(tolerance, "fit", watched)
    found = diagnose(data, seed=1, budget_s=1e-6, progress=lambda text, share: tried.append(text))
    assert any("time budget" in remark for remark in found.remarks)
    assert len(found.steps) == 1, "one list"
    assert len(found.steps[0].tried) == SETTINGS.fewest_fitted, "one alone is no comparison"
    # where it starts, and a step with all of its dampings; a Jacobian before and after
    most = 2 + len(_LADDER)
    assert fits and all(f.evaluations <= most + 2 * len(f.x) for f in fits), "one step each"
    assert found.findings or found.leads
    assert sum(": trying " in text for text in tried) <= 3  # one of each kind instead of some hundred
