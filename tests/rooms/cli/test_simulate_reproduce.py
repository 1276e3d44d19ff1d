"""``slipmargin simulate`` and ``slipmargin reproduce`` as a user meets them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

HEAD = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n"
STEP = HEAD + "0,1.16454,1.16454,-4.49944\n3.5,0,0,0\n4.5,0,0,0\n"


def commands(folder: Path, text: str = STEP) -> str:
    file = folder / "c.csv"
    file.write_text(text, encoding="utf-8")
    return str(file)


def test_the_papers_run_from_files(tmp_path, capsys):
    """docs/theory.md, section 6, improved model on paper: x short 52.9 mm, y −22.7 mm, φ −0.114 rad."""
    out, plot = tmp_path / "run.csv", tmp_path / "run.png"
    args = [
        "simulate",
        "ohio-kiwi",
        commands(tmp_path),
        "--surface",
        "paper",
        "--out",
        str(out),
        "--plot",
        str(plot),
    ]
    assert status([*args, "--theta0", "0.131,0.255,0.260"]) == 0
    lines = out.read_text(encoding="utf-8").splitlines()
    assert lines[0] == (
        "t_s,x_m,y_m,phi_rad,vx_m_s,vy_m_s,wz_rad_s,theta1_rad,theta2_rad,theta3_rad,slip_drive1_m_s,slip_drive2_m_s,"
        "slip_drive3_m_s,slip_transverse1_m_s,slip_transverse2_m_s,slip_transverse3_m_s,force_drive1_N,force_drive2_N,"
        "force_drive3_N,force_transverse1_N,force_transverse2_N,force_transverse3_N"
    )
    last = [float(cell) for cell in lines[-1].split(",")]
    np.testing.assert_allclose(last[:3], [4.5, 0.4 - 0.0529, -0.0227], atol=6e-5)
    assert last[3] == pytest.approx(-0.114, abs=5e-4)
    assert plot.stat().st_size > 10_000
    assert "ends at x 0.3471 m" in capsys.readouterr().out


def test_an_end_pose_has_no_minus_zero(tmp_path, capsys, monkeypatch):
    """A mecanum robot that drives straight ends at y 0, whatever the sign that rounding leaves."""
    rows = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s\n0,10,10,10,10\n1,0,0,0,0\n"
    monkeypatch.chdir(tmp_path)
    assert status(["robots", "new", "m", "--type", "mecanum"]) == 0
    args = ["m.toml", commands(tmp_path, rows), "--surface", "floor"]
    assert status(["simulate", *args, "--out", str(tmp_path / "r.csv")]) == 0
    said = capsys.readouterr().out
    assert "y 0.0000 m" in said and "-0.0000" not in said


def test_a_plan_is_followed_from_its_first_pose(tmp_path, capsys):
    t = np.linspace(0.0, 1.0, 51)
    rate = np.sin(np.pi * t) ** 2 * 0.5
    rows = [
        f"{a:.4f},1.0,2.0,0.3,{1.16454 * r:.6f},{1.16454 * r:.6f},{-4.49944 * r:.6f}"
        for a, r in zip(t, rate, strict=True)
    ]
    text = "t_s,x_m,y_m,phi_rad,omega1_rad_s,omega2_rad_s,omega3_rad_s\n" + "\n".join(rows) + "\n"
    assert (
        status(["simulate", "ohio-kiwi", commands(tmp_path, text), "--surface", "paper", "--json", "-"]) == 0
    )
    found = json.loads(capsys.readouterr().out)
    assert [found["x_m"][0], found["y_m"][0], found["phi_rad"][0]] == [1.0, 2.0, 0.3]
    assert found["planned_end_pose"] == [1.0, 2.0, 0.3]
    moved = np.hypot(found["x_m"][-1] - 1.0, found["y_m"][-1] - 2.0)
    assert moved == pytest.approx(0.25 * 0.4 / 3.5, rel=0.05)
    assert found["friction_work_J"] < 0.0


def test_a_plan_in_motion_without_its_velocity_is_said_to_start_at_rest(tmp_path, capsys):
    """Its robot began at rest under wheels that turned, in silence."""

    def said(columns: str, cells: str, turning: str) -> str:
        head = f"t_s,x_m,y_m,phi_rad,{columns}omega1_rad_s,omega2_rad_s,omega3_rad_s\n"
        file = commands(tmp_path, head + "".join(f"{t},0,0,0,{cells}{turning}\n" for t in (0, 0.1)))
        assert status(["simulate", "ohio-kiwi", file, "--surface", "paper"]) == 0
        return capsys.readouterr().err

    twist = "vx_m_s,vy_m_s,wz_rad_s,"
    assert "wz_rad_s: the robot starts at rest" in said("", "", "1,1,1")
    assert "starts at rest" not in said("", "", "0,0,0") + said(twist, "0,0,0,", "1,1,1")


def beside(columns: str) -> str:
    """Commands with columns of a plan: a part of its velocity was dropped, and those without a pose."""
    more = columns.count(",") + 1
    rows = [f"{t},{'0,' * more}1,1,1\n" for t in (0, 1)]
    return HEAD.replace("t_s,", f"t_s,{columns},") + "".join(rows)


@pytest.mark.parametrize(("text", "says"), [
    (STEP.replace("3.5,", "0,"), "time must increase"),
    (STEP.replace("-4.49944", "nan"), "2:4"),
    (STEP.replace("-4.49944", ""), "2:4"),
    (STEP.replace("-4.49944", "1e300"), "below 1e6"),
    (HEAD.replace(",omega3_rad_s", "") + "0,1,1\n1,1,1\n", "omega3_rad_s"),
    (HEAD + "0,1,1,1\n", "one row"),
    ("t_s,x_m,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,0,1,1,1\n1,0,1,1,1\n",
     "y_m"),
    (beside("x_m,y_m,phi_rad,vx_m_s,vy_m_s"), "wz_rad_s: this column is missing"),
    (beside("x_m,y_m,phi_rad,wz_rad_s"), "vx_m_s: this column is missing"),
    (beside("vx_m_s,vy_m_s,wz_rad_s"), "x_m: this column is missing"),
    (beside("ax_m_s2"), "x_m: this column is missing"),
    (beside("use1,use2,use3"), "x_m: this column is missing"),
])  # fmt: skip
def test_bad_commands_are_one_line(tmp_path, capsys, text, says):
    out = tmp_path / "run.csv"
    out.write_text("before", encoding="utf-8")
    assert (
        status(["simulate", "ohio-kiwi", commands(tmp_path, text), "--surface", "paper", "--out", str(out)])
        == 2
    )
    err = capsys.readouterr().err
    assert err.startswith("error: ") and err.count("\n") == 1 and says in err
    assert out.read_text(encoding="utf-8") == "before"


@pytest.mark.parametrize(("option", "value", "says"), [
    ("--theta0", "1,2", "give 3 numbers"), ("--push", "a,b,c", "give 3 numbers"),
    ("--push", "0,0,1e9", "times the weight"), ("--step", "-1", "rows"),
    ("--until", "2", "after the last row"), ("--rtol", "1", "relative error"),
])  # fmt: skip
def test_bad_options_are_one_line(tmp_path, capsys, option, value, says):
    assert status(["simulate", "ohio-kiwi", commands(tmp_path), "--surface", "paper", option, value]) == 2
    err = capsys.readouterr().err
    assert option in err and says in err and err.count("\n") == 1


def test_reproduce_writes_every_number_and_figure(tmp_path, capsys):
    out = tmp_path / "rep"
    assert status(["reproduce", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    report = json.loads((out / "reproduce.json").read_text(encoding="utf-8"))
    numbers = {row["key"]: row for row in report["numbers"]}
    for row in (*report["numbers"], *report["claims"]):
        assert row["verdict"] in {"reproduced", "differs", "cannot be checked"}
        assert row["where"].startswith("section") and row["quote"] and row["note"]
        assert row["key"] in said
        if row["difference"] is not None:
            assert row["difference"] == pytest.approx(row["recomputed"] - row["published"])
    assert all(row["published"] is not None for row in report["numbers"])
    assert sum(report["verdicts"].values()) == len(report["numbers"]) + len(report["claims"])
    assert report["fig8"]["rows"][0]["f_max_per_weight"][0] == pytest.approx(0.16705, abs=5e-6)
    assert report["identifiability"] is None
    assert numbers["improved_carpet_phi"]["published"] == 0.558
    assert (
        numbers["improved_carpet_phi"]["recomputed"] < 0.0
        and "DISCREPANCY" in numbers["improved_carpet_phi"]["note"]
    )
    assert report["measured"][0]["values"] == [0.524, 0.506, 0.489]
    assert "not printed" in report["unprinted"]["origin"] and "not printed" in said
    names = {"fig6.png", "fig7.png", "fig8.png", "fig9.png", "fig10.png", "spread.png"}
    assert names <= {path.name for path in out.iterdir()} and set(report["figures"]) == names


def test_reproduce_refuses_a_file_as_folder(tmp_path, capsys):
    file = tmp_path / "x"
    file.write_text("kept", encoding="utf-8")
    assert status(["reproduce", "--out", str(file)]) == 2
    assert "give a folder" in capsys.readouterr().err and file.read_text(encoding="utf-8") == "kept"


def test_slip_and_energy_do_not_depend_on_the_rows_that_are_written(tmp_path):
    found = []
    for step in ("0.001", "0.01", "0.5"):
        told = tmp_path / "o.json"
        words = ["simulate", "ohio-kiwi", commands(tmp_path), "--surface", "paper", "--step", step]
        assert status([*words, "--json", str(told)]) == 0
        result = json.loads(told.read_text(encoding="utf-8"))
        assert len(result["t_s"]) == round(4.5 / float(step)) + 1
        found.append([*result["peak_drive_slip_m_s"], result["friction_work_J"], *result["least_load_N"]])
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-3)
