"""A TOML table read strictly: every key is asked for by name, and what is left over is an error."""

from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Iterable
from typing import Any, final

from slipmargin.checks import real, shown
from slipmargin.errors import InputError

if sys.version_info >= (3, 11):
    import tomllib
else:  # the same library under its own name
    import tomli as tomllib

#: The version of the TOML files that this program reads.
SCHEMA = 1
_PLACE = re.compile(r"\(at (?:line (\d+), column (\d+)|end of document)\)")


def parse_toml(text: str) -> dict[str, Any]:
    """The document that ``text`` holds.

    Raises
    ------
    InputError
        Placed at ``line:column`` where the text is no TOML, or at a whole number beyond 64 bits.
    """
    try:
        found = tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        match = _PLACE.search(str(fault))
        if match and match[1]:
            place = f"{match[1]}:{match[2]}"
        else:
            lines = text.split("\n")
            place = f"{len(lines)}:{len(lines[-1]) + 1}"
        problem = _PLACE.sub("", str(fault)).strip()
        raise InputError(
            place, f"is not TOML ({problem[:1].lower() + problem[1:]})", "correct the syntax there"
        ) from None
    except RecursionError:
        raise InputError("1:1", "is nested too deeply", "write a flat file of tables") from None
    except ValueError as fault:  # a number of thousands of digits, a date that does not exist
        raise InputError("1:1", f"holds a value that cannot be read ({fault})", "correct the value") from None
    _refuse_huge("", found)
    return found


def _refuse_huge(place: str, value: object) -> None:
    # TOML's whole numbers have 64 bits; Python reads more, but cannot always write them into a message.
    if isinstance(value, dict):
        for key, one in value.items():
            _refuse_huge(f"{place}.{key}" if place else key, one)
    elif isinstance(value, list):
        for i, one in enumerate(value, 1):
            _refuse_huge(f"{place}[{i}]", one)
    elif isinstance(value, int) and value.bit_length() > 63:
        raise InputError(place, "is a whole number of more than 64 bits", "give a smaller number")


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word that ``word`` was probably meant to be, or None.

    A key without its unit is the likeliest slip: ``radius`` finds ``radius_m``.
    """
    words = list(known)
    longer = [k for k in words if k.startswith(word.rstrip("_") + "_")]
    if longer:
        return longer[0]
    close = difflib.get_close_matches(word, words, n=1, cutoff=0.6)
    return close[0] if close else None


def one_of(place: str, value: object, known: Iterable[str]) -> str:
    """``value`` where it is one of the known words; the error lists them."""
    words = list(known)
    if isinstance(value, str) and value in words:
        return value
    guess = nearest(value, words) if isinstance(value, str) else None
    hint = f"did you mean {guess!r}? Known: " if guess else "use one of: "
    raise InputError(place, f"is {shown(value)}", hint + ", ".join(words))


def document(text: str, start: str) -> Table:
    """The document that ``text`` holds, of the schema that this program reads.

    Parameters
    ----------
    start : str
        The cure for an empty file: how such a file is made.

    Raises
    ------
    InputError
        Where the text is no TOML, holds no key, or is of another schema.
    """
    found = parse_toml(text)
    if not found:
        raise InputError("", "is empty: it holds no key", start)
    top = Table("", found)
    schema = top.take("schema", f"write schema = {SCHEMA}")
    if type(schema) is not int or schema != SCHEMA:
        raise InputError("schema", f"is {shown(schema)}", f"this program reads schema = {SCHEMA}")
    return top


@final
class Table:
    """One table of a TOML document with the place it stands at (``wheel[2]``, counted from 1).

    Ask for each key once, then call :meth:`done`: a key nobody asked for is an error.
    """

    def __init__(self, place: str, value: object) -> None:
        if not isinstance(value, dict):
            kind = "[[" if place.endswith("]") else "["
            name = place.split("[")[0]
            raise InputError(
                place,
                f"is {shown(value)}, not a table",
                f"write {kind}{name}{']]' if kind == '[[' else ']'} and its keys below",
            )
        self.place = place
        self._left: dict[str, Any] = dict(value)
        self._asked: list[str] = []

    def at(self, key: str) -> str:
        """The place of one key."""
        return f"{self.place}.{key}" if self.place else key

    def has(self, key: str) -> bool:
        """Whether the key is there (asking counts)."""
        if key not in self._asked:
            self._asked.append(key)
        return key in self._left

    def take(self, key: str, cure: str) -> Any:
        """The raw value of a key that must be there."""
        if not self.has(key):
            twin = next((k for k in self._left if nearest(k, [key])), None)
            told = f"rename {twin!r} to {key!r}: {cure}" if twin and twin not in self._asked else cure
            raise InputError(self.at(key), "is missing", told)
        return self._left.pop(key)

    def number(self, key: str, unit: str, default: float | None = None) -> float:
        """A finite number [unit]; ``default`` where the key may be left out."""
        if default is not None and not self.has(key):
            return default
        cure = f"give a number [{unit}]"
        return real(self.at(key), self.take(key, cure), cure=cure)

    def whole(self, key: str, default: int | None = None) -> int:
        """A whole number."""
        if default is not None and not self.has(key):
            return default
        value = self.take(key, "give a whole number")
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError(self.at(key), f"is {shown(value)}", "give a whole number")
        return value

    def text(self, key: str) -> str:
        """A string that is not blank."""
        value = self.take(key, f'write {key} = "…"')
        if not isinstance(value, str) or not value.strip():
            raise InputError(self.at(key), f"is {shown(value)}, not a name", f'write {key} = "…"')
        return value

    def word(self, key: str, known: Iterable[str], default: str | None = None) -> str:
        """One of the known words."""
        words = list(known)
        if default is not None and not self.has(key):
            return default
        return one_of(self.at(key), self.take(key, f"use one of: {', '.join(words)}"), words)

    def numbers(
        self, key: str, count: int | None, unit: str, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        """A list of ``count`` finite numbers [unit] (None: any length)."""
        if default is not None and not self.has(key):
            return default
        many = "a list of" if count is None else f"{count}"
        cure = f"give {many} numbers [{unit}], like [{', '.join(['0.0'] * (count or 3))}]"
        value = self.take(key, cure)
        if not isinstance(value, list) or (count is not None and len(value) != count):
            raise InputError(self.at(key), f"is {shown(value)}", cure)
        return tuple(real(f"{self.at(key)}[{i}]", v, cure=cure) for i, v in enumerate(value, 1))

    def table(self, key: str, cure: str) -> Table:
        """The table under a key."""
        return Table(self.at(key), self.take(key, cure))

    def tables(self, key: str) -> list[Table]:
        """An array of tables, ``[[key]]``; empty where the key is absent."""
        if not self.has(key):
            return []
        value = self._left.pop(key)
        if not isinstance(value, list):
            raise InputError(
                self.at(key),
                "is a single value, not a list of tables",
                f"write [[{key}]], with double brackets, once for each",
            )
        return [Table(f"{self.at(key)}[{i}]", row) for i, row in enumerate(value, 1)]

    def raw(self) -> dict[str, Any]:
        """Everything that nobody has asked for yet, for a reader with rules of its own."""
        rest, self._left = self._left, {}
        return rest

    def done(self) -> None:
        """Refuse what nobody asked for.

        Raises
        ------
        InputError
            At the first unknown key, with the known key it resembles.
        """
        for key in self._left:
            guess = nearest(key, self._asked)
            hint = f"did you mean {guess!r}?" if guess else f"known here: {', '.join(self._asked)}"
            raise InputError(self.at(key), "is not a known key", hint)
