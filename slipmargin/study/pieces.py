"""Long computations in pieces: parallel and resumable, with the same result for any split and interruption.

Each finished piece is one file in a work folder, written whole or not at all and named by a hash of its own
input (what is computed, for which designs, by which version).  A later run reads the pieces that exist
and computes the rest; numbers are kept to the last bit.  joblib spreads the pieces over the cores,
or, through its Dask backend, over a cluster.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin import __version__
from slipmargin.errors import InputError
from slipmargin.io.source import read_text
from slipmargin.io.work_folder import make_folder, remove_files
from slipmargin.io.writes import write_text

#: One piece's answer: a row of named numbers for each of its items.
Rows = list[dict[str, float]]
SCHEMA = 1
_NAME = re.compile(r"piece-[0-9a-f]{32}\.json")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Executor:
    """Where finished pieces are kept and which processes compute.

    ``folder`` keeps finished pieces (None: nothing is kept); ``jobs`` processes, −1 for every core;
    ``scheduler`` a Dask scheduler's address, which replaces ``jobs``.
    """

    folder: Path | None = None
    jobs: int = 1
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.jobs == 0 or self.jobs < -1:
            raise InputError("jobs", f"is {self.jobs}", "give a number of processes, or -1 for every core")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """The rows of all items, in their order, and how many pieces an earlier run had left."""

    rows: tuple[dict[str, float], ...]
    pieces: int
    resumed: int


def in_pieces(
    work: Callable[[Any], dict[str, float]],
    items: Sequence[Any],
    *,
    key: Any,
    size: int,
    executor: Executor,
    advance: Callable[[int], None] = lambda steps: None,
) -> Done:
    """Apply ``work`` to every item.

    Parameters
    ----------
    work : callable
        A module's function (processes must find it), item → row.
    key : data
        Everything besides the items that the rows depend on; part of each piece's name.
    size : int
        Items a piece.
    advance : callable
        Called with the number of items of each finished piece.

    Raises
    ------
    InputError
        Where the work folder cannot be written, or the scheduler cannot be reached.
    """
    pieces = [list(items[i : i + size]) for i in range(0, len(items), size)]
    names = [piece_name(key, piece) for piece in pieces]
    rows: list[Rows | None] = [
        _kept(executor.folder, name, len(piece)) for name, piece in zip(names, pieces, strict=True)
    ]
    resumed = sum(row is not None for row in rows)
    for row in rows:
        advance(len(row) if row else 0)
    missing = [k for k, row in enumerate(rows) if row is None]
    if missing and executor.folder is not None:
        make_folder(executor.folder)
    with contextlib.closing(_computed(work, [(k, pieces[k]) for k in missing], executor)) as answers:
        for k, found in answers:
            if executor.folder is not None:
                make_folder(executor.folder)  # another run of this study, ending, may have removed it
                write_text(executor.folder / names[k], _text(found))
            rows[k] = found
            advance(len(found))
    return Done(
        rows=tuple(row for piece in rows if piece is not None for row in piece),
        pieces=len(pieces),
        resumed=resumed,
    )


def clear(folder: Path | None) -> None:
    """Remove the pieces of a finished study, and the folder if nothing else is in it."""
    if folder is not None:
        remove_files(folder, _NAME)


def piece_name(key: Any, items: Sequence[Any]) -> str:
    """The file name of a piece: a hash of the key, the items and the program's version."""
    text = json.dumps([SCHEMA, __version__, canonical(key), canonical(list(items))], ensure_ascii=True)
    return f"piece-{hashlib.sha256(text.encode()).hexdigest()[:32]}.json"


def canonical(value: Any) -> Any:
    """Frozen data as plain lists and strings, equal exactly where the data are; numbers to the last bit."""
    if is_dataclass(value) and not isinstance(value, type):
        return [type(value).__name__, *([f.name, canonical(getattr(value, f.name))] for f in fields(value))]
    if isinstance(value, np.ndarray):
        return [list(value.shape), [canonical(v) for v in value.ravel().tolist()]]
    if isinstance(value, Enum):
        return [type(value).__name__, value.name]
    if isinstance(value, dict):
        return [[canonical(k), canonical(v)] for k, v in value.items()]
    if isinstance(value, list | tuple):
        return [canonical(v) for v in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value.hex()
    raise TypeError(f"{type(value).__name__} has no canonical form")


def one_piece(work: Callable[[Any], dict[str, float]], number: int, items: Sequence[Any]) -> tuple[int, Rows]:
    """Return a piece's number and the rows of its items (module level: other processes must find it)."""
    return number, [work(item) for item in items]


def _computed(
    work: Callable[[Any], dict[str, float]], missing: list[tuple[int, list[Any]]], executor: Executor
) -> Generator[tuple[int, Rows], None, None]:
    if not missing:
        return
    if executor.scheduler is None and (executor.jobs == 1 or len(missing) == 1):
        for k, items in missing:
            yield one_piece(work, k, items)
        return
    from joblib import Parallel, delayed

    with _backend(executor.scheduler), _quiet_when_stopped():
        run = Parallel(
            n_jobs=executor.jobs if executor.scheduler is None else -1,
            batch_size=1,
            pre_dispatch="all",
            return_as="generator_unordered",
        )
        yield from run(delayed(one_piece)(work, k, items) for k, items in missing)


@contextlib.contextmanager
def _quiet_when_stopped() -> Iterator[None]:
    """Ctrl-C takes joblib's work away from its own thread, which then told of a KeyError.

    Where the work was stopped that thread may end later than this: the hook stays.
    """
    tell_others = threading.excepthook

    def hear(told: threading.ExceptHookArgs) -> None:
        ours = told.thread is not None and told.thread.name.startswith("ExecutorManager")
        if not (ours and told.exc_type is KeyError):
            tell_others(told)

    threading.excepthook = hear
    yield
    threading.excepthook = tell_others


@contextlib.contextmanager
def _backend(scheduler: str | None) -> Iterator[None]:
    """joblib's own processes, or the cluster behind a Dask scheduler."""
    if scheduler is None:
        yield
        return
    if find_spec("distributed") is None:
        raise InputError(
            "scheduler",
            "needs the packages dask and distributed",
            "install slipmargin[cluster], or leave the scheduler out",
        )
    from distributed import Client
    from joblib import parallel_config

    connect: Any = Client  # untyped where it is installed, unknown where it is not
    try:
        client = connect(scheduler, timeout="5s", set_as_default=False)
    except (OSError, ValueError) as fault:
        raise InputError(
            "scheduler",
            f"{scheduler!r} cannot be reached ({str(fault)[:80] or 'no answer'})",
            "start a Dask scheduler and give its tcp://HOST:PORT",
        ) from None
    with client, parallel_config(backend="dask", client=client):
        if not client.scheduler_info()["workers"]:
            raise InputError("scheduler", f"{scheduler!r} has no workers", "start a Dask worker for it")
        yield


def _text(rows: Rows) -> str:
    kept = [{name: float(value).hex() for name, value in row.items()} for row in rows]
    return json.dumps({"schema": SCHEMA, "rows": kept})


def _kept(folder: Path | None, name: str, count: int) -> Rows | None:
    """A piece that an earlier run finished; None where there is none that can be used."""
    if folder is None or not (folder / name).is_file():
        return None
    try:
        rows = [
            {str(k): float.fromhex(v) for k, v in row.items()}
            for row in json.loads(read_text(folder / name))["rows"]
        ]
    except (ValueError, KeyError, TypeError, AttributeError, InputError):
        return None  # damaged by someone else: it is computed again
    return rows if len(rows) == count else None
