"""Many runs over the threads of one process: compiled code holds no lock."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cache
from typing import Any, cast

from threadpoolctl import threadpool_limits

_THREADS = os.cpu_count() or 1
#: Fewer runs than this are over sooner than threads are handed their work.
_FEW = 4


def spread(work: Callable[[int], None], runs: int) -> None:
    """All runs: over the threads, for compiled code holds no lock, or in turn where they are few."""
    if runs < _FEW or _THREADS == 1:
        _several(work, 0, runs)
        return
    parts = min(runs, 4 * _THREADS)
    cuts = [runs * k // parts for k in range(parts + 1)]
    jobs = [_pool(os.getpid()).submit(_several, work, low, high) for low, high in itertools.pairwise(cuts)]
    for job in jobs:
        job.result()


def linear_algebra_alone() -> AbstractContextManager[Any]:
    """While it lasts, linear algebra keeps to the thread that asks for it.

    Its own threads and those of the runs would wait for one another; and matrices are small here.
    """
    return cast("AbstractContextManager[Any]", threadpool_limits(limits=1, user_api="blas"))


@cache
def _pool(process: int) -> Any:
    """The threads of a process: opened when first needed, anew in a process that was forked off."""
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(max_workers=_THREADS, thread_name_prefix="runs")


def _several(work: Callable[[int], None], low: int, high: int) -> None:
    for r in range(low, high):
        work(r)
