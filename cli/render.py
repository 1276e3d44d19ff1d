"""What people read: text on stdout, failures and progress on stderr.  Numbers become words only here."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NoReturn

from slipmargin.errors import InputError


def say(*lines: str) -> None:
    """Print lines on stdout; a reader that went away (``| head``) does not stop the work."""
    _write(sys.stdout, lines)


#: Warnings wait for the end: a command that is refused says one line, its error.
_warnings: list[str] = []


def warn(*lines: str) -> None:
    """Say ``warning: …`` lines on stderr once the command has done its work."""
    _warnings.extend(f"warning: {line}" for line in lines)


def tell(line: str, code: int) -> int:
    """One line on stderr instead of any warning, and the exit status to leave with."""
    _warnings.clear()
    _write(sys.stderr, ["".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)])
    return finish_output(code)


def finish_output(code: int) -> int:
    """Flush stdout before leaving, so that a closed pipe is not reported by the interpreter."""
    _write(sys.stdout, [])
    _write(sys.stderr, _warnings)
    _warnings.clear()
    return code


def _write(stream: Any, lines: Sequence[str]) -> None:
    try:
        for line in lines:
            stream.write(line + "\n")
        stream.flush()
    except BrokenPipeError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def refuse(option: str, problem: str, cure: str) -> NoReturn:
    """Refuse an option's value.

    Raises
    ------
    InputError
        Always; placed at the option.
    """
    raise InputError(option, problem, cure, "command line")


def columns(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Aligned lines: the first row is the head; every column is as wide as its widest cell."""
    cells = [list(head), *(list(row) for row in rows)]
    wide = [max(len(row[j]) for row in cells) for j in range(len(head))]
    return ["  ".join(cell.rjust(n) for cell, n in zip(row, wide, strict=True)).rstrip() for row in cells]


@contextlib.contextmanager
def progress(title: str, total: int) -> Iterator[Any]:
    """A progress bar on stderr, only where that is a terminal; yields ``advance(steps=1)``."""
    if not sys.stderr.isatty():
        yield lambda steps=1: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=total)
        yield lambda steps=1: bar.advance(task, steps)
