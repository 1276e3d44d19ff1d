"""What people read: text on stdout, failures and progress on stderr.  Numbers become words only here."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NoReturn
from unicodedata import category

from slipmargin.errors import InputError
from slipmargin.notice import heard


def say(*lines: str) -> bool:
    """Print lines on stdout; a reader that went away (``| head``) does not stop the work.

    Returns
    -------
    bool
        Whether they could be printed: a stream that nobody reads need not go on.
    """
    return _write(sys.stdout, lines)


#: The words of the command line that is carried out.
_words: list[str] = []


def note_words(words: Sequence[str]) -> None:
    """Remember the command line, for the pages that it makes."""
    _words[:] = words


def made() -> str:
    """When, by which version and by which command a page is made."""
    import datetime
    import shlex

    from slipmargin import __version__

    words = shlex.join(["slipmargin", *_words])
    return f"Made on {datetime.date.today().isoformat()} by slipmargin {__version__}: `{words}`"


#: Letters of one line about a failure.
LONGEST = 900

#: Warnings wait for the end: a command that is refused says one line, its error.
_warnings: list[str] = []


def warn(*lines: str) -> None:
    """Say ``warning: …`` lines on stderr once the command has done its work."""
    _warnings.extend(f"warning: {line}" for line in lines)


def say_at_once(*lines: str) -> None:
    """Lines on stderr while work goes on."""
    _write(sys.stderr, lines)


def tell(line: str, code: int) -> int:
    """One line on stderr instead of any warning, and the exit status to leave with."""
    _warnings.clear()
    if len(line) > LONGEST:  # a value of thousands of letters is not worth repeating
        line = f"{line[: LONGEST // 2]} … {line[-LONGEST // 3 :]}"
    _write(sys.stderr, [" ".join(line.split())])
    return finish_output(code)


def _shown(text: str) -> str:
    """The text with control characters spelled out, so that a name moves no cursor; line ends stay."""
    if text.isprintable():
        return text
    spelled = ("Cc", "Zl", "Zp")
    return "".join(ascii(c)[1:-1] if category(c) in spelled and c not in "\n\t" else c for c in text)


def finish_output(code: int) -> int:
    """Flush stdout before leaving, so that a closed pipe is not reported by the interpreter."""
    _write(sys.stdout, [])
    _write(sys.stderr, _warnings)
    _warnings.clear()
    return code


def _write(stream: Any, lines: Sequence[str]) -> bool:
    try:
        for line in lines:
            stream.write(_shown(line) + "\n")
        stream.flush()
        return True
    except OSError as fault:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # what is buffered still goes somewhere
        os.close(nowhere)
        if not isinstance(fault, BrokenPipeError) and stream is sys.stdout:
            raise InputError(
                "", f"cannot be written ({fault.strerror})", "make room, or write to another place", "stdout"
            ) from None
        return False


def refuse(option: str, problem: str, cure: str) -> NoReturn:
    """Refuse an option's value.

    Raises
    ------
    InputError
        Always; placed at the option.
    """
    raise InputError(option, problem, cure, "command line")


@contextlib.contextmanager
def at_options(**options: str) -> Iterator[None]:
    """A refused argument of the front door is told as the option that gave it.

    Parameters
    ----------
    options
        Argument of a function of :mod:`slipmargin` → the option, ``margin="--margin"``.
    """
    try:
        yield
    except InputError as fault:
        argument, _, inner = fault.place.partition(" ")
        if fault.source or argument not in options:
            raise
        refuse(f"{options[argument]} {inner}".rstrip(), fault.problem, fault.cure)


@contextlib.contextmanager
def stages(
    first: str = "reading the data", *, counted: bool = True
) -> Iterator[Callable[[str, float], None]]:
    """A progress bar that names the stage the work is in; yields ``report(stage, share)``, share 0 to 1.

    Work that is ``counted`` shows its percentage and the time left, other work the time spent.
    """
    if not sys.stderr.isatty():
        yield lambda stage, share: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    told = TextColumn("{task.description}", markup=False)
    left = (TaskProgressColumn(), TimeRemainingColumn(elapsed_when_finished=True))
    layout = (BarColumn(bar_width=24), *(left if counted else (TimeElapsedColumn(),)), told)
    with Progress(*layout, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(first, total=1.0 if counted else None)
        yield lambda stage, share: bar.update(task, description=stage, completed=min(1.0, max(0.0, share)))


@contextlib.contextmanager
def read_with_progress() -> Iterator[None]:
    """A progress bar of every long file that is read meanwhile."""
    with stages("reading") as progress, heard(progress):
        yield
