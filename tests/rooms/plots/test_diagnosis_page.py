"""report.html: one self-contained page that says what was found, and parses as a tree."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from diagnoses import diagnosis, lead, unnamed, wheel_loads

from slipmargin.api.diagnose import DiagnosisResult
from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.result import Diagnosis, LeadSource, Rejected, Score, Verdict
from slipmargin.effects import Trace
from slipmargin.report import diagnosis_words as words
from slipmargin.report.diagnosis_evidence import evidence
from slipmargin.report.page import (
    Text,
)

VOID = {"meta", "br", "img", "input", "hr", "link"}
#: Two named effects, one of them without a name, each with rivals and a parameter at its bound.
RICH = (wheel_loads(confused_with=("load_transfer",)), unnamed())


class Tree(HTMLParser):
    """Checks nesting and gathers identifiers, references and text."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.ids: list[str] = []
        self.text: list[str] = []
        self.references: list[str] = []
        self.headings: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)
        for name, value in attrs:
            if name == "id" and value:
                self.ids.append(value)
            if name in ("href", "src", "xlink:href", "data", "action") and value:
                self.references.append(value)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open[-1] == tag, f"</{tag}> closes <{self.open[-1:]}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("style",):
            self.text.append(data)
            if self.open[-1] == "h2":
                self.headings.append(data)


def read(text: str) -> Tree:
    tree = Tree()
    tree.feed(text)
    tree.close()
    assert tree.open == []
    return tree


def text_of(d: Diagnosis) -> str:
    text = files_of(d)["report.html"]
    assert isinstance(text, str)
    return text


def files_of(d: Diagnosis) -> dict[str, str | bytes]:
    change = limits_change(d.recipe, d.corrected, d.surface)
    return DiagnosisResult(diagnosis=d, change=change).files()


@pytest.fixture(scope="module")
def rich() -> str:
    return text_of(diagnosis(findings=RICH))


def test_page_is_self_contained(rich: str) -> None:
    tree = read(rich)
    assert all(r.startswith(("#", "data:image/png;base64,")) for r in tree.references), "fetches something"
    assert "<script" not in rich and "@import" not in rich and "http-equiv" not in rich
    outside = set(re.findall(r"https?://[^\s\"'<]+", rich))
    assert outside <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}  # names, not addresses
    used = re.findall(r"url\(([^)]*)\)", rich)
    assert used and all(u.startswith("#") for u in used)


def test_identifiers_are_unique_and_every_reference_is_met(rich: str) -> None:
    tree = read(rich)
    assert len(tree.ids) == len(set(tree.ids))
    wanted = set(re.findall(r"url\(#([^)]*)\)", rich)) | {r[1:] for r in tree.references if r.startswith("#")}
    assert wanted and wanted <= set(tree.ids)


def test_page_can_be_heard(rich: str) -> None:
    assert '<html lang="en">' in rich and "<title>" in rich
    assert rich.count("<h1>") == 1
    assert rich.count('<svg role="img" aria-label="') == rich.count("<figure>") == 5
    assert rich.count("<figcaption>") == 5
    assert rich.count("<caption>") == rich.count("<table") > 5
    assert 'name="viewport"' in rich and "prefers-color-scheme: dark" in rich and "@media print" in rich


def test_page_tells_the_whole_story(rich: str) -> None:
    tree = read(rich)
    said = " ".join(" ".join(tree.text).split())
    assert tree.headings == [
        "The answer in numbers",
        "What was measured",
        "What did not fit",
        "Why: the candidates",
        "The evidence: runs that no fit has seen",
        "What was found",
        "What it changes",
        "What to do next",
        "Details",
    ]
    for part in (
        "19.2 → 0.6 mm",
        "The model lacks wheel_loads",
        "6 runs of 3 s",
        "0.5 mm in x",
        "estimated",
        "4 outlying samples",
        "in trial-02 at 1.25 s",
        "the residual map does not support",
        "cannot tell them apart",
        "p ≤ 0.001",
        "41",
        "load_transfer",
        "0.0120 (0.0115 … 0.0125)",
        "load_fraction1",
        "at the edge of its range",
        "Doubt",
        "weigh the wheels",
        "corrected.toml",
        "unnamed_position.c3",
        "Planned anew it takes",
        "a remark about the log",
        "812",
    ):
        assert part in said, part


