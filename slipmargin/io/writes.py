"""Files written whole or not at all: an interrupted run leaves the previous file as it was.

Each file is first written beside its destination under a temporary name and then renamed over it.
:func:`write_together` does so for several files: none is renamed before all are complete.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

from slipmargin.errors import InputError
from slipmargin.io.stage import NEW, check_possible, staged

#: How a file's name may end, by what the file holds; a name without an ending promises nothing.
ENDINGS = {
    "picture": (".png", ".svg", ".pdf"),
    "page": (".html", ".htm"),
    "CSV table": (".csv", ".txt", ""),
    "JSON text": (".json", ".txt", ""),
}


def write_text(path: Path | str, text: str) -> None:
    """Write UTF-8 text atomically.

    Raises
    ------
    InputError
        Where the file cannot be written; the previous file is then untouched.
    """
    write_together({path: text})


def write_lines(path: Path | str, lines: Iterable[str]) -> None:
    """Write lines as they come, atomically; where ``lines`` fail nothing has changed.

    Raises
    ------
    InputError
        Where the file cannot be written; the previous file is then untouched.
    """
    place = Path(path)
    with contextlib.ExitStack() as stack:
        with _refused(place):
            _check_place(place)
            place = place.resolve()
            temporary = stack.enter_context(staged(place)) / NEW
            file = stack.enter_context(temporary.open("w", encoding="utf-8", newline=""))
        for line in lines:
            with _refused(place):
                file.write(f"{line}\n")
        with _refused(place):
            _done(file, temporary, place)
            os.replace(temporary, place)


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
    made: list[tuple[Path, Path]] = []
    with contextlib.ExitStack() as stages:
        for name, content in files.items():
            path = Path(name)
            with _refused(path):
                _check_place(path)
                path = path.resolve()  # write through a symbolic link, not over it
                made.append((_written(stages.enter_context(staged(path)) / NEW, content, path), path))
        for temporary, path in made:
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


def check_format(path: Path | str, kind: str = "picture") -> str:
    """The format that a file's name ends in, without its dot.

    Parameters
    ----------
    kind : str
        What the file will hold: a key of :data:`ENDINGS`.

    Raises
    ------
    InputError
        Where it is no ending of that kind: the file would not be what its name says.
    """
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS[kind]:
        raise InputError(
            "",
            f"ends in {Path(path).suffix!r}, which is no {kind}",
            f"use one of: {', '.join(filter(None, ENDINGS[kind]))}",
            str(path),
        )
    return ending.lstrip(".")


def _check_place(path: Path) -> None:
    check_possible(path)
    if path.is_dir():
        raise InputError("", "is a folder", "give a file name", str(path))
    if path.exists() and not path.is_file():  # renaming over a device would remove the device
        raise InputError("", "is not an ordinary file", "give a file name", str(path))


def _written(temporary: Path, content: str | bytes, path: Path) -> Path:
    """The content under a temporary name, on the disk, with the rights of the file that it replaces."""
    with temporary.open("wb") as file:
        file.write(content.encode("utf-8") if isinstance(content, str) else content)
        _done(file, temporary, path)
    return temporary


def _done(file: IO[Any], temporary: Path, path: Path) -> None:
    """Bring a file to the disk, with the rights of the one that it replaces."""
    file.flush()
    os.fsync(file.fileno())
    if path.exists():
        temporary.chmod(path.stat().st_mode & 0o777)


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
