"""``slipmargin import``: real logs to a data set that other commands read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from real_logs import EXCERPT, logs
from slipmargin_cli.main import status

from slipmargin.io.data_set import read_data_set

TABLE = [str(p) for p in logs(EXCERPT / "table_0.1")]
GRAY = [str(p) for p in logs(EXCERPT / "gray_0.1")]


def test_calibrate_on_one_floor_and_hold_on_the_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, gray = tmp_path / "table", tmp_path / "gray"
    assert (
        status(["import", "robotino", *TABLE, "--surface", "table", "--calibrate", "--out", str(table)]) == 0
    )
    told = capsys.readouterr()
    assert "read 6 runs" in told.out and "camera delay" in told.out and told.err == ""
    assert (
        status(
            [
                "import",
                "robotino",
                *GRAY,
                "--surface",
                "gray",
                "--out",
                str(gray),
                "--calibration",
                str(table / "calibration.toml"),
                "--json",
                "-",
            ]
        )
        == 0
    )
    report = json.loads(capsys.readouterr().out)
    assert report["schema"] == 1 and len(report["runs"]) == 8 and report["checks"] == []
    held = read_data_set(gray)
    assert held.surface == "gray" and len(held.trials) == 8
    assert [e.name for e in held.recipe.effects] == ["camera_scale", "camera_rotation", "camera_delay"]
    assert held.recipe.effects == read_data_set(table).recipe.effects
    assert report["calibration"]["scale"] == held.recipe.effects[0].scale_x  # type: ignore[union-attr]
    assert (gray / "calibration.toml").read_text(encoding="utf-8") == (table / "calibration.toml").read_text(
        encoding="utf-8"
    )


def test_damage_is_told_and_the_rest_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_text(Path(GRAY[0]).read_text(encoding="utf-8").rstrip("\n")[:-50], encoding="utf-8")
    (tmp_path / "letter.csv").write_text("dear reader\n", encoding="utf-8")
    out = tmp_path / "set"
    assert status(["import", "robotino", str(cut), str(tmp_path / "letter.csv"), "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "cut.csv: line" in told and "letter.csv: not used" in told and "Traceback" not in told
    assert len(read_data_set(out).trials) == 1


def test_swapped_wheels_are_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in GRAY[:4]:
        lines = Path(path).read_text(encoding="utf-8")
        (tmp_path / Path(path).name).write_text(
            lines.replace("m1pos", "m9pos").replace("m2pos", "m1pos").replace("m9pos", "m2pos"),
            encoding="utf-8",
        )
    files = [str(p) for p in sorted(tmp_path.glob("*.csv"))]
    assert status(["import", "robotino", *files, "--out", str(tmp_path / "set")]) == 0
    assert "warning: trials: " in (err := capsys.readouterr().err) and "wheels 1 and 2 swapped" in err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([GRAY[0], "--surface", "moon"], "'moon' is not described"),
        ([GRAY[0], "--robot", "nobody"], "nobody"),
        ([GRAY[0], "--calibrate", "--calibration", "x.toml"], "--calibrate: is given together"),
        ([GRAY[0], "--calibration", "gone.toml"], "gone.toml: there is no such file"),
        (["gone.csv"], "gone.csv: there is no such file"),
        ([GRAY[0], "--ticks-per-turn", "0"], "--ticks-per-turn: is 0"),
    ],
)
def test_bad_usage_is_one_line_and_leaves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], told: str
) -> None:
    assert status(["import", "robotino", *arguments, "--out", str(tmp_path / "set")]) == 2
    err = capsys.readouterr().err
    assert err.startswith("error: ") and err.count("\n") == 1 and told in err
    assert not (tmp_path / "set").exists()


def test_a_camera_is_not_calibrated_on_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # A motor that lags behind its command would have become the camera's delay, one that droops its scale.
    t = np.arange(0.0, 8.0, 0.02)
    speed = np.clip(t, 0.0, 1.0) * np.array([[1.0], [-0.5], [-0.5]])
    rows = np.column_stack([t, 0.02 * t, 0.0 * t, 0.0 * t, *speed])
    head = "t_s,x_m,y_m,phi_rad,a,b,c"
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=head, comments="")
    wheels = [word for name in "abc" for word in ("--wheel", f"{name}:rad/s")]
    pose = ["--time", "t_s", "--x", "x_m", "--y", "y_m", "--heading", "phi_rad"]
    words = ["import", "csv", str(tmp_path / "log.csv"), "--robot", "ohio-kiwi", *pose, *wheels]
    assert status([*words, "--commanded", "--calibrate", "--out", str(tmp_path / "set")]) == 2
    assert "has no measured wheel angles or speeds" in capsys.readouterr().err
    assert not (tmp_path / "set").exists()


def test_a_mapped_csv(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "map.toml").write_text(
        """
