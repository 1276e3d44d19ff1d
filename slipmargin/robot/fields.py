"""What a key of the robot file is: kind, unit, range and meaning, stated once beside the field that holds it.

Each dataclass of :mod:`slipmargin.robot.robot` carries one :class:`Key` in the metadata of each field.
Checking (:func:`check`), reading and writing (:mod:`slipmargin.io`), ``--vary`` and the reference page
``docs/robot-file.md`` follow these keys, so a new key is one field.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields, replace
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import Any, final
from unicodedata import category

import numpy as np

from slipmargin.checks import frozen, real, shown
from slipmargin.errors import InputError
from slipmargin.robot.uncertain import UncertainArray, looks_uncertain, read as read_uncertain, spread

#: Letters of a name; names stand in tables, pictures and other programs' files.
LONGEST = 200

#: The metadata of a dataclass field that is a key of the file.
Metadata = Mapping[str, "Key"]


class Kind(Enum):
    """What stands behind a key."""

    NUMBER = "number"
    WHOLE = "whole number"
    NAME = "name"
    WORD = "word"
    LIST = "list of numbers"
    TABLE = "table"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """One key of the robot file.

    Parameters
    ----------
    kind : Kind
    meaning : str
        What it is, in one plain sentence or phrase.
    unit : str
        "1" for a pure number, "" where there is none.
    low, high : float
        Ends of the range, for each number of a list; ``low`` itself is refused where ``above`` is set.
    reason : str
        Why the range is what it is, or what usual values are.
    words : type of Enum, or tuple of str
        What a WORD may be.
    meanings : tuple of str
        What each of the words means.
    count : int or None
        How many numbers a LIST has (None: any).
    of : type or None
        The dataclass whose fields are the keys of a TABLE.
    name : str
        The key as the file spells it; empty where the field has the same name.
    table : str
        The table it stands in where that is not the table of its dataclass.
    needs : tuple of (str, str)
        Other fields, each with a word: without that word (or, with "", without that field) this key has
        no effect, so it is refused.  Its default is None.
    uncertain : bool
        Whether the file may also give a NUMBER, or numbers of a LIST, as ``"0.26 ± 0.02"`` or as an interval.
    vary : tuple of str
        The quantities by which ``--vary`` reaches it.
    required : bool
        Whether a file must give it.
    default : object
        Its value where the file leaves it out.
    """

    kind: Kind
    meaning: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    reason: str = ""
    words: type[Enum] | tuple[str, ...] = ()
    meanings: tuple[str, ...] = ()
    count: int | None = None
    of: type | None = None
    name: str = ""
    table: str = ""
    needs: tuple[tuple[str, str], ...] = ()
    uncertain: bool = False
    vary: tuple[str, ...] = ()
    required: bool = True
    default: Any = None

    @property
    def choices(self) -> tuple[str, ...]:
        """The words it may be, as the file spells them."""
        return self.words if isinstance(self.words, tuple) else tuple(w.value for w in self.words)

    @property
    def range(self) -> str:
        """The range in words, with the unit."""
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        low, high = (f"{end:g}".replace("e+0", "e").replace("e-0", "e-") for end in (self.low, self.high))
        return f"above {low}, up to {high}{unit}" if self.above else f"{low} to {high}{unit}"

    @property
    def cure(self) -> str:
        """What to give instead of a value that is missing or refused."""
        if self.kind is Kind.NAME:
            return f'write {self.name} = "…"'
        if self.kind is Kind.WORD:
            return f"use one of: {', '.join(self.choices)}"
        if self.kind is Kind.TABLE:
            return f"write {self.name} = {{ drive = 0.26, transverse = 0.09 }}"
        many = "a list of numbers" if self.count is None else f"{self.count} numbers"
        what = {Kind.NUMBER: "a number", Kind.WHOLE: "a whole number", Kind.LIST: many}[self.kind]
        spread = ', or "0.26 ± 0.02", or [0.24, 0.28]' if self.uncertain else ""
        if spread and self.kind is Kind.LIST:
            spread = ', each also "0.26 ± 0.02" or [0.24, 0.28]'
        return f"give {what}, {self.range}" + (f" ({self.reason})" if self.reason else "") + spread

    def from_word(self, word: str) -> Any:
        """The value that a word of the file stands for."""
        return word if isinstance(self.words, tuple) else self.words(word)

    def checked(self, value: Any) -> Any:
        """The value in its own type, arrays read-only.

        Raises
        ------
        InputError
            Placed at the key: of another kind, out of range, not one of the words.
        """
        if self.kind is Kind.NUMBER:
            return self._perhaps_uncertain(self.name, value)
        if isinstance(value, UncertainArray) and self.uncertain:
            value = value.each
        if self.kind is Kind.LIST:
            if not isinstance(value, list | tuple | np.ndarray) or self.count not in (None, len(value)):
                raise InputError(self.name, f"is {shown(value)}", self.cure)
            cells = [self._perhaps_uncertain(f"{self.name}[{i}]", v) for i, v in enumerate(value, 1)]
            if any(spread(v) for v in cells):
                return UncertainArray(tuple(cells))
            return frozen(self.name, cells, (self.count,))
        if self.kind is Kind.NAME and isinstance(value, str) and not printable(value):
            problem = f"has {len(value)} letters" if len(value) > LONGEST else "holds a control character"
            raise InputError(self.name, problem, f"write a name of at most {LONGEST} letters on one line")
        if not self._fits(value):
            raise InputError(self.name, f"is {shown(value)}", self.cure)
        return value

    def _fits(self, value: Any) -> bool:
        if self.kind is Kind.WHOLE:
            return type(value) is int and self.low <= value <= self.high
        if self.kind is Kind.NAME:
            return isinstance(value, str) and bool(value.strip())
        if self.kind is Kind.WORD:
            return value in self.words if isinstance(self.words, tuple) else isinstance(value, self.words)
        return self.of is not None and isinstance(value, self.of)

    def _perhaps_uncertain(self, place: str, value: Any) -> float:
        if self.uncertain:
            return read_uncertain(place, value, self._number, self.cure, (self.low, self.high))
        if looks_uncertain(value):
            raise InputError(place, f"is {shown(value)}, but takes no spread", "give one number")
        return self._number(place, value)

    def _number(self, place: str, value: Any) -> float:
        above = self.low if self.above else None
        return real(place, value, low=self.low, high=self.high, above=above, cure=self.cure)


def printable(name: str) -> bool:
    """Whether a name can stand on a line: not too long, without control characters and line ends.

    Marks that turn the direction of writing are control characters too: they make a name read as another.
    """
    turning = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
    return len(name) <= LONGEST and not any(category(c) in ("Cc", "Zl", "Zp") or c in turning for c in name)


def number(unit: str, meaning: str, low: float, high: float, **more: Any) -> Metadata:
    """A finite number [unit] within [low, high]; ``above=True`` refuses ``low`` itself."""
    return _metadata(Key(kind=Kind.NUMBER, unit=unit, meaning=meaning, low=low, high=high, **more))


def whole(unit: str, meaning: str, low: int, high: int, **more: Any) -> Metadata:
    """A whole number within [low, high]."""
    return _metadata(Key(kind=Kind.WHOLE, unit=unit, meaning=meaning, low=low, high=high, **more))


def numbers(unit: str, meaning: str, count: int | None, low: float, high: float, **more: Any) -> Metadata:
    """A list of ``count`` finite numbers [unit], each within [low, high]."""
    return _metadata(Key(kind=Kind.LIST, unit=unit, meaning=meaning, count=count, low=low, high=high, **more))


def word(
    words: type[Enum] | tuple[str, ...], meaning: str, meanings: tuple[str, ...], **more: Any
) -> Metadata:
    """One of the known words, each with its meaning."""
    return _metadata(Key(kind=Kind.WORD, meaning=meaning, words=words, meanings=meanings, **more))


def text(meaning: str, **more: Any) -> Metadata:
    """A text that is not blank."""
    return _metadata(Key(kind=Kind.NAME, meaning=meaning, **more))


def table(of: type, meaning: str, **more: Any) -> Metadata:
    """A table whose keys are the fields of ``of``."""
    return _metadata(Key(kind=Kind.TABLE, meaning=meaning, of=of, **more))


def keys(kind: type, table: str = "") -> dict[str, Key]:
    """Field → key, in the file's order, of the keys of a dataclass that stand in ``table``."""
    return {field: key for field, key in _all_keys(kind).items() if key.table == table}


