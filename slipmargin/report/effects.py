"""The catalogue of effects as Markdown: ``slipmargin effects list --markdown`` > ``docs/effects.md``."""

from __future__ import annotations

from collections.abc import Sequence

from slipmargin.effects.effect import Effect, WheelEffect
from slipmargin.report.text import columns

HEAD = """# Effects

Physics that a robot file may add to the paper's model (`[[effect]]` tables), and that
`slipmargin diagnose` looks for. Every effect does nothing at its null values. Parameters are in SI
units; bounds are what a file may hold. An effect that none of these explains is added as
`unnamed_<variable>`, in a general form over the variable it depends on.

(This page is made by `slipmargin effects list --markdown`; a test compares the two.)

| effect | depends on | what it says |
|---|---|---|"""


def one_line(effect: type[Effect]) -> str:
    """Name, variable and the first line of the law."""
    law = (effect.__doc__ or "").strip().splitlines()[0].rstrip(".")
    return f"{effect.name:<23}{effect.traced_to.value:<17}{law}"


def effect_lines(effect: type[Effect]) -> list[str]:
    """Law, source and parameters of an effect, as the terminal shows them."""
    return [
        f"{effect.name}: {' '.join((effect.__doc__ or '').split())}",
        f"source: {effect.source}",
        f"traced to: {effect.traced_to.value}; rewrites: {effect.part.value}",
        *(f"counts in: {where}" for where in _counts_in(effect)),
        f"to confirm it: {effect.confirm}",
        "",
        *columns(
            ("parameter", "unit", "low", "null", "high", "meaning"),
            [
                (p.name, p.unit, f"{p.low:g}", f"{p.null:g}", f"{p.high:g}", p.meaning)
                for p in effect.parameters
            ],
        ),
        "",
        "In a robot file (these values do nothing):",
    ]


def page_lines(effects: Sequence[type[Effect]]) -> list[str]:
    """Lines of the page."""
    page = HEAD.splitlines()
    page += [f"| [`{e.name}`](#{e.name}) | `{e.traced_to.value}` | {_cell(e.summary)} |" for e in effects]
    for effect in effects:
        page += _section(effect)
    return page


def _section(effect: type[Effect]) -> list[str]:
    rows = [
        f"| `{p.name}` | {_unit(p.unit)} | {p.low:g} … {p.high:g} | {p.null:g} | {_cell(p.meaning)} |"
        for p in effect.parameters
    ]
    law = (effect.__doc__ or "").replace("``", "").strip().splitlines()
    return [
        "",
        f"## {effect.name}",
        "",
        effect.summary,
        "",
        "```text",
        *(line.strip() for line in law),
        "```",
        "",
        "| parameter | unit | bounds | null | meaning |",
        "|---|---|---|---|---|",
        *rows,
        "",
        f"Traced to `{effect.traced_to.value}`; rewrites `{effect.part.value}`; {_wheels(effect)}.",
        "",
        *(line for where in _counts_in(effect) for line in (f"It counts in {where}.", "")),
        f"Source: {effect.source}.",
        "",
        f"To confirm it: {effect.confirm}.",
    ]


def _counts_in(effect: type[Effect]) -> list[str]:
    """Where an effect counts, where that is not in every command."""
    where = effect.counts_in or effect.part.counts_in
    return [where] if where else []


def _wheels(effect: type[Effect]) -> str:
    if issubclass(effect, WheelEffect):
        return "acts on the wheels that `wheels` names, all by default"
    return "acts on the whole robot"


def _unit(unit: str) -> str:
    return "–" if unit in ("", "1") else unit


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
