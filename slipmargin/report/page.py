"""One self-contained HTML page: style and pictures inside, no script, nothing fetched.

A page is data (frozen blocks); :func:`html` writes it.  It reads well on a telephone, in the dark, on
paper and by a screen reader: real headings, table heads, captions, and a text for each picture.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import final
from zlib import crc32

from slipmargin.report.page_style import CSS, FIGURE_COLOURS
from slipmargin.report.text import labelled


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """A paragraph; `words in backticks` are set as code."""

    text: str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Bullets:
    """A list, numbered where the order matters."""

    items: tuple[str, ...]
    numbered: bool = False


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of cells under a head; every column but the first is right-aligned where ``numbers``."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: bool = True


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """One large number: what it is, its value, a note beneath."""

    label: str
    value: str
    note: str = ""


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """Facts side by side."""

    facts: tuple[Fact, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Image:
    """A drawn figure: SVG text, width [inches] and, where it gets a file of its own, PNG bytes."""

    svg: str
    width_in: float
    png: bytes | None = None


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """An image, the name of its own file, what it shows for a reader who cannot see it, and its caption."""

    name: str
    image: Image
    alt: str
    caption: str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Pictures side by side, one below the other where the window is narrow."""

    pictures: tuple[Picture, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Code:
    """Text to copy, as it is."""

    text: str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Fold:
    """Details that a reader opens when wanted; open on paper."""

    summary: str
    blocks: tuple[Block, ...]


Block = Text | Bullets | Table | Facts | Picture | Row | Code | Fold


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A heading and what stands under it."""

    heading: str
    blocks: tuple[Block, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A title, the answer in one sentence, sections, and a last line."""

    title: str
    lead: str
    sections: tuple[Section, ...]
    foot: str = ""
    lead_kind: str = "plain"  #: "good", "attention" or "plain": the colour of the bar beside the lead


def html(page: Page) -> str:
    """The page's text (UTF-8), the same for the same content."""
    pictures = [0]
    body = [
        f"<header><h1>{_rich(page.title)}</h1>",
        f'<p class="lead {escape(page.lead_kind)}">{_rich(page.lead)}</p>',
        "</header>",
        "<main>",
    ]
    for number, section in enumerate(page.sections, 1):
        body.append(
            f'<section aria-labelledby="s{number}">\n<h2 id="s{number}">{_rich(section.heading)}</h2>'
        )
        body += [_block(block, pictures) for block in section.blocks]
        body.append("</section>")
    body.append("</main>")
    if page.foot:
        body.append(f"<footer>{_rich(page.foot)}</footer>")
    return (
        "<!DOCTYPE html>\n"
        '<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{escape(page.title.replace('`', ''))}</title>\n<style>{CSS}</style>\n</head>\n<body>\n"
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    )


def _block(block: Block, pictures: list[int]) -> str:
    if isinstance(block, Text):
        return f"<p>{_rich(block.text)}</p>"
    if isinstance(block, Bullets):
        tag = "ol" if block.numbered else "ul"
        return f"<{tag}>" + "".join(f"<li>{_rich(item)}</li>" for item in block.items) + f"</{tag}>"
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Facts):
        return '<dl class="facts">' + "".join(map(_fact, block.facts)) + "</dl>"
    if isinstance(block, Code):
        return f'<pre tabindex="0">{escape(block.text)}</pre>'
    if isinstance(block, Row):
        return '<div class="row">' + "\n".join(_block(one, pictures) for one in block.pictures) + "</div>"
    if isinstance(block, Fold):
        inside = "\n".join(_block(b, pictures) for b in block.blocks)
        return f"<details><summary>{_rich(block.summary)}</summary>\n{inside}\n</details>"
    pictures[0] += 1
    drawn = inline(block.image, f"p{pictures[0]}", block.alt)
    return (
        f'<figure>\n<div class="plot" tabindex="0">{drawn}</div>\n'
        f"<figcaption>{_rich(block.caption)}</figcaption>\n</figure>"
    )


#: What no narrow window should have to show in one line.
_LONG_WORD, _SHORT_NAME = re.compile(r"\S{15,}"), re.compile(r"\w+-\d+")
#: A picture below the first width is shown whole in a window of 400 px; then it is at least so wide [px].
WIDE, NARROW = 620.0, 250.0


def _fact(fact: Fact) -> str:
    note = f'<dd class="note">{_rich(fact.note)}</dd>' if fact.note else ""
    return f"<div><dt>{_rich(fact.label)}</dt><dd>{_rich(fact.value)}</dd>{note}</div>"


def _table(table: Table) -> str:
    kind = ' class="numbers"' if table.numbers else ""
    head = "".join(f'<th scope="col"{_long(cell)}>{_rich(cell)}</th>' for cell in table.head)
    rows = "".join(
        "<tr>"
        + f'<th scope="row"{_long(row[0])}>{_rich(row[0])}</th>'
        + "".join(f"<td{_long(cell)}>{_rich(cell)}</td>" for cell in row[1:])
        + "</tr>\n"
        for row in table.rows
    )
    return (
        f'<div class="wide" tabindex="0"><table{kind}><caption>{_rich(table.caption)}</caption>\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>{rows}</tbody></table></div>"
    )


def _long(cell: str) -> str:
    """The class of a cell that a narrow window must break, or may not: a long word, or a short ``run-1``."""
    if _LONG_WORD.search(cell):
        return ' class="long"'
    return ' class="whole"' if _SHORT_NAME.fullmatch(cell) else ""


def _rich(text: str) -> str:
    kept = re.sub(r"(?<=\d) (?=[%°N]|mm?\b|m/s|rad|mrad)", "\u00a0", escape(text, quote=False))
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", kept)


def inline(image: Image, prefix: str, alt: str) -> str:
    """An image as SVG inside a page, with identifiers of its own, named for a screen reader."""
    text = image.svg[image.svg.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{prefix}-", text)
    text = re.sub(r'style="[^"]*"', lambda found: _COLOUR.sub(_variable, found[0]), text)
    width = 96.0 * image.width_in  # CSS pixels an inch
    least = min(0.55 * width, NARROW) if width < WIDE else 0.55 * width
    size = f"min-width:{round(least)}px;max-width:{round(1.15 * width)}px"
    head = f'<svg role="img" aria-label="{escape(alt)}" style="{size}"'
    text = re.sub(r"<svg\b", head, text, count=1)
    return text.strip()


#: A colour inside a style of a figure.
_COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b")


def _variable(found: re.Match[str]) -> str:
    """A colour of the house's figures as the variable that follows light and dark; others stay."""
    name = FIGURE_COLOURS.get(found[0].lower())
    return found[0] if name is None else f"var({name}, {found[0]})"


def pictures(page: Page) -> dict[str, bytes]:
    """Every picture of a page that has PNG bytes: file name → bytes."""
    found: dict[str, bytes] = {}

    def gather(blocks: tuple[Block, ...]) -> None:
        for block in blocks:
            if isinstance(block, Fold):
                gather(block.blocks)
            elif isinstance(block, Row):
                gather(block.pictures)
            elif isinstance(block, Picture) and block.image.png is not None:
                found[f"{block.name}.png"] = block.image.png

    for section in page.sections:
        gather(section.blocks)
    return found


def cell(title: str, lines: Sequence[str], image: Image | None) -> str:
    """A result as a notebook shows it: a table of labelled lines, and the picture beneath."""
    left = 'style="text-align:left"'
    rows = "".join(
        f"<tr><th {left}>{escape(label)}</th><td {left}>{escape(text)}</td></tr>"
        for label, text in map(labelled, lines)
    )
    drawn = "" if image is None else inline(image, f"c{crc32(image.svg.encode()):08x}", title)
    return f"<div><table><caption>{escape(title)}</caption><tbody>{rows}</tbody></table>{drawn}</div>"
