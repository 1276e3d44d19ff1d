"""What mutated files showed: each of these was a defect, a hang, a file left behind or an absurd number."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fuzz.mutate import number, scalar
from robot_files import GOOD
from slipmargin_cli.main import status

from slipmargin.data.record import Record
from slipmargin.errors import InputError

Said = Callable[..., str]
BASE = GOOD.split("[[effect]]")[0]
NO_FLOOR = """
[[effect]]
name = "floor_border"
factor = 0.0
offset_m = -100.0
"""
ICE = """
[[effect]]
name = "floor_patch"
factor = 0.0
centre_y_m = {place}
radius_m = 10.0
edge_m = 1.0
"""
DRAGGED = """
[[effect]]
name = "dragging_point"
force_N = 1000.0
place_x_m = 1.9
place_y_m = 4.9
"""
PULLED_OVER = """
[[effect]]
name = "tether"
stiffness_N_per_m = 200.0
anchor_x_m = -5.0
anchor_y_m = 0.0
height_m = 2.0
"""
THREE = """
schema = 1
name = "three"
[body]
mass_kg = 2.5
inertia_kg_m2 = 0.03
com_m = [0.0, 0.0]
com_height_m = 0.1
[loads]
model = "quasi-static"
[friction]
grip = "disc-strip"
[motor]
max_speed_rad_s = 9.4
stall_torque_N_m = 3.8
[[wheel]]
name = "left"
position_m = [0.0625, 0.10825]
drive_direction_deg = {}
radius_m = 0.05
rollers = 10
[[wheel]]
name = "back"
position_m = [-0.125, 0.0]
drive_direction_deg = {}
radius_m = 0.05
rollers = 10
[[wheel]]
name = "right"
position_m = [0.0625, -0.10825]
drive_direction_deg = {}
radius_m = 0.05
rollers = 10
[surface.floor]
roller = {{drive = 0.35, transverse = 0.05}}
rigid = {{drive = 0.35, transverse = 0.35}}
"""


@pytest.fixture
def said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Said:
    """Run a command in an empty folder; its refusal, one line, or what it prints."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str, refused: bool = False) -> str:
        assert status([str(word) for word in words]) == (2 if refused else 0)
        told = capfd.readouterr()
        assert not refused or (told.err.startswith("error: ") and told.err.count("\n") == 1)
        return told.err if refused else told.out

    return run


@pytest.mark.parametrize("grip", ["box", "ellipse", "disc-strip"])
def test_a_robot_without_any_grip_has_no_polytope(said: Said, grip: str) -> None:
    Path("r.toml").write_text((BASE + NO_FLOOR).replace('"box"', f'"{grip}"'), encoding="utf-8")
    line = said("polytope", "r.toml", "--surface", "paper", "--plot", "o.svg", refused=True)
    assert "do not span" in line and not Path("o.svg").exists()
    assert "-0.00 N" not in said("sweep", "r.toml", "--surface", "paper", "--step", "30")


def test_almost_no_grip_is_none_and_not_a_huge_deceleration(said: Said) -> None:
    """The ray against the direction left its rows at −150 000 m/s²."""
    for place in np.linspace(24.0, 32.0, 9):
        Path("r.toml").write_text(
            (BASE + ICE.format(place=place)).replace('"equal"', '"quasi-static"'), encoding="utf-8"
        )
        text = said("bounds", "r.toml", "--surface", "paper", "--step", "15", "--json", "o.json")
        assert "inf" not in text
        found = json.loads(Path("o.json").read_text(encoding="utf-8"))
        every = [
            v for key in ("starting", "turning", "braking") for v in found[f"{key}_m_s2"] if v is not None
        ]
        assert all(abs(v) < 1e5 for v in every)


def test_motors_that_drag_stalls_hold_no_acceleration(said: Said) -> None:
    """A row that hardly depends on the acceleration left −1 700 000 m/s²."""
    Path("r.toml").write_text(BASE + DRAGGED, encoding="utf-8")
    text = said("bounds", "r.toml", "--surface", "paper", "--step", "45", "--json", "o.json")
    assert "motor       none: drag alone takes more than the stall torque" in text
    assert json.loads(Path("o.json").read_text(encoding="utf-8"))["motor_limit_m_s2"] == 0.0


def test_a_set_that_is_thin_in_a_direction_has_no_share_of_nothing(said: Said) -> None:
    nap = '\n[[effect]]\nname = "floor_nap"\nnap_x = 0.9\nnap_y = -0.9\n'
    Path("r.toml").write_text((BASE + nap).replace('"box"', '"disc-strip"'), encoding="utf-8")
    assert "nan" not in said("polytope", "r.toml", "--surface", "paper")


def test_a_stop_from_no_robot_s_speed_is_refused(said: Said) -> None:
    Path("r.toml").write_text(
        BASE.replace("[motor]\nmax_speed_rad_s = 60.0\nstall_torque_N_m = 0.9\n", ""), encoding="utf-8"
    )
    line = said("stop", "r.toml", "--surface", "paper", "--speed", "1e12", "--no-verify", refused=True)
    assert "up to 1000 m/s" in line


