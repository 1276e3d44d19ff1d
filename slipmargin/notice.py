"""What is worth saying while work goes on: the package prints nothing, who wants to hear it registers."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

_on_compile: list[Callable[[], None]] = []


def on_compile(listener: Callable[[], None]) -> None:
    """Call ``listener`` once, when something must be compiled that the cache on disk does not hold."""
    _on_compile.append(listener)


def compiling() -> None:
    """Say that something is being compiled."""
    while _on_compile:
        _on_compile.pop()()


_on_reading: list[Callable[[str, float], None]] = []


@contextlib.contextmanager
def heard(listener: Callable[[str, float], None]) -> Iterator[None]:
    """While the block runs, ``listener`` hears what long file is read and its share that is done (0 to 1)."""
    _on_reading.append(listener)
    try:
        yield
    finally:
        _on_reading.remove(listener)


def reading(file: str, share: float) -> None:
    """Say how far a file is read."""
    for listener in _on_reading:
        listener(f"reading {file}", share)