def check(thing: Any) -> None:
    """Put each field of a frozen dataclass through its key; the ``__post_init__`` of the robot's parts.

    Raises
    ------
    InputError
        Placed at the first key whose value is refused, or that has no effect beside the other keys.
    """
    kind: type = type(thing)
    found = _all_keys(kind)
    for field, key in found.items():
        value = getattr(thing, field)
        if value is not None or key.required or key.default is not None:
            try:
                clean = key.checked(value)
            except InputError as fault:
                raise fault.within(key.table) from None
            object.__setattr__(thing, field, clean)
    for field, key in found.items():
        for needed, wanted in key.needs if getattr(thing, field) is not None else ():
            _refuse_without(thing, found, key, needed, wanted)


def _refuse_without(thing: Any, found: Mapping[str, Key], key: Key, needed: str, wanted: str) -> None:
    value = getattr(thing, needed)
    word = value.value if isinstance(value, Enum) else value
    if word == wanted if wanted else value is not None:
        return
    other = f'{found[needed].name} = "{wanted}"' if wanted else found[needed].name
    raise InputError(
        f"{key.table}.{key.name}" if key.table else key.name,
        f"has no effect without {other}",
        f"add {other}, or leave {key.name} out",
    )


@cache
def _all_keys(kind: type) -> Mapping[str, Key]:
    """Every field of a dataclass that is a key, with its name and default filled in."""
    return MappingProxyType(
        {f.name: _completed(f.metadata["key"], f) for f in fields(kind) if "key" in f.metadata}
    )


def _completed(key: Key, field: Field[Any]) -> Key:
    made = field.default_factory
    default = made() if made is not MISSING else field.default
    required = default is MISSING
    return replace(key, name=key.name or field.name, required=required, default=None if required else default)


def _metadata(key: Key) -> Metadata:
    return MappingProxyType({"key": key})
