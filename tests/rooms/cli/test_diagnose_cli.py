"""``slipmargin diagnose``: what it says, what it writes, and that it writes all or nothing."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomllib
from diagnoses import diagnosis, unnamed, wheel_loads
from slipmargin_cli import render
from slipmargin_cli.main import status
from strategies import kiwi

from slipmargin.checks import Array
from slipmargin.diagnosis import loop
from slipmargin.diagnosis.result import Diagnosis, Verdict
from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.io.folder import check_folder, write_folder
from slipmargin.io.robot_text import write_recipe

FILES = {
    "report.html",
    "report.json",
    "corrected.toml",
    "residual.png",
    "where.png",
    "candidates.png",
    "held-out.png",
}


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """A small data set folder."""
    folder = tmp_path / "set"
    (folder / "trials").mkdir(parents=True)
    (folder / "robot.toml").write_text(write_recipe(Recipe(robot=kiwi())), encoding="utf-8")
    (folder / "dataset.toml").write_text(
        'schema = 1\nrobot = "robot.toml"\nsurface = "paper"\nwheel_signal = "measured"\n', encoding="utf-8"
    )
    rows = ["t_s,x_m,y_m,phi_rad,omega1_rad_s,omega2_rad_s,omega3_rad_s"]
    rows += [
        f"{t:.2f},0,{0.13148 * t * t:.5f},0,{-10.0 * t:.3f},{10.0 * t:.3f},0"
        for t in np.arange(0.0, 0.5, 0.05)
    ]
    (folder / "trials" / "1.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return folder


def pretend(monkeypatch: pytest.MonkeyPatch, found: Diagnosis | BaseException) -> list[int]:
    """Put a constructed diagnosis (or a failure) in the engine's place; returns the seeds it is given."""
    seeds: list[int] = []

    def engine(data_set: object, seed: int, progress: Callable[[str, float], None], **_: object) -> Diagnosis:
        seeds.append(seed)
        progress("round 1: trying wheel_loads", 0.5)
        if isinstance(found, BaseException):
            raise found
        return found

    monkeypatch.setattr(loop, "diagnose", engine)
    return seeds


def test_an_effect_is_found(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seeds = pretend(monkeypatch, diagnosis())
    out = tmp_path / "new" / "out"
    assert status(["diagnose", str(data), "--out", str(out), "--seed", "3"]) == 0
    assert seeds == [3]
    text = capsys.readouterr().out.splitlines()
    assert text[0].startswith("effect-found: The model lacks wheel_loads")
    assert "shift_x_m = 0.0120 (0.0115 … 0.0125) m" in text[1] and "wheel_load;" in text[1]
    assert "19.2 mm" in text[2] and "→ 0.6 mm" in text[2] and "held-out" in text[2]
    assert text[3].startswith("limits   weakest pull 4.92 → ")
    assert {p.name for p in out.iterdir()} == FILES | {"limits.png"}
    assert next(line for line in text if line.startswith("written")).endswith("/report.html")
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert report["verdict"] == "effect-found"


def test_the_corrected_robot_is_accepted_by_other_commands(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pretend(monkeypatch, diagnosis(findings=(wheel_loads(), unnamed())))
    assert status(["diagnose", str(data), "--out", str(tmp_path / "out")]) == 0
    corrected = tmp_path / "out" / "corrected.toml"
    names = [e["name"] for e in tomllib.loads(corrected.read_text(encoding="utf-8"))["effect"]]
    assert names == ["wheel_loads", "unnamed_position"]
    said = capsys.readouterr().out
    assert "cannot be distinguished from floor_nap" in said
    assert status(["sweep", str(corrected), "--surface", "paper", "--step", "5", "--json", "-"]) == 0
    swept = json.loads(capsys.readouterr().out)
    report = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))
    after = report["limit_curves"]["after"]["f_max_N"]
    assert swept["f_max_N"] == pytest.approx(after[:91:5], rel=1e-9)


