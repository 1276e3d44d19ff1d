"""report.html: one self-contained page that says what was found, and parses as a tree."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from diagnoses import diagnosis, lead, trials, unnamed, wheel_loads
from matplotlib.figure import Figure

from slipmargin.api.diagnose import DiagnosisResult
from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.plan_change import PlanChange
from slipmargin.diagnosis.result import Diagnosis, Estimate, Event, LeadSource, Rejected, Score, Verdict
from slipmargin.diagnosis.separate import TRIALS, separating_trial, trace_of
from slipmargin.effects import Trace
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.plots.diagnosis import candidates_figure, held_out_figure
from slipmargin.plots.style import image
from slipmargin.report import diagnosis_words as words
from slipmargin.report.diagnosis_evidence import evidence
from slipmargin.report.page import (
    Bullets,
    Code,
    Fact,
    Facts,
    Fold,
    Page,
    Picture,
    Section,
    Table,
    Text,
    html,
    pictures,
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
        "as the data show it",
        "4 outlying samples",
        "in trial-02 at 1.25 s",
        "of which the residual map can say nothing",
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
    held = diagnosis(Verdict.UNEXPLAINED, leads=(lead(source=LeadSource.BORNE_OUT),))
    told = words.verdict_sentence(held)
    assert (
        "over the place on the floor holds on runs that it has not seen" in told
        and "no correction" not in told
    )
    page = " ".join(read(text_of(held)).text)
    (tried,) = re.findall(r"not borne out by unseen runs: ([^.]*)\.", page)
    assert words.VARIABLES[Trace.POSITION] not in tried and words.VARIABLES[Trace.CONSTANT_FORCE] in tried


def test_a_lead_that_chance_may_have_made_is_not_what_the_residual_follows() -> None:
    """With p = 0.55 it was said to follow a constant of one wheel, above a lead that was called weak."""
    weak = diagnosis(Verdict.UNEXPLAINED, leads=(lead(source=LeadSource.MAP, p_value=0.55),))
    said = words.verdict_sentence(weak)
    assert "No measured variable stands out; the place on the floor comes nearest." in said


def test_a_finding_on_one_wheel_says_which() -> None:
    """`found wheel_radius` was all that the command line said of a wheel that is smaller than the others."""
    found = diagnosis(Verdict.EFFECT_FOUND).findings[0]
    d = diagnosis(Verdict.EFFECT_FOUND, findings=(replace(found, wheels=("left",), confused_with=()),))
    assert f"The model lacks {found.name} of wheel left (depends" in words.verdict_sentence(d)
    form = replace(
        found, name="unnamed_wheel", label="unnamed_wheel: friction of wheel left", confused_with=()
    )
    d = diagnosis(Verdict.EFFECT_FOUND, findings=(form,))
    assert "The model lacks unnamed_wheel: friction of wheel left" in words.verdict_sentence(d)


def test_what_stands_out_near_the_noise_leads_on() -> None:
    found = diagnosis(Verdict.NO_MISSING_EFFECT, leads=(lead(),))
    said = " ".join(" ".join(read(text_of(found)).text).split())
    assert "The little that is left follows the place on the floor." in said and words.certain(found)
    assert "Nothing has to be done" in said and "To confirm or refute it, repeat one manoeuvre" in said


def test_errors_larger_than_noise_are_called_no_noise() -> None:
    slow = diagnosis(Verdict.UNEXPLAINED, before=Score(rmse_position_m=0.011, rmse_heading_rad=9e-3, chi=1.2))
    assert "as slowly as noise that lasts, but some are larger than it" in words.verdict_sentence(slow)
    assert "slowly" not in words.verdict_sentence(diagnosis(Verdict.UNEXPLAINED))
    far = diagnosis(Verdict.NO_MISSING_EFFECT, trials=trials(wrong=1.0))
    said = " ".join(" ".join(read(text_of(far)).text).split())
    assert "Nothing sticks out" not in said and "times the noise" in said


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
    # A search whose time is up maps nothing: a negative answer had been given.
    assert "What remains (chi 1.6) was not compared" in said(replace(left, map_after=()))


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
    many = diagnosis(findings=(wheel_loads(confused_with=("load_transfer", "push", *"abcde")),))
    said = words.verdict_sentence(many)  # eleven names stood in one sentence
    assert "wheel_loads or load_transfer or push or one of 5 others (these runs cannot tell" in said
    doubtful = wheel_loads(name="unnamed_wheel_load", doubts=("shift_x_m ended at its edge",))
    assert not words.certain(diagnosis(findings=(doubtful,)))
    # "Sliding friction is lower than sticking friction" stood beside a drag that grew.
    assert words.meaning(doubtful).endswith(
        "is written as wheel loads; its evidence does not carry the name."
    )
    assert "The name `wheel_loads` is not claimed" in " ".join(
        block.text for block in evidence(diagnosis(findings=(doubtful,))) if isinstance(block, Text)
    )


def test_the_time_of_an_event_is_found_in_a_long_file() -> None:
    """It was printed as 1.23e+04 s."""
    at = Event(trial="trial-02", t_s=12346.29, channel="x_m", size_sigma=40.0)
    assert "in trial-02 at 12346.29 s" in text_of(diagnosis(events=(at,)))


@pytest.mark.parametrize("verdict", [Verdict.UNEXPLAINED, Verdict.NO_MISSING_EFFECT])
@pytest.mark.parametrize("parts", [1, 2])
def test_of_one_run_nothing_is_said_to_be_held_out(verdict: Verdict, parts: int) -> None:
    """The page spoke of runs that no fit has seen, and of cross-validation over one run."""
    own = tuple(replace(t, held_out=False) for t in trials(parts))
    one = diagnosis(verdict, trials=own, held_out=(), cross_validated=False, leads=())
    said = " ".join(" ".join(read(text_of(one)).text).split())
    change = limits_change(one.recipe, one.corrected, one.surface)
    said += " ".join(words.summary_lines(one, change))
    for wrong in ("held-out", "not seen", "no fit has seen", "cross-validation", "left out of", "others"):
        assert wrong not in said, wrong
    assert "on the one run" in said and "none was held out" in said
    assert ("One run in 2 parts" if parts == 2 else "One run of 3 s") in said


def test_runs_that_chose_the_correction_are_not_said_to_be_unseen() -> None:
    """Few runs are each predicted without themselves; the picture shows a fit to all of them."""
    own = tuple(replace(t, held_out=False) for t in trials())
    said = " ".join(
        " ".join(read(text_of(diagnosis(trials=own, held_out=(), cross_validated=True))).text).split()
    )
    assert "no fit has seen" not in said and "nothing has seen" not in said
    assert "each run predicted without itself" in said and "fitted to these runs too" in said


def test_an_effect_that_no_round_tried_has_no_p_value() -> None:
    """A camera's rotation is told from pairs of runs: the page said p = 1."""
    one = diagnosis(findings=(wheel_loads(p_value=1.0),))
    change = limits_change(one.recipe, one.corrected, one.surface)
    for said in (text_of(one), " ".join(words.summary_lines(one, change))):
        assert "no round compared it" in said and "p = 1 " not in said


