"""The slip monitor: alarms where a wheel slips, at the rate that was set where none does."""

from __future__ import annotations

import io
import json
import re
import sys
import time
from pathlib import Path

import driving
import monitor as measured
import numpy as np
import pytest
from real_logs import EXCERPT
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.onboard.likelihood import LabelledRun, learn

ROOT = Path(__file__).resolve().parents[3]
RESULTS = json.loads((ROOT / "benchmarks/results/monitor.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def watch() -> sm.SlipMonitor:
    robot = sm.read_robot("mecanum4")
    return sm.SlipMonitor(robot, "floor", false_alarm_rate=0.01, gyro=True)


def run(margin: float | None, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Wheel speeds, yaw rates and largest shares of a simulated drive, limited or at three times the grip."""
    recipe = sm.read_robot("mecanum4")
    model = recipe.build("floor")
    limiter = sm.Limiter(recipe, "floor", margin=0.3 if margin is None else margin)
    pull = 3.0 * limiter.table.pull_m_s2
    wild = driving.axis_limit(pull * np.array([1.0, 1.0, 4.0]))
    limit = wild if margin is None else driving.slip_limit(limiter)
    twists = driving.commanded(limit, driving.wishes(model, seed, 150))
    found = driving.driven(model, twists)
    return model.geometry.wheel_speeds(twists), found.velocity[::4, 2], found.utilisation[::4].max(axis=1)


def test_it_alarms_where_a_wheel_slips_and_not_where_none_does(watch: sm.SlipMonitor) -> None:
    alarms: dict[bool, list[float]] = {False: [], True: []}
    for margin in (0.3, None):
        for seed in (11, 12):
            omega, gyro, used = run(margin, seed)
            watch.restart()
            told = [
                watch.update(0.01 * k, w, gyro_rad_s=g)
                for k, (w, g) in enumerate(zip(omega, gyro, strict=True))
            ]
            slips = np.array([np.max(used[max(0, k - 6) : k + 1]) > 0.99 for k in range(len(used))])
            alarm = np.array([one.alarm for one in told])
            alarms[margin is None].append(alarm[slips].mean() if margin is None else alarm.mean())
            assert all(bool(one.wheel) == one.alarm for one in told)
            assert all(np.all(np.linalg.eigvalsh(one.covariance) > 0.0) for one in told)
    assert np.mean(alarms[False]) <= 0.01
    assert np.mean(alarms[True]) > 0.5


def test_the_threshold_keeps_the_rate_on_unseen_samples_and_scores_are_what_theory_says() -> None:
    """Two normal clouds d apart: AUC is Φ(d/√2)."""
    rng = np.random.default_rng(0)

    def drawn(count: int) -> LabelledRun:
        slips = rng.uniform(size=count) < 0.4
        numbers = rng.normal(size=(count, 3)) + 1.5 * slips[:, None] * np.array([1.0, 0.0, 0.0])
        none = np.zeros((count, 3))
        return LabelledRun(numbers=numbers, slips=slips, wheels=none, truth=none)

    ratio, fresh = learn([drawn(2000) for _ in range(5)]), drawn(40_000)
    value = ratio.value(fresh.numbers)
    for rate in (0.01, 0.05, 0.2):
        assert np.mean(value[~fresh.slips] > ratio.threshold(rate)) == pytest.approx(rate, rel=0.25)
    assert measured.auc(value, fresh.slips) == pytest.approx(0.8556, abs=0.01)  # Φ(1.5/√2)


def test_real_currents_tell_a_slippery_floor_from_a_good_one() -> None:
    """Robotino logs in the repository: gray floor and table, each run judged by the others."""
    logs = measured.robotino_logs(EXCERPT)
    assert len(logs) == 18
    watch = sm.SlipMonitor("robotino", "gray", current=True, torque_per_ampere_N_m=0.82)
    found = measured.judged(watch, logs, ("current_A",), None)
    assert found["auc"] > 0.9 and found["detected at 5 %"] > 0.5


def test_the_page_shows_the_rates_that_were_measured() -> None:
    page = (ROOT / "docs/how-to/monitor.md").read_text(encoding="utf-8")
    for name, row in RESULTS["sets"].items():
        shown = f"| {name} | {row['auc']:.3f} | {row['detected at 5 %']:.2f} | {row['detected at 1 %']:.2f} |"
        assert shown in page, name
    assert RESULTS["cost"]["share of a core at 1 kHz"] < 0.2
    assert max(RESULTS["no-slip control, alarms, set 1 %"].values()) <= 0.01


def test_a_stream_is_answered_line_by_line_in_flat_memory(watch: sm.SlipMonitor) -> None:
    """The answer to a line is there before the next line is asked for."""
    asked: list[int] = []

    def lines():  # type: ignore[no-untyped-def]
        yield "t_s,gyro_rad_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s,battery_V\n"
        for k in range(3000):
            asked.append(k)
            yield f"{k * 0.001:.3f},0.1,1,-1,1,-1,24\n"

    watch.restart()
    start, count = time.process_time(), -1
    for count, _told in enumerate(watch.stream(lines())):
        assert len(asked) == count
    assert count == 3000
    assert (time.process_time() - start) / 3000 < 1e-3  # 1 kHz on a machine that others use too


def test_the_command_on_a_file_and_on_a_stream(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    omega, gyro, _ = run(None, 11)
    head = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s,gyro_rad_s"
    rows = [
        f"{0.01 * k:.2f}," + ",".join(f"{v:.6f}" for v in (*w, g))
        for k, (w, g) in enumerate(zip(omega, gyro, strict=True))
    ]
    text = "\n".join([head, *rows]) + "\n"
    (tmp_path / "log.csv").write_text(text)
    out = tmp_path / "slip.csv"
    words = ["monitor", "mecanum4", str(tmp_path / "log.csv"), "--surface", "floor", "--out", str(out)]
    assert status(words) == 0
    said = capsys.readouterr().out
    assert re.search(r"151 samples, alarm in \d+\.\d+ % of them, [1-9]", said) and "most loaded wheel" in said
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    assert status(["monitor", "mecanum4", "-", "--surface", "floor"]) == 0
    assert capsys.readouterr().out == out.read_text()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "line 1: is empty"),
        ("t_s,omega1_rad_s\n0,1\n", "lacks the column omega2_rad_s"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2\n", "line 2: has a cell that is no number"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,nan\n", "line 2: omega_rad_s: is"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,current1_A\n0,1,2,3,4\n", "torque-per-ampere"),
    ],
)
def test_refusals_are_one_line(
    text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text(text)
    assert status(["monitor", "ohio-kiwi", str(tmp_path / "log.csv"), "--surface", "paper"]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1 and told in said[0]


def test_three_wheels_without_more_channels_are_told_so() -> None:
    assert any("no redundancy" in w for w in sm.SlipMonitor("ohio-kiwi", "paper").warnings)
    with pytest.raises(InputError, match="gyro_rad_s"):
        sm.SlipMonitor("ohio-kiwi", "paper", gyro=True).update(0.0, [0.0, 0.0, 0.0])


def test_training_on_a_data_set_with_poses() -> None:
    rig = ROOT / "tests" / "data" / "rig" / "a-null"
    if not (rig / "trials").is_dir():
        pytest.skip("no trials in tests/data/rig: only its pulls are kept in the repository")
    watch = sm.SlipMonitor(rig / "robot.toml", "floor", gyro=True, commanded=True, training=rig)
    assert watch.ratio.grips.gain[0] > watch.ratio.slips.gain[0]
