"""Work in pieces: resumed, to the last bit, by this process, others, or a cluster."""

from __future__ import annotations

import contextlib
import math
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.robot import GripShape
from slipmargin.study.objectives import Kind
from slipmargin.study.pieces import (
    Executor,
    _quiet_when_stopped,
    canonical,
    clear,
    in_pieces,
    piece_name,
)
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.study import DesignProblem, study
from slipmargin.study.vary import parse_vary

COUNTED: list[float] = []


def square(x: float) -> dict[str, float]:
    COUNTED.append(x)
    return {"square": x * x, "third": x / 3.0, "none": math.nan}


def do(items: list[float], folder: Path | None, **changes: object) -> list[dict[str, float]]:
    COUNTED.clear()
    return list(
        in_pieces(square, items, key="squares", size=2, executor=Executor(folder=folder, **changes)).rows
    )  # type: ignore[arg-type]


def test_pieces_are_kept_and_taken_up_again(tmp_path: Path) -> None:
    folder = tmp_path / "f.csv.work"
    first = do([1.0, 2.0, 3.0, 4.0, 5.0], folder)
    assert COUNTED == [1.0, 2.0, 3.0, 4.0, 5.0] and len(list(folder.iterdir())) == 3
    again = do([1.0, 2.0, 3.0, 4.0, 5.0], folder)
    assert not COUNTED
    assert [r["third"] for r in again] == [r["third"] for r in first] == [x / 3.0 for x in range(1, 6)]
    assert all(math.isnan(r["none"]) for r in again)
    do([1.0, 2.0, 3.0, 4.5, 5.0], folder)
    assert COUNTED == [3.0, 4.5]


@pytest.mark.parametrize(
    "damage",
    [
        "",
        "{",
        '{"rows": 3}',
        '{"rows": [{"square": 1}]}',
        '{"rows": []}',
        "[]",
        '{"rows": [{"square": "0x1p0"}]}',
    ],
)
def test_a_damaged_piece_is_computed_again(tmp_path: Path, damage: str) -> None:
    wanted = do([1.0, 2.0], None)
    folder = tmp_path / "work"
    do([1.0, 2.0], folder)
    (path,) = folder.iterdir()
    path.write_text(damage, encoding="utf-8")
    assert [r["square"] for r in do([1.0, 2.0], folder)] == [r["square"] for r in wanted]
    assert COUNTED == [1.0, 2.0]


def test_progress_counts_items(tmp_path: Path) -> None:
    steps: list[int] = []
    for _ in range(2):
        in_pieces(
            square,
            [1.0, 2.0, 3.0],
            key=0,
            size=2,
            executor=Executor(folder=tmp_path / "w"),
            advance=steps.append,
        )
    assert sum(steps) == 6


def test_clearing_leaves_what_is_not_ours(tmp_path: Path) -> None:
    folder = tmp_path / "w"
    do([1.0], folder)
    (folder / "mine.txt").write_text("mine", encoding="utf-8")
    clear(folder)
    assert [p.name for p in folder.iterdir()] == ["mine.txt"]
    (folder / "mine.txt").unlink()
    clear(folder)
    clear(folder)
    clear(None)
    assert not folder.exists()


def test_the_name_of_a_piece_is_its_problem() -> None:
    """Every number of a design counts, to the last bit; nothing else does."""
    start = RobotOnSurface(recipe=Recipe(robot=kiwi()), surface="paper")
    same = RobotOnSurface(recipe=Recipe(robot=kiwi()), surface="paper")
    names = {
        piece_name("q", [m])
        for m in (
            start,
            replace(start, surface="carpet"),
            start.with_robot(kiwi(mass_kg=float(np.nextafter(3.0, 4.0)))),
            start.with_robot(kiwi(com_m=(0.0, 1e-12))),
        )
    }
    assert len(names) == 4 and piece_name("q", [same]) in names and piece_name("p", [start]) not in names
    plain = [["a", [1, (2.5).hex(), None, True, ["Kind", "LAPS"]]]]
    assert canonical({"a": [1, 2.5, None, True, Kind.LAPS]}) == plain
    with pytest.raises(TypeError, match="no canonical form"):
        canonical(object())


@pytest.mark.parametrize("jobs", [0, -2])
def test_jobs_that_are_none(jobs: int) -> None:
    with pytest.raises(InputError, match="number of processes"):
        Executor(jobs=jobs)


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="cannot be made"):
        do([1.0], tmp_path / "file" / "work")


def problem() -> DesignProblem:
    design = RobotOnSurface(recipe=Recipe(robot=kiwi()), surface="paper")
    return DesignProblem(base=design, grids=(parse_vary("delta_deg=10:40:2"),), kinds=(Kind.MOTION,))


