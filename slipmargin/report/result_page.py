"""The page of one result: verdict, numbers, picture, table, what to do next, details; the same for all."""

from __future__ import annotations

from collections.abc import Sequence

from slipmargin.report.page import (
    Block,
    Bullets,
    Fact,
    Facts,
    Fold,
    Page,
    Picture,
    Row,
    Section,
    Table,
)
from slipmargin.report.text import labelled


def result_page(
    *,
    title: str,
    lead: str,
    good: bool,
    facts: Sequence[Fact],
    pictures: Sequence[Picture],
    tables: Sequence[Table],
    next_steps: Sequence[str],
    lines: Sequence[str],
    warnings: Sequence[str] = (),
) -> Page:
    """A page in the order that a reader asks.

    Parameters
    ----------
    lead : str
        The verdict in a sentence that a mechanic understands.
    tables : sequence of Table
        The first is shown, the others are folded.
    lines : sequence of str
        The lines that the command prints, ``label   text``.
    """
    shown: tuple[Block, ...] = tuple(tables[:1])
    folded = tuple(Fold(summary=table.caption, blocks=(table,)) for table in tables[1:])
    every = Table(
        caption="What the command prints",
        head=("what", "value"),
        rows=tuple(labelled(line) for line in lines),
        numbers=False,
    )
    said = (Bullets(items=tuple(warnings)),) if warnings else ()
    return Page(
        title=title,
        lead=lead,
        lead_kind="good" if good else "attention",
        sections=(
            Section(heading="The answer in numbers", blocks=(Facts(facts=tuple(facts)),)),
            Section(heading="Picture", blocks=(Row(pictures=tuple(pictures)),)),
            *((Section(heading="Table", blocks=(*shown, *folded)),) if tables else ()),
            Section(heading="What to do next", blocks=(*said, Bullets(items=tuple(next_steps)))),
            Section(heading="Details", blocks=(Fold(summary="Every line of the answer", blocks=(every,)),)),
        ),
    )
