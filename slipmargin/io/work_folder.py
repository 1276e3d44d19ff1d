"""A folder of finished pieces beside an output, kept until the work is done."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

from slipmargin.errors import InputError
from slipmargin.io.stage import made_in, sweep


def make_folder(folder: Path) -> None:
    """Make the folder, and those it stands in, if they are not there.

    Raises
    ------
    InputError
        Where it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise InputError(
            "", f"cannot be made ({fault.strerror})", "give --out another name or folder", str(folder)
        ) from None


def remove_files(folder: Path, pattern: re.Pattern[str]) -> None:
    """Remove the files whose whole name matches, and the folder if nothing else is in it."""
    if not folder.is_dir():
        return
    for path in list(folder.iterdir()):
        if pattern.fullmatch(path.name):
            path.unlink(missing_ok=True)
        elif pattern.fullmatch(made_in(path.name)):
            sweep(folder / made_in(path.name))
    with contextlib.suppress(OSError):  # something of the user's is in it: it stays
        folder.rmdir()
