"""Files written whole or not at all: an interrupted run leaves the previous file as it was.

Each file is first written beside its destination under a temporary name and then renamed over it.
:func:`write_together` does so for several files: none is renamed before all are complete.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from slipmargin.errors import InputError

#: Formats of pictures, by the ending of the file's name.
FORMATS = ("png", "svg", "pdf")


def write_text(path: Path | str, text: str) -> None:
    """Write UTF-8 text atomically.

    Raises
    ------
    InputError
        Where the file cannot be written; the previous file is then untouched.
    """
    write_together({path: text})


def write_bytes(path: Path | str, data: bytes) -> None:
    """Write bytes atomically (a figure, for example)."""
    write_together({path: data})


def write_together(files: Mapping[Path | str, str | bytes]) -> None:
    """Write several files, all complete before the first replaces its predecessor.

    Raises
    ------
    InputError
        Where one cannot be written; then none is touched.
    """
    staged: list[tuple[Path, Path]] = []
    with _swept(staged):
        for name, content in files.items():
            path = Path(name)
            with _refused(path):
                _check_place(path)
                path = path.resolve()  # write through a symbolic link, not over it
                staged.append((_stage(path, content), path))
        for temporary, path in staged:
            with _refused(path):
                os.replace(temporary, path)


def check_writable(*paths: Path | str | None) -> None:
    """Refuse an output that cannot be written before any work is done.

    Raises
    ------
    InputError
        Where the folder does not exist, the path is a folder, or writing is not permitted.
    """
    for name in paths:
        if name is None or str(name) == "-":
            continue
        path = Path(name)
        with _refused(path):
            _check_place(path)
            if not path.parent.is_dir():
                raise InputError("", f"there is no folder {str(path.parent)!r}", "create it first", str(path))
            if not os.access(path.parent, os.W_OK):
                raise InputError("", "may not be written there", "choose another folder", str(path))


def check_format(path: Path | str) -> str:
    """The format that a figure's file name ends in.

    Raises
    ------
    InputError
        Where it is not one that can be drawn.
    """
    ending = Path(path).suffix.lower().lstrip(".")
    if ending not in FORMATS:
        raise InputError(
            "",
            f"ends in {Path(path).suffix!r}, which is no picture",
            f"use one of: {', '.join('.' + f for f in FORMATS)}",
            str(path),
        )
    return ending


def _check_place(path: Path) -> None:
    if "\0" in str(path):
        raise InputError("", "is not a possible path", "give a file name", repr(str(path)))
    if path.is_dir():
        raise InputError("", "is a folder", "give a file name", str(path))
    if path.exists() and not path.is_file():  # renaming over a device would remove the device
        raise InputError("", "is not an ordinary file", "give a file name", str(path))


def _stage(path: Path, content: str | bytes) -> Path:
    data = content.encode("utf-8") if isinstance(content, str) else content
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        mode = path.stat().st_mode & 0o777 if path.exists() else 0o666 & ~_umask()
        os.chmod(name, mode)
    except BaseException:
        os.unlink(name)
        raise
    return Path(name)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextlib.contextmanager
def _swept(staged: list[tuple[Path, Path]]) -> Iterator[None]:
    """Whatever happens, no temporary file stays behind."""
    try:
        yield
    finally:
        for temporary, _ in staged:
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def _refused(path: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise InputError(
            "", f"there is no folder {str(path.parent)!r}", "create it first", str(path)
        ) from None
    except OSError as fault:
        raise InputError(
            "", f"cannot be written ({fault.strerror})", "choose another place", str(path)
        ) from None
