"""The report pages of bounds, check, plan, simulate, sweep and design: content, looks, print."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import browser, needs_browser
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.report.design import change
from slipmargin.report.motion import in_air
from slipmargin.report.motion_pages import _who
from slipmargin.report.page import inline
from slipmargin.report.page_style import CSS, FIGURE_COLOURS
from slipmargin.report.text import thinned, towards, two_digits

WAY = "x_m,y_m,phi_rad\n0,0,0\n1,0,0\n1,1,0\n"
SPEEDS = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s\n0,10,10,10,10\n1,0,0,0,0\n1.5,0,0,0,0\n"
PULLS = "phi_rad,force_N\n0.0,5.2\n0.0,5.0\n0.7854,5.5\n"
NAMES = ("bounds", "sweep", "plan", "check", "slips", "simulate", "design")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Each command's page, made by the command."""
    folder = tmp_path_factory.mktemp("pages")
    for name, text in (("way", WAY), ("speeds", SPEEDS), ("pulls", PULLS)):
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    at = {name: str(folder / f"{name}.html") for name in NAMES}
    plan, floor = str(folder / "plan.csv"), ("--surface", "floor")
    for name, words in {
        "bounds": ["bounds", "mecanum4", *floor],
        "sweep": ["sweep", "ohio-kiwi", "--surface", "paper", "--measured", str(folder / "pulls.csv")],
        "plan": ["plan", "mecanum4", str(folder / "way.csv"), *floor, "--out", plan],
        "check": ["check", "mecanum4", plan, *floor],
        "slips": ["check", "mecanum4", plan, *floor, "--margin", "0.3"],
        "simulate": ["simulate", "mecanum4", str(folder / "speeds.csv"), *floor],
        "design": ["design", "omni4", *floor, "--vary", "front_angle_deg=30:60:15", "--static"],
    }.items():
        assert status([*words, "--report", at[name]]) == 0
    return {name: Path(file).read_text(encoding="utf-8") for name, file in at.items()}


class _Reader(HTMLParser):
    """Headings in order, texts, and tags that fetch something."""

    def __init__(self) -> None:
        super().__init__()
        self.headings: list[str] = []
        self.fetches: list[str] = []
        self._in = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._in = tag
        fetched = [v for k, v in attrs if k in {"src", "srcset"} or (k == "href" and tag == "link")]
        self.fetches += [tag] * (tag in {"script", "link", "iframe"}) + [
            str(v) for v in fetched if not str(v).startswith("data:")
        ]

    def handle_data(self, data: str) -> None:
        if self._in == "h2" and data.strip():
            self.headings.append(data.strip())


def read(text: str) -> _Reader:
    reader = _Reader()
    reader.feed(text)
    return reader


@pytest.mark.parametrize("name", [n for n in NAMES if n != "design"])
def test_the_order_is_that_in_which_a_reader_asks(pages: dict[str, str], name: str) -> None:
    wanted = ["The answer in numbers", "Picture", "Table", "What to do next", "Details"]
    assert read(pages[name]).headings == wanted


@pytest.mark.parametrize("name", NAMES)
def test_a_page_stands_alone_and_says_how_it_was_made(pages: dict[str, str], name: str) -> None:
    text = pages[name]
    assert not read(text).fetches
    assert "`" not in re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)  # no literal backticks
    command = "check" if name == "slips" else name
    made = (
        rf"Made on \d{{4}}-\d\d-\d\d by slipmargin {re.escape(sm.__version__)}: <code>slipmargin {command} "
    )
    assert re.search(made, text)


