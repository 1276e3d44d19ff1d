"""Figures of a study: what they show is what the study holds."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from strategies import kiwi

from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.push import Push
from slipmargin.plots.study import study_figure, study_panels
from slipmargin.plots.style import images
from slipmargin.report.design import best_by_objective, in_words
from slipmargin.report.design_page import design_page
from slipmargin.report.page import Page, Section, Table, html
from slipmargin.report.page_style import CSS
from slipmargin.study.objectives import BY_NAME, Kind
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.robust import parse_interval, robust
from slipmargin.study.study import DesignProblem, Study, study
from slipmargin.study.table import study_data
from slipmargin.study.vary import parse_vary

FRONT = ("f_worst", "start_worst_m_s2")


def made(
    *texts: str,
    kinds: tuple[Kind, ...] = (Kind.STATIC,),
    name: str = "f_worst",
    effects: tuple[AnyEffect, ...] = (),
) -> Study:
    design = RobotOnSurface(recipe=Recipe(robot=kiwi(), effects=effects), surface="paper")
    return study(
        DesignProblem(
            base=design, grids=tuple(parse_vary(t) for t in texts), kinds=kinds, objective=BY_NAME[name]
        )
    )


@pytest.mark.parametrize("texts", [("mass_kg=1,2",), ("mass_kg=1,2", "wheel_radius_m=0.04,0.05")])
def test_an_objective_that_no_design_has_is_not_shown(texts: tuple[str, ...]) -> None:
    pushed = Push(force_x_N=700.0, force_y_N=-99.0, moment_N_m=100.0, time_s=0.0, duration_s=100.0)
    found = made(*texts, kinds=(Kind.STATIC, Kind.MOTION), name="yaw_moment_N_m", effects=(pushed,))
    assert np.isnan(found.columns["start_worst_m_s2"]).all()
    assert "start_worst_m_s2" not in found.objectives and "f_worst" in found.objectives
    assert all("starting" not in str(axes.get_title()) for axes in study_figure(found, FRONT).axes)
    head, rows = best_by_objective(found)
    assert head[0] == "objective" and "start_worst_m_s2" not in [row[0] for row in rows]
    assert study_data(found)["best_by_objective"]["start_worst_m_s2"] is None


def test_curves_are_the_columns() -> None:
    found = made("delta_deg=0:60:10", kinds=(Kind.MOTION,))
    sure = robust(found.designs, BY_NAME["f_worst"], [parse_interval("mu_drive=0.2:0.3")])
    curves, motion, polar, front = study_figure(found, ("f_worst", "start_worst_m_s2"), sure).axes
    lines = {
        str(line.get_label()): np.asarray(line.get_ydata())
        for axes in (curves, motion)
        for line in axes.get_lines()
    }
    assert np.array_equal(lines["worst heading"], found.columns["f_worst"])
    assert np.array_equal(lines["starting, worst direction"], found.columns["start_worst_m_s2"])
    assert np.array_equal(lines["worst case of what is uncertain"], sure.value)
    assert lines["best"] == [found.columns["f_worst"][found.best()]]
    assert any("(best)" in str(line.get_label()) for line in polar.get_lines())
    on = found.front(("f_worst", "start_worst_m_s2"))
    assert len(np.asarray(front.get_lines()[1].get_xdata())) == on.sum()


def test_all_designs_that_tie_have_a_star() -> None:
    """A mass as far to the left as to the right is alike: one side had the star."""
    found = made("com_x_m=-0.02,-0.01,0.01,0.02", name="f_worst_static")
    stars = study_figure(found, ("f_worst", "f_mean")).axes[0].get_lines()
    best = next(line for line in stars if line.get_marker() == "*")
    assert len(np.asarray(best.get_xdata())) == len(found.ties("f_worst_static")) == 2


def test_two_numbers_make_a_heat_map() -> None:
    found = made("delta_deg=10:40:10", "com_y_m=-0.02,0,0.09", name="f_worst_static")
    heat = study_figure(found, ("f_worst", "f_mean")).axes[0]
    mesh = next(c for c in heat.collections if isinstance(c, QuadMesh))
    wanted = found.shaped("f_worst_static").T
    shown = np.ma.filled(mesh.get_array(), np.nan).reshape(wanted.shape)
    assert np.array_equal(shown, wanted, equal_nan=True)


@pytest.mark.parametrize(
    "texts",
    [
        ("wheels=3,4,5",),
        ("load_model=equal,static", "delta_deg=10:40:10"),
        ("wheels=3,4", "grip=box", "mass_kg=1,2"),
        ("mass_kg=3",),
    ],
)
def test_every_kind_of_study_can_be_drawn_and_told(texts: tuple[str, ...]) -> None:
    found = made(*texts)
    assert len(study_figure(found, ("f_worst", "f_mean")).axes) >= 4
    drawn = images(study_panels(found, ("f_worst", "f_mean"), None))
    page = html(design_page(found, ("f_worst", "f_mean"), None, (), [("best", "it")], drawn))
    assert page.count("<h2") == 4 and page.count("<svg") == 4
    assert not re.search(r"<text[^>]*>[^<]*(delta_deg|load_model|mass_kg)", page)  # nobody typed a key


def test_only_long_words_break_in_a_narrow_table() -> None:
    """At 400 px the last column was broken letter by letter: "0.2" over "25", "f_w" over "ors" over "t"."""
    table = Table(caption="c", head=("a", "limited by"), rows=(("0.2366", "front-left+rear-right"),))
    page = html(Page(title="t", lead="l", sections=(Section(heading="h", blocks=(table,)),)))
    assert '<th scope="row">0.2366</th><td class="long">front-left+rear-right</td>' in page
    narrow = CSS.split("@media (max-width: 34rem)")[1].split("@media print")[0]
    assert re.findall(r"([^{};]*)\{ overflow-wrap: anywhere", narrow) == [" .long "]


def test_a_page_says_in_words_what_a_command_calls_by_its_key() -> None:
    """The page said "f_worst" and "front_angle_deg = 30", which nobody had typed."""
    said = in_words(
        "best: delta_deg = 30, mu_drive = 0.4 (1 other is as good); k_s_per_m = 1000, load_model = static"
    )
    assert said == (
        "best: wheel angle δ 30°, drive coefficient 0.4 (1 other is as good); k 1000 s/m, load model static"
    )
    assert in_words("0.001 m more com_y_m: f_worst") == (
        f"0.001 m more centre of mass y: {BY_NAME['f_worst'].meaning}"
    )
    found = made("delta_deg=10:40:10")
    drawn = images(study_panels(found, ("f_worst", "f_mean"), None))
    lead = design_page(found, ("f_worst", "f_mean"), None, (), [("best", "it")], drawn).lead
    assert "wheel angle δ" in lead and "_" not in lead


def test_an_objective_is_not_explained_by_itself() -> None:
    meaning = BY_NAME["f_worst"].meaning
    assert in_words(f"best: f_worst 0.23 m g ({meaning})") == f"best: {meaning} 0.23 m g"


def test_a_map_of_designs_that_are_all_alike_keeps_its_size() -> None:
    """A star at no place took room at the corner of the page: four stamps and overlapping letters."""
    found = made("mass_kg=2,3,4", "wheel_radius_m=0.02,0.03", name="f_worst_static")
    figure = study_figure(found, ("f_worst", "f_mean"))
    figure.draw_without_rendering()
    heat = figure.axes[0]
    assert heat.get_position().width > 0.25 and heat.get_position().height > 0.2
    assert "every design alike" in {text.get_text() for text in heat.texts}
    mesh = next(c for c in heat.collections if isinstance(c, QuadMesh))
    low, high = mesh.get_clim()
    assert high - low > 0.1 * found.columns["f_worst_static"].max()  # rounding is no colour
