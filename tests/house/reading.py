"""How long the sentences of a page are, by a library that splits text into sentences (pySBD)."""

from __future__ import annotations

import re
import statistics
import warnings
from functools import cache
from pathlib import Path
from typing import Any


@cache
def _splitter() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its source has old escapes
        import pysbd

        return pysbd.Segmenter(language="en", clean=False)


def prose(text: str) -> list[str]:
    """The paragraphs, list items and quotes of a Markdown page as plain text; no code, table or heading."""
    text = re.sub(r"^---\n.*?^---\n", "", text, count=1, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^[ \t]*(```|~~~).*?^[ \t]*\1[ \t]*$", "\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\$\$.*?\$\$", "\n", text, flags=re.DOTALL)
    text = re.sub(r"<[^>]+>|!\[[^\]]*\]\([^)]*\)", " ", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"^ {4,}\S.*$", "\n", text, flags=re.MULTILINE)
    found: list[str] = []
    for block in re.split(r"\n\s*\n|\n(?=[ \t]*(?:[-*+]|\d+\.) )", text):
        line = " ".join(block.split())
        if not line or line[0] in "|#!:" or set(line) <= set("-=*_ "):
            continue
        line = re.sub(r"^(?:[-*+]|\d+\.|>)\s+", "", line)
        line = re.sub(r"`[^`]*`", "code", line)  # one word, whatever it holds
        found.append(line.replace("**", "").replace("*", ""))
    return found


def notebook_prose(script: str) -> str:
    """The Markdown cells of a notebook that is kept as a script, as one page."""
    cells = re.split(r"^# %%", script, flags=re.MULTILINE)
    told = [cell.splitlines()[1:] for cell in cells if cell.startswith(" [markdown]")]
    return "\n\n".join("\n".join(line[2:] for line in cell if line.startswith("#")) for cell in told)


def sentences(text: str) -> list[str]:
    """Every sentence of a page; what has fewer than three words is none."""
    split = [one.strip() for part in prose(text) for one in _splitter().segment(part)]
    return [one for one in split if len(one.split()) >= 3]


def median_words(text: str) -> float:
    """Median number of words of a sentence; 0 of a page without prose."""
    counts = [len(one.split()) for one in sentences(text)]
    return statistics.median(counts) if counts else 0.0


if __name__ == "__main__":
    import sys

    for name in sys.argv[1:]:
        page = Path(name).read_text(encoding="utf-8")
        page = notebook_prose(page) if name.endswith(".py") else page
        counts = sorted((len(s.split()) for s in sentences(page)), reverse=True)
        print(f"{median_words(page):5.1f} {len(counts):4d} longest {counts[:3]} {name}")
