"""Bytes and text from a file, with failures that name the file."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from slipmargin.errors import InputError

#: Lines after which the progress of reading is told.
EACH = 20_000


def read_text(path: Path) -> str:
    """The UTF-8 text of a file (a leading byte-order mark is dropped).

    Raises
    ------
    InputError
        Where there is no such file, it is a folder, may not be read, or is not UTF-8 (with the
        ``line:column`` of the first bad byte).
    """
    data = read_bytes(path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        before = data[: fault.start]
        line = before.count(b"\n") + 1
        column = fault.start - (before.rfind(b"\n") + 1) + 1
        raise InputError(
            f"{line}:{column}",
            f"byte 0x{data[fault.start]:02x} is not UTF-8 text",
            "save the file as UTF-8",
            str(path),
        ) from None


def lines_of(
    path: Path, progress: Callable[[float], None] = lambda share: None, *, strict: bool = True
) -> Iterator[str]:
    """The lines of a UTF-8 file, one at a time, so that a log of any length is read in little memory.

    Parameters
    ----------
    progress : callable
        Called now and then with the share of the file that is read.
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
        text = io.TextIOWrapper(raw, encoding="utf-8-sig", errors="strict" if strict else "replace")
        try:
            for number, line in enumerate(text):
                if seeks and number % EACH == EACH - 1:
                    progress(raw.tell() / size)
                yield line.rstrip("\n")
        except UnicodeDecodeError:
            read_text(path)  # says where
            raise


def read_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises
    ------
    InputError
        Where there is no such file, it is a folder, or it may not be read.
    """
    with _told(path):
        return Path(path).read_bytes()


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