@pytest.mark.parametrize(
    ("name", "kind", "said"),
    [
        ("bounds", "good", "mecanum4 on floor may speed up at 1.52 m/s² in any direction: no wheel slips"),
        ("sweep", "good", "Standing on paper, ohio-kiwi holds a pull of 4.42 N at every orientation asked"),
        ("plan", "good", "mecanum4 can drive this path of 2.061 m in 2.49 s on floor: no wheel slips"),
        ("check", "good", "This trajectory can be driven"),
        ("slips", "attention", "does not slip, but leaves too little in reserve"),
        ("simulate", "attention", "After 1.5 s the robot stands 0.5 m from the origin, turned by 0°. All"),
    ],
)
def test_the_verdict_comes_first(pages: dict[str, str], name: str, kind: str, said: str) -> None:
    lead = re.search(r'<p class="lead (\w+)">(.*?)</p>', pages[name])
    assert lead is not None and lead[1] == kind
    assert said in lead[2].replace("\u00a0", " ")


def test_a_trajectory_that_slips_is_called_so() -> None:
    t = np.linspace(0.0, 1.0, 41)
    still = np.zeros_like(t)
    found = sm.check("ohio-kiwi", "paper", np.column_stack([t, 2.0 * t**2, still, still]))
    assert found.page().lead.startswith("This trajectory slips: at ")
    assert found.page().lead_kind == "attention"


def test_what_rolls_without_slip_is_not_called_sliding() -> None:
    t = np.linspace(0.0, 4.0, 81)
    slow = np.column_stack([t, *np.outer([-0.1, 0.1, 0.0], np.minimum(t, 1.0))])
    page = sm.simulate("ohio-kiwi", "paper", slow, linear=True).page()
    assert "No wheel slides" in page.lead and page.lead_kind == "good"


def test_a_result_without_a_page_says_so() -> None:
    with pytest.raises(InputError, match="has no report page"):
        sm.polytope("ohio-kiwi", "paper").page_text()


@pytest.mark.parametrize("ending", [".html"])
def test_write_knows_the_ending(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"page{ending}"
    sm.bounds("ohio-kiwi", "paper").write(file)
    assert "<h1>Limits of ohio-kiwi on paper</h1>" in file.read_text(encoding="utf-8")


def test_no_code_name_labels_a_figure(pages: dict[str, str]) -> None:
    for text in pages.values():
        for drawn in re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL):
            labels = re.findall(r">([^<>]+)</text>", drawn)
            assert not [one for one in labels if re.search(r"_m_s2|f_worst|start_", one)]


def test_figures_follow_the_readers_colours() -> None:
    """Each colour of the house becomes a variable that the style sheet has for light, dark and paper."""
    from slipmargin.plots import style

    for colour in (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.PURPLE, style.SKY, style.INK):
        name = FIGURE_COLOURS[colour.lower()]
        assert CSS.count(f"{name}:") == 3, f"{name}: light, dark and paper"
    figure = style.image(sm.bounds("ohio-kiwi", "paper").panels()["limits"])
    drawn = inline(figure, "p", "x")
    assert "var(--blue, #0072b2)" in drawn
    assert not re.search(r'style="[^"]*(?<!, )#(?:0072b2|222222|ffffff)', drawn)


@pytest.mark.parametrize(
    ("count", "most", "always", "wanted"),
    [
        (91, 12, [0, 90], [0, 10, 20, 30, 40, 50, 60, 70, 80, 90]),
        (360, 12, [45], [0, 45, 90, 135, 180, 225, 270, 315]),
        (5, 12, [], [0, 1, 2, 3, 4]),
        (1000, 3, [7, 8, 9, 10], [7, 8, 9]),
    ],
)
def test_tables_are_thinned_at_round_steps(
    count: int, most: int, always: list[int], wanted: list[int]
) -> None:
    assert thinned(count, most, always) == wanted


def test_directions_are_words() -> None:
    words = [towards(np.deg2rad(d)) for d in (0, 44, 90, 180, -90, 271, 359, -180)]
    assert words == [
        "forwards",
        "forwards and to the left",
        "to the left",
        "backwards",
        "to the right",
        "to the right",
        "forwards",
        "backwards",
    ]


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as found:
        yield found


