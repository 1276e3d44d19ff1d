"""The benchmark on real robots: splits, metrics and rows on excerpts, and the page as the results say it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from real.models import (
    REPEATS,
    ROWS,
    AsTheyAre,
    GainCoulombLag,
    Linear,
    RunsBeside,
    ScalePerAxis,
    measured_path,
    rows_for,
    windows,
)
from real.page import PAGE, page
from real.run import nll, row, stretches, velocity_error
from real.sets import RealSet, neighbours, read, robojackets

from slipmargin.checks import Array
from slipmargin.data.record import Record

DATA = Path(__file__).resolve().parents[2] / "data"
EXCERPT = DATA / "robojackets_excerpt" / "enc_vis_excerpt.txt"


@pytest.fixture(scope="module")
def ssl() -> RealSet:
    return robojackets(EXCERPT)[0]


def test_a_run_is_fitted_or_judged_never_both(ssl: RealSet) -> None:
    fitted, judged = ({t.name for t in part} for part in (ssl.fitted.trials, ssl.judged))
    assert not fitted & judged
    assert {int(n[-3:]) // 2 % 2 for n in fitted} == {0} and {int(n[-3:]) // 2 % 2 for n in judged} == {1}
    assert ssl.fitted.nominal_rate_Hz == 60.0


def test_sets_that_are_not_there_are_left_out(tmp_path: Path) -> None:
    assert read(tmp_path) == []


class Known(Linear):
    """A model that is given the truth plus an offset of its velocity."""

    def __init__(self, off: tuple[float, float, float]) -> None:
        self.off = np.array(off)

    def fit(self, data: RealSet) -> None:
        self.data = data

    def path(self, record: Record) -> Array:
        path = measured_path(record)
        path[~record.seen] = 0.0
        return path + record.t_s[:, None] * self.off


def test_errors_are_those_that_were_put_in(ssl: RealSet) -> None:
    model = Known((0.1, 0.0, 0.2))
    model.fit(ssl)
    error, way = stretches(model, ssl.judged, 0.5)
    assert np.allclose(error, [0.05, 0.0, 0.1], atol=1e-6)  # thirty rows at 60 Hz
    assert len(error) == len(way) >= 3 * len(ssl.judged)
    assert velocity_error(model, ssl.judged) == pytest.approx([0.1, 0.0, 0.2], abs=1e-9)


def test_stretches_follow_each_other_within_what_was_seen() -> None:
    t = np.arange(0.0, 3.0, 0.1)
    seen = t >= 0.4 - 1e-9
    found = windows(t, seen, 0.5)
    assert found[0][0] == 4 and all(b == c for (_, b), (c, _) in pairwise(found))
    assert windows(t, seen, None) == [(4, 29)] and windows(t, seen, 10.0) == []


def test_a_model_that_is_too_sure_of_itself_pays() -> None:
    random = np.random.default_rng(1)
    small, large = random.standard_normal((200, 3)), 5.0 * random.standard_normal((200, 3))
    assert nll(small, large) > nll(large, large) > nll(small, small)


def test_a_factor_on_each_axis_is_learnt_and_a_lag_explains_more(ssl: RealSet) -> None:
    errors = {}
    for kind in (AsTheyAre, ScalePerAxis, GainCoulombLag):
        model = kind()
        model.fit(ssl)
        errors[kind] = velocity_error(model, ssl.fitted.trials)[:2]
    assert np.all(errors[ScalePerAxis] < errors[AsTheyAre])
    assert np.all(errors[GainCoulombLag] < errors[ScalePerAxis])


def test_runs_in_every_direction_say_how_well_a_run_repeats(ssl: RealSet) -> None:
    """Straight ways all around: the mean of those beside a run is the run's own."""
    t, runs = np.linspace(0.0, 2.0, 21), []
    for i in range(12):
        way = np.outer(t, [np.cos(np.deg2rad(30 * i)), np.sin(np.deg2rad(30 * i)), 0.0])
        runs.append(Record(name=str(i), t_s=t, theta=np.zeros((21, 4)), pose=way))
    beside = neighbours(runs)
    names = {name: [r.name for r in pair] for name, pair in beside.items()}
    assert (names["0"], names["1"], names["11"]) == (["10", "2"], ["0", "2"], ["10", "0"])
    model = RunsBeside()
    model.fit(replace(ssl, beside=beside))
    for run in runs:
        np.testing.assert_allclose(model.path(run), measured_path(run), atol=1e-12)
    assert REPEATS in rows_for(replace(ssl, beside=beside)) and REPEATS not in rows_for(ssl)


@pytest.mark.parametrize("name", [name for name in ROWS if name not in ("slipmargin diagnose", REPEATS)])
def test_every_row_gives_figures(ssl: RealSet, name: str) -> None:
    if name == "neural network":
        pytest.importorskip("sklearn")
    found = row(ssl, name)
    assert found["set"] == "robojackets" and found["model"] == name
    for word in ("0.5 s", "2 s", "run"):
        assert 0.0 < found[word]["displacement_mm"] < np.inf  # from so little, some rows learn nonsense
    assert np.isfinite(found["nll"])


def test_the_page_is_what_the_results_say() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()
