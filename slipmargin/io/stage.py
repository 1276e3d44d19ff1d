"""A place beside an output in which it is made, so that it appears at once and whole.

A run that is killed leaves its stage behind.  The next run that writes the same output removes it: a stage is
locked while its run lives, and the system frees the lock however the run ends.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from slipmargin.errors import InputError

#: Names in a stage: what is made, and what it replaces until it has replaced it.
NEW, OLD = "new", "old"
_END = ".part"
#: What the system says of a path that nothing can ever have.
_IMPOSSIBLE = {
    errno.ELOOP: "is a symbolic link that leads to itself",
    errno.ENAMETOOLONG: "is too long a name",
}


def check_possible(path: Path) -> None:
    """Refuse a path at which nothing can be made, before any work is done.

    Raises
    ------
    InputError
        Where it holds a null, leads to itself, or is so long that it, or its stage, has no room for its name.
    """
    stage = os.path.join(path.parent, f".{path.name}.{8 * 'x'}{_END}")
    for place in (str(path), stage):
        try:
            os.stat(place)
        except ValueError:
            raise InputError("", "is not a possible path", "give another name", repr(str(path))) from None
        except OSError as fault:
            if fault.errno in _IMPOSSIBLE:
                problem = _IMPOSSIBLE[fault.errno]
                raise InputError("", problem, "give another name", str(path)) from None


@contextlib.contextmanager
def staged(path: Path) -> Iterator[Path]:
    """Yield a new folder beside ``path``, on the same disk; at the end it is gone.

    Raises
    ------
    OSError
        Where it cannot be made.
    """
    sweep(path)
    while True:
        folder = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}.", suffix=_END))
        lock = _locked(folder, wait=True)
        if folder.is_dir():
            break
        _free(lock)  # another run took it for one that was left behind, before it was locked
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        _free(lock)


def made_in(name: str) -> str:
    """The name of the output whose stage is called ``name``; empty where it is no stage's name."""
    return (
        name[1:].removesuffix(_END).rpartition(".")[0] if name.startswith(".") and name.endswith(_END) else ""
    )


def sweep(path: Path) -> None:
    """Remove the stages that killed runs left beside ``path``; what one had taken away goes back."""
    with contextlib.suppress(OSError), os.scandir(path.parent) as there:
        left = [Path(e.path) for e in there if made_in(e.name) == path.name]
        for folder in left:
            lock = _locked(folder, wait=False)
            if lock is None:
                continue  # its run lives, or locks are not to be had here
            if (folder / OLD).exists() and not path.exists():
                os.replace(folder / OLD, path)
            shutil.rmtree(folder, ignore_errors=True)
            _free(lock)


def _locked(folder: Path, *, wait: bool) -> int | None:
    """Lock a folder; None where that cannot be done."""
    if sys.platform == "win32":
        return None
    import fcntl

    handle = None
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        _free(handle)
        return None
    return handle


def _free(lock: int | None) -> None:
    if lock is not None:
        os.close(lock)
