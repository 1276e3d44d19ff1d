"""The slip monitor: alarms where a wheel slips, at the rate that was set where none does."""

from __future__ import annotations

import io
import json
import re
import sys
import time
from dataclasses import replace
from pathlib import Path

import driving
import monitor as measured
import monitor_stream as measured_stream
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from limiter import ModelLimiter
from real_logs import EXCERPT
from slipmargin_cli.main import status
from strategies import models

import slipmargin as sm
from slipmargin.effects import GeneralEffect, Part, Trace
from slipmargin.effects.load_transfer import LoadTransfer
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.onboard.likelihood import LabelledRun, learn
from slipmargin.onboard.limiter import utilisation
from slipmargin.onboard.signals import Channels, Signals
from slipmargin.physics.grips import GripShape
from slipmargin.physics.kinematics import rate_as_axes_turn
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

ROOT = Path(__file__).resolve().parents[3]
#: Words of a command that asks for few runs to train on, where the rate is not what a test is about.
QUICK = ("--false-alarms", "0.5")
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


def clouds(rng: np.random.Generator, count: int, shift: float = 0.0) -> LabelledRun:
    """Two normal clouds 1.5 apart; a run's own shift moves both, as a floor or a battery does."""
    slips = rng.uniform(size=count) < 0.4
    numbers = rng.normal(size=(count, 3)) + np.outer(1.5 * slips + shift, [1.0, 0.0, 0.0])
    none = np.zeros((count, 3))
    return LabelledRun(numbers=numbers, slips=slips, wheels=none, truth=none)


def test_scores_are_what_theory_says_and_the_threshold_nears_the_rate_with_many_runs() -> None:
    """Two normal clouds d apart: AUC is Φ(d/√2)."""
    rng = np.random.default_rng(0)
    ratio, fresh = learn([clouds(rng, 100) for _ in range(400)]), clouds(rng, 40_000)
    value = ratio.value(fresh.numbers)
    for rate in (0.01, 0.05, 0.2):
        alarms = float(np.mean(value[~fresh.slips] > ratio.threshold(rate)))
        assert rate - 3.0 / 400 - 0.1 * rate < alarms < 1.1 * rate
    assert measured.auc(value, fresh.slips) == pytest.approx(0.8556, abs=0.01)  # Φ(1.5/√2)
    square, line, constant = ratio.polynomial()
    again = np.sum(fresh.numbers * (fresh.numbers @ square + line), axis=1) + constant
    np.testing.assert_allclose(again, value, atol=1e-10)


def test_the_rate_is_kept_where_runs_differ_from_one_another() -> None:
    """30 training runs, each with a shift of its own, 100 times.

    The quantile of all their samples went over the rate in 44 of the 100.
    """
    rng, rate, alarms = np.random.default_rng(1), 0.05, []
    for _ in range(100):
        ratio = learn([clouds(rng, 60, rng.normal()) for _ in range(30)])
        fresh = [clouds(rng, 60, rng.normal()) for _ in range(20)]
        values = np.concatenate([ratio.value(run.numbers[~run.slips]) for run in fresh])
        alarms.append(np.mean(values > ratio.threshold(rate)))
    assert 0.005 < np.mean(alarms) <= rate
    assert np.mean(np.array(alarms) > rate) < 0.1


def test_one_long_recording_in_blocks_keeps_the_rate_on_its_further_stretches() -> None:
    """Samples hang together over about five, 4000 a recording: blocks of 20 alarm at the rate that is set.

    Blocks of 100 are too few for 1 %.
    """
    rng, alarms, quiet = np.random.default_rng(3), [], []
    for _ in range(40):
        whole, fresh = stretch(rng, 4000), stretch(rng, 4000)
        ratio = learn(whole.blocks(20))
        quiet.append(not np.isfinite(learn(whole.blocks(100)).threshold(0.01)))
        alarms.append(np.mean(ratio.value(fresh.numbers[~fresh.slips]) > ratio.threshold(0.05)))
    assert all(quiet) and 0.03 < np.mean(alarms) <= 0.05
    assert sum(len(block.slips) for block in whole.blocks(30)) == 3990  # a rest of 10 is left out