schema = 1
separator = ";"
time = { column = "t", unit = "ms" }
[pose]
x = { column = "xpos", unit = "mm", scale = 1.84 }
y = { column = "ypos", unit = "mm", scale = -1.84 }
heading = { column = "ang", unit = "deg", offset_rad = 1.5707963 }
"""
        + "".join(
            f'[[wheel]]\nangle = {{ column = "m{i}pos", unit = "ticks", ticks_per_turn = 32000, '
            "scale = -1 }\n"
            for i in (1, 2, 3)
        ),
        encoding="utf-8",
    )
    assert (
        status(
            [
                "import",
                "csv",
                *GRAY,
                "--map",
                str(tmp_path / "map.toml"),
                "--robot",
                "robotino",
                "--surface",
                "gray",
                "--out",
                str(tmp_path / "set"),
            ]
        )
        == 0
    )
    assert "read 8 runs (csv)" in capsys.readouterr().out
    assert read_data_set(tmp_path / "set").trials[0].theta is not None


def test_a_bag_that_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("rosbags", reason="rosbags is not installed (extra [ros])")
    topics = ["--pose-topic", "/p", "--joint-topic", "/j", "--joint", "a", "--joint", "b", "--joint", "c"]
    assert (
        status(
            ["import", "ros", str(tmp_path), "--robot", "robotino", *topics, "--out", str(tmp_path / "set")]
        )
        == 2
    )
    assert "is no bag" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("unit", "words", "says"),
    [
        ("rad/s", ["--commanded"], "commanded"),
        ("rad/s", [], "measured"),
        ("rad", ["--commanded"], "--commanded: is given, and r holds no wheel speeds"),
    ],
)
def test_the_wheel_columns_may_be_commands(
    unit: str, words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Wheel speeds that were said to be commanded were asked for a second time, as commands."""
    log, out = tmp_path / "r.csv", tmp_path / "set"
    rows = [
        f"{0.01 * i:.2f},{5e-4 * i * i * 1e-2:.6f},0,0,{0.03 * i:.3f},{-0.03 * i:.3f},0" for i in range(80)
    ]
    log.write_text("\n".join(["t,x,y,yaw,a,b,c", *rows]) + "\n", encoding="utf-8")
    wheels = [word for name in "abc" for word in ("--wheel", f"{name}:{unit}")]
    named = ["--time", "t", "--x", "x", "--y", "y", "--heading", "yaw", *wheels]
    code = status(["import", "csv", str(log), "--robot", "ohio-kiwi", "--out", str(out), *named, *words])
    if says.startswith("--"):
        assert code == 2 and says in capsys.readouterr().err and not out.exists()
        return
    assert code == 0
    read = read_data_set(out)
    (trial,) = read.trials
    assert read.wheel_signal.value == says
    assert (trial.omega_cmd is None) == (says == "measured") and (trial.omega is None) == (
        says == "commanded"
    )


def test_a_map_of_commands_alone_needs_the_word(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, mapped = tmp_path / "r.csv", tmp_path / "m.toml"
    log.write_text(
        "t,x,y,h,a,b,c\n" + "".join(f"{0.01 * i},0,0,0,1,1,1\n" for i in range(9)), encoding="utf-8"
    )
    named = (("x", "x", "m"), ("y", "y", "m"), ("heading", "h", "rad"))
    pose = "\n".join(f'{k} = {{ column = "{c}", unit = "{u}" }}' for k, c, u in named)
    wheels = "".join(f'\n[[wheel]]\ncommand = {{ column = "{c}", unit = "rad/s" }}' for c in "abc")
    mapped.write_text(
        f'schema = 1\n[time]\ncolumn = "t"\nunit = "s"\n[pose]\n{pose}{wheels}\n', encoding="utf-8"
    )
    words = [
        "import",
        "csv",
        str(log),
        "--robot",
        "ohio-kiwi",
        "--out",
        str(tmp_path / "o"),
        "--map",
        str(mapped),
    ]
    assert status(words) == 2
    assert "--commanded: is not given, and r holds commanded speeds alone, give it" in capsys.readouterr().err
