"""A diagnosis of pulls as sentences, as plain data (``report.json``) and as a page."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.pull_diagnosis import PullDiagnosis
from slipmargin.diagnosis.pull_next import NextPull
from slipmargin.diagnosis.pull_unseen import PullScore
from slipmargin.diagnosis.result import Verdict
from slipmargin.report import diagnosis_json as plain, diagnosis_words as words
from slipmargin.report.diagnosis_details import candidates, limits
from slipmargin.report.page import (
    Block,
    Bullets,
    Fact,
    Facts,
    Fold,
    Image,
    Page,
    Picture,
    Section,
    Table,
    Text,
)
from slipmargin.report.text import two_digits

_KIND = {Verdict.EFFECT_FOUND: "good", Verdict.NO_MISSING_EFFECT: "good", Verdict.UNEXPLAINED: "attention"}
_NOISE = {
    "stated": "as stated with the data",
    "repeats": "from repeated pulls",
    "neighbours": "from differences between neighbouring orientations",
    "residual": "from what the model found leaves of all pulls",
}


def verdict_sentence(d: PullDiagnosis) -> str:
    """The answer in one sentence."""
    if d.verdict is Verdict.NO_MISSING_EFFECT:
        return (
            f"No missing effect: the model predicts {len(d.force_N)} pulls as well as their scatter allows "
            f"({d.before.rms_N:.3g} N root mean square, chi {d.before.chi:.3g}; 1 is pure noise)."
        )
    if d.verdict is Verdict.UNEXPLAINED:
        return (
            f"Unexplained: the model misses the pulls by {d.before.rms_N:.3g} N (root mean square, chi "
            f"{d.before.chi:.3g}; 1 is pure noise), and no candidate predicts orientations that were left "
            "out clearly better."
        )
    found = words.listed([f"{f.name} (depends on {words.VARIABLES[f.traced_to]})" for f in d.findings])
    return (
        f"The model lacks {found}; with {'it' if len(d.findings) == 1 else 'them'} the error on orientations "
        f"left out of the search falls from {d.before.rms_N:.3g} N to {d.after.rms_N:.3g} N (chi "
        f"{d.before.chi:.3g} to {d.after.chi:.3g})."
    )


def next_sentence(pull: NextPull) -> str:
    """One proposal: the robot's orientation, the pull's direction, and what it is good for."""
    phi, way = math.degrees(pull.phi_rad), math.degrees(pull.direction_rad)
    where = f"robot at φ = {phi:.0f}°, pulled along {way:.0f}° of the floor"
    if pull.separates:
        one, other = pull.separates
        return f"{where}: {one} and {other} differ there by {pull.apart_N:.3g} N"
    less = 100.0 * (1.0 - pull.factor)
    return f"{where}: narrows the interval of {pull.narrows} by {less:.{0 if less >= 10.0 else 1}f} %"


def summary_lines(d: PullDiagnosis, change: LimitsChange) -> list[str]:
    """What the command prints: verdict, effects, error and limits before and after, the next pulls."""
    lines = [f"{d.verdict.value}: {verdict_sentence(d)}"]
    for f in d.findings:
        values = ", ".join(words.interval(e) for e in f.parameters[:4])
        lines.append(
            f"found    {f.name} (traced to {f.traced_to.value}; {words.p_words(f.p_value)} among "
            f"{f.candidates_tried} candidates): {values}"
        )
        lines += [f"         cannot be told apart from {name} by these pulls" for name in f.confused_with]
    arrow = f" → {_error(d.after)}" if d.findings else ""
    lines.append(f"error    {_error(d.before)}{arrow} on orientations left out")
    lines += words.pull_lines(change)
    if d.verdict is not Verdict.EFFECT_FOUND:
        without = d.steps[0].chi_before  # counted as that of a lead, unlike the error's chi
        lines += [f"lead     {x.label} (chi {without:.3g} → {x.chi:.3g})" for x in d.leads[:3]]
    if d.verdict is not Verdict.NO_MISSING_EFFECT:
        lines += [f"next     {next_sentence(p)}" for p in d.next_pulls]
    lines += [f"note     {remark}" for remark in d.remarks]
    return lines


def _error(score: PullScore) -> str:
    return f"{score.rms_N:.3g} N (chi {score.chi:.3g})"


def report(d: PullDiagnosis, change: LimitsChange) -> dict[str, Any]:
    """Everything the report holds, as plain values; what only runs show is null."""
    wheels = tuple(wheel.name for wheel in d.recipe.robot.wheels)
    return {
        "schema": plain.SCHEMA,
        "verdict": d.verdict.value,
        "data_set": d.data_set,
        "robot": d.recipe.robot.name,
        "surface": d.surface,
        "judged_on": "pulls",
        "noise": {"force_N": d.sigma_N},
        "noise_estimated": d.noise_from != "stated",
        "noise_from": d.noise_from,
        "cross_validated": True,
        "before": _score(d.before),
        "after": _score(d.after),
        "p_value": d.p_value,
        "effects": [plain.effect_row(f, wheels) for f in d.findings],
        "leads": [
            {
                "traced_to": x.traced_to.value,
                "name": x.label if x.named else None,
                "label": x.label,
                "chi": x.chi,
                "evidence": {"chi_before": d.steps[0].chi_before, "chi_after": x.chi},
            }
            for x in d.leads
        ],
        "found_in": d.found_in,
        "folds": d.folds,
        "limits": {"before": plain.limits_row(change.before), "after": plain.limits_row(change.after)},
        "limit_curves": plain.curves_of(change),
        "pulls": {
            "count": len(d.force_N),
            "settings": d.settings,
            "phi_rad": d.phi_rad,
            "force_N": d.force_N,
            "before_N": d.before_N,
            "after_N": d.after_N,
        },
        "next_pulls": [
            {
                "phi_rad": p.phi_rad,
                "direction_rad": p.direction_rad,
                "separates": p.separates,
                "apart_N": p.apart_N if p.separates else None,
                "narrows": p.narrows or None,
                "factor": None if p.separates else p.factor,
            }
            for p in d.next_pulls
        ],
        "steps": [plain.step_row(s) for s in d.steps],
        "remarks": d.remarks,
    }


def _score(score: PullScore) -> dict[str, float | None]:
    return {
        "rmse_position_m": None,
        "rmse_heading_rad": None,
        "rms_force_N": score.rms_N,
        "mean_force_N": score.mean_N,
        "chi": score.chi,
    }


def page(d: PullDiagnosis, change: LimitsChange, images: Mapping[str, Image]) -> Page:
    """The page as data: the answer, the pulls before and after, what was found, what to pull next.

    Parameters
    ----------
    images : mapping
        The drawn figures by name, as :func:`slipmargin.plots.pulls.figures` names them.
    """
    sections = [
        Section(heading="The answer in numbers", blocks=(_facts(d, change),)),
        Section(heading="Measured and predicted pulls", blocks=_measured(d, images)),
    ]
    if d.findings:
        sections.append(Section(heading="What was found", blocks=_found(d)))
        sections.append(Section(heading="What it changes", blocks=limits(change, images)))
    elif d.verdict is Verdict.UNEXPLAINED:
        sections.append(Section(heading="Leads", blocks=_leads(d)))
    sections.append(Section(heading="What to do next", blocks=_next(d)))
    sections.append(Section(heading="Details", blocks=_details(d)))
    return Page(
        title=f"Diagnosis of {d.recipe.robot.name} on {d.surface}: pulls of {d.data_set}",
        lead=verdict_sentence(d),
        lead_kind=_KIND[d.verdict],
        sections=tuple(sections),
        foot="Written by slipmargin diagnose. chi is the root mean square of residual over noise: 1 is pure "
        "noise.",
    )


def _facts(d: PullDiagnosis, change: LimitsChange) -> Facts:
    def pair(before: float, after: float, unit: str) -> str:
        text = f"{before:.3g} → {after:.3g} {unit}" if d.findings else f"{before:.3g} {unit}"
        return text.strip()

    unseen = "orientations left out of the search"
    return Facts(
        facts=(
            Fact(label="Force error", note=unseen, value=pair(d.before.rms_N, d.after.rms_N, "N")),
            Fact(
                label="Mean, measured minus predicted",
                note=unseen,
                value=pair(d.before.mean_N, d.after.mean_N, "N"),
            ),
            Fact(
                label="Error over noise (chi)",
                value=pair(d.before.chi, d.after.chi, ""),
                note="1 is pure noise",
            ),
            Fact(
                label="Weakest pull before slip",
                note=f"{words.over_orientations(change)}, on rollers",
                value=pair(change.before.f_max_min_N, change.after.f_max_min_N, "N"),
            ),
        )
    )


def _measured(d: PullDiagnosis, images: Mapping[str, Image]) -> tuple[Block, ...]:
    said = (
        f"{len(d.force_N)} pulls in {d.settings} settings; noise of one pull {two_digits(d.sigma_N)} N, "
        f"{_NOISE[d.noise_from]}. Every setting was left out of a search once ({d.folds} searches) and "
        "predicted with what was found without it."
    )
    if d.findings:
        said += f" {d.found_in} of the {d.folds} searches found the same effects."
    return (
        Text(text=said),
        Picture(
            name="pulls",
            image=images["pulls"],
            alt="Measured and predicted pulls over the robot's orientation, before and after",
            caption="Points: measured. Red: the model as believed. Blue: predicted by what was found without "
            "that orientation."
            if d.findings
            else "Points: measured. Red: the model as believed.",
        ),
    )


def _found(d: PullDiagnosis) -> tuple[Block, ...]:
    rows = tuple(
        (f"`{f.label}`", e.name, words.number(e) + words.edge(e), e.unit)
        for f in d.findings
        for e in (*f.parameters, *f.derived)
    )
    confused = tuple(
        f"These pulls cannot tell `{f.name}` from `{name}`." for f in d.findings for name in f.confused_with
    )
    return (
        *(Text(text=f"`{f.name}`: {words.meaning(f)} {f.equation}") for f in d.findings),
        Table(
            caption="Parameters with 95 % intervals, and what follows from them",
            head=("effect", "parameter", "value (interval)", "unit"),
            rows=rows,
        ),
        *((Bullets(items=tuple(dict.fromkeys(confused))),) if confused else ()),
    )


def _leads(d: PullDiagnosis) -> tuple[Block, ...]:
    rows = tuple((words.VARIABLES[x.traced_to], f"`{x.label}`", f"{x.chi:.3g}") for x in d.leads)
    if not rows:
        return (Text(text="No candidate predicts the pulls better than the model as believed."),)
    return (
        Table(
            caption=f"Candidates by variable; without any of them chi is {d.steps[0].chi_before:.3g}",
            head=("variable", "best candidate", "chi on pulls left out"),
            rows=rows,
        ),
    )


def _next(d: PullDiagnosis) -> tuple[Block, ...]:
    items = [f"Confirm `{f.name}`: {f.confirm}." for f in d.findings]
    if d.verdict is not Verdict.NO_MISSING_EFFECT:
        items += [f"Pull next: {next_sentence(p)}." for p in d.next_pulls]
    if d.findings:
        items.append(
            "Use `corrected.toml` in place of the robot file: every command accepts it "
            f"(`slipmargin sweep corrected.toml --surface {d.surface}`)."
        )
    if d.verdict is Verdict.UNEXPLAINED:
        items.append("Do not trust the limits of this model beyond the error shown above.")
    return (Bullets(items=tuple(items), numbered=True) if items else Text(text="Nothing: the limits stand."),)


def _details(d: PullDiagnosis) -> tuple[Block, ...]:
    order = np.lexsort((d.force_N, d.phi_rad))
    rows = tuple(
        (
            f"{math.degrees(d.phi_rad[k]):.1f}",
            f"{d.force_N[k]:.3f}",
            f"{d.before_N[k]:.3f}",
            f"{d.after_N[k]:.3f}",
        )
        for k in order
    )
    blocks: list[Block] = [
        Fold(
            summary="Every pull",
            blocks=(
                Table(
                    caption="Force in newtons; predicted without the setting of the pull",
                    head=("φ [deg]", "measured", "as believed", "corrected"),
                    rows=rows,
                ),
            ),
        )
    ]
    blocks += candidates(d.steps, "Candidates of round {}", "chi on pulls left out")
    if d.remarks:
        blocks.append(Bullets(items=d.remarks))
    return tuple(blocks)