@pytest.mark.parametrize("verdict", [Verdict.NO_MISSING_EFFECT, Verdict.UNEXPLAINED])
def test_nothing_found(
    verdict: Verdict,
    data: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pretend(monkeypatch, diagnosis(verdict))
    out = tmp_path / "out"
    assert status(["diagnose", str(data), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert text.startswith(verdict.value + ": ") and "found   " not in text and "limits   unchanged" in text
    assert {p.name for p in out.iterdir()} == FILES
    assert "effect" not in tomllib.loads((out / "corrected.toml").read_text(encoding="utf-8"))


def test_json_on_stdout_is_the_report_alone(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pretend(monkeypatch, diagnosis())
    assert status(["diagnose", str(data), "--out", str(tmp_path / "out"), "--json", "-"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))


def test_same_diagnosis_same_files(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretend(monkeypatch, diagnosis())
    for name in ("one", "two"):
        assert status(["diagnose", str(data), "--out", str(tmp_path / name)]) == 0
    for file in (tmp_path / "one").iterdir():
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes(), file.name


@pytest.mark.parametrize("failure", [KeyboardInterrupt(), InputError("t_s", "is in milliseconds", "divide")])
@pytest.mark.parametrize("there", [False, True])
def test_a_run_that_ends_early_leaves_everything_as_it_was(
    failure: BaseException, there: bool, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    if there:
        out.mkdir()
        (out / "report.json").write_text("before", encoding="utf-8")
    pretend(monkeypatch, failure)
    code = status(["diagnose", str(data), "--out", str(out)])
    assert code == (130 if isinstance(failure, KeyboardInterrupt) else 2)
    if there:
        assert [p.name for p in out.iterdir()] == ["report.json"]
        assert (out / "report.json").read_text(encoding="utf-8") == "before"
    else:
        assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--out", "{tmp}/file"], "file"),
        (["--out", "{tmp}/file/deeper"], "file"),
        (["--out", "{tmp}/out", "--seed", "-1"], "--seed"),
        (["--out", "{tmp}/out", "--json", "{tmp}/no/where.json"], "where.json"),
        ([], "--out"),
    ],
)
def test_bad_usage_is_refused_before_any_work(
    arguments: list[str],
    place: str,
    data: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    seeds = pretend(monkeypatch, diagnosis())
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert status(["diagnose", str(data), *(a.format(tmp=tmp_path) for a in arguments)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ") and place in said and said.count("\n") == 1
    assert seeds == [] and not (tmp_path / "out").exists()


def test_a_missing_data_set_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["diagnose", str(tmp_path / "none"), "--out", str(tmp_path / "out")]) == 2
    assert "none" in capsys.readouterr().err


def test_folder_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError):
        write_folder(tmp_path / "a" / "b", {"one": "1", "no/such": "2"})
    assert list(tmp_path.iterdir()) == []
    write_folder(tmp_path / "a" / "b", {"one": "1", "two": b"2"})
    assert sorted(p.name for p in (tmp_path / "a" / "b").iterdir()) == ["one", "two"]
    with pytest.raises(InputError):
        write_folder(tmp_path / "a" / "b", {"one": "other", "no/such": "2"})
    assert (tmp_path / "a" / "b" / "one").read_text(encoding="utf-8") == "1"
    with pytest.raises(InputError, match="is a file"):
        check_folder(tmp_path / "a" / "b" / "one")
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match="may not be written"):
        check_folder(tmp_path / "a")


def test_progress_names_the_stage_only_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with render.stages() as report:
        report("round 1", 0.5)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with render.stages() as report:
        report("round 1: trying [left] wheel", 0.5)  # brackets are no markup


def test_interrupted_process_leaves_nothing(data: Path, tmp_path: Path) -> None:
    # a shell that runs this suite in the background has it ignore Ctrl-C, and its children too
    code = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import time, sys\nfrom slipmargin.diagnosis import loop\n"
        "def engine(*a, **b):\n    print('in', flush=True)\n    time.sleep(30)\n"
        "loop.diagnose = engine\n"
        "from slipmargin_cli.main import status\n"
        f"sys.exit(status(['diagnose', {str(data)!r}, '--out', {str(tmp_path / 'out')!r}]))\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None and process.stdout.readline() == "in\n"
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 130
        assert process.stderr is not None and "Traceback" not in process.stderr.read()
    assert {p.name for p in tmp_path.iterdir()} == {"set"}


def _faulty(tmp_path: Path, change: Callable[[Array], Array]) -> Path:
    """A small planted data set whose trials' columns (t, x, y, φ, ω1…3, θ1…3) went through ``change``."""
    from planting import planted

    from slipmargin.data.record import Record
    from slipmargin.io.data_set_write import write_data_set
    from slipmargin.io.robot_file import read_recipe

    data = planted(read_recipe("ohio-kiwi"), None, seed=9, count=3, duration_s=2.0, rate_hz=50.0)
    trials = []
    for trial in data.trials:
        assert trial.omega is not None and trial.theta is not None
        table = change(np.column_stack([trial.t_s, trial.pose, trial.omega, trial.theta]))
        trials.append(
            Record(
                name=trial.name,
                t_s=table[:, 0],
                pose=table[:, 1:4],
                omega=table[:, 4:7],
                theta=table[:, 7:10],
            )
        )
    write_data_set(tmp_path / "faulty", replace(data, trials=tuple(trials)), {}, "")
    return tmp_path / "faulty"


FAULTS: dict[str, tuple[Callable[[Array], Array], str]] = {
    "milliseconds": (lambda a: a * np.r_[1000.0, np.ones(9)], "milliseconds"),
    "millimetres": (lambda a: a * np.r_[1.0, 1000.0, 1000.0, np.ones(7)], "millimetres"),
    "degrees": (lambda a: a * np.r_[1.0, 1.0, 1.0, 180.0 / np.pi, np.ones(6)], "degrees"),
    "swapped wheels": (lambda a: a[:, [0, 1, 2, 3, 6, 5, 4, 9, 8, 7]], "wheel"),
    "mirrored frame": (lambda a: a * np.r_[1.0, 1.0, -1.0, -1.0, np.ones(6)], "mirror"),
    "a clock that jumps": (
        lambda a: a + np.where(np.arange(len(a)) > 50, 30.0, 0.0)[:, None] * np.eye(10)[0],
        "clock",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_data_that_are_wrong_are_named_and_nothing_is_written(
    fault: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, word = FAULTS[fault]
    folder = _faulty(tmp_path, change)
    code = status(["diagnose", str(folder), "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err.strip()
    assert code == 2
    assert said.startswith("error: ") and "\n" not in said and word in said
    assert not (tmp_path / "out").exists()
