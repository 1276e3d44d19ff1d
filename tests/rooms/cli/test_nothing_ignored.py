"""What has no effect is refused, or the answer says so.  Each of these was ignored without a word."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.io.robot_text import write_recipe

WAY = "x_m,y_m,phi_rad\n0,0,0\n1,0,0\n"
MONITORED = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s"


def robot(folder: Path, *effects: str, name: str = "mecanum4") -> str:
    """A built-in robot with effects in its file."""
    file = folder / f"{name}.toml"
    text = write_recipe(sm.read_robot(name))
    file.write_text("\n\n".join([text, *(f"[[effect]]\n{e}" for e in effects)]), encoding="utf-8")
    return str(file)


@pytest.fixture
def said(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    """What a command says on stderr, and its exit status."""

    def run(*words: object) -> tuple[int, str]:
        capsys.readouterr()
        code = status([str(w) for w in words])
        return code, capsys.readouterr().err

    return run


def test_columns_that_a_monitor_does_not_read(said, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    words = ("monitor", "ohio-kiwi", log, "--surface", "paper", "--false-alarms", 0.5)
    rows = "".join(f"{0.01 * k:.2f},1,2,-3,500,7\n" for k in range(30))
    log.write_text(f"{MONITORED},gyro_deg_s,foo\n{rows}", encoding="utf-8")
    code, told = said(*words)
    assert code == 0 and "columns not read: gyro_deg_s, foo" in told
    log.write_text(f"{MONITORED},omega1_rad_s\n0,1,2,3,4\n", encoding="utf-8")
    assert said(*words) == (
        2,
        f"error: {log}: line 1: has the column omega1_rad_s twice, remove one of them\n",
    )
    log.write_text(f"{MONITORED}\n0,1,2,3,4\n", encoding="utf-8")
    code, told = said(*words)
    assert code == 2 and "line 2: has 5 cells, the header 4" in told


def test_channels_that_a_monitor_was_made_without() -> None:
    watch = sm.SlipMonitor("ohio-kiwi", "paper", false_alarm_rate=0.5)
    for channel in ({"gyro_rad_s": 9.0}, {"current_A": [1, 1, 1]}, {"commanded_rad_s": [1, 1, 1]}):
        with pytest.raises(InputError, match="has no effect: the monitor was made without it"):
            watch.update(0.0, [1.0, 1.0, 1.0], **channel)  # type: ignore[arg-type]


def test_columns_that_a_check_does_not_read(said, tmp_path: Path) -> None:
    t = np.linspace(0.0, 2.0, 41)
    pose = np.column_stack([t, 0.02 * t**2, 0.0 * t, 0.0 * t])
    file = tmp_path / "way.csv"

    def checked(more: str, *columns: np.ndarray) -> str:
        head = "t_s,x_m,y_m,phi_rad" + more
        np.savetxt(file, np.column_stack([pose, *columns]), delimiter=",", header=head, comments="")
        code, told = said("check", "ohio-kiwi", file, "--surface", "paper")
        assert code == 0
        return told

    assert "not read" not in checked("")
    assert "columns not read: vx_mm_s, foo" in checked(",vx_mm_s,foo", t, t)
    assert "columns not read: ax_m_s2, ay_m_s2 (rates are compared where all" in checked(
        ",ax_m_s2,ay_m_s2", t, t
    )
    assert "not read" not in checked(",vx_m_s,vy_m_s,omega1_rad_s,use1", 0.04 * t, 0.0 * t, t, t)
    text = checked(",vx_m_s,vy_m_s", 0.04 * t, 0.0 * t)
    assert "not read" not in text
    lines = file.read_text(encoding="utf-8").splitlines()
    lines[5] = ",".join([*lines[5].split(",")[:4], "", "0"])
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert "columns not read: vx_m_s, vy_m_s" in said("check", "ohio-kiwi", file, "--surface", "paper")[1]


def test_quoted_columns_that_a_check_does_read(said, tmp_path: Path) -> None:
    t = np.linspace(0.0, 2.0, 41)
    file = tmp_path / "way.csv"
    head = '"t_s","x_m","y_m","phi_rad","foo"'
    np.savetxt(
        file, np.column_stack([t, 0.02 * t**2, 0 * t, 0 * t, t]), delimiter=",", header=head, comments=""
    )
    code, told = said("check", "ohio-kiwi", file, "--surface", "paper")
    assert code == 0 and "warning: columns not read: foo\n" in told


def test_smoothing_that_smooths_nothing(said, tmp_path: Path) -> None:
    t = np.linspace(0.0, 2.0, 101)
    file = tmp_path / "way.csv"
    head = "t_s,x_m,y_m,phi_rad"
    np.savetxt(file, np.column_stack([t, 0.02 * t**2, 0 * t, 0 * t]), delimiter=",", header=head, comments="")
    for least, idle in ((0.009, True), (0.05, True), (0.081, False)):
        code, told = said("check", "ohio-kiwi", file, "--surface", "paper", "--smooth", least)
        assert code == 0 and (f"smooth_s {least:g} has no effect" in told) is idle


def test_friction_that_a_wrench_set_does_not_count(said, tmp_path: Path) -> None:
    edge = 'name = "floor_border"\noffset_m = 10.0\ndirection_rad = 0.0\nfactor = 0.5\nedge_m = 0.01'
    code, told = said("polytope", robot(tmp_path, edge), "--surface", "floor")
    assert code == 0 and "falls to 0.5 of what this set has" in told
    assert "falls to" not in said("polytope", "mecanum4", "--surface", "floor")[1]


def test_effects_that_designs_and_simulators_do_not_count(said, tmp_path: Path) -> None:
    file = robot(tmp_path, 'name = "motor_lag"\nlag_s = 0.05')
    design = ("design", file, "--surface", "floor", "--vary", "mass_kg=9,10", "--static")
    assert "effect motor_lag: counts in" in said(*design)[1]
    for form in ("sdf", "urdf", "mjcf"):
        code, told = said("export", form, file, "--out", tmp_path / f"r.{form.replace('mjcf', 'xml')}")
        assert code == 0 and "effect motor_lag: counts in" in told


def test_a_name_is_no_way_to_another_folder(said, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    file = Path(robot(tmp_path))
    text = file.read_text(encoding="utf-8").replace('name = "mecanum4"', 'name = "../../evil"', 1)
    file.write_text(text, encoding="utf-8")
    monkeypatch.chdir(inner)
    assert said("export", "sdf", file)[0] == 0
    assert [p.name for p in inner.iterdir()] == ["evil.sdf"] and not (tmp_path / "evil.sdf").exists()


def test_an_effect_on_too_few_wheels(said, tmp_path: Path) -> None:
    loads = 'name = "wheel_loads"\nshift_x_m = 0.0\nshift_y_m = 0.0\ndiagonal_share = 0.2'
    code, told = said("bounds", robot(tmp_path, loads, name="ohio-kiwi"), "--surface", "paper")
    assert code == 2 and "diagonal_share: has no effect on 3 wheels, only on 4 or more" in told
    assert said("bounds", robot(tmp_path, loads), "--surface", "floor")[0] == 0


def test_options_without_effect(said, tmp_path: Path) -> None:
    way = tmp_path / "way.csv"
    way.write_text(WAY, encoding="utf-8")
    plan = ("plan", "omni4", way, "--surface", "floor")
    code, told = said(*plan, "--blend", "0.1", "--out", tmp_path / "p.csv")
    assert code == 2 and "--blend: has no effect: two waypoints have no corner" in told
    exact = sm.read_robot("omni4").build("floor")
    assert not exact.grip.rigid_fraction.any()
    assert (
        "robust has no effect" in said("bounds", "omni4", "--surface", "floor", "--robust", "--step", "45")[1]
    )
    assert (
        "robust has" not in said("bounds", "ohio-kiwi", "--surface", "paper", "--robust", "--step", "45")[1]
    )
    code, told = said(*plan, "--out", "-")
    assert code == 2 and "stdout takes JSON text alone" in told and not Path("-").exists()


def test_wheel_angles_that_a_sweep_does_not_compare(said, tmp_path: Path) -> None:
    pulls = tmp_path / "pulls.csv"
    pulls.write_text("phi_rad,force_N,theta1_rad,theta2_rad,theta3_rad\n0,4.5,0,0,0\n", encoding="utf-8")
    code, told = said("sweep", "ohio-kiwi", "--surface", "paper", "--step", "30", "--measured", pulls)
    assert code == 0 and "wheel angles of the pulls are not read" in told


def test_coefficients_that_are_no_table(said, tmp_path: Path) -> None:
    file = Path(robot(tmp_path))
    text = file.read_text(encoding="utf-8")
    text += '\n[surface.mine]\nlibrary = "paper-omni-williams2002"\nroller = 3\n'
    file.write_text(text, encoding="utf-8")
    code, told = said("bounds", file, "--surface", "mine", "--step", "45")
    assert code == 2 and "surface.mine.roller: is 3, not a table" in told
