"""What is worth saying while work goes on: the package prints nothing, who wants to hear it registers."""

from __future__ import annotations

from collections.abc import Callable

_on_compile: list[Callable[[], None]] = []


def on_compile(listener: Callable[[], None]) -> None:
    """Call ``listener`` once, when something must be compiled that the cache on disk does not hold."""
    _on_compile.append(listener)


def compiling() -> None:
    """Say that something is being compiled."""
    while _on_compile:
        _on_compile.pop()()
