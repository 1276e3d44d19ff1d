"""Bytes and text from a file, with failures that name the file."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import BinaryIO, TextIO

from slipmargin.errors import InputError
from slipmargin.notice import reading
from slipmargin.work import FACTOR, FILE_B, LINE, fits

#: What other people's readers stumble over in a damaged file, each beside what is its own.
DAMAGE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, AssertionError)
#: Lines after which the progress of reading is told.
EACH = 20_000
#: Bytes that are read at once of a file that is held whole.
_PART = 1 << 24


def read_text(path: Path) -> str:
    """The UTF-8 text of a file (a leading byte-order mark is dropped).

    Raises
    ------
    InputError
        Where there is no such file, it is a folder, may not be read, or is not UTF-8 (with the
        ``line:column`` of the first bad byte).
    """
    return text_of(read_bytes(path), str(path))


def text_of(data: bytes, source: str) -> str:
    """The UTF-8 text of what a file held, as :func:`read_text`."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        before = data[: fault.start]
        column = fault.start - (before.rfind(b"\n") + 1) + 1
        raise _not_text(before.count(b"\n") + 1, column, data[fault.start], source) from None


def _not_text(line: int, column: int, byte: int, source: str) -> InputError:
    return InputError(
        f"{line}:{column}", f"byte 0x{byte:02x} is not UTF-8 text", "save the file as UTF-8", source
    )


def utf8(lines: Iterable[str], source: str) -> Iterator[str]:
    """The lines of a stream whose bytes that are no UTF-8 became marks (Python's ``surrogateescape``).

    Raises
    ------
    InputError
        With the ``line:column`` of the first such byte, when it is met.
    """
    for number, line in enumerate(lines, 1):
        if not line.isascii():
            try:
                line.encode()
            except UnicodeEncodeError as fault:
                column = len(line[: fault.start].encode()) + 1
                raise _not_text(number, column, ord(line[fault.start]) & 0xFF, source) from None
        yield line


def whole_lines(text: TextIO | io.TextIOBase, source: str) -> Iterator[str]:
    """The lines of a stream, each with its end; what never ends a line is not waited for.

    Raises
    ------
    InputError
        With the number of a line of more than :data:`~slipmargin.work.LINE` letters.
    """
    for number, line in enumerate(iter(partial(text.readline, LINE), ""), 1):
        if len(line) == LINE and not line.endswith("\n"):
            problem, cure = f"this line has more than {LINE} letters", "give a text file with a line a row"
            raise InputError(f"{number}:1", problem, cure, source)
        yield line


def lines_of(path: Path, *, strict: bool = True) -> Iterator[str]:
    """The lines of a UTF-8 file, one at a time, so that a log of any length is read in little memory.

    Who listens (:func:`slipmargin.notice.heard`) is told now and then how far it is.

    Parameters
    ----------
    strict : bool
        Whether bytes that are no UTF-8 are refused; else they become marks.

    Raises
    ------
    InputError
        As :func:`read_text`, when the fault is met.
    """
    with _told(path), Path(path).open("rb") as raw:
        size = max(1, os.fstat(raw.fileno()).st_size)
        seeks = raw.seekable()  # a pipe does not, and nobody knows its length
        text = io.TextIOWrapper(raw, encoding="utf-8-sig", errors="surrogateescape" if strict else "replace")
        lines = whole_lines(text, str(path))
        for number, line in enumerate(utf8(lines, str(path)) if strict else lines):
            if seeks and number % EACH == EACH - 1:
                reading(path.name, raw.tell() / size)
            yield line.rstrip("\n")


def read_bytes(path: Path, unless: tuple[bytes, ...] = ()) -> bytes:
    """The bytes of a file; only the first ones where it starts like one of ``unless``.

    Raises
    ------
    InputError
        Where there is no such file, it is a folder, it may not be read, or it is too large to be held.
    """
    with _told(path), Path(path).open("rb") as raw:  # a pipe can be read only once
        start = raw.read(max(map(len, unless), default=0))
        return start if unless and start.startswith(unless) else start + _rest(raw, path)


def _rest(raw: BinaryIO, path: Path) -> bytes:
    parts, size = [], 0
    while part := raw.read(_PART):
        parts.append(part)
        size += len(part)
        if not fits(size, FILE_B):
            problem = f"holds more than {FILE_B >> 20} MiB"
            raise InputError("", problem, f"give a smaller file, or set {FACTOR}=10", str(path))
    return b"".join(parts)


@contextlib.contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise InputError("", "there is no such file", "check the path", str(path)) from None
    except IsADirectoryError:
        raise InputError("", "is a folder", "give a file", str(path)) from None
    except OSError as fault:
        raise InputError(
            "", f"cannot be read ({fault.strerror})", "check the path and its permissions", str(path)
        ) from None
    except ValueError as fault:
        if "\0" not in str(path):
            raise
        raise InputError("", "is not a possible path", "give a file", repr(str(path))) from fault
