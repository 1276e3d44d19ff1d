"""How this room compiles: cached on disk, division by zero gives infinity, fused multiply-add allowed.

Numba's cache looks at the file of a function, not at the files it calls into: after changing
``layout.py`` by hand, delete the ``*.nbi`` and ``*.nbc`` files beside it.
"""

from __future__ import annotations

from collections.abc import Callable
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


def fast(function: F) -> F:
    """A compiled function that Python may call too."""
    return cast(F, _compile(**_RULES)(function))


def inner(function: F) -> F:
    """A compiled function that only compiled functions call: it compiles faster without a door."""
    return cast(F, _compile(**_RULES, no_cpython_wrapper=True)(function))


def fast_unlocked(function: F) -> F:
    """An entry point that runs in several threads at once."""
    return cast(F, _compile(**_RULES, nogil=True)(function))
