"""A data set is read strictly, written whole, and comes back as it was."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.pulls import Pulls
from slipmargin.data.record import Record
from slipmargin.diagnosis.pull_diagnosis import of_unused
from slipmargin.errors import InputError
from slipmargin.io.data_set import read_data_set
from slipmargin.io.data_set_write import check_data_set_place, write_data_set
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.trial_file import read_pulls, read_trial, trial_parts

TRIAL = (
    "t_s,x_m,y_m,phi_rad,omega1_rad_s,omega2_rad_s,omega3_rad_s,theta1_rad,theta2_rad,theta3_rad\n"
    "0,0,0,0,0,0,0,0,0,0\n0.01,0.001,,0.1,1,2,3,0.01,0.02,0.03\n0.03,0.002,0.1,0.2,1,2,3,0.1,0.2,0.3\n"
)
HEAD = 'schema = 1\nrobot = "robot.toml"\nsurface = "gray"\nwheel_signal = "measured"\n'
SIGMA = "[sigma]\nx_m = 0.0005\ny_m = 0.0005\nphi_rad = 0.002\n"


def record(**more: object) -> Record:
    t = np.array([0.0, 0.01, 0.03, 0.031])
    pose = np.array([[0.0, 0, 0], [0.1, np.nan, 0.2], [0.2, 0.1, 0.3], [0.25, 0.1, 0.3]])
    return Record(
        **{
            "name": "a",
            "t_s": t,
            "pose": pose,
            "omega": np.ones((4, 3)),  # type: ignore[arg-type]
            "theta": np.cumsum(np.ones((4, 3)), axis=0),
        }
        | more
    )


def mixed() -> Record:
    """The angle of one wheel and the speeds of the others."""
    one, two = np.ones((4, 3)), np.ones((4, 3))
    one[:, 1:], two[:, 0] = np.nan, np.nan
    return record(theta=one, omega=two)


def data_set(**more: object) -> DataSet:
    return DataSet(
        **{
            "name": "d",
            "recipe": read_recipe("robotino"),
            "surface": "gray",  # type: ignore[arg-type]
            "wheel_signal": WheelSignal.MEASURED,
            "trials": (record(),),
            "sigma": np.array([1e-3, 1e-3, 2e-3]),
        }
        | more
    )


def folder(tmp_path: Path, head: str = HEAD, trial: str | None = TRIAL, pulls: str | None = None) -> Path:
    there = tmp_path / "set"
    write_data_set(there, data_set())
    (there / "dataset.toml").write_text(head, encoding="utf-8")
    (there / "trials" / "a.csv").unlink()
    if trial is not None:
        (there / "trials" / "t0.csv").write_text(trial, encoding="utf-8")
    if pulls is not None:
        (there / "pulls.csv").write_text(pulls, encoding="utf-8")
    return there


def test_reads_what_the_contract_says(tmp_path: Path) -> None:
    found = read_data_set(folder(tmp_path, HEAD + SIGMA, pulls="phi_rad,force_N\n0.5,4.5\n1,5\n"))
    assert (found.name, found.surface, found.wheel_signal) == ("set", "gray", WheelSignal.MEASURED)
    assert found.sigma is not None and found.sigma.tolist() == [0.0005, 0.0005, 0.002]
    assert found.pulls is not None and found.pulls.force_N.tolist() == [4.5, 5.0]
    trial = found.trials[0]
    assert trial.name == "t0" and trial.seen.tolist() == [True, False, True]
    assert trial.theta is not None and trial.theta[2].tolist() == [0.1, 0.2, 0.3]
    assert trial.omega_cmd is None and trial.wheels == 3 and trial.duration_s == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"head": HEAD.replace("= 1", "= 2")}, "schema"),
        ({"head": HEAD + "colour = 3\n"}, "colour: is not a known key"),
        ({"head": HEAD.replace('"gray"', '"moon"')}, "'moon' is not described"),
        ({"head": HEAD.replace('"measured"', '"heard"')}, "wheel_signal: is 'heard'"),
        ({"head": HEAD + SIGMA.replace("0.002", "0")}, "sigma.phi_rad"),
        ({"head": HEAD + "[sigma]\nx_m = 0.1\n"}, "sigma.y_m: is missing"),
        ({"head": HEAD + SIGMA + "z_m = 1\n"}, "z_m: is not a known key"),
        ({"head": HEAD + "[["}, "is not TOML"),
        ({"trial": None}, "there is no trial"),
        ({"trial": TRIAL.replace("phi_rad", "phi_deg", 1)}, "'phi_rad' is missing"),
        ({"trial": TRIAL.replace("theta3_rad", "theta4_rad", 1)}, "'theta4_rad' is not a known column"),
        ({"trial": TRIAL.replace("0.03,0.002", "0.005,0.002")}, "4:1: the time 0.005 s does not come after"),
        ({"trial": TRIAL.replace("0.01,0.001", "0.01,zero")}, "3:2: x_m is 'zero'"),
        ({"trial": TRIAL.replace(",3,0.1,0.2,0.3", ",3,0.1")}, "4:9: the row has 8 cells"),
        ({"trial": "t_s,x_m,y_m,phi_rad\n0,0,0,0\n1,1,1,1\n"}, "wheel 1 has no omega1_rad_s or theta1_rad"),
        ({"head": HEAD.replace("measured", "commanded")}, "wheel 1 has no omega1_cmd_rad_s"),
        ({"trial": "t_s,x_m,y_m,phi_rad\n0,0,,0\n1,,1,1\n"}, "no sample holds a whole pose"),
        ({"pulls": "phi_rad,force_N\n0.5,\n"}, "2:2: force_N is empty"),
        ({"pulls": "phi_rad,force_N,theta1_rad\n0.5,1,2\n"}, "'theta2_rad' is missing"),
    ],
)
def test_refuses_in_one_line_that_names_the_place(tmp_path: Path, change: dict[str, str], told: str) -> None:
    with pytest.raises(InputError) as refusal:
        read_data_set(folder(tmp_path, **change))  # type: ignore[arg-type]
    text = str(refusal.value)
    assert told in text and "\n" not in text and str(tmp_path) in text


def test_refuses_a_folder_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such folder"):
        read_data_set(tmp_path / "nowhere")
    with pytest.raises(InputError, match=r"dataset\.toml: is not there"):
        read_data_set(tmp_path)


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"trials": ()}, "there is no trial"),
        ({"sigma": np.array([1.0, 0.0, 1.0])}, "noise is positive"),
        ({"sigma": np.array([1.0, 1e-300, 1.0])}, "noise is positive: give it, from 1e-09 to 1000"),
        ({"trials": (record(omega=np.ones((4, 2)), theta=None),)}, "has 2 wheels"),
        ({"trials": (mixed(),)}, "a: has angles of some wheels and speeds of others, give angles or speeds"),
    ],
)
def test_a_data_set_that_contradicts_itself(more: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        data_set(**more)


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"t_s": np.array([0.0])}, "no motion"),
        ({"t_s": np.array([0.0, np.nan, 2, 3])}, "a time that is missing"),
        ({"t_s": np.array([0.0, 2, 1, 3])}, "sample 3 is at 1 s"),
        ({"pose": np.zeros((4, 2))}, "shape"),
        ({"pose": np.full((4, 3), np.inf)}, "infinite"),
        ({"pose": np.full((4, 3), np.nan)}, "no sample holds a whole pose"),
        ({"omega": np.ones((4, 4))}, "theta"),
    ],
)
def test_a_record_that_contradicts_itself(more: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        record(**more)


def test_records_cannot_be_written_to() -> None:
    with pytest.raises(ValueError, match="read-only"):
        record().pose[0, 0] = 1.0


def test_comes_back_as_it_was_written(tmp_path: Path) -> None:
    given = data_set(
        pulls=Pulls(
            phi_rad=np.array([0.1, 2.0]), force_N=np.array([3.0, 4.0]), theta_rad=np.arange(6.0).reshape(2, 3)
        )
    )
    write_data_set(tmp_path / "s", given, {"notes.txt": "hello"}, comment="made in a test")
    back = read_data_set(tmp_path / "s")
    np.testing.assert_array_equal(back.trials[0].pose, given.trials[0].pose)
    assert given.trials[0].theta is not None and back.trials[0].theta is not None
    np.testing.assert_array_equal(back.trials[0].theta, given.trials[0].theta)
    assert back.sigma is not None and back.sigma.tolist() == [1e-3, 1e-3, 2e-3]
    assert back.pulls is not None and back.pulls.theta_rad is not None
    assert back.pulls.theta_rad.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert (tmp_path / "s" / "notes.txt").read_text(encoding="utf-8") == "hello"
    write_data_set(tmp_path / "again", back, {"notes.txt": "hello"}, comment="made in a test")
    one, two = (
        {p.relative_to(tmp_path / name): p.read_bytes() for p in (tmp_path / name).rglob("*.*")}
        for name in ("s", "again")
    )
    assert one == two and len(one) > 3


def test_replaces_a_data_set_whole_and_nothing_else(tmp_path: Path) -> None:
    place = tmp_path / "s"
    write_data_set(place, data_set(trials=(record(), record(name="b"))))
    write_data_set(place, data_set())
    assert [p.name for p in (place / "trials").iterdir()] == ["a.csv"]  # no trial of the old one is left
    assert [p.name for p in tmp_path.iterdir()] == ["s"]  # and no stage
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("keep", encoding="utf-8")
    with pytest.raises(InputError, match="holds something else"):
        write_data_set(tmp_path / "mine", data_set())
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="is a file"):
        check_data_set_place(tmp_path / "file")
    with pytest.raises(InputError, match="parent folder"):
        check_data_set_place(tmp_path / "no" / "s")


def test_a_failed_write_leaves_the_old_data_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "s"
    write_data_set(place, data_set())
    before = (place / "dataset.toml").read_text(encoding="utf-8")

    def full(_: object) -> Iterator[str]:
        yield "t_s"
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("slipmargin.io.data_set_write.trial_parts", full)
    with pytest.raises(InputError, match="No space left"):
        write_data_set(place, data_set(sigma=None))
    assert (place / "dataset.toml").read_text(encoding="utf-8") == before
    assert [p.name for p in tmp_path.iterdir()] == ["s"]


def test_a_failed_exchange_puts_the_old_one_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = (tmp_path / "s").resolve()
    write_data_set(place, data_set())
    real = os.replace

    def refuses(source: Path, target: Path) -> None:
        if Path(source).name == "new":
            raise OSError(5, "Input/output error")
        real(source, target)

    monkeypatch.setattr(os, "replace", refuses)
    with pytest.raises(InputError, match="Input/output error"):
        write_data_set(place, data_set(sigma=None))
    monkeypatch.undo()
    assert read_data_set(place).sigma is not None
    assert [p.name for p in tmp_path.iterdir()] == ["s"]


def test_a_place_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def denied(**_: object) -> str:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.mkdtemp", denied)
    with pytest.raises(InputError, match="Permission denied"):
        write_data_set(tmp_path / "s", data_set())


number = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda v: float(f"{v:.6g}"))


@settings(max_examples=40, deadline=None)
@given(
    rows=st.lists(
        st.tuples(st.floats(1e-3, 1.0), number, number, st.one_of(number, st.none()), number),
        min_size=2,
        max_size=12,
    )
)
def test_any_trial_survives_the_round_trip(
    rows: list[tuple[float, ...]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    t = np.round(np.cumsum([r[0] for r in rows]), 6)
    pose = np.array([[r[1], r[2], np.nan if r[3] is None else r[3]] for r in rows])
    if np.min(np.diff(t)) <= 0.0 or not np.isfinite(pose).all(axis=1).any():
        return
    speed = np.stack([np.array([r[4] for r in rows]), np.full(len(t), np.nan), np.ones(len(t))], axis=1)
    given_ = Record(name="t", t_s=t, pose=pose, omega=speed)
    path = tmp_path_factory.mktemp("r") / "t.csv"
    path.write_text("".join(trial_parts(given_)), encoding="utf-8")
    back = read_trial(path, 3)
    np.testing.assert_allclose(back.t_s, t, rtol=1e-8)
    np.testing.assert_array_equal(back.pose, pose)
    assert back.omega is not None and back.theta is None
    np.testing.assert_array_equal(back.omega, speed)


def test_pulls_by_themselves(tmp_path: Path) -> None:
    path = tmp_path / "p.csv"
    path.write_text("phi_rad,force_N\n0,1\n", encoding="utf-8")
    assert read_pulls(path, 3).theta_rad is None
    with pytest.raises(InputError, match="shape"):
        Pulls(phi_rad=np.zeros(2), force_N=np.zeros(3))


def test_a_recipe_with_effects_is_kept(tmp_path: Path) -> None:
    from slipmargin.effects.camera_scale import CameraScale

    given = data_set()
    given = replace(given, recipe=given.recipe.with_effects(CameraScale(scale_x=0.9, scale_y=0.91)))
    write_data_set(tmp_path / "s", given)
    (effect,) = read_data_set(tmp_path / "s").recipe.effects
    assert (effect.name, effect.scale_y) == ("camera_scale", 0.91)  # type: ignore[union-attr]


def test_a_data_set_may_hold_pulls_alone(tmp_path: Path) -> None:
    """No runs, no wheel_signal; noise of a pull under [sigma]; every optional column comes back."""
    rows = "phi_rad,force_N,direction_rad,point_x_m,point_y_m,height_m\n0.5,4.5,1,0.1,0,0.2\n1,5,0,0,0,0\n"
    head = HEAD.replace('wheel_signal = "measured"\n', "") + "[sigma]\nforce_N = 0.05\n"
    read = read_data_set(folder(tmp_path, head, None, pulls=rows))
    assert not read.trials and read.sigma is None and read.pulls is not None
    assert read.pulls.sigma_N == 0.05 and read.pulls.height_m is not None
    write_data_set(tmp_path / "copy", read)
    again = read_data_set(tmp_path / "copy").pulls
    assert again is not None and again.sigma_N == 0.05
    for key in ("phi_rad", "force_N", "direction_rad", "point_m", "height_m"):
        np.testing.assert_array_equal(getattr(again, key), getattr(read.pulls, key))


def test_what_a_file_of_pulls_alone_says_of_runs_is_answered(tmp_path: Path) -> None:
    head = HEAD + "nominal_rate_Hz = 3.0\n[sigma]\nx_m = 0.001\ny_m = 0.001\nphi_rad = 0.002\n"
    read = read_data_set(folder(tmp_path, head, None, pulls="phi_rad,force_N\n0.5,4.5\n"))
    assert read.unused == ("wheel_signal", "nominal_rate_Hz", "[sigma] of the pose")
    assert of_unused(read)[0] == "wheel_signal has no effect: the data set holds pulls and no runs."
    (tmp_path / "runs").mkdir()
    assert read_data_set(folder(tmp_path / "runs", HEAD)).unused == ()
    write_data_set(tmp_path / "copy", replace(read, sigma=None, nominal_rate_Hz=None))
    assert read_data_set(tmp_path / "copy").unused == ()


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("phi_rad,force_N\n90,4.5\n", "2:1: phi_rad is 90, divide degrees"),
        ("phi_rad,force_N\n0.1,-4.5\n", "2:2: force_N is -4.5"),
        ("phi_rad,force_N\n0.1,1e308\n", "2:2: force_N is 1e.308"),
        ("phi_rad,force_N,height_m\n0.1,4.5,-1\n", "2:3: height_m is -1"),
        ("phi_rad,force_N,point_x_m\n0.1,4.5,0\n", "'point_y_m' is missing"),
    ],
)
def test_pulls_that_cannot_be_are_refused_by_their_cell(tmp_path: Path, rows: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_data_set(folder(tmp_path, pulls=rows))


def test_runs_need_to_say_what_their_wheel_columns_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="wheel_signal: is missing"):
        read_data_set(folder(tmp_path, HEAD.replace('wheel_signal = "measured"\n', "")))


def test_noise_of_pulls_without_pulls_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="given without pulls"):
        read_data_set(folder(tmp_path, HEAD + "[sigma]\nforce_N = 0.05\n"))


def test_any_name_of_a_surface_comes_back(tmp_path: Path) -> None:
    recipe = read_recipe("robotino")
    name = '14" lab \\ "left"'
    robot = replace(recipe.robot, surfaces=tuple(replace(s, name=name) for s in recipe.robot.surfaces[:1]))
    write_data_set(tmp_path / "d", data_set(recipe=replace(recipe, robot=robot), surface=name))
    assert read_data_set(tmp_path / "d").surface == name


def test_what_is_not_written_again_is_not_replaced(tmp_path: Path) -> None:
    """Importing anew with --force deleted pulls, notes and the very log that was read."""
    place = tmp_path / "s"
    write_data_set(place, data_set())
    (place / "raw").mkdir()
    (place / "raw" / "log.csv").write_text("t_s\n", encoding="utf-8")
    (place / "pulls.csv").write_text("phi_rad,force_N\n0,1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"holds pulls\.csv, raw beside a data set, which would be lost"):
        write_data_set(place, data_set())
    assert (place / "raw" / "log.csv").is_file() and (place / "pulls.csv").is_file()
    (place / "raw" / "log.csv").unlink()
    (place / "raw").rmdir()
    (place / "pulls.csv").unlink()
    write_data_set(place, data_set())


def test_a_run_is_read_or_refused_and_never_forgotten(tmp_path: Path) -> None:
    """``run0.CSV`` and runs in a folder within were not read, and nothing said so."""
    place = tmp_path / "s"
    write_data_set(place, data_set(trials=(record(), record(name="b"))))
    (place / "trials" / "a.csv").rename(place / "trials" / "a.CSV")
    (place / "trials" / "notes.md").write_text("a note is no run", encoding="utf-8")
    (place / "trials" / "._b.csv").write_bytes(b"\x00\x05\x16")  # what some systems leave beside a file
    assert [t.name for t in read_data_set(place).trials] == ["a", "b"]
    (place / "trials" / "notes.txt").write_text("the second run was disturbed\n", encoding="utf-8")
    assert len(read_data_set(place).trials) == 2
    (place / "trials" / "c.txt").write_text("t_s;x_m;y_m\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"c\.txt: would not be read as a run, move runs into trials/"):
        read_data_set(place)
    (place / "trials" / "c.txt").unlink()
    (place / "trials" / "more").mkdir()
    (place / "trials" / "b.csv").rename(place / "trials" / "more" / "b.csv")
    with pytest.raises(InputError, match="more: would not be read"):
        read_data_set(place)


def test_a_wheel_s_missing_speed_is_no_loss_where_every_angle_is_known() -> None:
    speeds = np.ones((4, 3))
    speeds[:, 1] = np.nan
    assert data_set(trials=(record(omega=speeds),)).trials
