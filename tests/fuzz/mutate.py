"""Changes of good input: trees of TOML and JSON, tables of CSV, command lines, and plain bytes."""

from __future__ import annotations

import copy
import json
import math
from random import Random
from typing import Any

#: Numbers that programs stumble over.
NUMBERS: tuple[Any, ...] = (
    0, -0.0, 1, -1, 2, 3, 1e-300, -1e-300, 1e300, -1e300, 1e308, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 0.999,
    1e3, 1e4, 1e6, 1e9, 1e12, 9223372036854775807, 9223372036854775808, 10**400, 90, 89.9, 45, 180, 360,
    1e5, math.pi, math.nan, math.inf, -math.inf, True, False,
)  # fmt: skip
#: Text that is data, whatever it looks like.
WORDS = (
    "", " ", "<b onfuzz=1>x</b>", "<script>fuzz()</script>", "]]>", "&amp;&lt", "$x^2$",
    "$\\frac{", "\\alpha_{", "%s%n",
    "\x1b[31mred\x1b[0m", "\x1b]0;t\x07", "two\nlines", "tab\there", "cr\rhere", "nul\x00x",
    "\x7f\x85\u2028", "=1+1",
    "+cmd|' /C calc'!A0", "@sum", "-1", "a,b", 'say "x"', "'", "`id`", "../../etc/passwd",
    "x" * 10_000, "é" * 300, "日本語",
    "\u202eevil", "🤖", "nan", "inf", "null", "true", "0.26 ± 0.02", "1 ± 0", "3 ± 1e300", "box",
    "ellipse", "disc-strip",
    "quasi-static", "static", "fixed", "equal", "tanh", "atan", "ros", "paper", "measured", "commanded",
)  # fmt: skip


def number(random: Random, value: Any) -> Any:
    """Another number: near the value, of another size, or one of the bad ones."""
    way = random.random()
    if isinstance(value, bool) or way < 0.25:
        return random.choice(NUMBERS)
    if isinstance(value, int) and way < 0.7:
        return value + random.choice((-2, -1, 1, 2, 5))
    value = _float(value)
    if way < 0.6:
        return value * math.exp(random.gauss(0.0, 0.5)) if value else random.gauss(0.0, 1.0)
    if way < 0.8:
        return -value
    return value * 10.0 ** random.choice((-6, -3, -1, 1, 3, 6))


def _float(value: float) -> float:
    """The value as a float: infinite where it is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def scalar(random: Random, value: Any) -> Any:
    """Another value in the place of this one."""
    if isinstance(value, str):
        return random.choice(WORDS) if random.random() < 0.8 else mixed(random, value)
    if random.random() < 0.06:
        return random.choice((random.choice(WORDS), [], {}, [1, 2], [[1]], None))
    if isinstance(value, int | float):
        if random.random() < 0.05:
            value = _float(value)
            spread = abs(value) * random.choice((0.01, 0.1, 1.0))
            return random.choice((f"{value} ± {spread}", [value - spread, value + spread]))
        return number(random, value)
    return random.choice(NUMBERS)


def mixed(random: Random, text: str) -> str:
    """The text with a piece cut out, doubled or replaced."""
    if not text:
        return random.choice(WORDS)
    a, b = sorted((random.randrange(len(text) + 1), random.randrange(len(text) + 1)))
    return text[:a] + random.choice(("", text[a:b] * 2, random.choice(WORDS))) + text[b:]


def sizes(random: Random, good: Any, changes: int) -> None:
    """Give so many numbers of a tree another size of the same sign, in place: mostly still a good tree."""
    all_numbers = [at for at in places(good) if _is_float(_at(good, at))]
    for at in random.sample(all_numbers, min(changes, len(all_numbers))):
        factor = random.choice((0.0, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3, -1.0))
        _at(good, at[:-1])[at[-1]] = _at(good, at) * factor


def _at(tree: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _is_float(value: Any) -> bool:
    return isinstance(value, float)


def places(tree: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of everything in a tree."""
    if isinstance(tree, dict):
        return [p for key in tree for p in ((*path, key), *places(tree[key], (*path, key)))]
    if isinstance(tree, list):
        return [p for i in range(len(tree)) for p in ((*path, i), *places(tree[i], (*path, i)))]
    return []


def tree(random: Random, good: Any, changes: int) -> Any:
    """A copy of a tree of tables, lists and values with so many changes."""
    found = copy.deepcopy(good)
    for _ in range(changes):
        at = random.choice(places(found) or [()])
        if not at:
            break
        holder = found
        for key in at[:-1]:
            holder = holder[key]
        _change(random, holder, at[-1])
    return found