def test_limits_that_do_not_move_are_said_to_stay() -> None:
    finding = wheel_loads(
        effect=CameraDelay(delay_s=0.02),
        name="camera_delay",
        traced_to=Trace.MEASUREMENT,
        derived=(),
        parameters=(Estimate(name="delay_s", value=0.02, low=0.018, high=0.022, unit="s"),),
    )
    assert "No limit changes" in text_of(diagnosis(findings=(finding,)))


def test_odd_data_is_drawn() -> None:
    one = trials(1, samples=3)
    lost = replace(one[0], measured=np.full((3, 3), np.nan))
    for runs in ((lost,), trials(25)):
        held = tuple(replace(t, held_out=False) for t in runs)
        page = read(text_of(diagnosis(trials=held, cross_validated=True, held_out=())))
        assert any(runs[0].name in part for part in page.text)


def test_long_labels_leave_room_for_the_dots() -> None:
    """Joint candidates of a later round are shown without what the model holds already."""
    first, last = diagnosis().steps
    long = "wheel_loads with the centre of mass where stated + wheel_radius[left]"
    tried = tuple(replace(t, label=f"{long} + {t.label}") for t in last.tried)
    figure = candidates_figure(diagnosis(steps=(replace(first, taken=long), replace(last, tried=tried))))
    figure.draw_without_rendering()  # a collapsed layout would warn, and warnings are errors
    labels = [text.get_text() for text in figure.axes[1].get_yticklabels()]
    assert labels[0] == "floor tilt  (2)" and all(len(text) < 55 for text in labels)
    assert all(axes.get_position().width > 0.4 for axes in figure.axes)


