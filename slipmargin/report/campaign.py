"""What a campaign adds to the report of a diagnosis: groups, the evidence of each data set, its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from slipmargin.diagnosis.campaign import MemberResult
from slipmargin.diagnosis.result import Diagnosis, Finding
from slipmargin.report.diagnosis_words import number, pulls_sentence
from slipmargin.report.page import Section, Table, Text

_LOAD = "load_fraction_"


def belongs_to(finding: Finding) -> str:
    """``floor gray``, or the machine."""
    return finding.group or "the machine"


def lines(diagnosis: Diagnosis, members: Sequence[MemberResult]) -> list[str]:
    """The campaign in words: data sets, what each finding belongs to, and who shows it."""
    told = []
    for m in members:
        told.append(
            f"data set {m.member.name}: floor {m.member.floor}, loading {m.member.loading}, instrument "
            f"{m.member.instrument}; {_errors(m)}"
        )
        told += [f"         {sentence}" for sentence in _pulls(m)]
    for finding in diagnosis.findings:
        shown = ", ".join(
            f"{s.data_set} (chi {s.chi_without:.3g} without, {s.chi_with:.3g} with it)"
            for s in finding.shown_by
        )
        told.append(f"group    {finding.name} belongs to {belongs_to(finding)}; shown by {shown}")
        mass = _mass(finding, members)
        told += [
            f"         load of wheel {e.name.removeprefix(_LOAD)}: {kg:.2f} kg ({low:.2f} … {high:.2f})"
            for e in finding.derived
            if e.name.startswith(_LOAD)
            for kg, low, high in [(mass * e.value, mass * e.low, mass * e.high)]
        ]
    return told


def _mass(finding: Finding, members: Sequence[MemberResult]) -> float:
    names = {s.data_set for s in finding.shown_by}
    return next((m.member.recipe.robot.body.mass_kg for m in members if m.member.name in names), 0.0)


def _errors(m: MemberResult) -> str:
    one, two = m.drift_before, m.drift_after
    return (
        f"{_judged(m)}: displacement {100 * one.displacement:.3g} → "
        f"{100 * two.displacement:.3g} %, heading {np.rad2deg(one.heading_rad):.3g} → "
        f"{np.rad2deg(two.heading_rad):.3g} deg"
    )


def _judged(m: MemberResult) -> str:
    """The runs whose errors are told."""
    if not m.judged:
        return f"no run held out, errors of {m.runs} searched"
    return "1 run held out" if m.judged == 1 else f"{m.judged} runs held out"


def _pulls(m: MemberResult) -> tuple[str, ...]:
    """What the pull tests of a data set say, or why they say nothing."""
    if m.pulls is None:
        return m.missing
    return (f"{m.member.name}: {pulls_sentence(m.pulls)}",)


def section(diagnosis: Diagnosis, members: Sequence[MemberResult]) -> Section:
    """The campaign's part of the page."""
    sets = Table(
        caption="The data sets and their errors over whole runs",
        head=(
            "Data set",
            "Floor",
            "Loading",
            "Instrument",
            "Runs",
            "Errors of",
            "Displacement [%]",
            "Heading [deg]",
        ),
        rows=tuple(
            (
                m.member.name,
                m.member.floor,
                m.member.loading,
                m.member.instrument,
                str(m.runs),
                _judged(m),
                f"{100 * m.drift_before.displacement:.3g} → {100 * m.drift_after.displacement:.3g}",
                f"{np.rad2deg(m.drift_before.heading_rad):.3g} → {np.rad2deg(m.drift_after.heading_rad):.3g}",
            )
            for m in members
        ),
    )
    rows = tuple(
        (
            f.name,
            belongs_to(f),
            "; ".join(f"{e.name} = {number(e)}" for e in f.parameters),
            "; ".join(f"{s.data_set}: {s.chi_without:.3g} → {s.chi_with:.3g}" for s in f.shown_by),
        )
        for f in diagnosis.findings
    )
    head = ("Effect", "Belongs to", "Parameters", "chi without → with it")
    found = Table(caption="What was found, where, and who shows it", head=head, rows=rows)
    pulls = tuple(Text(text=sentence) for m in members for sentence in _pulls(m))
    return Section(heading="The campaign", blocks=(sets, *pulls, *((found,) if rows else ())))


def as_json(diagnosis: Diagnosis, members: Sequence[MemberResult]) -> dict[str, Any]:
    """The campaign's part of ``report.json``."""
    return {
        "data_sets": [
            {
                "name": m.member.name,
                "floor": m.member.floor,
                "loading": m.member.loading,
                "instrument": m.member.instrument,
                "runs": m.runs,
                "judged": m.judged,
                "errors_of": "held-out runs" if m.judged else "searched runs",
                "before": _row(m, after=False),
                "after": _row(m, after=True),
                **({} if m.pulls is None else {"pulls": asdict(m.pulls)}),
            }
            for m in members
        ],
        "groups": [
            {
                "effect": f.name,
                "belongs_to": belongs_to(f),
                "shown_by": [
                    {
                        "data_set": s.data_set,
                        "runs": s.runs,
                        "chi_without": s.chi_without,
                        "chi_with": s.chi_with,
                    }
                    for s in f.shown_by
                ],
            }
            for f in diagnosis.findings
        ],
    }


def _row(m: MemberResult, *, after: bool) -> dict[str, float]:
    score, drift = (m.after, m.drift_after) if after else (m.before, m.drift_before)
    return {
        "rmse_position_m": score.rmse_position_m,
        "rmse_heading_rad": score.rmse_heading_rad,
        "chi": score.chi,
        "displacement": drift.displacement,
        "heading_rad": drift.heading_rad,
    }
