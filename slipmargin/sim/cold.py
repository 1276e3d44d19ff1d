"""The first run after installation: what must be compiled is shared between two processes.

Numba compiles one function at a time in a process.  A second process compiles, in the order in which
they will be asked for, parts of the kernel that are needed late, and what finds the wheels'
breakpoints; it leaves them in the cache on disk, where this one, compiling the kernel, finds them.
"""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from slipmargin.sim.body import slopes
from slipmargin.sim.compiled import STATE
from slipmargin.sim.friction import contact
from slipmargin.sim.motion import run
from slipmargin.sim.rodas import factor, solve
from slipmargin.sim.terms import series_slope
from slipmargin.sim.wheels import breakpoints

_NUMBER, _ROW, _TABLE = "float64", "float64[::1]", "float64[:,::1]"
#: What the second process compiles, and for which arguments.
_APART: tuple[tuple[Any, tuple[str, ...]], ...] = (
    (series_slope, (_ROW, "int64", "int64", "int64", _NUMBER, _NUMBER, _NUMBER)),
    (contact, ("int64", *(_NUMBER,) * 7)),
    (slopes, (_ROW, _TABLE, _ROW, _TABLE, _ROW)),
    (factor, (_TABLE, _TABLE, _ROW, _NUMBER, "boolean", _TABLE, _ROW)),
    (solve, (_TABLE, _ROW, _TABLE, _NUMBER, "boolean", _ROW, _TABLE, "int64")),
    (breakpoints, (_ROW, _ROW, "float64[:,:,::1]", _ROW)),
)
_KERNEL = (
    "(float64[::1], float64[::1], float64[:,:,::1], float64[::1], boolean[::1], float64[::1], float64[:,::1],"
    " float64[::1], float64[::1], float64, float64, int64, float64[:,::1], boolean, float64[:,:,::1],"
    " float64[::1])"
)
_PATIENCE_S = 60.0


def compile_apart() -> None:
    """What the second process does."""
    for function, kinds in _APART:
        function.compile(f"({', '.join(kinds)})")


@cache
def warm_up() -> None:
    """Compile what every run needs, once; nothing to do where the cache holds it."""
    kept = Path(run.stats.cache_path)  # type: ignore[attr-defined]
    if any(kept.glob(f"*run-{STATE}*.nbi")):
        return
    words = [sys.executable, "-c", f"from {__name__} import compile_apart; compile_apart()"]
    quiet = subprocess.DEVNULL
    try:
        other = subprocess.Popen(words, stdin=quiet, stdout=quiet, stderr=quiet)
    except OSError:
        return  # no second process here: the first call compiles everything by itself
    run.compile(_KERNEL)  # type: ignore[attr-defined]
    try:
        other.wait(timeout=_PATIENCE_S)
    except subprocess.TimeoutExpired:
        other.kill()
