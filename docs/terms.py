"""Links each glossary term to its line where a page of the site first uses it."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

GLOSSARY = Path(__file__).resolve().parent / "glossary.md"
#: A row of the glossary: symbol, term, unit, meaning, where.
_ROW = re.compile(r"^\|([^|]*)\|([^|]*)\|([^|]*)\|([^|]*)\|([^|]*)\|$", flags=re.MULTILINE)
#: Words that are terms here and everyday words elsewhere: a link at each would only distract.
EVERYDAY = {"noise", "drag", "effect", "null", "lift", "slip", "mass", "lead", "trial", "band", "heading"}
EVERYDAY |= {"term", "axle", "candidate", "acceleration", "twist", "friction law"}
#: Text in which nothing is linked: code, links, pictures, headings, tables, formulas, HTML.
_KEPT = re.compile(
    r"(^[ \t]*```.*?^[ \t]*```[ \t]*$|\$\$.*?\$\$|^ {4,}\S[^\n]*$|^#[^\n]*$|^\|[^\n]*$|^:::[^\n]*$|"
    r"`[^`\n]*`|!?\[[^\]]*\]\([^)]*\)|<[^>]+>)",
    flags=re.DOTALL | re.MULTILINE,
)


@cache
def terms() -> dict[str, str]:
    """Term in small letters → the anchor of its line; longer terms first."""
    found: dict[str, str] = {}
    for match in _ROW.finditer(GLOSSARY.read_text(encoding="utf-8")):
        for word in words(match[2]):
            found.setdefault(word, anchor(match[2]))
    return dict(sorted(found.items(), key=lambda pair: -len(pair[0])))


def words(cell: str) -> list[str]:
    """The terms of a cell that are plain words: no code, no older word in brackets."""
    plain = re.sub(r"`[^`]*`|\([^)]*\)", "", cell)
    parts = (part.strip(" :;").lower() for part in re.split(r"[,;:]", plain))
    return [part for part in parts if re.fullmatch(r"[a-z][a-z/ -]{3,}", part) and part not in EVERYDAY]


def anchor(cell: str) -> str:
    """The anchor of a glossary line, made from its first term."""
    return "term-" + re.sub(r"[^a-z]+", "-", (words(cell) or ["none"])[0]).strip("-")


def anchored(text: str) -> str:
    """The glossary with an anchor on each line that has a term."""

    def put(match: re.Match[str]) -> str:
        if not words(match[2]) or anchor(match[2]) != terms()[words(match[2])[0]]:
            return match[0]
        head, tail = match[0][: match.start(2) - match.start()], match[0][match.end(2) - match.start() :]
        return f'{head} <span id="{anchor(match[2])}"></span>{match[2].lstrip()}{tail}'

    return _ROW.sub(put, text)


def first_uses(text: str) -> list[tuple[str, int, int]]:
    """Each term that a page uses in its running text: (term, start, end) of the first use."""
    free = _KEPT.sub(lambda match: "\0" * len(match[0]), text)
    found = []
    for term in terms():
        match = re.search(rf"(?<![\w-]){re.escape(term)}s?(?![\w-])", free, flags=re.IGNORECASE)
        if match:
            found.append((term, match.start(), match.end()))
            free = free[: match.start()] + "\0" * len(match[0]) + free[match.end() :]
    return sorted(found, key=lambda use: use[1])


def linked(text: str, up: str) -> str:
    """A page with each term linked where it is first used; ``up`` leads to the folder of the glossary."""
    out, at, done = "", 0, set()
    for term, start, end in first_uses(text):
        if terms()[term] in done:  # the same line of the glossary under its other name
            continue
        done.add(terms()[term])
        out += f"{text[at:start]}[{text[start:end]}]({up}glossary.md#{terms()[term]})"
        at = end
    return out + text[at:]
