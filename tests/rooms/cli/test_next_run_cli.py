"""``slipmargin next-run``: refusals in one line, nothing half-written, files of what was found."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from planting import planted, smooth_kiwi
from proposals import next_runs
from slipmargin_cli.main import status

from slipmargin.diagnosis.watch import Watch
from slipmargin.experiment import next_runs as room
from slipmargin.io.data_set_write import write_data_set
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.robot_text import write_recipe


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("next") / "runs"
    write_data_set(folder, planted(smooth_kiwi(), None, 1, count=2, duration_s=1.0))
    return folder


@pytest.fixture
def pulled(tmp_path: Path) -> Path:
    """A data set of pulls alone."""
    folder = tmp_path / "pulled"
    folder.mkdir()
    (folder / "robot.toml").write_text(write_recipe(read_recipe("ohio-kiwi")), encoding="utf-8")
    (folder / "dataset.toml").write_text(
        'schema = 1\nrobot = "robot.toml"\nsurface = "paper"\nwheel_signal = "measured"\n', encoding="utf-8"
    )
    rows = [f"{0.3 * k:.2f},{4.5 + 0.1 * (k % 5):.2f}" for k in range(24)]
    (folder / "pulls.csv").write_text("\n".join(["phi_rad,force_N", *rows]) + "\n", encoding="utf-8")
    return folder


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> list[room.Request]:
    """What is asked of the room, which answers at once."""
    asked: list[room.Request] = []

    def answer(data_set: object, request: room.Request, repairs: object, progress: Watch) -> object:
        asked.append(request)
        progress("choosing", 0.5)
        return next_runs()

    monkeypatch.setattr(room, "next_runs", answer)
    return asked


def test_it_writes_runs_report_and_json(
    data: Path, engine: list[room.Request], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, page, numbers = tmp_path / "next", tmp_path / "next.html", tmp_path / "next.json"
    words = ["next-run", str(data), "--space", "3x2.5", "--runs", "2", "--margin", "0.2", "--out", str(out)]
    more = [
        "--report",
        str(page),
        "--json",
        str(numbers),
        "--max-speed",
        "0.5",
        "--longest",
        "6",
        "--seed",
        "4",
    ]
    assert status([*words, *more]) == 0
    (request,) = engine
    assert request.size_m == (3.0, 2.5) and request.runs == 2 and request.seed == 4
    assert request.share == pytest.approx(0.8) and request.longest_s == 6.0 and request.max_speed_m_s == 0.5
    assert request.max_yaw_rate_rad_s == np.inf
    assert sorted(p.name for p in out.iterdir()) == ["run-1-path-1.csv", "run-1-path-2.csv", "run-1.csv"]
    told = capsys.readouterr().out
    assert told.startswith("effect-found: The runs leave") and f"written: {out / 'run-1.csv'}" in told
    assert json.loads(numbers.read_text(encoding="utf-8"))[
        "question"
    ] == "which" and "<svg" in page.read_text(encoding="utf-8")


def test_json_on_stdout_is_json_alone(
    data: Path, engine: list[room.Request], capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(["next-run", str(data), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["motions_compared"] == 49 and len(engine) == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--space", "3"], "--space: is '3', give two sides in metres, 3x2"),
        (["--space", "3x2x1"], "--space: is '3x2x1', give two sides in metres, 3x2"),
        (["--space", "axb"], "--space: is 'axb', give two sides in metres, 3x2"),
        (["--space=-3x2"], "--space: is -3, give two sides in metres, 3x2"),
        (["--space", "nanx2"], "--space: is nan, not a finite number, give two sides in metres, 3x2"),
        (
            ["--space", "0.2x3"],
            "--space: is 0.2 m x 3 m and the robot with its wheels takes 0.241 m x 0.241 m",
        ),
        (["--runs", "0"], "--runs: is 0, give a whole number from 1 to 20"),
        (["--runs", "21"], "--runs: is 21, give a whole number from 1 to 20"),
        (["--margin", "1.5"], "--margin:"),
        (["--longest", "0"], "--longest: is 0, give a positive number, or leave it out"),
        (["--max-speed", "-1"], "--max-speed: is -1, give a positive number, or leave it out"),
        (["--max-yaw-rate", "inf"], "--max-yaw-rate: is inf, not a finite number"),
        (["--seed", "-1"], "--seed: is -1, give a whole number from 0"),
        (["--budget", "0"], "--budget: is 0"),
        (["--out", "{data}/robot.toml"], "robot.toml: is a file, give a folder"),
        (["--json", "{data}/none/x.json"], "there is no folder"),
    ],
)
def test_bad_options_are_one_line(
    data: Path, options: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [word.format(data=data) for word in options]
    assert status(["next-run", str(data), "--out", str(tmp_path / "new"), *words]) == 2
    told = capsys.readouterr()
    assert said in told.err and told.err.count("\n") == 1 and told.err.startswith("error: ") and not told.out
    assert not (tmp_path / "new").exists()


def test_what_is_no_data_set_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["next-run", str(tmp_path / "none")]) == 2
    assert "there is no such folder" in capsys.readouterr().err
    campaign = tmp_path / "campaign.toml"
    campaign.write_text("schema = 1\n", encoding="utf-8")
    assert status(["next-run", str(campaign)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_an_interrupted_run_leaves_nothing(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(room, "next_runs", stop)
    before = sorted(p.name for p in tmp_path.iterdir())
    words = ["--out", str(tmp_path / "next"), "--json", str(tmp_path / "n.json")]
    assert status(["next-run", str(data), *words]) == 130
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_pulls_take_the_budget_and_words_about_runs_are_spoken_of(
    pulled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import slipmargin.diagnosis.pull_diagnosis as pulls_room

    whole, budgets = pulls_room.diagnose_pulls, []

    def hurried(data: object, *, budget_s: float | None, **more: object) -> object:
        budgets.append(budget_s)
        return whole(data, budget_s=budget_s, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(pulls_room, "diagnose_pulls", hurried)
    words = ["--budget", "1", "--runs", "5", "--space", "3x2", "--out", str(tmp_path / "next")]
    assert status(["next-run", str(pulled), *words]) == 0
    said = capsys.readouterr().err
    assert budgets == [1.0] and not (tmp_path / "next").exists()
    for word in ("runs", "space_m", "--out"):
        assert f"warning: {word} has no effect: the data set holds pulls and no runs" in said


def test_a_picture_of_pulls_alone_is_refused_before_the_diagnosis(
    pulled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It was refused after the whole search, and the page and the numbers were lost with it."""
    monkeypatch.setattr(
        "slipmargin.diagnosis.pull_diagnosis.diagnose_pulls", lambda *_, **__: pytest.fail("it searches")
    )
    assert status(["next-run", str(pulled), "--plot", str(tmp_path / "p.png")]) == 2
    assert capsys.readouterr().err == (
        "error: command line: --plot: has no effect: the data set holds pulls and no runs, leave it out\n"
    )


@pytest.mark.parametrize("inside", ["trials", "trials/proposed", "."])
def test_runs_that_were_measured_are_not_written_over(
    data: Path, engine: list[room.Request], inside: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """``--out DATASET/trials`` put proposals in the place of measured runs of their names."""
    before = {file: file.read_bytes() for file in data.rglob("*.csv")}
    assert status(["next-run", str(data), "--out", str(data / inside)]) == 2
    assert "is read as well as written" in capsys.readouterr().err and not engine
    assert {file: file.read_bytes() for file in data.rglob("*.csv")} == before
    assert status(["next-run", str(data), "--out", str(data / "proposed")]) == 0
    assert {file: file.read_bytes() for file in before} == before
    for file in (data / "proposed").iterdir():
        file.unlink()
    (data / "proposed").rmdir()
