"""The statics figures: what they say is what was computed, and nothing global changes."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given, settings
from matplotlib.figure import Figure
from strategies import four_wheels, kiwi, models

import slipmargin as sm
from slipmargin.data.pulls import gather_pulls
from slipmargin.errors import InputError
from slipmargin.limits import sweep, wrench_set
from slipmargin.model import Model, nominal_model
from slipmargin.plots.machine import draw_machine, machine_figure
from slipmargin.plots.polytope import polytope_figure
from slipmargin.plots.style import check_format, save
from slipmargin.plots.sweep import draw_sweep, sweep_figure, sweep_panels
from slipmargin.robot import GripShape
from slipmargin.sets.section import section

CIRCLE = np.linspace(0.0, 2.0 * np.pi, 73)


@pytest.fixture(scope="module")
def model() -> Model:
    return nominal_model(kiwi(), "paper")


def test_fig_8_axes_show_the_sweep(model: Model) -> None:
    found = sweep(model, np.deg2rad(np.arange(0.0, 91.0)))
    pulls = gather_pulls(np.array([0.0, 0.0, 0.5]), np.array([4.8, 5.0, 5.2]))
    axes = draw_sweep(Figure().add_subplot(), found, pulls, 4.4)
    line = next(x for x in axes.lines if x.get_label() == "all wheels on rollers")
    np.testing.assert_allclose(line.get_xdata(), np.arange(0.0, 91.0))
    np.testing.assert_allclose(line.get_ydata(), found.f_max_N)
    assert axes.get_xlabel().endswith("[deg]") and axes.get_ylabel() == "largest pull without slip [N]"
    assert axes.get_ylim()[0] == 0.0 and axes.get_xlim() == pytest.approx((0.0, 90.0))
    labels = [t.get_text() for t in axes.get_legend().get_texts()]
    assert "roller or rigid under each wheel" in labels and any("measured" in x for x in labels)


def test_polar_plot_is_seen_from_the_robot(model: Model) -> None:
    # φ = 0: the pull along floor +x is to the robot's right, a quarter turn clockwise from forwards (up).
    figure = sweep_panels(*[sweep(model, CIRCLE)] * 2)["polar"]
    axes = figure.axes[0]
    line = next(x for x in axes.lines if x.get_label() == "all wheels on rollers")
    assert line.get_xdata()[0] == pytest.approx(-np.pi / 2)
    # φ = 90°: the robot faces floor −x, the pull along +x is backwards (down).
    assert np.cos(line.get_xdata()[18]) == pytest.approx(-1.0)
    assert axes.get_theta_offset() == pytest.approx(np.pi / 2) and axes.get_theta_direction() == 1
    assert axes.get_ylim()[0] == 0.0
    words = [t.get_text() for t in axes.get_xticklabels()]
    assert words[::2] == ["forwards", "left", "backwards", "right"]


@settings(max_examples=10, deadline=None)
@given(models())
def test_section_is_the_sweep_by_another_road(model: Model) -> None:
    ring = section(wrench_set(model).zonotope())
    phi = np.linspace(0.0, 2.0 * np.pi, 37)[:-1]
    force = sweep(model, phi, with_band=False).f_max_N
    # Friction answers the pull: it points along −(cos φ, −sin φ) in the body frame; the set is symmetric.
    ray = np.stack([np.cos(phi), -np.sin(phi)], axis=1)
    np.testing.assert_allclose(reach_of(ring, ray), force, rtol=2e-3)


def reach_of(ring: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """How far rays (K, 2) from the origin go inside a convex polygon with corners counter-clockwise."""
    a, b = ring, np.roll(ring, -1, axis=0)
    normal = np.stack([(b - a)[:, 1], -(b - a)[:, 0]], axis=1)
    offset, along = np.sum(normal * a, axis=1), rays @ normal.T
    return np.min(np.where(along > 1e-12, offset / np.where(along > 1e-12, along, 1.0), np.inf), axis=1)


def test_every_figure_is_saved_in_every_format(model: Model, tmp_path: Path) -> None:
    before, rounded = dict(mpl.rcParams), four_wheels(grip=GripShape.DISC_STRIP)
    figures = {
        "sweep": sweep_figure(sweep(model, CIRCLE[:10]), sweep(model, CIRCLE), None, 4.0),
        "polytope": polytope_figure(wrench_set(model), "title"),
        "curved polytope": polytope_figure(wrench_set(nominal_model(rounded, "paper")), "title"),
        "machine": machine_figure(nominal_model(four_wheels(), "paper")),
    }
    for name, figure in figures.items():
        for ending, head in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
            save(figure, tmp_path / f"{name}.{ending}")
            assert (tmp_path / f"{name}.{ending}").read_bytes().startswith(head)
    assert dict(mpl.rcParams) == before


def test_the_section_of_a_coupled_grip_is_its_own() -> None:
    """The pulls of the sweep, which come from cone programs, are the reach of the section drawn."""
    phi = np.array([0.1, 0.7, 2.0, 4.0])
    ways = np.stack([np.cos(phi), -np.sin(phi)], axis=1)
    for shape in (GripShape.DISC_STRIP, GripShape.ELLIPSE):
        rounded = nominal_model(kiwi(grip=shape), "paper")
        ring = section(wrench_set(rounded).body())
        reach = reach_of(ring, ways)
        force = sweep(rounded, phi, with_band=False).f_max_N
        np.testing.assert_allclose(reach, force, rtol=1e-2)
        assert np.all(reach <= force * (1.0 + 1e-4))


@pytest.mark.parametrize("name", ["omni4", "mecanum4"])
def test_the_section_has_no_corner_twice_and_its_circle_a_radius(name: str) -> None:
    """Edges that meet in the plane gave a corner twice, an edge without length and a circle of nan N."""
    found = sm.polytope(sm.read_robot(name, grip="disc-strip"), "floor")
    ring = section(found.body)
    assert np.min(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1)) > 1e-12
    labels = [t.get_text() for t in found.plot().axes[1].get_legend().get_texts()]
    assert any(label.startswith("in every direction: ") for label in labels)
    assert not [label for label in labels if "nan" in label]


def test_a_figure_drawn_twice_is_the_same_file(model: Model, tmp_path: Path) -> None:
    for name in ("a.svg", "b.svg"):
        save(sweep_panels(*[sweep(model, CIRCLE)] * 2)["polar"], tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_other_endings_are_refused(model: Model, tmp_path: Path) -> None:
    for name in ("f.bmp", "f", "f.png.gz"):
        with pytest.raises(InputError, match="no picture"):
            check_format(tmp_path / name)
    with pytest.raises(InputError, match="no picture"):
        save(Figure(), tmp_path / "f.jpg")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4"])
def test_the_robot_in_the_polar_plot_looks_where_the_labels_say(name: str) -> None:
    """Forwards is up in both conventions; robots in ROS axes had stood turned by a quarter."""
    found = sm.sweep(name, sm.read_robot(name).robot.surfaces[0].name, step_deg=45.0)
    model = found.sweep.model
    axes = Figure().add_subplot()
    draw_machine(axes, model, forwards_up=True)
    body, wedge = axes.patches[0].get_xy(), axes.patches[1].get_xy()
    way = wedge[:-1].mean(axis=0) - body[:-1].mean(axis=0)
    assert way[1] > 0.0 and abs(way[0]) < 1e-9 * way[1]
