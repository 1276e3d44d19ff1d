"""Work that grows with the input has a limit, a message and an option that raises it."""

from __future__ import annotations

import math
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomllib
from fuzz import mutate
from fuzz.judge import judge
from real_logs import EXCERPT

import slipmargin as sm
from slipmargin.effects.push import Push
from slipmargin.errors import InputError, MotionStopped
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.effort import NEARLY, Demands
from slipmargin.limits.every_motion import all_motions
from slipmargin.limits.motion_rows import prepare
from slipmargin.limits.motion_state import Contact
from slipmargin.sim.batch import Batch
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate
from slipmargin.study.measure import _refuse_undecided
from slipmargin.work import FACTOR, allow


def many_wheels(folder: Path, count: int, grip: str = "box") -> Path:
    """A ring of wheels whose rigid sectors hold more along and less across."""
    wheels = [
        {
            "name": f"w{i}",
            "position_m": [
                0.3 * math.cos(2.0 * math.pi * i / count),
                0.3 * math.sin(2.0 * math.pi * i / count),
            ],
            "drive_direction_deg": 360.0 * i / count + 90.0,
            "radius_m": 0.05,
            "rigid_fraction": 0.1,
        }
        for i in range(count)
    ]
    material = {"roller": {"drive": 0.3, "transverse": 0.1}, "rigid": {"drive": 0.5, "transverse": 0.05}}
    table = {
        "schema": 1,
        "name": "ring",
        "body": {"mass_kg": 5.0, "inertia_kg_m2": 0.2},
        "friction": {"law": "atan", "k_s_per_m": 1000.0, "grip": grip},
        "wheel": wheels,
        "surface": {"floor": material},
    }
    file = folder / "ring.toml"
    file.write_text(mutate.toml(table), encoding="utf-8")
    return file


def test_a_limit_is_said_with_its_cure_and_raised_by_a_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"asks for 300 rows, and at most 100 .* SLIPMARGIN_WORK=3 to allow"):
        allow("step", 300, 100, "rows", "take a longer step")
    monkeypatch.setenv(FACTOR, "3")
    allow("step", 300, 100, "rows", "take a longer step")
    for bad in ("much", "0.5", "nan", "inf"):
        monkeypatch.setenv(FACTOR, bad)
        with pytest.raises(InputError, match="SLIPMARGIN_WORK: is"):
            allow("step", 300, 100, "rows", "take a longer step")


@pytest.mark.parametrize("grip", ["box", "ellipse"])
def test_contact_states_of_many_wheels_are_refused_not_waited_for(tmp_path: Path, grip: str) -> None:
    file = many_wheels(tmp_path, 16, grip)
    with pytest.raises(InputError, match="contact states"):
        sm.sweep(file, "floor", step_deg=30.0)
    with pytest.raises(InputError, match="contact states"):
        sm.bounds(file, "floor", step_deg=45.0, robust=True)


def test_bounds_of_many_wheels_say_what_was_left_out(tmp_path: Path) -> None:
    found = sm.bounds(many_wheels(tmp_path, 16), "floor", step_deg=45.0)
    assert np.all(np.isnan(found.bounds.rigid_use))
    assert any("not computed" in line for line in found.lines())
    assert "steady_use_rigid" in found.to_json().partition("not_given")[2]


def test_drawn_robots_are_not_tried_on_too_many_contact_states(tmp_path: Path) -> None:
    """64 states of 8 wheels took 45 s; the limits stand, and a warning says what was left out."""
    file = many_wheels(tmp_path, 6)
    file.write_text(
        file.read_text(encoding="utf-8").replace("mass_kg = 5.0", 'mass_kg = "5.0 ± 0.2"'), encoding="utf-8"
    )
    found = sm.bounds(file, "floor", step_deg=90.0, robust=True)
    assert found.slip_chance is None
    assert any(
        "facets times wheels for each drawn robot" in line and "leave out --robust" in line
        for line in found.warnings
    )


def test_a_motion_of_many_wheels_ends_after_fewer_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """24 wheels took a minute until two million steps were over."""
    monkeypatch.setattr("slipmargin.sim.batch.WHEEL_STEPS", 300)
    model = sm.read_robot("omni4").build("floor")
    t_s = np.linspace(0.0, 1.0, 11)
    signal = linear(t_s, 4.0 * np.sin(7.0 * t_s[:, None] + np.arange(4)))
    with pytest.raises(MotionStopped, match="SLIPMARGIN_WORK=10 to allow ten times as many"):
        simulate(model, signal, t_s)
    monkeypatch.setenv(FACTOR, "100")
    assert simulate(model, signal, t_s).t_s[-1] == 1.0
    with pytest.raises(MotionStopped, match="too many steps"):
        simulate(model, signal, t_s, max_steps=20)


