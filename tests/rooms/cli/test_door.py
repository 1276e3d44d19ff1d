"""The front door: what it lists, how it answers, and that it loads nothing before it is asked."""

from __future__ import annotations

import doctest
import importlib
import inspect
import json
import os
import pkgutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import slipmargin as sm
from slipmargin import api
from slipmargin.api.result import Result
from slipmargin.errors import InputError

CONTENTS = [
    "Limiter",
    "SlipMonitor",
    "__version__",
    "bounds",
    "built_in_robots",
    "check",
    "check_robot",
    "compare",
    "describe_effect",
    "describe_robot",
    "describe_surface",
    "design",
    "diagnose",
    "explore",
    "export_c",
    "export_simulator",
    "export_trajectory",
    "import_logs",
    "known_effects",
    "known_quantities",
    "known_surfaces",
    "measure",
    "new_robot",
    "next_run",
    "plan",
    "polytope",
    "read_robot",
    "reproduce",
    "robot_from_urdf",
    "simulate",
    "stop",
    "sweep",
    "trajectory_text",
]


def test_the_directory_is_the_table_of_contents() -> None:
    assert dir(sm) == CONTENTS
    assert all(callable(getattr(sm, name)) for name in CONTENTS if name != "__version__")
    with pytest.raises(AttributeError, match=r"dir\(slipmargin\)"):
        _ = sm.sweeep  # type: ignore[attr-defined]


def test_a_room_of_the_same_name_does_not_take_a_function_s_place() -> None:
    code = "import slipmargin.diagnosis.loop, slipmargin as sm; assert callable(sm.diagnose), sm.diagnose"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_importing_the_package_loads_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "numba", "matplotlib", "cvxpy", "typer")
    code = f"import sys, slipmargin; dir(slipmargin); print([m for m in {heavy!r} if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True, timeout=60
    )
    assert done.stdout == "[]\n"


def test_python_dash_m_is_the_command() -> None:
    words = [sys.executable, "-m", "slipmargin", "sweep", "ohio-kiwi", "--surface", "paper"]
    utf8 = os.environ | {"PYTHONUTF8": "1"}  # a terminal that cannot show φ gets its escape
    done = subprocess.run(words, capture_output=True, encoding="utf-8", env=utf8, check=True, timeout=60)
    assert done.stdout.startswith("weakest     4.92 N (0.1671 m g) at φ = 0°")
    wrong = subprocess.run(
        [*words[:-1], "moon"], capture_output=True, encoding="utf-8", check=False, timeout=60
    )
    assert wrong.returncode == 2 and wrong.stderr.startswith("error: command line: --surface: is 'moon'")


MODULES = ["slipmargin", *(f"slipmargin.api.{m.name}" for m in pkgutil.iter_modules(api.__path__))]


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings_run(name: str) -> None:
    assert doctest.testmod(importlib.import_module(name), verbose=False).failed == 0


@pytest.mark.parametrize("name", [name for name in CONTENTS if name != "__version__"])
def test_every_function_has_an_example(name: str) -> None:
    text = inspect.getdoc(getattr(sm, name)) or ""  # __doc__ is indented before Python 3.13
    assert ">>> import slipmargin as sm\n>>> " in text


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    robot = sm.read_robot("ohio-kiwi")
    plan = sm.plan(robot, "paper", [[0, 0, 0], [0.3, 0, 0]], points=40)
    return {
        "sweep": sm.sweep(robot, "paper", step_deg=30.0),
        "polytope": sm.polytope(robot, "paper"),
        "bounds": sm.bounds(robot, "paper", step_deg=45.0),
        "plan": plan,
        "check": sm.check(robot, "paper", plan.trajectory),
        "simulate": sm.simulate(robot, "paper", plan.trajectory),
        "design": sm.design(robot, "paper", "delta_deg=0:60:30", static=True),
    }


