"""Bytes and text from a file, with failures that name the file."""

from __future__ import annotations

from pathlib import Path

from slipmargin.errors import InputError


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


def read_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises
    ------
    InputError
        Where there is no such file, it is a folder, or it may not be read.
    """
    try:
        return Path(path).read_bytes()
    except FileNotFoundError:
        raise InputError("", "there is no such file", "check the path", str(path)) from None
    except IsADirectoryError:
        raise InputError("", "is a folder", "give a file", str(path)) from None
    except OSError as fault:
        raise InputError(
            "", f"cannot be read ({fault.strerror})", "check the path and its permissions", str(path)
        ) from None
    except ValueError:  # a path with a null character
        raise InputError("", "is not a possible path", "give a file", repr(str(path))) from None
