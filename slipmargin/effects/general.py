"""An effect without a name: free coefficients in a general basis over the variable it was traced to.

It stands in the robot file as ``unnamed_<variable>`` with its terms spelled out, so every command
obeys it like a named one.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, real, shown
from slipmargin.effects.effect import Part, Trace
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm, Multiplier, PoseShift
from slipmargin.physics.variables import Basis, Frame, Target, Variable

PREFIX = "unnamed_"
Term = Multiplier | ForceTerm | PoseShift

#: Which field of the part the terms are appended to, and the kind of term it takes.
_PLACES: dict[Part, tuple[str, type]] = {
    Part.GRIP: ("multipliers", Multiplier),
    Part.LOSSES: ("terms", ForceTerm),
    Part.TRANSIENTS: ("multipliers", Multiplier),
    Part.SENSING: ("warps", PoseShift),
}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GeneralEffect:
    """Terms over one traced variable, appended to one part of the model."""

    traced_to: Trace
    part: Part
    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        if self.part not in _PLACES:
            known = ", ".join(part.value for part in _PLACES)
            raise InputError("part", f"is {self.part.value!r}", f"use one of: {known}")
        kind = _PLACES[self.part][1]
        if not all(isinstance(term, kind) for term in self.terms):
            raise InputError("term", f"does not fit into {self.part.value}", f"give {kind.__name__} terms")

    @property
    def name(self) -> str:
        """``unnamed_<variable>``."""
        return PREFIX + self.traced_to.value

    def rewrite(self, part: Any, nominal: Model) -> Any:
        """The part with these terms on top."""
        del nominal
        field = _PLACES[self.part][0]
        return replace(part, **{field: (*getattr(part, field), *self.terms)})

    def check_wheels(self, count: int) -> None:
        """Refuse terms that weigh another number of wheels than the robot's ``count``.

        Raises
        ------
        InputError
            Placed at the weights.
        """
        for i, term in enumerate(self.terms, 1):
            if isinstance(term, Multiplier) and len(term.wheels) != count:
                raise InputError(
                    f"term[{i}].wheel_weights",
                    f"has {len(term.wheels)} weights",
                    f"give one for each of the {count} wheels",
                )

    def to_table(self) -> dict[str, Any]:
        """As a ``[[effect]]`` table."""
        return {"name": self.name, "part": self.part.value, "term": [_row(term) for term in self.terms]}


def _row(term: Term) -> dict[str, Any]:
    row: dict[str, Any] = {
        "variable": term.variable.name.lower(),
        "basis": term.basis.name.lower(),
        "shape": term.shape.tolist(),
    }
    if isinstance(term, Multiplier):
        return row | {
            "target": term.target.name.lower(),
            "wheel_weights": term.wheels.tolist(),
            "coefficients": term.coefficients.tolist(),
            **({"place": term.place.tolist()} if np.any(term.place) else {}),
        }
    if isinstance(term, ForceTerm):
        row["frame"] = term.frame.name.lower()
        if term.height_m != 0.0:
            row["height_m"] = _AT_COM if term.height_m is None else term.height_m
        if term.lift_N != 0.0:
            row["lift_N"] = term.lift_N
        if np.any(term.place_m):
            row["place_m"] = term.place_m.tolist()
    keys = _TRIPLE[type(term)]
    return row | {key: term.coefficients[i].tolist() for i, key in enumerate(keys)}


_COMMON = {"variable", "basis", "shape"}
#: The word for a force at the height of the centre of mass.
_AT_COM = "centre_of_mass"
_HEIGHT_CURE = f"give a number [m] or {_AT_COM!r}"
_OPTIONAL = {"height_m", "lift_N", "place_m"}
_TRIPLE: dict[type, tuple[str, str, str]] = {
    ForceTerm: ("fx_N", "fy_N", "mz_N_m"),
    PoseShift: ("dx_m", "dy_m", "dphi_rad"),
}


def from_table(table: Mapping[str, Any]) -> GeneralEffect:
    """The effect that a ``[[effect]]`` table named ``unnamed_…`` describes.

    Raises
    ------
    InputError
        If a key is unknown or missing, or a value is not one of the known words or numbers.
    """
    _only("", table, {"name", "part", "term"})
    trace = _word(Trace, "name", str(table["name"]).removeprefix(PREFIX))
    part = _word(Part, "part", table["part"])
    if part not in _PLACES:
        raise InputError("part", f"is {part.value!r}", f"use one of: {', '.join(p.value for p in _PLACES)}")
    rows = table["term"]
    if not isinstance(rows, list) or not rows or not all(isinstance(row, Mapping) for row in rows):
        raise InputError("term", "is not a list of tables", "write [[effect.term]] tables")
    terms = tuple(_term(f"term[{i}]", _PLACES[part][1], row) for i, row in enumerate(rows, 1))
    return GeneralEffect(traced_to=trace, part=part, terms=terms)


def _term(place: str, kind: type, row: Mapping[str, Any]) -> Term:
    if kind is Multiplier:
        keys = _COMMON | {"target", "coefficients", "wheel_weights"}
    else:
        keys = _COMMON | set(_TRIPLE[kind]) | ({"frame"} if kind is ForceTerm else set())
    _only(place, row, keys, _OPTIONAL if kind is ForceTerm else {"place"} if kind is Multiplier else set())
    try:
        common: dict[str, Any] = {
            "variable": _word(Variable, "variable", row["variable"]),
            "basis": _word(Basis, "basis", row["basis"]),
            "shape": _numbers("shape", row),
        }
        if kind is Multiplier:
            target = _word(Target, "target", row["target"])
            return Multiplier(
                **common,
                target=target,
                coefficients=_numbers("coefficients", row),
                wheels=_numbers("wheel_weights", row),
                place=_numbers("place", row) if "place" in row else np.zeros(3),
            )
        triple = [_numbers(key, row) for key in _TRIPLE[kind]]
        if len({len(numbers) for numbers in triple}) != 1:
            raise InputError(_TRIPLE[kind][0], "differs in length from the other two", "give them one length")
        if kind is ForceTerm:
            frame = _word(Frame, "frame", row["frame"])
            height = row.get("height_m", 0.0)
            return ForceTerm(
                **common,
                coefficients=np.array(triple),
                frame=frame,
                height_m=None if height == _AT_COM else real("height_m", height, cure=_HEIGHT_CURE),
                lift_N=real("lift_N", row.get("lift_N", 0.0), cure="give a number [N]"),
                place_m=_numbers("place_m", row) if "place_m" in row else np.zeros(2),
            )
        return PoseShift(**common, coefficients=np.array(triple))
    except InputError as error:
        raise error.within(place) from None


def _only(place: str, row: Mapping[str, Any], keys: set[str], optional: Set[str] = frozenset()) -> None:
    prefix = f"{place}." if place else ""
    for key in sorted(set(row) - keys - optional):
        raise InputError(
            prefix + key, "is not a known key", f"use only: {', '.join(sorted(keys | optional))}"
        )
    for key in sorted(keys - set(row)):
        raise InputError(prefix + key, "is missing", "add it")


def _numbers(key: str, row: Mapping[str, Any]) -> Array:
    value = row[key]
    if not isinstance(value, list) or not value:
        raise InputError(key, f"is {shown(value)}", "give a list of numbers")
    return np.array([real(f"{key}[{i}]", v, cure="give a finite number") for i, v in enumerate(value, 1)])


def _word(kind: Any, key: str, value: object) -> Any:
    words = {(m.value if isinstance(m.value, str) else m.name.lower()): m for m in kind}
    if not isinstance(value, str) or value not in words:
        raise InputError(key, f"is {shown(value)}", f"use one of: {', '.join(words)}")
    return words[value]
