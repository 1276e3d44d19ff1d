"""The judged collections: drawn alike from a seed, readable, silent about their truth, and right."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import draw
from judged.camera import NULL_KINDS
from judged.families import CATALOGUE_FAMILIES, FAMILIES, INVENTIONS, SINCE, Draw, Family, Planted
from judged.motions import draw_run
from judged.robots import KINDS, Wishes, draw_robot

from slipmargin.effects.catalogue import effect_class
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.floor_weave import FloorWeave
from slipmargin.effects.stiff_roller import StiffRoller
from slipmargin.effects.wheel_runout import WheelRunout
from slipmargin.effects.wheel_wobble import WheelWobble
from slipmargin.io.data_set import read_data_set
from slipmargin.io.robot_file import read_recipe
from slipmargin.sim.signal import held, hermite
from slipmargin.sim.simulate import simulate


def written(files: dict[str, str], folder: Path) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def test_there_are_enough_families() -> None:
    assert len(FAMILIES) >= 12 and len(INVENTIONS) >= 5
    assert len({family.name for family in FAMILIES}) == len(FAMILIES)
    for family in CATALOGUE_FAMILIES:
        effect = effect_class(family.catalogue or "")
        assert effect is not None and effect.traced_to.value == family.variable, family.name
    for family in INVENTIONS:
        assert family.catalogue is None, "scored by its variable"
        since = effect_class(family.name)
        assert since is None or (family.name in SINCE and since.traced_to.value == family.variable)
    assert {f.name for f in INVENTIONS} >= set(SINCE) and len(INVENTIONS) - len(SINCE) >= 5


def test_development_never_sees_what_is_held_back() -> None:
    held_back = {family.name for family in INVENTIONS if family.held_back}
    quiet = {name for name, (held_out, _) in NULL_KINDS.items() if held_out}
    assert len(held_back) >= 4 and len(quiet) >= 2
    drawn = {what for _, _, what, _ in draw.jobs_of("dev", 3, 300, 100)}
    assert not drawn & (held_back | quiet)
    assert {what for _, _, what, _ in draw.jobs_of("test", 3, 100, 100)} >= held_back | quiet


def test_a_seed_draws_the_same_bytes() -> None:
    family = next(f for f in FAMILIES if f.name == "slick_patch")
    first = draw.effect_set([4, 0, 7], family, most=2)
    assert first == draw.effect_set([4, 0, 7], family, most=2)
    assert first[0] != draw.effect_set([5, 0, 7], family, most=2)[0]
    assert draw.null_set([4, 0, 8], "coloured", most=2) == draw.null_set([4, 0, 8], "coloured", most=2)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.name)
def test_every_family_is_read_as_a_data_set(family: Family, tmp_path: Path) -> None:
    files, truth = draw.effect_set([11, 1, 2], family, most=2)
    data = read_data_set(written(files, tmp_path))
    assert len(data.trials) == truth["runs"] == 2
    assert 1.5 < truth["chi"] < 1.6 * draw.CHI_HIGH and truth["variable"] == family.variable


@pytest.mark.parametrize("kind", NULL_KINDS)
def test_every_kind_of_null_is_read_as_a_data_set(kind: str, tmp_path: Path) -> None:
    files, truth = draw.null_set([11, 2, 3], kind, most=2)
    assert len(read_data_set(written(files, tmp_path)).trials) == 2
    assert truth["noise"] == kind and not truth["planted"]


def test_the_truth_is_not_in_the_folder(tmp_path: Path) -> None:
    out = tmp_path / "drawn"
    words = ["--seed", "20", "--out", str(out), "--effects", "2", "--nulls", "1"]
    assert draw.main(words) == 0
    truth = json.loads((out / "truth.json").read_text(encoding="utf-8"))["sets"]
    assert set(truth) == {path.name for path in (out / "sets").iterdir()} and len(truth) == 3
    for name, true in truth.items():
        inside = [path for path in (out / "sets" / name).rglob("*") if path.is_file()]
        assert {p.name for p in inside if p.suffix != ".csv"} == {"robot.toml", "dataset.toml"}
        assert all(path.parent.name == "trials" for path in inside if path.suffix == ".csv")
        for path in inside:
            assert true["family"] not in path.read_text(encoding="utf-8")
        assert true["family"] not in name and "effect" not in (out / "sets" / name / "robot.toml").read_text(
            encoding="utf-8"
        )
    assert draw.main(words) == 2  # never over what is there


@pytest.mark.parametrize(("kind", "idle"), [("test", "--count"), ("coverage", "--effects")])
def test_a_size_that_a_kind_does_not_have_is_refused(
    kind: str, idle: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A smaller test was asked for by --count, and all 200 sets were drawn."""
    out = tmp_path / "drawn"
    assert draw.main(["--seed", "1", "--out", str(out), "--kind", kind, idle, "4"]) == 2
    assert f"{idle}: has no effect on --kind {kind}" in capsys.readouterr().err and not out.exists()


def _off(files: dict[str, str], folder: Path, planted: Planted, run: Any, effects: tuple[Any, ...]) -> float:
    """The largest distance [m] between this simulator's track and the package's."""
    written(files, folder)
    recipe = read_recipe(folder / "robot.toml").with_effects(*effects)
    commanded = planted.tables is not None
    rows = run.rows_s
    signal = held(rows, run.command) if commanded else hermite(rows, run.log_theta, run.log_omega)
    theirs = simulate(recipe.build("floor"), signal, rows, commanded=commanded, start_pose=run.start)
    mine = draw.tracks(planted, [run])[0]
    return float(np.abs(np.asarray(theirs.pose) - mine)[:, :2].max())


