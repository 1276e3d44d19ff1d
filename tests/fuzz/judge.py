"""What came of a case: fine, refused in one line, or one of the things that must not happen."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from slipmargin.report.not_given import largest

#: What must not happen, beside "ok" and "refused".
BAD = ("traceback", "internal", "hang", "memory", "killed", "absurd", "dirty")
#: A wheel uses no more of its grip [1], where a result tells such a share at all.
MOST_USE = 1e5
NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf|infinity)(?![\w])", re.IGNORECASE)
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029]")


def judge(
    code: int,
    out: str,
    err: str,
    folder: Path,
    before: set[str],
    *,
    stream: bool = False,
    names: Collection[str] = (),
) -> tuple[str, str]:
    """The word for an ended run and what shows it.

    Of a ``stream`` lines are out before one is refused.  ``names`` are words of its files: a wheel that is
    called ``nan`` there is no number that went wrong.
    """
    if "Traceback" in err:
        return "traceback", _last(err)
    if code == 1 and "internal error" in err:
        return ("memory" if "MemoryError" in err or "Unable to allocate" in err else "internal"), _last(err)
    left = [p for p in folder.rglob("*") if p.is_file() and str(p.relative_to(folder)) not in before]
    for path in left:
        if path.name.endswith(".part") or ".work" in path.name:
            return "dirty", f"left behind: {path.name}"
    if _CONTROL.search(out) or _CONTROL.search(err):
        return "dirty", f"control characters: {_CONTROL.search(out + err)!r}"
    if code == 2:
        if left:
            return "dirty", f"refused, but wrote {left[0].name}"
        fine = (
            (out == "" or stream) and err.count("\n") == 1 and err.startswith("error: ") and len(err) < 2000
        )
        return ("refused", "") if fine else ("dirty", f"refused, but not in one line: {(out + err)[:300]!r}")
    if code not in (0, 1):
        return "killed", f"status {code}: {_last(err)}"
    if any(not line.startswith("warning: ") for line in err.splitlines()):
        return "dirty", f"not a warning: {err[:300]!r}"
    for absurd in _absurd(out, left, [n for n in names if NO_NUMBER.fullmatch(n)]):
        return "absurd", absurd
    return "ok", ""


def _last(err: str) -> str:
    return (err.strip().splitlines() or [""])[-1][:400]


def _absurd(out: str, files: list[Path], names: Collection[str]) -> Iterator[str]:
    texts = {"stdout": out} | {
        p.name: p.read_text(encoding="utf-8", errors="replace")
        for p in files
        if p.suffix not in (".png", ".pdf")
    }
    for name, text in texts.items():
        if name.endswith(".json") or (name == "stdout" and text.startswith("{\n")):
            yield from _in_json(name, text)
        elif name.endswith(".svg"):
            try:
                ElementTree.fromstring(text)
            except ElementTree.ParseError as fault:
                yield f"{name}: no XML: {fault}"
        elif name.endswith(".html"):
            if "<script>fuzz" in text or "<b onfuzz" in text:
                yield f"{name}: markup of a name is not escaped"
        else:
            for word in names:
                text = re.sub(rf"\b{word}\b", "a name", text)
            found = NO_NUMBER.search(text)
            if found:
                yield f"{name}: {text[max(0, found.start() - 80) : found.end() + 20]!r}"
            if name.endswith(".csv") and re.search(r'(^|,)"?[=@]', text, re.MULTILINE):
                yield f"{name}: a cell begins like a formula"


def _in_json(name: str, text: str) -> Iterator[str]:
    try:
        found = json.loads(text, parse_constant=lambda word: f"constant {word}")
    except ValueError as fault:
        yield f"{name}: no JSON: {fault}"
        return
    for path, value in walk(found):
        if isinstance(value, str) and value.startswith("constant "):
            yield f"{name}: {path} is {value[9:]}"
        if isinstance(value, float) and not _sane(path, value):
            yield f"{name}: {path} is {value:g}"


def walk(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of a tree with the keys on the way to it."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from walk(item, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list):
        for item in value:
            yield from walk(item, path)
    else:
        yield path, value


def _sane(path: str, value: float) -> bool:
    key = path.rpartition(".")[2]
    most = MOST_USE if f"_{key}".endswith("_use") else largest(key)
    return abs(value) <= most and not math.isnan(value)
