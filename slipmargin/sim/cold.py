"""The first run after installation: the kernel is compiled from parts that were compiled before it.

Another process compiles the parts, and what finds the wheels' breakpoints, and leaves them in the cache on
disk; then this one compiles the kernel.  A kernel whose parts come from the cache, each optimised by itself,
takes a third less time a step than one that the compiler has seen as one piece, and is compiled no later.
Parts that this process had compiled itself would not come from the cache.
"""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from numba import types

from slipmargin.physics.compiled import compiling, twin
from slipmargin.physics.contact import contact
from slipmargin.sim import body, motion, rodas, stops, varying

# Types, not their names: numba keeps what it compiled under the very object it was asked with.
_N, _INT, _BOOL = types.float64, types.int64, types.boolean
_ROW, _TABLE, _CUBE = (types.Array(types.float64, k, "C") for k in (1, 2, 3))
_COUNTS = types.Array(types.int64, 1, "C")
_FIVE = types.UniTuple(_TABLE, 5)  # type: ignore[no-untyped-call]
#: What the other process compiles, and for which arguments.
_APART: tuple[tuple[Any, tuple[Any, ...]], ...] = (
    (twin(contact), (_INT, _INT, *(_N,) * 7)),
    (varying.factors, (_ROW, _TABLE, _INT, _N, _ROW, _TABLE, _ROW)),
    (stops.first_switch, (_TABLE, _TABLE, _N, _ROW, _ROW, _TABLE, _N)),
    (rodas.solve, (_TABLE, _TABLE, _ROW, _N, _N, _BOOL, _ROW, _ROW, _ROW)),
    (rodas.factor, (_TABLE, _ROW, _N, _TABLE, _ROW)),
    (rodas.end, (_ROW, _TABLE, _ROW, _N, _N, _N, _ROW)),
    (rodas.begin, (_ROW, _TABLE, _INT, _N, _ROW, _ROW)),
    (body.slopes, (_ROW, _TABLE, _N, _ROW, _TABLE, _ROW, _TABLE, _INT)),
    (body.wheel_rate, (_ROW, _ROW, _ROW, _N, _N)),
    (stops.next_stop, (_TABLE, _ROW, _CUBE, _TABLE, _ROW, _N, _COUNTS)),
    (motion.tell, (_ROW, _ROW, _TABLE, _ROW)),
)
_KERNEL = (_ROW, _TABLE, _ROW, _CUBE, _TABLE, _ROW, _COUNTS, _COUNTS, _ROW, _ROW, _FIVE, _TABLE, _TABLE)
#: Longest wait for the other process [s]: it takes some seconds.
_PATIENCE_S = 60.0


def compile_apart() -> None:
    """What the other process does."""
    for function, kinds in _APART:
        function.compile(kinds)


@cache
def warm_up() -> None:
    """Compile what every run needs, once; nothing to do where the cache holds it."""
    kernel: Any = motion.run
    if any(Path(kernel.stats.cache_path).glob(f"*{kernel.py_func.__qualname__}*.nbi")):
        return
    words = [sys.executable, "-c", f"from {__name__} import compile_apart; compile_apart()"]
    quiet = subprocess.DEVNULL
    try:
        other = subprocess.Popen(words, stdin=quiet, stdout=quiet, stderr=quiet)
    except OSError:
        return  # no other process here: the first call compiles everything by itself
    try:
        with compiling():
            other.wait(timeout=_PATIENCE_S)
    except subprocess.TimeoutExpired:
        other.kill()
    kernel.compile(_KERNEL)
