"""JSON of other tools, read with failures that name ``line:column``."""

from __future__ import annotations

import json
from typing import Any

from slipmargin.errors import InputError


def parse_json(text: str, cure: str) -> Any:
    """What a JSON text holds.

    Raises
    ------
    InputError
        Placed at ``line:column``, with the ``cure``.
    """
    try:
        return json.loads(text)
    except json.JSONDecodeError as fault:
        raise InputError(f"{fault.lineno}:{fault.colno}", f"is no JSON ({fault.msg})", cure) from None
    except (RecursionError, ValueError):  # nested too deeply; a number with thousands of digits
        raise InputError("", "is no JSON that can be read", cure) from None
