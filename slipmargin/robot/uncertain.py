"""A number of the robot file that is not known exactly: ``"0.26 ± 0.02"`` or ``[0.24, 0.28]``.

It is a float, the mean or the middle, so every command that does not ask for its spread uses that value;
arithmetic with it gives plain numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, shown
from slipmargin.errors import InputError

_PLUS_MINUS = re.compile(r"\s*([0-9][0-9.eE-]{0,40}?)\s*(?:±|\+/-|\+-)\s*([0-9][0-9.eE-]{0,40})\s*")


@final
class Uncertain(float):
    """A number with a spread: normal with ``sd``, or (``sd`` None) uniform between its ends."""

    __slots__ = ("ends", "sd")
    ends: tuple[float, float]
    sd: float | None

    def __new__(cls, ends: tuple[float, float], sd: float | None = None) -> Uncertain:
        """The middle of two ends; with ``sd`` both ends are the mean."""
        made = super().__new__(cls, 0.5 * (ends[0] + ends[1]))
        made.ends, made.sd = ends, sd
        return made

    def __reduce__(self) -> tuple[type[Uncertain], tuple[tuple[float, float], float | None]]:
        return type(self), (self.ends, self.sd)

    def written(self) -> str | list[float]:
        """The number as the robot file spells it."""
        return list(self.ends) if self.sd is None else f"{float(self)!r} ± {self.sd!r}"

    def drawn(self, rng: np.random.Generator, count: int) -> Array:
        """Random values (count,): uniform between the ends, or normal and not below 0."""
        if self.sd is None:
            return rng.uniform(*self.ends, count)
        return np.maximum(rng.normal(float(self), self.sd, count), 0.0)


def read(place: str, value: Any, number: Callable[[str, Any], float], cure: str) -> float:
    """A number, plain or uncertain; ``number`` checks one plain number at a place.

    Raises
    ------
    InputError
        For another spelling, ends in the wrong order, or a spread as large as the value.
    """
    if isinstance(value, Uncertain):
        return value
    if isinstance(value, list | tuple) and len(value) == 2:
        low, high = (number(f"{place}[{i}]", v) for i, v in enumerate(value, 1))
        if not low < high:
            raise InputError(place, f"is {shown(value)}", "give the lower end first")
        return Uncertain((low, high))
    found = _PLUS_MINUS.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return number(place, value)
    try:
        mean, sd = float(found[1]), float(found[2])
    except ValueError:
        raise InputError(place, f"is {shown(value)}", cure) from None
    mean = number(place, mean)
    if not 0.0 < sd < mean:
        raise InputError(
            place,
            f"is {shown(value)}",
            "give a standard deviation above 0 and below the value, or an interval",
        )
    return Uncertain((mean, mean), sd)
