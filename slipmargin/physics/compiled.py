"""Compiled twins of the equations, so that compiled loops call the very functions that arrays go through.

Numba's cache looks at the file of a function, not at the files it calls into.  What is cached here bears
the state of this room in its name: a change of a law compiles its callers anew.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])
_compile: Any = njit  # its stub does not know every option


@cache
def twin(function: F) -> F:
    """The function compiled; the original stays as it is."""
    return cast(F, _compile(function))


def cached(function: F) -> F:
    """A compiled function that is kept on disk until its own file or the equations change."""
    function.__qualname__ = f"{function.__qualname__}-{_state()}"  # what numba names its cached files after
    return cast(F, _compile(cache=True)(function))


@cache
def _state() -> str:
    files = [(p.name, p.stat().st_size, p.stat().st_mtime_ns) for p in Path(__file__).parent.glob("*.py")]
    return sha256(repr(sorted(files)).encode()).hexdigest()[:8]