@pytest.mark.parametrize("kind", KINDS)
def test_the_simulator_agrees_with_the_packages(kind: str, tmp_path: Path) -> None:
    """The two share no code: without any effect their tracks differ by less than a micrometre."""
    asked = set()
    for seed in range(60):
        rng = np.random.default_rng(seed)
        robot = draw_robot(rng, Wishes())
        what = robot.machine.shape, robot.machine.rigid_fraction[0] > 0.0
        if robot.kind != kind or what in asked:
            continue
        asked.add(what)
        run = draw_run(rng, robot.machine, 200, spread=True, commanded=False, hardest=1.0)
        off = _off({"robot.toml": robot.text}, tmp_path, Planted(machine=robot.machine), run, ())
        assert off < 1e-6, (seed, off)
    assert len(asked) >= 3 and any(rigid for _, rigid in asked)


#: Effects of the camera are no part of the package's simulation.
IN_MOTION = [f for f in CATALOGUE_FAMILIES if f.covered and f.variable != "measurement"]


@pytest.mark.parametrize("family", IN_MOTION, ids=lambda f: f.name)
def test_a_planted_effect_is_the_catalogues(family: Family, tmp_path: Path) -> None:
    """Sets that judge intervals hold the catalogue's very law: tracks agree with the effect, not without."""
    rng = np.random.default_rng(6)
    robot = draw_robot(rng, Wishes(plain_loads=True, box=True, no_rigid=True, no_motor=True))
    run = draw_run(rng, robot.machine, 200, spread=True, commanded=family.commanded, hardest=2.5)
    planted = family.draws(Draw(rng=rng, machine=robot.machine, runs=[run]))(0.4)
    words: dict[str, Any] = dict(planted.parameters)
    if planted.wheels:
        words["wheels"] = tuple(str(i) for i in planted.wheels)
    effect = effect_class(family.name)
    assert effect is not None
    if family.commanded and planted.tables is None:
        planted = Planted(machine=planted.machine, physics=planted.physics, tables=lambda r: r.tables)
    files = {"robot.toml": robot.text}
    off = _off(files, tmp_path, planted, run, (effect(**words),))
    without = _off(files, tmp_path, planted, run, ())
    assert without > 5e-4 and off < 0.05 * without, (off, without)


def _runout(planted: Planted) -> WheelRunout:
    size, phase = (planted.parameters[key] for key in ("relative_amplitude", "phase_rad"))
    return WheelRunout(cosine=size * np.cos(phase), sine=size * np.sin(phase), wheels=_wheels(planted))


def _wobble(planted: Planted) -> WheelWobble:
    size, phase = (planted.parameters[key] for key in ("toe_amplitude_rad", "phase_rad"))
    return WheelWobble(
        cosine_rad=-size * np.sin(phase), sine_rad=size * np.cos(phase), wheels=_wheels(planted)
    )


def _weave(planted: Planted) -> FloorWeave:
    size, towards = (planted.parameters[key] for key in ("relative_amplitude", "direction_rad"))
    return FloorWeave(cosine=size * np.cos(4.0 * towards), sine=size * np.sin(4.0 * towards))


def _roller(planted: Planted) -> StiffRoller:
    factor, start, width = (planted.parameters[key] for key in ("transverse_factor", "from_rad", "width_rad"))
    middle = float(np.angle(np.exp(1j * (start + 0.5 * width))))
    return StiffRoller(factor=factor, angle_rad=middle, wheels=_wheels(planted))


def _drag(planted: Planted) -> DraggingPoint:
    force, x, y = (planted.parameters[key] for key in ("force_N", "x_m", "y_m"))
    return DraggingPoint(force_N=force, place_x_m=x, place_y_m=y)


def _wheels(planted: Planted) -> tuple[str, ...]:
    return tuple(str(i) for i in planted.wheels)


@pytest.mark.parametrize(
    ("name", "size", "effect", "share"),
    [
        ("out_of_round_wheel", 0.1, _runout, 0.01),
        ("bent_axle", 0.8, _wobble, 0.01),
        ("fourfold_floor", 0.4, _weave, 0.01),
        ("sticking_roller", 0.8, _roller, 0.05),  # its edges are sharp there
        ("dragging_castor", 0.4, _drag, 0.01),
    ],
)
def test_an_invention_is_an_effect_by_now(
    name: str, size: float, effect: Callable[[Planted], Any], share: float, tmp_path: Path
) -> None:
    """Its tracks are those of the effect but for a ``share`` of what it does."""
    rng = np.random.default_rng(6)
    robot = draw_robot(rng, Wishes(plain_loads=True, box=True, no_rigid=True, no_motor=True))
    run = draw_run(rng, robot.machine, 200, spread=True, commanded=False, hardest=2.5)
    family = next(f for f in INVENTIONS if f.name == name)
    planted = family.draws(Draw(rng=rng, machine=robot.machine, runs=[run]))(size)
    files = {"robot.toml": robot.text}
    off = _off(files, tmp_path, planted, run, (effect(planted),))
    without = _off(files, tmp_path, planted, run, ())
    assert without > 5e-4 and off < share * without, (off, without)
