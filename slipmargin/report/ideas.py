"""The words and the page of several robots side by side: a sentence a question, then one table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from slipmargin.physics.convention import Convention
from slipmargin.report.page import Fact, Image, Page, Picture, Table
from slipmargin.report.result_page import result_page
from slipmargin.report.text import two_digits
from slipmargin.study.ideas import (
    PLACE,
    QUESTIONS,
    START,
    WORTH,
    Idea,
    Place,
    Question,
    lacks_torque,
    ranking,
)


def verdicts(ideas: Sequence[Idea]) -> list[tuple[str, str]]:
    """A sentence for each question: who is best, or who are alike."""
    return [(question.word, _verdict(ideas, question)) for question in QUESTIONS]


def _verdict(ideas: Sequence[Idea], question: Question) -> str:
    found = ranking(ideas, question)
    if found is None:
        why = (
            "no robot's loads follow its centre of mass" if question.key == PLACE else "no robot has a limit"
        )
        return f"not compared: {why}"
    best = ideas[found.order[0]]
    value = best.values[question.key]
    if value <= 0.0:
        return f"no idea can: with each of them {_why_none(best, question)}"
    if found.alike == 1:
        after = _next(ideas, found.order, question)
        return f"{best.name} is best: {_with_unit(value, question)} {question.meaning}{after}"
    level = [ideas[k] for k in sorted(found.order[: found.alike])]
    names = "all" if found.alike == len(ideas) else f"{_and([idea.name for idea in level])} are"
    low = min(idea.values[question.key] for idea in level)
    span = _number(value) if _number(low) == _number(value) else f"{_number(low)} to {_number(value)}"
    why = "; the uncertain friction makes more than they differ" if found.chance else ""
    return f"{names} alike: {span} {question.unit} {question.meaning}{why}"


def _next(ideas: Sequence[Idea], order: Sequence[int], question: Question) -> str:
    """How far behind the second is; nothing where there is none."""
    if len(order) < 2:
        return ""
    first, second = (ideas[k].values[question.key] for k in order[:2])
    name = ideas[order[1]].name
    if second <= 0.0:
        return f"; with {name} {_why_none(ideas[order[1]], question)}"
    if question.key == PLACE:
        return f"; {name} has {_number(second)} %"
    return f", {_percent(first / second)} more than {name}"


def _why_none(idea: Idea, question: Question) -> str:
    """Why an idea's value of a question is none."""
    if lacks_torque(idea, question):
        return "the motors have no torque left at half of their top speed"
    return "a wheel slips at constant speed already"


def moves(ideas: Sequence[Idea]) -> list[str]:
    """For each idea that would gain by it, where its centre of mass should go."""
    out = []
    for idea in ideas:
        place = idea.place
        if place is None or not math.isfinite(place.share):
            continue
        if place.best_m_s2 <= (1.0 + WORTH) * max(place.own_m_s2, 0.0):
            out.append(
                f"{idea.name}: no other place of the centre of mass gains {100.0 * WORTH:g} % of starting"
            )
            continue
        gain = (
            f"{_percent(place.best_m_s2 / place.own_m_s2)} more starting in the weakest direction"
            if place.own_m_s2 > 0.0
            else f"starting of {_number(place.best_m_s2)} m/s²"
        )
        way = _way(place, idea.design.robot.convention)
        out.append(f"{idea.name}: {gain} with the centre of mass {way}")
    return out


def _way(place: Place, convention: Convention) -> str:
    """``30 mm further back and 5 mm further left``."""
    right, ahead = convention.right_forward(
        place.best_m[0] - place.own_m[0], place.best_m[1] - place.own_m[1]
    )
    parts = [
        f"{abs(1e3 * step):.0f} mm further {words[0] if step > 0.0 else words[1]}"
        for step, words in ((float(ahead), ("forward", "back")), (float(right), ("right", "left")))
        if abs(step) >= 5e-4
    ]
    return " and ".join(parts) or "moved by less than a millimetre"


