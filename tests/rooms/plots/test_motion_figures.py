"""Figures of bounds, plans and audits: what they must show."""

from __future__ import annotations

import numpy as np
import pytest
from proposals import next_runs
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.limits.bounds_summary import bounds
from slipmargin.limits.motion_state import Contact
from slipmargin.model import nominal_model
from slipmargin.paths.check import check
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.plots.bounds import bounds_figure
from slipmargin.plots.next_run import next_runs_figure
from slipmargin.plots.paths import check_figure, limiting, plan_figure, plan_panels
from slipmargin.report.bounds import answer
from slipmargin.report.paths import covered, top_speed_m_s

pytest.importorskip("matplotlib")
WAY = through(np.array([[0.0, 0.0, 0.0], [0.6, 0.4, 0.4], [1.2, 0.0, 0.0]]))


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_plan_and_check_figures(robot: object) -> None:
    model = nominal_model(robot, "paper")
    found = plan(model, WAY, Request(share=0.9, points=60))
    rows = trajectory(found, step_s=0.02)
    figure = plan_figure(found, rows)
    path, speed, use = figure.axes
    assert f"{found.duration_s:.3f} s" in path.get_title(loc="left")
    fastest = np.max(speed.lines[-1].get_ydata())
    assert fastest == pytest.approx(np.max(found.profile().speed_m_s))
    assert fastest == pytest.approx(
        np.max(np.linalg.norm(rows.velocity * [1.0, 1.0, model.reach_m], axis=1)), rel=1e-2
    )
    assert "turning counted" in speed.get_xlabel()
    assert speed.get_ylabel() == "speed, turning counted [m/s]"
    assert [line.get_label() for line in use.lines[: model.count]] == list(rows.wheels)
    near = limiting(rows, 0.9)
    assert np.any(near) and np.all(rows.use[near] > 0.98 * 0.9 * (1.0 - 1e-3))
    figure.draw_without_rendering()
    audit = check(model, rows.t_s * 0.8, rows.pose, share=0.9)
    figure = check_figure(model, audit, rows)
    assert "asks more than is allowed" in figure.axes[0].get_title(loc="left")
    assert "stretch time by" in figure.axes[1].get_title(loc="left")
    figure.draw_without_rendering()


def test_wheels_near_their_limit_together_have_one_colour_and_name() -> None:
    """Rounding coloured the path of a symmetric robot by one of the two front wheels, then by the other."""
    found = plan(
        nominal_model(kiwi(), "paper"), through(np.array([[0.0, 0, 0], [0, 1, 0]])), Request(points=60)
    )
    figure = plan_figure(found, trajectory(found, step_s=0.02))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "wheels right, left" in labels and not {"wheel right", "wheel left"} & set(labels)


def test_a_robot_that_must_slip_has_no_spokes() -> None:
    """On rigid sectors the paper's robot can only brake, in four directions: points, and it is said."""
    found = bounds(nominal_model(kiwi(), "paper"), step_deg=5.0, contact=Contact.UNKNOWN)
    figure = bounds_figure(found)
    limits, steady, corner = figure.axes
    assert "must slip on rigid sectors in 360 of 360 directions" in limits.get_title(loc="left")
    for line in limits.lines:
        seen = np.asarray(line.get_ydata())
        assert np.all(seen[np.isfinite(seen)] > 0.0)
    assert (
        sum(np.count_nonzero(np.isfinite(x.get_ydata())) for x in limits.lines if x.get_marker() == "o") == 4
    )
    assert any("worst roller/rigid" in str(x.get_label()) for x in steady.lines)
    assert corner.texts[0].get_text() == "none: it must slip at constant speed"
    words = "\n".join(answer(found))
    assert (
        "it must slip at constant speed on rigid sectors in every direction" in words and "inf" not in words
    )
    figure.draw_without_rendering()


def test_bounds_figure() -> None:
    found = bounds(nominal_model(kiwi(), "paper"), step_deg=15.0)
    figure = bounds_figure(found)
    limits, steady, corner = figure.axes
    labels = [line.get_label() for line in limits.lines]
    assert labels == ["braking", "speeding up", "turning at speed"]
    assert limits.lines[2].get_linestyle() == "--"  # often equal to speeding up, which it hid
    assert "worst roller/rigid state" in [line.get_label() for line in steady.lines]
    assert "curvature" in corner.get_xlabel()
    figure.draw_without_rendering()


def test_the_title_of_a_path_with_a_long_legend_is_whole() -> None:
    """A path as wide as high under three rows of legend had its title cut off above."""
    model = nominal_model(four_wheels(), "paper")
    way = through(np.array([[0, 0, 0], [1, 0.5, 0], [2, 0, 1.5708], [2, 1, 1.5708]], dtype=float))
    found = plan(model, way, Request(share=0.9, points=60))
    figure = plan_panels(found, trajectory(found, step_s=0.02))["path"]
    figure.canvas.draw()
    axes = figure.axes[0]
    top = axes.title.get_window_extent().y1
    assert top <= figure.bbox.height and axes.get_aspect() == 1.0
    low, high = axes.get_xlim()
    assert low < 0.0 and high > 2.0


def test_a_turn_on_the_spot_is_told_as_a_turn() -> None:
    """The path's parameter counts turning as a way: it was printed as metres."""
    model = nominal_model(kiwi(), "paper")
    found = plan(model, through(np.array([[0.0, 0, 0], [0, 0, 1.0]])), Request(points=60))
    said = covered(found)
    assert said.startswith("0 m and 57.") and said.endswith("° of turning")
    straight = plan(model, through(np.array([[0.0, 0, 0], [1.0, 0, 0]])), Request(points=60))
    assert covered(straight) == "1 m"


def test_a_plan_is_as_long_and_as_fast_whatever_the_tables_step() -> None:
    """With a step of 100 s a path of one metre was said to be driven at 0 m/s."""
    one, other = (
        sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [1, 0.5, 1]], points=60, step_s=step)
        for step in (0.01, 0.4)
    )
    assert len(other.trajectory.t_s) < 10 and one.lines()[0] == other.lines()[0]
    speed = np.max(np.hypot(*one.trajectory.velocity[:, :2].T))
    assert top_speed_m_s(one.plan) == pytest.approx(speed, rel=1e-3)


def test_the_lines_of_proposed_runs_are_named() -> None:
    """Two of three lines, and the arrows, stood in the picture without a word."""
    figure = next_runs_figure(next_runs())
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    assert [s for s in said if "wheel_radius[1]" in s] and [s for s in said if "wheel_toe[1]" in s]
    assert any("arrows" in s for s in said)
    drawn = {(line.get_color(), line.get_linestyle()) for line in figure.axes[0].get_lines()}
    shown = {(h.get_color(), h.get_linestyle()) for h in legend.legend_handles}  # type: ignore[union-attr]
    assert drawn <= shown


def test_a_legend_of_wheels_with_long_names_is_as_wide_as_the_figure_at_most() -> None:
    """Of a mecanum robot's plan the legend was cut on both sides."""
    model = sm.read_robot("mecanum4").build("floor")
    way = through(np.array([[0, 0, 0], [1, 0.2, 0], [1.5, 1, 0.5], [0.5, 1.4, 1]], dtype=float))
    found = plan(model, way, Request(share=0.9))
    rows = trajectory(found, step_s=0.005)
    for figure in (plan_figure(found, rows), check_figure(model, check(model, rows.t_s, rows.pose), rows)):
        figure.canvas.draw()
        seen = figure.legends[0].get_window_extent()
        assert seen.x0 >= 0.0 and seen.x1 <= figure.bbox.width and len(figure.legends) == 1
