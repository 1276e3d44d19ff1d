"""JSON as the contract promises it: plain numbers, no NaN, keys in the order given."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from enum import Enum
from typing import Any

import numpy as np


def json_text(value: Any, indent: int | None = 1) -> str:
    """``value`` as JSON text: arrays become lists, a number that is not finite becomes null.

    With an indent each key of a table, and each table of a list, stands on a line of its own, and a list of
    numbers on one.  Without, everything is one line.
    """
    plain = _plain(value)
    return (_dumped(plain) if indent is None else _indented(plain, " " * indent, "\n")) + "\n"


def _dumped(plain: Any) -> str:
    return json.dumps(plain, ensure_ascii=False, allow_nan=False)


def _indented(plain: Any, step: str, start: str) -> str:
    """A table over several lines, each of which begins with ``start`` and a step more."""
    inner = start + step
    if isinstance(plain, dict) and plain:
        lines = (f"{_dumped(key)}: {_indented(item, step, inner)}" for key, item in plain.items())
        return "{" + inner + f",{inner}".join(lines) + start + "}"
    if isinstance(plain, list) and any(isinstance(item, dict) for item in plain):
        return "[" + inner + f",{inner}".join(_indented(i, step, inner) for i in plain) + start + "]"
    return _dumped(plain)


def _plain(value: Any) -> Any:
    if type(value) is float:  # nearly every value of a table
        return value if math.isfinite(value) else None
    if type(value) is str:
        return value
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, Enum):
        return _plain(value.value)
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, str):
        return value
    raise TypeError(f"{type(value).__name__} has no form in JSON")