def test_a_robust_plan_of_many_wheels_is_refused_not_waited_for(tmp_path: Path) -> None:
    """Fifty metres of twelve wheels on 64 contact states took half a minute."""
    file, way = many_wheels(tmp_path, 6), np.array([[0.0, 0.0, 0.0], [60.0, 0.0, 0.0]])
    with pytest.raises(InputError, match="over all samples and contact states, and at most 3e\\+06 are made"):
        sm.plan(file, "floor", way, points=800, robust=True)


def test_the_most_that_ends_ask_for_is_that_of_each() -> None:
    """The torques of 24 wheels at every end took half a gigabyte, and bounds 45 s of processor time."""
    model = sm.read_robot("omni4").build("floor")
    motion = all_motions(model)
    asked = Demands.of(model, *prepare(model, motion, 0.9, Contact.ROLLERS)[1:], motion.velocity)
    at = np.random.default_rng(3).normal(0.0, 2.0, (7, motion.count, 3))
    limit = np.full((2, motion.count, model.count), 0.5)
    whole, most = asked.each(at), asked.most(at, np.arange(motion.count), limit)
    near = 100.0 * NEARLY  # what is left of a wrench moves the share of a small grip by more than that
    np.testing.assert_allclose(most.use, whole.use, rtol=near, atol=near)
    np.testing.assert_allclose(most.motors, whole.of_motors(limit), rtol=near, atol=near)
    np.testing.assert_allclose(most.torque_N_m, whole.torque_N_m.max(axis=1), rtol=near, atol=near)


def test_bounds_of_24_wheels_hold_no_table_of_all_ends(tmp_path: Path) -> None:
    file = many_wheels(tmp_path, 24)
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    for i, wheel in enumerate(table["wheel"]):  # no symmetry: every wheel has facets of its own
        wheel["position_m"] = [(1.0 + 0.02 * i) * x for x in wheel["position_m"]]
    file.write_text(mutate.toml(table), encoding="utf-8")
    tracemalloc.start()
    try:
        sm.bounds(file, "floor", step_deg=90.0)
        assert tracemalloc.get_traced_memory()[1] < 700e6
    finally:
        tracemalloc.stop()


def test_one_wrong_time_stamp_makes_no_table_of_ages(tmp_path: Path) -> None:
    """It made arrays of 535 GiB, or took 80 s."""
    lines = (EXCERPT / "gray_0.1" / "heading_005.csv").read_text(encoding="utf-8").rstrip("\n").split("\n")
    cells = lines[-1].split(";")
    lines[-1] = ";".join([str(1e9 * float(cells[0])), *cells[1:]])
    (tmp_path / "l.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"rows on an even clock.* where it jumps by"):
        sm.import_logs([tmp_path / "l.csv"], "robotino", "robotino")


def test_a_robot_that_holds_no_pull_measures_no_floor() -> None:
    """Slopes were divided by the largest pull, and singular values of what is not finite not found."""
    with pytest.raises(InputError, match="hold any pull"):
        _refuse_undecided(("omni",), np.array([0.3, 0.1]), np.zeros(5), lambda mu: np.zeros(5))


def test_training_runs_that_take_minutes_are_refused_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A push of 1 000 N that spins the robot 300 times a second: every run took 14 000 steps."""
    push = Push(force_x_N=-1000.0, force_y_N=0.0, moment_N_m=50.0, time_s=0.1, duration_s=100.0)
    recipe = replace(read_recipe("ohio-kiwi"), effects=(push,))
    ran: list[int] = []
    run = Batch.run
    monkeypatch.setattr(Batch, "run", lambda *a, **k: (ran.append(1), run(*a, **k))[1])
    with pytest.raises(InputError, match="wheel steps of simulated runs"):
        sm.SlipMonitor(recipe, "paper")
    assert len(ran) < 20


def test_a_wheel_whose_name_reads_like_no_number_is_no_absurd_result(tmp_path: Path) -> None:
    (tmp_path / "o.csv").write_text("saturated,force_N\nleft+inf,1.0\n", encoding="utf-8")
    told = {names: judge(0, "", "", tmp_path, set(), names=names)[0] for names in ((), ("left", "inf"))}
    assert told == {(): "absurd", ("left", "inf"): "ok"}