def test_no_missing_effect_is_said_plainly() -> None:
    tree = read(text_of(diagnosis(Verdict.NO_MISSING_EFFECT)))
    said = " ".join(" ".join(tree.text).split())
    assert "No missing effect" in said and "Nothing. These runs give no reason" in said
    assert "What was found" not in tree.headings and "How it fits" in tree.headings
    assert "→" not in said.split("What was measured")[0]  # one number, no before and after


def test_unexplained_leads_on() -> None:
    said = " ".join(" ".join(read(text_of(diagnosis(Verdict.UNEXPLAINED))).text).split())
    assert "Unexplained" in said and "The residual follows the place on the floor: look there first" in said
    assert "To confirm or refute it, repeat one manoeuvre with the same heading in different places" in said
    assert words.VARIABLES[Trace.CONSTANT_FORCE] in said and "Do not trust the limits" in said
    nothing = diagnosis(Verdict.UNEXPLAINED, steps=(), where=(), events=(), excitation=(), leads=(), map=())
    bare = " ".join(read(text_of(nothing)).text)
    assert "Nothing could be tried" in bare and "No candidate was tried" in bare
    assert "follows no measured variable significantly" in bare
    unproved = diagnosis(Verdict.UNEXPLAINED, leads=(lead(source=LeadSource.FIT),))
    assert "First to look at, without proof: the place on the floor" in words.verdict_sentence(unproved)


def test_what_was_proposed_and_failed_is_shown_with_the_reason() -> None:
    no = Rejected(
        labels=("friction_coefficients",),
        failures=("on runs that nothing has seen chi goes from 52 to 55.6",),
        chi_before=52.0,
        chi_after=55.6,
    )
    said = " ".join(" ".join(read(text_of(diagnosis(Verdict.UNEXPLAINED, rejected=(no,)))).text).split())
    assert "Proposed by the search, and not claimed" in said and "chi goes from 52 to 55.6" in said


def test_what_remains_is_named_by_its_variable() -> None:
    def said(d: Diagnosis) -> str:
        return " ".join(block.text for block in evidence(d) if isinstance(block, Text))

    left = diagnosis(after=Score(rmse_position_m=2e-3, rmse_heading_rad=5e-3, chi=1.6))
    strong = replace(left, map_after=left.map)
    assert "What remains (chi 1.6) follows the robot's acceleration" in said(strong)
    assert "follows none of the variables of the residual map significantly" in said(left)
    assert "What remains" not in said(diagnosis())


def test_the_verdict_never_says_more_than_the_errors() -> None:
    part = diagnosis(after=Score(rmse_position_m=8e-3, rmse_heading_rad=0.03, chi=10.0))
    assert words.verdict_sentence(part).startswith("Found in part: the model lacks wheel_loads")
    assert "still 10 times the noise" in words.verdict_sentence(part) and not words.certain(part)
    grown = diagnosis(after=Score(rmse_position_m=0.048, rmse_heading_rad=0.07, chi=30.0))
    assert "falls" not in words.verdict_sentence(grown)
    assert words.certain(diagnosis()) and words.certain(diagnosis(Verdict.NO_MISSING_EFFECT))
    rival = diagnosis(findings=(wheel_loads(confused_with=("load_transfer",)),))
    assert "wheel_loads or load_transfer (these runs cannot tell them apart)" in words.verdict_sentence(rival)
    assert not words.certain(rival)
    doubtful = wheel_loads(name="unnamed_wheel_load", doubts=("shift_x_m ended at its edge",))
    assert not words.certain(diagnosis(findings=(doubtful,)))
    assert "The name `wheel_loads` is not claimed" in " ".join(
        block.text for block in evidence(diagnosis(findings=(doubtful,))) if isinstance(block, Text)
    )
