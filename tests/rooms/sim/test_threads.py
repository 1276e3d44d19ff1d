"""Runs are spread over threads: opened only where there are many, and anew in a forked process."""

from __future__ import annotations

import multiprocessing
import os

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from slipmargin.paper.published import FOUND, command, paper_model
from slipmargin.sim import threads as room
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack

PACKED = pack(paper_model("paper", improved=True))


def poses(runs):
    batch = Batch([command(FOUND.angles_rad)] * runs, [np.linspace(0.0, 0.1, 3)] * runs)
    return batch.run(PACKED, np.zeros(3)).pose


@pytest.fixture(autouse=True)
def several_threads(monkeypatch):
    """Two threads, on a machine with one core too; no pool is left from other tests."""
    monkeypatch.setattr(room, "_THREADS", 2)
    room._pool.cache_clear()
    yield
    room._pool.cache_clear()


@pytest.mark.parametrize(("runs", "pools"), [(1, 0), (3, 0), (8, 1)])
def test_few_runs_open_no_threads(runs, pools):
    poses(runs)
    assert room._pool.cache_info().currsize == pools


def same_in_a_fork(want):
    os._exit(0 if np.array_equal(poses(8), want) else 1)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_runs_after_a_fork():
    """Threads do not survive a fork: a child that used its parent's pool would wait for ever."""
    want = poses(8)
    child = multiprocessing.get_context("fork").Process(target=same_in_a_fork, args=(want,))
    child.start()
    child.join(60.0)
    code = child.exitcode
    child.kill()
    assert code == 0


def linear_algebra() -> list[int]:
    """How many threads each library of linear algebra may use."""
    return [found["num_threads"] for found in threadpool_info() if found["user_api"] == "blas"]


def test_linear_algebra_beside_runs_keeps_to_one_thread():
    """The first list of a diagnosis took twice as long where other work had the second core."""
    usual = linear_algebra()
    with room.linear_algebra_alone():
        assert usual and set(linear_algebra()) == {1}
    assert linear_algebra() == usual