def test_a_path_that_is_to_end_at_no_robot_s_speed_is_refused(said: Said) -> None:
    """Its square was too large for a number."""
    Path("w.csv").write_text("x_m,y_m,phi_rad\n0,0,0\n1,0,0\n", encoding="utf-8")
    words = ("--surface", "floor", "--end-speed", "1e300", "--out", "o.csv")
    line = said("plan", "mecanum4", "w.csv", *words, refused=True)
    assert "--end-speed" in line and "from 0 to 1000 m/s" in line


def test_what_slips_anyway_has_no_second_method(said: Said) -> None:
    """The best of designs that all slip was said to differ by inf from a second method."""
    drags = DRAGGED.replace("1000.0", "2.0").replace("1.9", "0.02").replace("4.9", "0.02")
    Path("r.toml").write_text(BASE + drags, encoding="utf-8")
    words = ("--vary", "mass_kg=0.5,0.6", "--objective", "start_worst_m_s2")
    assert " inf " not in said("design", "r.toml", "--surface", "paper", *words)


def test_a_file_and_a_folder_have_two_names(said: Said) -> None:
    line = said("reproduce", "--out", "o.json", "--json", "o.json", refused=True)
    assert "as a file and as a folder" in line and not Path("o.json").exists()


def test_a_study_that_is_refused_at_its_end_leaves_no_pieces(
    said: Said, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("r.toml").write_text((BASE + PULLED_OVER).replace('"equal"', '"quasi-static"'), encoding="utf-8")
    words = ("design", "r.toml", "--surface", "paper", "--vary", "wheel_radius_m=0.02,0.05", "--out", "o.csv")
    said(*words)  # the best of what falls over was checked by a second method, which refused it
    assert sorted(path.name for path in Path().iterdir()) == ["o.csv", "r.toml"]

    def refuse(*_: object) -> None:
        raise InputError("design", "is refused", "take another one")

    monkeypatch.setattr(import_module("slipmargin.study.reason"), "reason", refuse)
    said(*words, refused=True)
    assert sorted(path.name for path in Path().iterdir()) == ["o.csv", "r.toml"]


def test_times_of_a_million_years_are_no_trajectory(said: Said) -> None:
    rows = "\n".join(f"{k}e13,{0.1 * k},0,0" for k in range(10))
    Path("t.csv").write_text("t_s,x_m,y_m,phi_rad\n" + rows + "\n", encoding="utf-8")
    line = said("check", "mecanum4", "t.csv", "--surface", "floor", refused=True)
    assert "t_s" in line and "give numbers below 1e+12" in line


def test_angles_that_no_wheel_turns_are_no_run() -> None:
    t_s = np.linspace(0.0, 1.0, 30)
    with pytest.raises(InputError, match="theta: holds 1e\\+15, and no robot measures that"):
        Record(name="l", t_s=t_s, pose=np.zeros((30, 3)), theta=1e15 * t_s[:, None])


def test_a_path_that_turns_a_hundred_thousand_times_is_refused_not_waited_for(said: Said) -> None:
    """It was checked at seven million places, for minutes."""
    Path("w.csv").write_text(
        "x_m,y_m,phi_rad\n0,0,0\n-0.1,0.1,0\n-0.2,0.2,938234\n-0.3,0.3,938234\n", encoding="utf-8"
    )
    line = said("plan", "robotino", "w.csv", "--surface", "gray", "--out", "o.csv", refused=True)
    assert "grid points, and at most 1.5e+04 are made" in line and "SLIPMARGIN_WORK" in line


def test_drives_whose_lines_nearly_meet_are_compared_with_others(said: Said) -> None:
    """Where one wheel carries nothing besides, the matrix of the drive forces could not be inverted."""
    Path("r.toml").write_text(THREE.format(150.0, -90.0, 30.0), encoding="utf-8")
    Path("s.toml").write_text(THREE.format(1500.0, -90.0, 30.0), encoding="utf-8")
    assert "r is best" in said("design", "r.toml", "s.toml", "--surface", "floor")


def test_two_methods_agree_on_no_pull_at_all(said: Said) -> None:
    """Their difference was told as a share of nothing."""
    Path("r.toml").write_text((BASE + NO_FLOOR).replace("drive = 0.26", "drive = 1e-300"), encoding="utf-8")
    out = said("sweep", "r.toml", "--surface", "paper", "--method", "cvxpy")
    assert "of the pull" in out and "by inf" not in out and "-0.00" not in out


def test_a_wheel_that_carries_the_robot_alone_gives_no_polytope(said: Said) -> None:
    """Rounding gave the others a load, and facets with normals of 1e14."""
    load = BASE.replace('"equal"', '"static"').replace(
        "com_m = [0.0, 0.0]", "com_m = [0.0, -0.09499999999999]"
    )
    Path("r.toml").write_text(load, encoding="utf-8")
    assert "do not span forces" in said("polytope", "r.toml", "--surface", "paper", refused=True)


def test_a_file_is_no_folder_above_another_output(said: Said) -> None:
    """The folder was made, and the file then refused."""
    line = said("reproduce", "--out", "o/within", "--json", "o", refused=True)
    assert "as a file and as a folder" in line and not Path("o").exists()


def test_integers_too_large_for_a_float_are_mutated_as_well() -> None:
    """The fuzzer itself ended at one of them."""
    for seed in range(2000):
        for value in (10**400, -(10**400)):
            number(Random(seed), value)
            scalar(Random(seed), value)
