"""A design study as one self-contained page: the answer, figures, best by objective, the designs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from slipmargin.report.design import best_at, change, in_words, label, named
from slipmargin.report.page import (
    Bullets,
    Fact,
    Facts,
    Fold,
    Image,
    Page,
    Picture,
    Row,
    Section,
    Table,
    Text,
)
from slipmargin.study.influence import Influence
from slipmargin.study.objectives import BY_NAME
from slipmargin.study.robust import Robust
from slipmargin.study.study import Study

#: What the lines of the answer are called on a page.
_LABELS = {
    "own": "the file’s own",
    "between": "between the designs that were tried",
    "influence": "what changes it most",
}
#: What each picture shows.
_CAPTIONS = {
    "goal": "What was asked for, over what was varied.",
    "other": "Another objective, over the same.",
    "pulls": "The pull before a wheel slips, by its direction, for a few designs.",
    "front": "Two objectives at once. A design on the line is beaten by no other in both.",
}
#: Designs listed on the page; more belong in the CSV file.
LISTED = 200


def design_page(
    study: Study,
    front: Sequence[str],
    robust: Robust | None,
    influences: Sequence[Influence],
    summary: Sequence[tuple[str, str]],
    images: Mapping[str, Image],
) -> Page:
    """The page of a study: the best design, why, and what else was looked at."""
    goal, best, design = study.problem.objective, study.best(), study.problem.base
    value, own = float(study.columns[goal.name][best]), study.own[goal.name]
    at = in_words(best_at(study, goal.name))
    facts = [
        Fact(label="Best design", value=at),
        Fact(
            label=goal.meaning[:1].upper() + goal.meaning[1:],
            value=f"{value:.4g} {goal.unit}".removesuffix(" 1"),
        ),
    ]
    if math.isfinite(own) and own > 0.0:
        facts.append(
            Fact(
                label="Against the file’s own",
                value=change(value, own),
                note=f"from {own:.4g}",
            )
        )
    said = f"best design {at} with {value:.4g} {goal.unit} of {goal.meaning}"
    figures = Row(
        pictures=tuple(
            Picture(
                name=f"study-{name}", image=image, caption=_CAPTIONS[name], alt=f"{_CAPTIONS[name]} {said}"
            )
            for name, image in images.items()
        )
    )
    sections = [
        Section(
            heading="The answer",
            blocks=(
                Facts(facts=tuple(facts)),
                Bullets(items=tuple(f"{_LABELS.get(k, k)}: {in_words(text)}" for k, text in summary)),
            ),
        ),
        Section(heading="Figures", blocks=(figures,)),
        Section(heading="Best by objective", blocks=(_by_objective(study),)),
    ]
    if influences:
        table = _influence_table(influences, goal.meaning)
        sections.append(Section(heading="What changes it most", blocks=(table,)))
    sections.append(Section(heading="Designs", blocks=(_designs(study, front, robust),)))
    return Page(
        title=f"Design study of {design.robot.name}",
        lead=f"On {design.surface}: {_is_best(at)} for “{goal.meaning}”.",
        sections=tuple(sections),
        foot="Pulls are shares of m g. Limits in motion: full drag, on rollers unless named "
        "otherwise; they are not the static pull divided by the mass.",
    )


def _by_objective(study: Study) -> Table:
    rows = [
        (
            f"{BY_NAME[name].meaning} `{name}`",
            BY_NAME[name].unit,
            in_words(best_at(study, name)),
            _number(float(study.columns[name][study.best(name)])),
            _number(study.own[name]),
        )
        for name in study.objectives
    ]
    return Table(
        caption="For each objective, with its name for `--objective`, the best design and the file’s own",
        head=("objective", "unit", "best at", "value", "file’s own"),
        rows=tuple(rows),
        numbers=False,
    )


def _influence_table(influences: Sequence[Influence], meaning: str) -> Table:
    def told(i: Influence) -> tuple[str, str]:
        if i.peak:
            return "–", f"{'less' if i.below < i.here else 'more'} with any other"
        return _number(i.slope), ""

    rows = tuple((label(i.key), _number(i.value), i.unit, *told(i)) for i in influences)
    return Table(
        caption=f"What changes {meaning}, at the best design",
        head=("quantity", "value", "unit", "change per unit", ""),
        rows=rows,
    )


def _designs(study: Study, front: Sequence[str], robust: Robust | None) -> Fold | Text:
    if len(study.values) > LISTED:
        return Text(text=f"{len(study.values)} designs: the table is in the CSV file (`--out`).")
    names = [name for name in study.columns if name in BY_NAME]
    on = study.front(front)
    extra = () if robust is None else ("worst case",)
    rows = tuple(
        (
            _design(study, i),
            *(_number(float(study.columns[n][i])) for n in names),
            *(() if robust is None else (_number(float(robust.value[i])),)),
            study.impossible.get(i, "on the front" if on[i] else ""),
        )
        for i in range(len(study.values))
    )
    return Fold(
        summary=f"All {len(study.values)} designs",
        blocks=(Table(caption="One row a design", head=("design", *names, *extra, ""), rows=rows),),
    )


def _is_best(at: str) -> str:
    if at == "every design alike":
        return "it makes no difference"
    return f"{at} is best"


def _design(study: Study, row: int) -> str:
    return in_words(named(study.keys, study.values[row]))


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.4g}"
