"""The first run after installation: what must be compiled is shared between two processes.

Numba compiles one function at a time in a process.  A second process compiles, in the order in which
they will be asked for, the parts of the kernel that are needed late, and what finds the wheels'
breakpoints; it leaves them in the cache on disk, where this one, compiling the kernel, finds them.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from numba import types

from slipmargin.physics.compiled import twin
from slipmargin.physics.contact import contact
from slipmargin.sim import body, motion, rodas, stops, varying

# Types, not their names: numba keeps what it compiled under the very object it was asked with.
_N, _INT, _BOOL = types.float64, types.int64, types.boolean
_ROW, _TABLE, _CUBE = (types.Array(types.float64, k, "C") for k in (1, 2, 3))
_COUNTS = types.Array(types.int64, 1, "C")
_FIVE = types.UniTuple(_TABLE, 5)  # type: ignore[no-untyped-call]
#: What the second process compiles, and for which arguments.
_APART: tuple[tuple[Any, tuple[Any, ...]], ...] = (
    (twin(contact), (_INT, _INT, *(_N,) * 7)),
    (varying.factors, (_ROW, _TABLE, _INT, _N, _ROW, _TABLE, _ROW)),
    (stops.first_switch, (_TABLE, _TABLE, _N, _ROW, _ROW, _TABLE, _N)),
    (rodas.solve, (_TABLE, _TABLE, _ROW, _N, _N, _BOOL, _ROW, _ROW, _ROW)),
    (rodas.factor, (_TABLE, _ROW, _N, _TABLE, _ROW)),
    (rodas.end, (_ROW, _TABLE, _N, _N, _N, _ROW)),
    (rodas.begin, (_ROW, _TABLE, _INT, _N, _ROW, _ROW)),
    (body.slopes, (_ROW, _TABLE, _ROW, _TABLE, _ROW, _TABLE, _INT)),
    (body.wheel_rate, (_ROW, _ROW, _ROW, _N, _N)),
    (stops.next_stop, (_TABLE, _ROW, _CUBE, _TABLE, _ROW, _N, _COUNTS)),
    (motion.tell, (_ROW, _ROW, _TABLE, _ROW)),
)
_KERNEL = (_ROW, _TABLE, _ROW, _CUBE, _TABLE, _ROW, _COUNTS, _COUNTS, _ROW, _ROW, _FIVE, _TABLE)
#: Longest wait for the second process [s]: it takes about as long as this one, some seconds.
_PATIENCE_S = 60.0


def compile_apart() -> None:
    """What the second process does."""
    for function, kinds in _APART:
        function.compile(kinds)


@cache
def warm_up() -> None:
    """Compile what every run needs, once; nothing to do where the cache holds it."""
    kernel: Any = motion.run
    if any(Path(kernel.stats.cache_path).glob(f"*{kernel.py_func.__qualname__}*.nbi")):
        return
    if (os.cpu_count() or 1) < 2:
        return
    words = [sys.executable, "-c", f"from {__name__} import compile_apart; compile_apart()"]
    quiet = subprocess.DEVNULL
    try:
        other = subprocess.Popen(words, stdin=quiet, stdout=quiet, stderr=quiet)
    except OSError:
        return  # no second process here: the first call compiles everything by itself
    kernel.compile(_KERNEL)
    try:
        other.wait(timeout=_PATIENCE_S)
    except subprocess.TimeoutExpired:
        other.kill()
