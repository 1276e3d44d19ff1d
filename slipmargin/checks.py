"""Refuse at the door: small checks that constructors share.

Each raises :class:`~slipmargin.errors.InputError` naming the field, and returns the clean value.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipmargin.errors import InputError

Array = NDArray[np.float64]
#: Indices of trials, wheels, runs.
Index = NDArray[np.int64]
#: Measured and planned numbers are below this in any unit: powers of larger ones overflow in what follows.
LARGEST = 1e12
#: No robot on wheels is faster [m/s].
FASTEST_M_S = 1e3


def shown(value: object) -> str:
    """A refused value as a message quotes it: at most 60 characters."""
    try:
        text = repr(value)
    except ValueError:  # Python writes no whole number of more than some thousand digits
        return "a number of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "…"


def real(
    place: str,
    value: Any,
    *,
    low: float = -math.inf,
    high: float = math.inf,
    above: float | None = None,
    cure: str,
) -> float:
    """A finite float within ``[low, high]`` (and strictly greater than ``above``)."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating, np.integer)):
        raise InputError(place, f"is {shown(value)}, not a number", cure)
    try:
        number = float(value)
    except OverflowError:
        raise InputError(place, "is too large for a floating-point number", cure) from None
    if not math.isfinite(number):
        raise InputError(place, f"is {number}, not a finite number", cure)
    if number < low or number > high or (above is not None and number <= above):
        raise InputError(place, f"is {number:g}", cure)
    return number


def from_zero(place: str, seed: int) -> None:
    """Refuse a seed of everything random that is below zero."""
    if seed < 0:
        raise InputError(place, f"is {shown(seed)}", "give a whole number from 0")


def shaped(place: str, value: Any, shape: tuple[int | None, ...]) -> Array:
    """A float copy of ``value`` with the given shape (``None``: any length)."""
    array = np.array(value, dtype=np.float64)
    fits = array.ndim == len(shape) and all(
        want is None or want == got for want, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = "×".join("any" if n is None else str(n) for n in shape)
        raise InputError(place, f"has shape {array.shape}", f"give an array of shape {wanted}")
    return array


def frozen(place: str, value: Any, shape: tuple[int | None, ...]) -> Array:
    """A read-only float copy of ``value`` with the given shape (``None``: any length), all finite."""
    array = shaped(place, value, shape)
    if not np.all(np.isfinite(array)):
        raise InputError(place, "holds a value that is not finite", "give finite numbers")
    return read_only(array)


def measurable(place: str, array: Array) -> Array:
    """The array itself; refused where a number is larger than :data:`LARGEST`, missing ones aside."""
    size = np.abs(array)
    if np.any(size >= LARGEST):
        worst = float(np.nanmax(size))
        raise InputError(
            place, f"holds {worst:.3g}, and no robot measures that", f"give numbers below {LARGEST:g}"
        )
    return array


def read_only(array: Array) -> Array:
    """The array itself, which can no longer be written to."""
    array.setflags(write=False)
    return array


def exact_mean(values: Array) -> float:
    """The mean of finite values, summed without rounding: the same whatever their order; NaN else."""
    if not values.size or not np.isfinite(values).all():
        return float("nan")
    return math.fsum(values.tolist()) / values.size


def rounded_down(value: float) -> float:
    """To three digits that are never more than the value."""
    if value <= 0.0:
        return 0.0
    unit = 10.0 ** (np.floor(np.log10(value)) - 2)
    return float(np.floor(value / unit * (1.0 + 1e-12)) * unit)