def stretch(rng: np.random.Generator, count: int) -> LabelledRun:
    """Two clouds whose samples hang together over about five."""
    noise = rng.normal(size=(count + 20, 3))
    numbers = np.array([np.sum(noise[k : k + 5], axis=0) for k in range(count)]) / np.sqrt(5.0)
    slips = np.repeat(rng.uniform(size=count // 10) < 0.4, 10)
    none = np.zeros((count, 3))
    return LabelledRun(
        numbers=numbers + np.outer(1.5 * slips, [1.0, 0.0, 0.0]), slips=slips, wheels=none, truth=none
    )


@settings(max_examples=20)
@given(models(shapes=tuple(GripShape)), st.booleans(), st.integers(0, 1000))
def test_its_shares_are_those_of_the_limiter(model: Model, creeps: bool, seed: int) -> None:
    """What drag takes from the drive grip, how loads share a wrench and viscous drag were left out.

    So was the least of a drag that is not known exactly.
    """
    model = replace(model, grip=replace(model.grip, viscous_N_s_per_m=np.array([0.0, 2.0])))
    if creeps:
        law = SlipRatioFriction(share=1.0, steepness=6.0)
        model = replace(model, grip=law.rewrite(model.grip, model))
    limiter, random = ModelLimiter(model, 0.1), np.random.default_rng(seed)
    signals, use = Signals(limiter.table, Channels()), np.zeros((3, model.count))
    for twist, rate in zip(random.normal(0.0, 0.3, (50, 3)), random.normal(0.0, 0.5, (50, 3)), strict=True):
        signals._shares(twist, rate, use)
        pull = rate - rate_as_axes_turn(twist[None])[0]
        expected = utilisation(limiter.table, twist[None], pull[None], np.zeros(1))[0]
        np.testing.assert_allclose(use[0], expected, rtol=1e-7)


def test_too_few_runs_are_told_and_give_no_alarm() -> None:
    rng = np.random.default_rng(2)
    ratio = learn([clouds(rng, 100) for _ in range(12)])
    assert ratio.threshold(0.05) == np.inf and 19 <= ratio.runs_needed(0.05) <= 25
    assert np.isfinite(ratio.threshold(0.2))
    watch = sm.SlipMonitor("omni4", "floor", training=[run_of(rng) for _ in range(6)])
    assert any("too few for a false-alarm rate of 0.01" in warning for warning in watch.warnings)
    told = watch.update(0.0, [0.0] * 4)
    assert not told.alarm and 0.0 <= told.slip_probability <= 1.0


def run_of(rng: np.random.Generator) -> LabelledRun:
    """A run with as many numbers as four wheels have."""
    slips = rng.uniform(size=100) < 0.4
    numbers, none = rng.normal(size=(100, 7)) + slips[:, None], np.zeros((100, 3))
    return LabelledRun(numbers=numbers, slips=slips, wheels=none, truth=none)


@pytest.mark.parametrize("robot", sm.built_in_robots())
def test_simulated_runs_are_enough_for_the_rate(robot: str) -> None:
    """Half as many were simulated, too few for any rate: without logged runs nothing ever alarmed."""
    surface = sm.read_robot(robot).robot.surfaces[0].name
    watch = sm.SlipMonitor(robot, surface, false_alarm_rate=0.05)
    assert not any("too few" in text for text in watch.warnings)


def test_real_currents_tell_a_slippery_floor_from_a_good_one() -> None:
    """Robotino logs in the repository: gray floor and table, each run judged by the others."""
    logs = measured.robotino_logs(EXCERPT)
    assert len(logs) == 18
    watch = sm.SlipMonitor("robotino", "gray", current=True, torque_per_ampere_N_m=0.82)
    found = measured.judged(watch, logs, ("current_A",), None)
    assert found["auc"] > 0.9 and found["detected at 5 %"] > 0.5


def test_the_page_shows_the_rates_that_were_measured() -> None:
    page = (ROOT / "docs/how-to/monitor.md").read_text(encoding="utf-8")
    for row in measured.table(RESULTS["sets"]):
        assert row in page, row
    assert RESULTS["cost"]["share of a core at 1 kHz"] < 0.1
    assert all(row["false alarms, set 5 %"] <= 0.05 for row in RESULTS["sets"].values())
    assert all(row["false alarms, set 1 %"] <= 0.01 for row in RESULTS["sets"].values())
    for row in measured.control_table(RESULTS["no-slip control, alarms, set 1 %"]):
        assert row in page, row
    hours = json.loads((ROOT / "benchmarks/results/monitor_stream.json").read_text(encoding="utf-8"))
    rows = hours["hours, resident bytes, share of a core"]
    grown = max(row[1] for row in rows) - rows[0][1]
    assert f"{hours['samples']:,} samples (10 hours)" in page
    assert f"grew by {grown / 1e6:.2f} MB" in page and grown < 5e6
    assert f"took {100 * hours['largest share of a core']:.1f} % of a core" in page
    assert hours["largest share of a core"] < 0.2
    assert f"blocks of {measured.BLOCK / 60.0:.1f} s: false alarms" in page  # 60 Hz


def test_a_plan_without_slip_does_not_alarm() -> None:
    """Its training began every run at rest, so that speed was a sign of slip: 58 percent alarmed."""
    recipe = sm.read_robot("ohio-kiwi", rigid_sectors=False)
    watch = sm.SlipMonitor(recipe, "paper", false_alarm_rate=0.01)
    way = [[0, 0, 0], [1, 0.6, 0.4], [2, 0.4, 0.2], [3, 1, 0]]
    rows = sm.plan(recipe, "paper", way, margin=0.1, max_speed_m_s=1.0, points=60, step_s=0.01).trajectory
    found = [watch.update(float(t), w).alarm for t, w in zip(rows.t_s, rows.omega, strict=True)]
    assert np.mean(found) <= 0.01


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


def test_minutes_of_stream_leave_memory_flat() -> None:
    """The short form of benchmarks/monitor_stream.py: 36 s of 1 kHz."""
    found = measured_stream.streamed(0.01)
    assert found["samples"] == 36_000
    assert found["gained since the first tenth [bytes]"] < 1_000_000  # keeping every estimate: 20 MB and more


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
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    out = tmp_path / "slip.csv"
    words = ["monitor", "mecanum4", str(tmp_path / "log.csv"), "--surface", "floor", "--out", str(out)]
    assert status([*words, *QUICK]) == 0
    said = capsys.readouterr().out
    assert re.search(r"151 samples, alarm in \d+\.\d+ % of them, [1-9]", said) and "most loaded wheel" in said
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    assert status(["monitor", "mecanum4", "-", "--surface", "floor", *QUICK]) == 0
    assert capsys.readouterr().out == out.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "line 1: is empty"),
        ("t_s,omega1_rad_s\n0,1\n", "lacks the column omega2_rad_s"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2\n", "line 2: has a cell that is no number"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,nan\n", "line 2: omega_rad_s: is"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,3\nnan,1,2,3\n", "line 3: t_s: is nan"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n1,1,2,3\n0,1,2,3\n", "line 3: t_s: goes back from 1"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n", "line 2: there is no sample"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega2_cmd_rad_s\n0,1,2,3,4\n", "omega1_cmd_rad_s"),
        ("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,current1_A\n0,1,2,3,4\n", "column current2_A"),
        (
            "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,current1_A,current2_A,current3_A\n0,1,2,3,4,5,6\n",
            "torque-per-ampere",
        ),
    ],
)
def test_refusals_are_one_line(
    text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    assert status(["monitor", "ohio-kiwi", str(tmp_path / "log.csv"), "--surface", "paper", *QUICK]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1 and told in said[0]


def test_a_header_that_lacks_a_column_is_refused_before_the_monitor_learns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("slipmargin.api.monitor_training.simulated", lambda *given: pytest.fail("it learns"))
    (tmp_path / "log.csv").write_text("t_s,omega1_rad_s,omega2_rad_s\n0,1,2\n", encoding="utf-8")
    assert status(["monitor", "ohio-kiwi", str(tmp_path / "log.csv"), "--surface", "paper"]) == 2
    assert "log.csv: line 1: lacks the column omega3_rad_s" in capsys.readouterr().err


def test_a_robot_that_tips_in_every_run_is_refused_after_ten() -> None:
    robot = sm.read_robot("mecanum4")
    high = replace(robot, effects=(LoadTransfer(com_height_m=0.7, com_share=0.77), stiff_with_load()))
    # 3 cm lower friction chatters where a wheel is about to lift, and rounding decides what ends most runs.
    with pytest.raises(
        InputError, match=r"training: 10 of 10 simulated runs do not reach their end: a wheel lifts"
    ):
        sm.SlipMonitor(high, "floor", false_alarm_rate=0.5)


def stiff_with_load() -> GeneralEffect:
    """Friction that is some ten thousand times as steep under load."""
    return GeneralEffect(
        traced_to=Trace.VELOCITY,
        part=Part.GRIP,
        terms=(
            Multiplier(
                variable=Variable.WHEEL_LOAD,
                basis=Basis.ODD,
                target=Target.STIFFNESS_DRIVE,
                shape=np.array([2.0, -1.0]),
                coefficients=np.array([-0.097, 7.06]),
                wheels=np.ones(4),
            ),
        ),
    )


def test_a_torque_for_currents_that_nobody_logs_is_refused() -> None:
    """It was ignored without a word."""
    for words in ({}, {"current": True, "training": []}):
        with pytest.raises(InputError, match="torque_per_ampere_N_m: has no effect"):
            sm.SlipMonitor("ohio-kiwi", "paper", torque_per_ampere_N_m=0.5, **words)


def test_a_seed_below_zero_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,3\n", encoding="utf-8")
    assert status(["monitor", "ohio-kiwi", str(log), "--surface", "paper", "--seed", "-1"]) == 2
    assert "--seed: is -1, give a whole number from 0" in capsys.readouterr().err


def test_the_log_itself_is_no_place_for_results(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n0,1,2,3\n", encoding="utf-8")
    before = log.read_bytes()
    assert status(["monitor", "ohio-kiwi", str(log), "--surface", "paper", "--out", str(log)]) == 2
    assert "is read as well as written" in capsys.readouterr().err and log.read_bytes() == before
    other = tmp_path / "other-name.csv"
    other.hardlink_to(log)
    assert status(["monitor", "ohio-kiwi", str(log), "--surface", "paper", "--out", str(other)]) == 2
    assert "is read as well as written" in capsys.readouterr().err and log.read_bytes() == before


def test_three_wheels_without_more_channels_are_told_so() -> None:
    watch = sm.SlipMonitor("ohio-kiwi", "paper", false_alarm_rate=0.5)
    assert any("no redundancy" in w for w in watch.warnings)
    with pytest.raises(InputError, match="gyro_rad_s"):
        sm.SlipMonitor("ohio-kiwi", "paper", false_alarm_rate=0.5, gyro=True).update(0.0, [0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("column", "line"), [(0, "9e300,1,2,3,0"), (2, "1,1,1e308,3,0"), (4, "1,1,2,3,-1e300")]
)
def test_a_sample_that_no_robot_measures_is_refused(column: int, line: str) -> None:
    """One wheel speed of 1e308 made every estimate after it NaN."""
    names = ["t_s", "omega1_rad_s", "omega2_rad_s", "omega3_rad_s", "gyro_rad_s"]
    watch = sm.SlipMonitor("ohio-kiwi", "paper", false_alarm_rate=0.5, gyro=True)
    place = "omega_rad_s" if 0 < column < 4 else names[column]
    with pytest.raises(InputError, match=f"line 3: {place}: holds .* no robot measures that"):
        list(watch.stream([",".join(names), "0,1,2,3,0", line]))


def test_training_on_a_data_set_with_poses() -> None:
    rig = ROOT / "tests" / "data" / "rig" / "a-null"
    if not (rig / "trials").is_dir():
        pytest.skip("no trials in tests/data/rig: only its pulls are kept in the repository")
    watch = sm.SlipMonitor(rig / "robot.toml", "floor", gyro=True, commanded=True, training=rig)
    assert watch.ratio.grips.gain[0] > watch.ratio.slips.gain[0]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({}, "gyro_rad_s: is missing"),
        ({"gyro_rad_s": np.array([0.1, np.nan, 0.1])}, "gyro_rad_s: holds a value that is not finite"),
        ({"gyro_rad_s": np.zeros(2)}, "gyro_rad_s"),
        ({"gyro_rad_s": np.zeros(3), "current_A": np.zeros((3, 4))}, "current_A: has no effect"),
        ({"gyro_rad_s": np.zeros(3), "omega": np.full((3, 4), np.nan)}, "omega: holds a value that is not"),
        ({"gyro_rad_s": np.zeros(3), "t_s": np.array([0.0, 0.2, 0.1])}, "t_s: does not increase"),
        ({"gyro_rad_s": np.zeros(3), "t_s": np.array([0.0, np.nan, 0.1])}, "t_s: holds a value that is not"),
        ({"gyro_rad_s": np.zeros(3), "slips": np.zeros(2)}, "slips: has shape"),
        (
            {"gyro_rad_s": np.zeros(3), "twist": np.zeros((3, 3)), "slips": np.full(3, np.nan)},
            "slips: holds a value that is not",
        ),
    ],
)
def test_a_run_for_training_is_whole(watch: sm.SlipMonitor, more: dict[str, np.ndarray], said: str) -> None:
    """One NaN made every later sample one, and of them a threshold that no value is above."""
    run = {"omega": np.ones((3, 4)), "twist": np.full((3, 3), np.nan), "slips": np.zeros(3, dtype=bool)}
    with pytest.raises(InputError, match=said):
        watch.labelled(**({"t_s": np.array([0.0, 0.1, 0.2])} | run | more))