@needs_browser
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_page_fits_a_telephone(
    pages: dict[str, str], chromium: Any, tmp_path: Path, name: str, scheme: str
) -> None:
    """At 400 px neither the page nor a picture is scrolled sideways."""
    file = tmp_path / "page.html"
    file.write_text(pages[name], encoding="utf-8")
    page = chromium.new_page(viewport={"width": 400, "height": 800}, color_scheme=scheme)
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.goto(file.as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    over = page.eval_on_selector_all(
        ".plot", "all => all.filter(e => e.scrollWidth > e.clientWidth + 1).length"
    )
    assert over == 0
    ground = page.evaluate("getComputedStyle(document.querySelector('.plot svg path')).fill")
    assert ground == {"light": "rgb(255, 255, 255)", "dark": "rgb(22, 25, 29)"}[scheme]
    assert not said
    page.close()


@needs_browser
@pytest.mark.parametrize("name", ["bounds", "check"])
def test_paper_shows_the_details(pages: dict[str, str], chromium: Any, tmp_path: Path, name: str) -> None:
    """Printed on A4, what is folded on the screen is there; in the dark too it is black on white."""
    file, paper = tmp_path / "page.html", tmp_path / "page.pdf"
    file.write_text(pages[name], encoding="utf-8")
    page = chromium.new_page(color_scheme="dark")
    page.goto(file.as_uri())
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    folded = page.locator("details table").last
    assert folded.evaluate("e => e.getBoundingClientRect().height") > 50
    page.pdf(path=paper, format="A4")
    page.close()
    if subprocess.run(["which", "pdftotext"], capture_output=True).returncode == 0:
        done = subprocess.run(["pdftotext", str(paper), "-"], capture_output=True, text=True, check=True)
        assert {"bounds": "isotropic", "check": "worst"}[name] in done.stdout


def test_wheels_that_slip_alike_are_named_together() -> None:
    """The page named the first of four wheels that slipped alike."""
    wheels = ("fl", "fr", "rl")
    assert _who(wheels, np.array([0.3, 0.2999, 0.3])) == "all wheels slip"
    assert _who(wheels, np.array([0.3, 0.2, 0.299])) == "wheels fl and rl slip"
    assert _who(wheels, np.array([0.1, 0.2, 0.1])) == "wheel fr slips"


def test_pulls_below_the_recommended_one_are_the_verdict(tmp_path: Path) -> None:
    """The page was green, "no wheel slips" at 4.59 N, above a measured slip at 4.30 N."""
    pulls = tmp_path / "pulls.csv"
    for force, good in ((4.0, False), (5.0, True)):
        pulls.write_text(f"phi_rad,force_N\n0.0,{force}\n", encoding="utf-8")
        page = sm.sweep("ohio-kiwi", "paper", measured=pulls).page()
        assert page.lead_kind == ("good" if good else "attention")
        assert ("it slipped at 4 N, at φ = 0°" in page.lead) is not good
        assert ("no wheel slips" in page.lead) is good


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (160.4, "160"),
        (16.04, "16"),
        (1.604, "1.6"),
        (0.01604, "0.016"),
        (0.0, "0"),
        (-160.4, "-160"),
        (2e7, "2e+07"),
    ],
)
def test_a_spread_has_two_digits_and_no_needless_power_of_ten(value: float, said: str) -> None:
    assert two_digits(value) == said


@pytest.mark.parametrize(("value", "said"), [(1.1, "+10.0 %"), (0.9, "-10.0 %"), (1.0 - 1e-7, "0.0 %")])
def test_what_does_not_change_has_no_sign(value: float, said: str) -> None:
    """The page of a study said "-0.0 %" where its table said "0.0 %"."""
    assert change(value, 1.0) == said


def test_when_a_wheel_lifts_is_found_in_a_long_run() -> None:
    """It was printed as 1.23e+03 s."""
    assert in_air(["left", "right"], np.array([0.0, 0.5]), 1234.56) == (
        "wheels hang in the air: wheel right for 0.5 s, first at 1234.56 s; the others carry their share"
    )
