"""The first run after installation: what must be compiled is shared between two processes.

Numba compiles one function at a time in a process.  A second process compiles what finds the wheels'
breakpoints while this one compiles the kernel, and leaves it in the cache on disk.
"""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path

from slipmargin.sim.compiled import STATE
from slipmargin.sim.motion import run
from slipmargin.sim.wheels import breakpoints

_WHEELS = "(float64[::1], float64[::1], float64[:,:,::1], float64[::1])"
_KERNEL = (
    "(float64[::1], float64[::1], float64[:,:,::1], float64[::1], boolean[::1], float64[::1], float64[:,::1],"
    " float64[::1], float64[::1], float64, float64, int64, float64[:,::1], boolean, float64[:,:,::1],"
    " float64[::1])"
)
_PATIENCE_S = 60.0


def compile_wheels() -> None:
    """What the second process does."""
    breakpoints.compile(_WHEELS)  # type: ignore[attr-defined]


@cache
def warm_up() -> None:
    """Compile what every run needs, once; nothing to do where the cache holds it."""
    kept = Path(run.stats.cache_path)  # type: ignore[attr-defined]
    if any(kept.glob(f"*run-{STATE}*.nbi")):
        return
    words = [sys.executable, "-c", f"from {__name__} import compile_wheels; compile_wheels()"]
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
