"""How this room compiles: cached on disk, division by zero gives infinity, fused multiply-add allowed.

Numba's cache looks at the file of a function, not at the files it calls into or takes constants from.
Cached files therefore carry the state of the whole room in their names: a change of ``layout.py``
compiles everything anew.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])
_compile: Any = njit  # its stub does not know every option
_RULES: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"contract", "nsz", "arcp"},
    "no_cfunc_wrapper": True,
}


def _state() -> str:
    """Eight digits for the names, sizes and times of change of the room's files."""
    files = [(p.name, p.stat().st_size, p.stat().st_mtime_ns) for p in Path(__file__).parent.glob("*.py")]
    return sha256(repr(sorted(files)).encode()).hexdigest()[:8]


STATE = _state()


def _compiled(function: F, **more: Any) -> F:
    function.__qualname__ = f"{function.__qualname__}-{STATE}"  # what numba names its cached files after
    return cast(F, _compile(**_RULES, **more)(function))


def fast(function: F) -> F:
    """A compiled function that Python may call too."""
    return _compiled(function)


def inner(function: F) -> F:
    """A compiled function that only compiled functions call: it compiles faster without a door."""
    return _compiled(function, no_cpython_wrapper=True)


def fast_unlocked(function: F) -> F:
    """An entry point that runs in several threads at once."""
    return _compiled(function, nogil=True)