def table(ideas: Sequence[Idea]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and a row an idea; a star marks the best, or all that are alike."""
    stars = {
        (q.key, k)
        for q in QUESTIONS
        for found in [ranking(ideas, q)]
        if found is not None and ideas[found.order[0]].values[q.key] > 0.0
        for k in found.order[: found.alike]
    }
    head = ("idea", *(f"{q.word} [{q.unit}]" for q in QUESTIONS))
    rows = [
        (idea.name, *(_cell(idea, q) + (" *" if (q.key, k) in stars else "  ") for q in QUESTIONS))
        for k, idea in enumerate(ideas)
    ]
    return head, rows


def _cell(idea: Idea, question: Question) -> str:
    value, deviation = idea.values[question.key], idea.deviation(question.key)
    if not math.isfinite(value):
        return "none"
    if value <= 0.0:
        return "no torque" if lacks_torque(idea, question) else "slips"
    return _number(value) + (f" ± {two_digits(deviation)}" if deviation > 0.0 else "")


def ideas_page(
    ideas: Sequence[Idea], images: Mapping[str, Image], lines: Sequence[str], warnings: Sequence[str]
) -> Page:
    """The page that compares ideas: who is best at starting first."""
    said, (words, rows) = dict(verdicts(ideas)), table(ideas)
    # A row a question: few columns, so that a telephone shows it whole.
    cells = [words[1:], *(row[1:] for row in rows)]
    head = ("", *(row[0] for row in rows))
    floor = ideas[0].design.surface
    can = any(idea.values[START] > 0.0 for idea in ideas)
    facts = []
    for question in QUESTIONS:
        found = ranking(ideas, question)
        if found is not None and ideas[found.order[0]].values[question.key] > 0.0:
            names = _and([ideas[k].name for k in sorted(found.order[: found.alike])])
            value = _with_unit(ideas[found.order[0]].values[question.key], question)
            alike = "alike, up to " if found.alike > 1 else ""
            facts.append(Fact(label=question.word.capitalize(), value=names, note=f"{alike}{value}"))
    spread = (
        " ± and the lines on bars (two of them) are standard deviations by the uncertain friction."
        if any("±" in cell for row in cells for cell in row)
        else ""
    )
    steps = [f"Move the battery: {line}." for line in moves(ideas) if "no other place" not in line]
    if steps:
        steps.append("A battery that is a fifth of the whole mass must go five times as far.")
    steps.append(f"Look closer at one idea: `slipmargin bounds IDEA --surface {floor} --report page.html`.")
    return result_page(
        title=f"{len(ideas)} ideas on {floor}",
        lead=f"Starting: {said['starting']}.",
        good=can,
        facts=facts,
        pictures=tuple(
            Picture(
                name=q.key,
                image=images[q.key],
                alt=f"A bar an idea: {q.word}",
                caption=_caption(q),
            )
            for q in QUESTIONS
            if q.key in images
        ),
        tables=(
            Table(
                caption="A star marks the best, or all that are alike; in the pictures they are blue."
                + spread,
                head=head,
                rows=tuple(zip(*cells, strict=True)),
            ),
        ),
        next_steps=steps,
        lines=lines,
        warnings=warnings,
    )


def _caption(question: Question) -> str:
    if question.key == PLACE:
        return "Starting as it is, of what it would be with the battery in the best place: more is better."
    return f"{question.word.capitalize()} {question.meaning}: more is better."


def _and(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _with_unit(value: float, question: Question) -> str:
    return f"{_number(value)} {question.unit}"


def _number(value: float) -> str:
    return f"{value:.4g}"


def _percent(ratio: float) -> str:
    """How much more than one, with two digits: ``6.1 %``, ``150 %``."""
    return f"{two_digits(100.0 * (ratio - 1.0))} %"
