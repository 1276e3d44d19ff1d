"""A folder of results written whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from slipmargin.errors import InputError
from slipmargin.io.stage import NEW, check_possible, staged
from slipmargin.io.writes import write_together


def check_folder(folder: Path | str) -> None:
    """Refuse a folder that could not be written, before any work is done.

    Raises
    ------
    InputError
        Where it, or a folder on the way to it, is a file, or no path can be so, or writing is not permitted.
    """
    path = Path(folder)
    check_possible(path)
    near = next(p for p in (path, *path.absolute().parents) if p.exists())
    if not near.is_dir():
        raise InputError("", "is a file", "give a folder", str(near))
    if not os.access(near, os.W_OK | os.X_OK):
        raise InputError("", "may not be written there", "choose another folder", str(near))


def write_folder(folder: Path | str, files: Mapping[str, str | bytes]) -> None:
    """Write files into a folder, all complete before the first is seen.

    A folder that is not there yet appears at once with everything in it; in one that is, each file
    replaces its predecessor, and other files stay.

    Raises
    ------
    InputError
        Where it cannot be written; then nothing has changed.
    """
    path = Path(folder)
    check_folder(path)
    if path.exists():
        write_together({path / name: content for name, content in files.items()})
        return
    path = path.absolute()
    made = [p for p in path.parents if not p.exists()]
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with staged(path) as stage:
            (stage / NEW).mkdir()
            write_together({stage / NEW / name: content for name, content in files.items()})
            with contextlib.suppress(OSError):
                (stage / NEW).rename(path)
                return
        if not path.is_dir():
            raise InputError("", "cannot be made", "choose another place", str(path))
        write_together({path / name: content for name, content in files.items()})  # another run made it first
    except BaseException:
        for parent in made:
            with contextlib.suppress(OSError):  # another run's results stand in it
                parent.rmdir()
        raise