def _change(random: Random, holder: Any, key: Any) -> None:
    value, way = holder[key], random.random()
    if not isinstance(value, dict | list) and way < 0.85:
        holder[key] = scalar(random, value)
    elif way < 0.9:
        del holder[key]
    elif isinstance(holder, list):
        holder.insert(key, copy.deepcopy(value))
        if random.random() < 0.1:
            holder.extend(copy.deepcopy(value) for _ in range(random.choice((1, 5, 30, 200))))
    elif isinstance(value, list) and value:
        random.shuffle(value)
        if random.random() < 0.5:
            value.pop()
    else:
        holder[random.choice(("", "extra", "name", "wheels", "schema"))] = value


def toml(table: dict[str, Any]) -> str:
    """TOML text of nested tables."""
    return "\n".join(_toml(table, ())) + "\n"


def _toml(table: dict[str, Any], at: tuple[str, ...]) -> list[str]:
    lines, later = [], []
    for key, value in table.items():
        place = (*at, _key(key))
        if isinstance(value, dict) and len(at) < 2:
            later += ["", f"[{'.'.join(place)}]", *_toml(value, place)]
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value) and len(at) < 1:
            for item in value:
                later += ["", f"[[{'.'.join(place)}]]", *_toml(item, place)]
        elif value is not None:
            lines.append(f"{_key(key)} = {_value(value)}")
    return lines + later


def _key(key: str) -> str:
    return key if key and all(c.isalnum() or c == "_" for c in key) and key.isascii() else _quoted(key)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value if v is not None) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return _quoted(value) if isinstance(value, str) else repr(value)


def table(random: Random, text: str, changes: int, separator: str = ",") -> str:
    """CSV text with cells, rows and columns changed."""
    rows = [line.split(separator) for line in text.rstrip("\n").split("\n")]
    for _ in range(changes):
        _change_table(random, rows)
    return "\n".join(separator.join(row) for row in rows) + "\n"


def _change_table(random: Random, rows: list[list[str]]) -> None:
    way, r = random.random(), random.randrange(len(rows))
    column = random.randrange(max(1, len(rows[0])))
    if way < 0.3:
        c = random.randrange(len(rows[r]) or 1)
        cell = random.choice(
            (lambda: "", lambda: random.choice(WORDS), lambda: str(random.choice(NUMBERS))[:500])
        )()
        rows[r][c : c + 1] = [_changed(rows[r][c], random) if rows[r] and random.random() < 0.6 else cell]
    elif way < 0.4:
        factor = random.choice((0.0, -1.0, 1e-9, 1e-3, 1e3, 1e6, 1e9, 1e15))
        for row in rows[1:]:
            if column < len(row):
                row[column] = _scaled(row[column], factor)
    elif way < 0.5:
        value = random.choice(("0", "1", "", "1e9", "-3.14"))
        for row in rows[1:]:
            if column < len(row):
                row[column] = value
    elif way < 0.6 and len(rows) > 2:
        del rows[r : r + random.choice((1, 1, 5, len(rows)))]
    elif way < 0.7:
        rows.insert(r, list(rows[r]))
    elif way < 0.78:
        body = rows[1:]
        random.choice((random.shuffle, list.reverse))(body)
        rows[1:] = body
    elif way < 0.86:
        for row in rows:
            if column < len(row):
                del row[column]
    elif way < 0.93:
        other = random.randrange(max(1, len(rows[0])))
        for row in rows[random.choice((0, 1)) :]:
            if max(column, other) < len(row):
                row[column], row[other] = row[other], row[column]
    else:
        del rows[random.choice((1, 2, 3, len(rows))) :]
    if not rows:
        rows.append([""])


def _changed(cell: str, random: Random) -> str:
    try:
        return repr(number(random, float(cell)))
    except (ValueError, OverflowError):
        return random.choice(WORDS)


def _scaled(cell: str, factor: float) -> str:
    try:
        return repr(float(cell) * factor)
    except ValueError:
        return cell


def raw(random: Random, data: bytes, changes: int) -> bytes:
    """Bytes with some flipped, cut out or doubled."""
    found = bytearray(data)
    for _ in range(changes):
        at = random.randrange(len(found) + 1)
        way = random.random()
        if way < 0.4 and at < len(found):
            found[at] = random.randrange(256)
        elif way < 0.6:
            del found[at : at + random.choice((1, 10, 100, len(found)))]
        elif way < 0.8:
            found[at:at] = random.choice(WORDS).encode()[:100]
        else:
            found[at:at] = found[max(0, at - 40) : at]
    return bytes(found)