@pytest.mark.parametrize("name", ["sweep", "polytope", "bounds", "plan", "check", "simulate", "design"])
def test_a_result_says_draws_and_writes_itself(name: str, results: dict[str, Result], tmp_path: Path) -> None:
    found = results[name]
    line = repr(found)
    assert "\n" not in line and "ohio-kiwi on paper" in line and any(c.isdigit() for c in line)
    assert isinstance(found.plot(), Figure)
    shown = found._repr_html_()
    assert shown.startswith("<div><table>") and shown.count("<svg") == 1
    found.write(tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["schema"] == 1
    found.write(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    if name != "polytope":
        found.write(tmp_path / "a.csv")
        assert len((tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()) > 2
    else:
        with pytest.raises(InputError, match="has no table"):
            found.write(tmp_path / "a.csv")
    with pytest.raises(InputError, match=r"use \.csv"):
        found.write(tmp_path / "a.txt")


def test_arguments_are_refused_by_their_own_names() -> None:
    for call, words in (
        (lambda: sm.sweep("ohio-kiwi", "moon"), "surface: is 'moon'"),
        (lambda: sm.sweep("ohio-kiwi", "paper", margin=1.0), "margin: is 1"),
        (lambda: sm.bounds("ohio-kiwi", "paper", step_deg=0.0), "step_deg: is 0"),
        (lambda: sm.plan("ohio-kiwi", "paper", [[0, 0], [1, 0]]), "waypoints: have the shape"),
        (lambda: sm.simulate("ohio-kiwi", "paper", [[0, 1], [1, 1]]), "commands: have the shape"),
        (lambda: sm.check("ohio-kiwi", "paper", np.zeros((3, 3))), "trajectory: has the shape"),
        (lambda: sm.design("ohio-kiwi", "paper", "delta=1:2:1"), "vary"),
        (lambda: sm.import_logs([], "bag", "robotino"), "format: is 'bag'"),
    ):
        with pytest.raises(InputError) as fault:
            call()
        assert str(fault.value).startswith(words)


def test_a_robot_can_be_changed_while_it_is_read() -> None:
    plain = sm.read_robot("ohio-kiwi", rigid_sectors=False, grip="ellipse", load_model="static")
    found = sm.sweep(plain, "paper", step_deg=45.0)
    assert np.array_equal(found.f_low_N, found.f_high_N) and found.method == "cones"
    assert not found.warnings and sm.sweep("ohio-kiwi", "paper", step_deg=45.0).warnings


@pytest.mark.parametrize(
    ("effect", "where"),
    [
        ({"name": "camera_rotation", "rotation_rad": 0.01}, "diagnose only"),
        ({"name": "wheel_runout", "cosine": 0.02, "sine": 0.0, "wheels": ["rear"]}, "those of round wheels"),
        ({"name": "wheel_wobble", "cosine_rad": 0.05, "wheels": ["rear"]}, "that run true"),
        ({"name": "wheel_play", "play_rad": 0.02}, "those of wheels without play"),
        ({"name": "floor_ramp", "slope_rad": 0.02}, "those of a level floor"),
        ({"name": "floor_seam", "height_m": 0.002}, "those of a level floor"),
        ({"name": "floor_bump", "height_m": 0.002}, "those of a level floor"),
    ],
)
def test_an_effect_that_a_command_does_not_use_is_said(
    tmp_path: Path, effect: dict[str, Any], where: str
) -> None:
    robot = tmp_path / "robot.toml"
    lines = "\n".join(f"{key} = {json.dumps(value)}" for key, value in effect.items())
    known = Path(sm.__file__).parent / "robots" / "ohio-kiwi.toml"
    robot.write_text(f"{known.read_text(encoding='utf-8')}\n[[effect]]\n{lines}\n", encoding="utf-8")
    told = [w for w in sm.sweep(robot, "paper", step_deg=45.0).warnings if w.startswith("effect ")]
    assert told == [w for w in told if effect["name"] in w and where in w] and len(told) == 1
