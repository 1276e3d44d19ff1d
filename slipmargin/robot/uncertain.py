"""A number of the robot file that is not known exactly: ``"0.26 ± 0.02"`` or ``[0.24, 0.28]``.

It is a float, the mean or the middle, so every command that does not ask for its spread uses that value;
arithmetic with it gives plain numbers, but for a minus before it, which turns its spread too.  A list of
numbers may hold such ones (:class:`UncertainArray`).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, shown
from slipmargin.errors import InputError

_PLUS_MINUS = re.compile(r"\s*(-?[0-9.][0-9.eE-]{0,40}?)\s*(?:±|\+/-|\+-)\s*([0-9.][0-9.eE-]{0,40})\s*")


@final
class Uncertain(float):
    """A number with a spread: normal with ``sd``, or (``sd`` None) uniform between its ends.

    A draw is kept within ``span``, the range of its key.
    """

    __slots__ = ("ends", "sd", "span")
    ends: tuple[float, float]
    sd: float | None
    span: tuple[float, float]

    def __new__(
        cls, ends: tuple[float, float], sd: float | None = None, span: tuple[float, float] = (0.0, np.inf)
    ) -> Uncertain:
        """The middle of two ends; with ``sd`` both ends are the mean."""
        made = super().__new__(cls, 0.5 * (ends[0] + ends[1]))
        made.ends, made.sd, made.span = ends, sd, span
        return made

    def __reduce__(self) -> tuple[type[Uncertain], tuple[Any, ...]]:
        return type(self), (self.ends, self.sd, self.span)

    def __neg__(self) -> Uncertain:
        (low, high), (least, most) = self.ends, self.span
        return Uncertain((-high, -low), self.sd, (-most, -least))

    def written(self) -> str | list[float]:
        """The number as the robot file spells it."""
        return list(self.ends) if self.sd is None else f"{float(self)!r} ± {self.sd!r}"

    def drawn(self, rng: np.random.Generator, count: int) -> Array:
        """Random values (count,): uniform between the ends, or normal within the key's range."""
        if self.sd is None:
            return rng.uniform(*self.ends, count)
        return np.clip(rng.normal(float(self), self.sd, count), *self.span)


@final
class UncertainArray(np.ndarray[Any, np.dtype[np.float64]]):
    """The middles of a list of numbers, read-only, with the list as given in ``each``.

    What is computed from it is a plain array.
    """

    each: tuple[float, ...]

    def __new__(cls, each: tuple[float, ...]) -> UncertainArray:
        """An array of the middles."""
        made = np.array([float(v) for v in each]).view(cls)
        made.each = each
        made.setflags(write=False)
        return made

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        return array[()] if return_scalar else np.asarray(array)

    def __reduce__(self) -> tuple[type[UncertainArray], tuple[Any, ...]]:
        return type(self), (self.each,)


def drawn(value: Any, rng: np.random.Generator, count: int) -> Array:
    """Random values of a number (count,) or of a list (count, n); what is exact is repeated."""
    if isinstance(value, UncertainArray):
        return np.column_stack([drawn(one, rng, count) for one in value.each])
    if isinstance(value, Uncertain):
        return value.drawn(rng, count)
    return np.repeat(np.asarray(value, dtype=float)[None], count, axis=0)


def spread(value: Any) -> bool:
    """Whether a value, or a number of a list, has a spread."""
    return isinstance(value, Uncertain | UncertainArray)


def looks_uncertain(value: Any) -> bool:
    """Whether a value of a file is spelled as one with a spread."""
    said = isinstance(value, str) and _PLUS_MINUS.fullmatch(value) is not None
    return said or isinstance(value, Uncertain) or (isinstance(value, list) and len(value) == 2)


def read(
    place: str, value: Any, number: Callable[[str, Any], float], cure: str, span: tuple[float, float]
) -> float:
    """A number, plain or uncertain; ``number`` checks one plain number at a place.

    Raises
    ------
    InputError
        For another spelling, ends in the wrong order, or (where the number must be positive) a spread as
        large as the value.
    """
    if isinstance(value, Uncertain):
        return value
    if isinstance(value, list | tuple) and len(value) == 2:
        low, high = (number(f"{place}[{i}]", v) for i, v in enumerate(value, 1))
        if not low < high:
            raise InputError(place, f"is {shown(value)}", "give the lower end first")
        return Uncertain((low, high), span=span)
    found = _PLUS_MINUS.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return number(place, value)
    try:
        mean, sd = float(found[1]), float(found[2])
    except ValueError:
        raise InputError(place, f"is {shown(value)}", cure) from None
    mean = number(place, mean)
    if not 0.0 < sd < (mean if span[0] >= 0.0 else np.inf):
        raise InputError(
            place,
            f"is {shown(value)}",
            "give a standard deviation above 0 and below the value, or an interval",
        )
    return Uncertain((mean, mean), sd, span)