def test_other_processes_find_the_same_numbers() -> None:
    alone, spread = study(problem()), study(problem(), executor=Executor(jobs=2))
    for name, column in alone.columns.items():
        assert np.array_equal(column, spread.columns[name], equal_nan=True), name


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """A Dask scheduler with two worker processes on loopback."""
    if find_spec("dask") is None or find_spec("distributed") is None:
        pytest.skip("dask and distributed are not installed")
    source = (
        "import sys, time\nfrom distributed import LocalCluster\n"
        "if __name__ == '__main__':\n"
        "    c = LocalCluster(n_workers=2, threads_per_worker=1, host='127.0.0.1',\n"
        "                     dashboard_address=None)\n"
        "    print(c.scheduler_address, flush=True)\n    sys.stdin.read()\n    c.close()\n"
    )
    env = {**os.environ, "OMP_NUM_THREADS": "1"}
    with subprocess.Popen(
        [sys.executable, "-c", source],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=env,
    ) as process:
        assert process.stdout is not None and process.stdin is not None
        yield process.stdout.readline().strip()
        process.stdin.close()
        process.wait(30)


@pytest.mark.filterwarnings("ignore")  # the cluster's own
def test_a_cluster_finds_the_same_numbers(scheduler: str) -> None:
    assert scheduler.startswith("tcp://127.0.0.1:")
    alone = study(problem())
    start = time.monotonic()
    spread = study(problem(), executor=Executor(scheduler=scheduler))
    assert time.monotonic() - start < 60.0
    for name, column in alone.columns.items():
        assert np.array_equal(column, spread.columns[name], equal_nan=True), name


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://x"])
@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_is_not_there(address: str) -> None:
    if find_spec("distributed") is None:
        pytest.skip("distributed is not installed")
    with pytest.raises(InputError, match="cannot be reached"):
        study(problem(), executor=Executor(scheduler=address))


def test_a_cluster_needs_its_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    from slipmargin.study import pieces

    monkeypatch.setattr(pieces, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"slipmargin\[cluster\]"):
        study(problem(), executor=Executor(scheduler="tcp://127.0.0.1:9"))


def test_another_run_of_the_same_study_may_end_first(tmp_path: Path) -> None:
    """It takes the folder of pieces with it; what this run has computed was lost."""
    folder = tmp_path / "o.csv.work"

    def work(item: int) -> dict[str, float]:
        shutil.rmtree(folder, ignore_errors=True)
        return {"x": float(item)}

    done = in_pieces(work, [1, 2, 3], key="k", size=1, executor=Executor(folder=folder))
    assert [row["x"] for row in done.rows] == [1.0, 2.0, 3.0]


def test_static_limits_that_take_long_are_kept_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Designs that no zonotope describes were all computed before the first piece: Ctrl-C lost them."""
    from slipmargin.study import statics

    way = statics.headings(13)
    monkeypatch.setattr(statics, "headings", lambda: way)
    design = RobotOnSurface(recipe=Recipe(robot=kiwi(grip=GripShape.ELLIPSE)), surface="paper")
    several = DesignProblem(base=design, grids=(parse_vary("delta_deg=10:30:2"),), kinds=())
    folder = tmp_path / "o.csv.work"

    def stop(steps: int) -> None:
        if steps:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study(several, executor=Executor(folder=folder), advance=stop)
    assert len(list(folder.iterdir())) == 1
    again, alone = study(several, executor=Executor(folder=folder)), study(several)
    assert (again.resumed, again.pieces) == (1, 2)
    for name, column in alone.columns.items():
        assert np.array_equal(column, again.columns[name], equal_nan=True), name


def test_designs_that_zonotopes_describe_need_no_pieces() -> None:
    design = RobotOnSurface(recipe=Recipe(robot=kiwi()), surface="paper")
    steps: list[int] = []
    several = DesignProblem(base=design, grids=(parse_vary("delta_deg=10:30:10"),), kinds=())
    found = study(several, advance=steps.append)
    assert found.pieces == 0 and sum(steps) == 4 and not np.isnan(found.columns["f_worst"]).any()


def test_what_joblib_lacks_once_it_is_stopped_is_no_news(capsys: pytest.CaptureFixture[str]) -> None:
    """Ctrl-C in a study on several cores mostly ended in a traceback of joblib's own thread."""

    before = threading.excepthook
    with contextlib.suppress(KeyboardInterrupt), _quiet_when_stopped():
        raise KeyboardInterrupt
    try:
        thread = threading.Thread(target={}.pop, args=(55,), name="ExecutorManagerThread")
        thread.start()
        thread.join()
    finally:
        threading.excepthook = before
    assert capsys.readouterr().err == ""
    with _quiet_when_stopped():
        kept = threading.excepthook
    assert threading.excepthook is not kept, "it is put back where the work was done"