def test_a_candidates_long_label_is_whole() -> None:
    """A label of 63 characters lost its middle."""
    first = diagnosis().steps[0]
    long = "wheel loads with the centre of mass where stated in loading each"
    tried = tuple(replace(t, label=f"{t.label} + {long}") for t in first.tried)
    figure = candidates_figure(diagnosis(steps=(replace(first, tried=tried),)))
    figure.draw_without_rendering()
    for text in figure.axes[0].get_yticklabels():
        assert "…" not in text.get_text() and long in text.get_text().replace("\n", " ")
        assert text.get_window_extent().height < figure.dpi * 0.25
        assert text.get_window_extent().x0 >= 0.0
    assert figure.axes[0].get_position().width > 0.4


def test_the_held_out_figure_says_where_predictions_begin(rich: str) -> None:
    figure = held_out_figure(diagnosis())
    assert "begins at the pose that fits its run best" in figure.legends[0].get_title().get_text()
    assert "Each prediction begins at the pose that fits its run best" in rich


def test_names_are_escaped() -> None:
    d = diagnosis(data_set="<b>&\"'", remarks=("a < b & `c<d`",))
    text = text_of(d)
    assert "<b>" not in text and "&lt;b&gt;&amp;" in text and "a &lt; b &amp; <code>c&lt;d</code>" in text


def test_same_diagnosis_same_page_and_no_settings_left_behind(rich: str) -> None:
    before = dict(mpl.rcParams)
    assert text_of(diagnosis(findings=RICH)) == rich
    assert dict(mpl.rcParams) == before


def test_pictures_are_the_page_s_own() -> None:
    d = diagnosis()
    files = {name: data for name, data in files_of(d).items() if name.endswith(".png")}
    assert set(files) == {"residual.png", "where.png", "candidates.png", "held-out.png", "limits.png"}
    assert all(data.startswith(b"\x89PNG") for data in files.values())


