"""Named grids over a robot file: ``KEY=FROM:TO:STEP`` or ``KEY=a,b,c``, and their product.

Besides the named quantities a key may be a place in the file, counted from 1 or by name:
``wheel[2].radius_m``, ``wheel[rear].rigid_fraction``, ``effect[1].rigid_fraction``.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, final

from slipmargin.errors import InputError
from slipmargin.io.toml_table import nearest
from slipmargin.robot import Wheel
from slipmargin.robot.fields import Kind, keys
from slipmargin.study.quantities import QUANTITIES, Quantity, Value
from slipmargin.study.robot_on_surface import RobotOnSurface

#: The most designs that one study may hold.
MOST = 1_000_000
_PLACE = re.compile(r"(wheel|effect)\[([^\]]+)\]\.(\w+)")
_WHEEL_FIELDS = tuple(field for field, key in keys(Wheel).items() if key.kind is Kind.NUMBER)
_FORM = "write KEY=FROM:TO:STEP or KEY=a,b,c"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Vary:
    """One quantity and the values it takes, in order."""

    quantity: Quantity
    values: tuple[Value, ...]

    @property
    def key(self) -> str:
        """The quantity's name."""
        return self.quantity.key

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers that may be varied continuously."""
        return not self.quantity.words and not self.quantity.whole


def parse_vary(text: str) -> Vary:
    """``KEY=FROM:TO:STEP`` (ends included where the step meets them) or ``KEY=a,b,c``.

    Raises
    ------
    InputError
        Placed at the key: unknown (the known ones are listed), no number, an empty or endless range.
    """
    key, equals, right = (part.strip() for part in text.partition("="))
    if not equals or not key or not right:
        raise InputError(repr(text), "is no grid", _FORM)
    quantity = quantity_of(key)
    if ":" in right and not quantity.words:
        values: tuple[Value, ...] = _range(key, right)
    else:
        values = tuple(_value(quantity, cell.strip()) for cell in right.split(","))
    if len(set(values)) < len(values):
        raise InputError(key, f"names a value twice in {right!r}", "give each value once")
    return Vary(quantity=quantity, values=tuple(_whole(quantity, v) for v in values))


def quantity_of(key: str) -> Quantity:
    """The quantity called ``key``, or the one at that place of the file.

    Raises
    ------
    InputError
        Listing every known key.
    """
    known = {q.key: q for q in QUANTITIES}
    if key in known:
        return known[key]
    place = _PLACE.fullmatch(key)
    if place:
        return _placed(key, place[1], place[2], place[3])
    guess = nearest(key, known)
    hint = f"did you mean {guess!r}? Known: " if guess else "known: "
    raise InputError(
        key, "is not a quantity that can be varied", f"{hint}{', '.join(known)}, wheel[N].KEY, effect[N].KEY"
    )


def product(design: RobotOnSurface, grids: Sequence[Vary]) -> list[tuple[Value, ...]]:
    """Every combination of the grids' values, the last one changing fastest.

    Raises
    ------
    InputError
        If no grid is given, a key is given twice, a surface is unknown, or the product is too large.
    """
    if not grids:
        raise InputError("vary", "is missing", _FORM)
    keys = [g.key for g in grids]
    twice = next((k for k in keys if keys.count(k) > 1), None)
    if twice is not None:
        raise InputError(twice, "is varied twice", "give one grid for each quantity")
    if {"wheels", "wheels_in_rows"} <= set(keys):
        raise InputError("wheels_in_rows", "contradicts wheels", "vary one of the two layouts")
    count = math.prod(len(g.values) for g in grids)
    if count > MOST:
        raise InputError(keys[0], f"and the other grids make {count} designs", f"make at most {MOST}")
    for grid in grids:
        if grid.key == "surface":
            names = [s.name for s in design.robot.surfaces]
            wrong = next((v for v in grid.values if v not in names), None)
            if wrong is not None:
                raise InputError(
                    "surface", f"{wrong!r} is not in the robot file", f"use one of: {', '.join(names)}"
                )
    return list(itertools.product(*(g.values for g in grids)))


def applied(
    design: RobotOnSurface, quantities: Sequence[Quantity], values: Sequence[Value]
) -> RobotOnSurface:
    """The design with each quantity set, in the order of the catalogue.

    Raises
    ------
    InputError
        Where a value is impossible: names the quantity.
    """
    order = {q.key: i for i, q in enumerate(QUANTITIES)}
    pairs = sorted(zip(quantities, values, strict=True), key=lambda p: order.get(p[0].key, len(order)))
    for quantity, value in pairs:
        try:
            design = quantity.put(design, value)
        except InputError as fault:
            place = fault.place or quantity.key
            problem = f"cannot be {value}: {place} {fault.problem}"
            raise InputError(quantity.key, problem, fault.cure) from None
    return design


def _range(key: str, text: str) -> tuple[Value, ...]:
    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(key, f"has the range {text!r}", _FORM)
    start, stop, step = (_number(key, part.strip()) for part in parts)
    if step <= 0.0:
        raise InputError(key, f"has the step {step:g}", "give a positive step")
    if stop < start:
        raise InputError(key, f"goes from {start:g} down to {stop:g}", "swap the ends")
    count = math.floor((stop - start) / step + 1e-9) + 1
    if count > MOST:
        raise InputError(key, f"takes {count} values", f"take at most {MOST}")
    # Rounded to 12 digits so that 0.1 + 0.2 is written, and means, 0.3.
    return tuple(float(f"{start + step * i:.12g}") for i in range(count))


def _value(quantity: Quantity, cell: str) -> Value:
    if not quantity.words:
        return _number(quantity.key, cell)
    if cell in quantity.words or (quantity.words == ("*",) and cell):
        return cell
    raise InputError(quantity.key, f"is {cell!r}", f"use: {', '.join(quantity.words)}")


def _number(key: str, cell: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        raise InputError(key, f"takes numbers, not {cell!r}", _FORM) from None
    if not math.isfinite(number):
        raise InputError(key, f"is {cell}", "give finite numbers")
    return number


def _whole(quantity: Quantity, value: Value) -> Value:
    if quantity.whole and isinstance(value, float):
        if value != int(value):
            raise InputError(quantity.key, f"is {value:g}", "give whole numbers")
        return int(value)
    return value


def _placed(key: str, kind: str, which: str, field: str) -> Quantity:
    if kind == "wheel" and field not in _WHEEL_FIELDS:
        raise InputError(
            key, f"{field!r} is not a number of a wheel", f"use one of: {', '.join(_WHEEL_FIELDS)}"
        )

    def find(design: RobotOnSurface) -> int:
        names = (
            [w.name for w in design.robot.wheels]
            if kind == "wheel"
            else [e.name for e in design.recipe.effects]
        )
        if which in names:
            return names.index(which)
        if which.isdecimal() and 1 <= int(which) <= len(names):
            return int(which) - 1
        raise InputError(
            key,
            f"there is no {kind} {which!r}",
            f"use 1 to {len(names)} or a name: {', '.join(names) or 'the file lists none'}",
        )

    def put(design: RobotOnSurface, value: Any) -> RobotOnSurface:
        at = find(design)
        if kind == "wheel":
            wheels = list(design.robot.wheels)
            wheels[at] = replace(wheels[at], **{field: value})
            return design.with_robot(replace(design.robot, wheels=tuple(wheels)))
        effects: list[Any] = list(design.recipe.effects)
        check(effects[at])
        effects[at] = replace(effects[at], **{field: value})
        return replace(design, recipe=replace(design.recipe, effects=tuple(effects)))

    def check(effect: Any) -> None:
        names = [p.name for p in getattr(effect, "parameters", ())]
        if field not in names:
            raise InputError(
                key,
                f"effect {effect.name} has no number {field!r}",
                f"use one of: {', '.join(names) or 'none can be varied'}",
            )

    def get(design: RobotOnSurface) -> Value | None:
        at = find(design)
        if kind == "wheel":
            return float(getattr(design.robot.wheels[at], field))
        check(design.recipe.effects[at])
        return float(getattr(design.recipe.effects[at], field))

    return Quantity(key=key, unit="", meaning=f"{field} of {kind} {which}", put=put, get=get)
