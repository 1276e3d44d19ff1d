"""How code is compiled: cached on disk, division by zero gives infinity, every operation rounded by itself.

Which parts were compiled together decides what the compiler copies into one another.  If it might then fuse
a product with a sum, or divide by multiplying, the last digits would follow from the order in which a cache
was filled, and the same seed would give two answers on two machines.  So neither is allowed; it costs no
time that can be measured.

The equations of this room are compiled as they stand: :func:`twin` compiles a copy of a plain function in
which the names of other physics functions stand for their compiled twins, and ``np`` for the same
functions of plain numbers.

Numba's cache looks at the file of a function, not at the files it calls into or takes constants from.
Cached files therefore carry the state of the function's own room and of this one in their names: a change
of a friction law compiles everything anew.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numba.core import event

from slipmargin.notice import compiling as say_compiling

F = TypeVar("F", bound=Callable[..., Any])
_compile: Any = njit  # its stub does not know every option


class _Heard(event.Listener):
    """Hears when numba compiles what its cache does not hold, and how long that takes."""

    def __init__(self) -> None:
        self.spent_s, self._began_s, self._inside = 0.0, 0.0, 0

    def on_start(self, event: Any) -> None:
        say_compiling()
        if not self._inside:
            self._began_s = time.monotonic()
        self._inside += 1

    def on_end(self, event: Any) -> None:
        self._inside -= 1
        if not self._inside:
            self.spent_s += time.monotonic() - self._began_s


_HEARD = _Heard()
event.register("numba:compile", _HEARD)  # type: ignore[no-untyped-call]


def compiling_s() -> float:
    """How long this process has waited for compilers so far [s]."""
    return _HEARD.spent_s


@contextmanager
def compiling() -> Iterator[None]:
    """Count the time of the block as compiling."""
    _HEARD.on_start(None)
    try:
        yield
    finally:
        _HEARD.on_end(None)


_RULES: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"nsz"},
    "no_cfunc_wrapper": True,
}
_PHYSICS = "slipmargin.physics."
#: What ``np`` means in compiled physics: numba compiles these much faster than ufuncs of one number.
_NUMBERS = ModuleType("numbers")
_NUMBERS.__dict__.update(
    sin=math.sin,
    cos=math.cos,
    tan=math.tan,
    arctan=math.atan,
    tanh=math.tanh,
    arctanh=math.atanh,
    exp=math.exp,
    log=math.log,
    log1p=math.log1p,
    sqrt=math.sqrt,
    hypot=math.hypot,
    copysign=math.copysign,
    floor=math.floor,
    abs=abs,
    minimum=min,
    maximum=max,
    pi=math.pi,
)


@cache
def state(room: Path) -> str:
    """Eight digits for the names, sizes and times of change of the files of a room and of this one."""
    files = [
        (p.name, p.stat().st_size, p.stat().st_mtime_ns)
        for folder in (room, Path(__file__).parent)
        for p in folder.glob("*.py")
    ]
    return sha256(repr(sorted(files)).encode()).hexdigest()[:8]


def _compiled(function: F, **more: Any) -> F:
    own = state(Path(function.__code__.co_filename).parent)
    function.__qualname__ = f"{function.__qualname__}-{own}"  # what numba names its cached files after
    return cast(F, _compile(**_RULES, **more)(function))


def inner(function: F) -> F:
    """A compiled function that only compiled functions call: Python cannot, and it compiles faster.

    It creates no arrays; so it counts no references to those it is given, which would cost more time than
    all the rest of the simulator.
    """
    return _compiled(function, no_cpython_wrapper=True, _nrt=False)


def spliced(function: F) -> F:
    """An :func:`inner` function whose code is copied to where it is called: for few calls and speed."""
    return _compiled(function, no_cpython_wrapper=True, _nrt=False, forceinline=True)


def fast(function: F) -> F:
    """A compiled function that Python calls, in several threads at once; it may create arrays."""
    return _compiled(function, nogil=True)


def kernel(function: F) -> F:
    """A :func:`fast` function that creates no arrays and counts no references."""
    return _compiled(function, nogil=True, _nrt=False)


@cache
def twin(function: Any) -> Any:
    """The compiled twin of a plain function of the physics room; the function itself stays as it is."""
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        value = names.get(name)
        if value is np:
            names[name] = _NUMBERS
        elif isinstance(value, FunctionType) and value.__module__.startswith(_PHYSICS):
            names[name] = twin(value)
    copy = FunctionType(function.__code__, names, function.__name__, function.__defaults__)
    return inner(copy)