def test_every_kind_of_block() -> None:
    figure = Figure(figsize=(3, 2))
    figure.add_subplot().plot([0, 1], [0, 1])
    blocks = (
        Text(text="a `b`"),
        Bullets(items=("one",)),
        Bullets(items=("two",), numbered=True),
        Code(text="x < 1"),
        Table(caption="c", head=("h", "i"), rows=(("1", "2"),), numbers=False),
        Facts(facts=(Fact(label="l", value="v"), Fact(label="m", value="w", note="n"))),
        Fold(
            summary="more",
            blocks=(Picture(name="p", image=image(figure, png=True), alt='a "quoted" line', caption="line"),),
        ),
    )
    built = Page(title="T", lead="L", sections=(Section(heading="H", blocks=blocks),))
    tree = read(html(built))
    assert set(pictures(built)) == {"p.png"}
    assert {"T", "L", "H", "one", "two", "x < 1", "more", "line"} <= set(tree.text)


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate(name="a", value=0.0981, low=0.0943, high=0.1029, unit="1"), "a = 0.0981 (0.0943 … 0.1029)"),
        (Estimate(name="b", value=31.2, low=12.0, high=50.4, unit="N/m"), "b = 31 (12 … 50) N/m"),
        (
            Estimate(name="c", value=0.6, low=0.6, high=0.6, unit="1", at_bound=True),
            "c = 0.6, at the edge of its range",
        ),
        (Estimate(name="d", value=0.0, low=0.0, high=0.0, unit="s"), "d = 0 s"),
        (Estimate(name="sectors_per_turn", value=8.0, low=8.0, high=8.0, unit="1"), "sectors_per_turn = 8"),
        (Estimate(name="e", value=2.0, low=-np.inf, high=np.inf, unit="s"), "e = 2.000 (-inf … inf) s"),
    ],
)
def test_numbers_have_the_digits_their_interval_supports(estimate: Estimate, text: str) -> None:
    assert words.interval(estimate) == text


@pytest.mark.parametrize(
    ("before", "after", "text"),
    [
        (10.0, 9.35, "−6.5 %"),
        (10.0, 4.0, "−60 %"),
        (10.0, 10.001, "unchanged"),
        (0.0, 0.0, "unchanged"),
        (0.0, 1.0, ""),
        (1.0, 1.25, "+25 %"),
    ],
)
def test_changes_in_percent(before: float, after: float, text: str) -> None:
    assert words.percent(before, after) == text


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (
            PlanChange(before_s=2.0, after_s=2.5, use_believed=0.9, use_real=1.2),
            "this plan slips (it asks a wheel for 120 %",
        ),
        (
            PlanChange(before_s=2.0, after_s=None, use_believed=0.9, use_real=None),
            "finds no way to make the move",
        ),
        (
            PlanChange(before_s=None, after_s=2.5, use_believed=None, use_real=None),
            "has no plan without slip",
        ),
        (
            PlanChange(before_s=2.0, after_s=1.9, use_believed=0.9, use_real=0.8),
            "up to 80 % of a wheel's grip",
        ),
    ],
)
def test_what_became_of_the_plan(change: PlanChange, part: str) -> None:
    assert part in words.plan_sentence(change)


def test_every_variable_has_words_and_a_trial() -> None:
    assert set(words.VARIABLES) == set(TRIALS) == set(Trace)


def test_every_pair_of_effects_can_be_separated() -> None:
    names = [e.name for e in CATALOGUE] + [f"unnamed_{t.value}: some form" for t in Trace]
    for effect in CATALOGUE:
        assert trace_of(f"{effect.name}[left]") is effect.traced_to
        assert trace_of(f"{effect.name} with its coefficient") is effect.traced_to
        for other in names:
            assert separating_trial(effect.name, effect.traced_to, other)
    assert trace_of("nobody") is None and separating_trial("stribeck", Trace.SLIP_SPEED, "nobody")


@pytest.mark.skipif(
    shutil.which("chromium") is None, reason="chromium is not installed (apt-get install chromium)"
)
@pytest.mark.parametrize("width", [390, 1200])
def test_browser_lays_it_out(rich: str, width: int, tmp_path: Path) -> None:
    """No element is wider than the window: only the pictures scroll, each in its own frame."""
    probe = (
        "<script>addEventListener('load', () => { document.title = 'wide ' + "
        "(document.documentElement.scrollWidth - document.documentElement.clientWidth); });</script>"
    )
    (tmp_path / "page.html").write_text(rich.replace("</body>", probe + "</body>"), encoding="utf-8")
    done = subprocess.run(
        [
            "chromium",
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            f"--user-data-dir={tmp_path / 'profile'}",
            f"--window-size={max(width, 500)},900",
            "--dump-dom",
            f"file://{tmp_path / 'page.html'}",
        ],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert "<title>wide 0</title>" in done.stdout
