"""Each fault of people's data, put into good data: mended and said, or refused by name."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from spoilt import (
    all_clocks,
    coarse,
    each,
    good,
    heading_turned,
    held_frames,
    jitter,
    jumps,
    posed,
    relocking,
    slow_camera,
    swapped,
    turned_wheel,
    wheel,
    wrapped,
)

from slipmargin.checks import Array
from slipmargin.data.camera_frames import without_zeros
from slipmargin.data.checks import check_data_set
from slipmargin.data.clean_up import Repaired, repaired
from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record
from slipmargin.data.wheel_signals import tick

RANDOM = np.random.default_rng


def kinds(found: Repaired) -> list[str]:
    return [r.kind for r in found.repairs]


def the_only(found: Repaired, kind: str, runs: int = 8) -> float:
    assert kinds(found) == [kind], [r.sentence for r in found.repairs]
    (repair,) = found.repairs
    assert len(repair.runs) == runs and repair.sentence.endswith(".")
    return repair.size


def worst(found: Repaired, true: DataSet, what: Callable[[Record], Array]) -> float:
    """Largest difference from the good data, ignoring missing samples."""
    pairs = zip(found.data_set.trials, true.trials, strict=True)
    return max(float(np.nanmax(np.abs(what(a) - what(b)))) for a, b in pairs)


def theta(record: Record) -> Array:
    assert record.theta is not None
    return np.asarray(record.theta - record.theta[0])


def omega(record: Record) -> Array:
    assert record.omega is not None
    return record.omega


@pytest.mark.parametrize("seed", range(3, 9))
@pytest.mark.parametrize("rate", [50.0, 200.0])
def test_good_data_are_left_alone(seed: int, rate: float) -> None:
    data = good(seed, rate_hz=rate, count=6)
    found = repaired(data)
    assert found.repairs == () and found.data_set is data
    assert check_data_set(data) == ()


def test_headings_wrapped() -> None:
    data = good()
    found = repaired(each(data, heading_turned))
    the_only(found, "wrapped_heading", runs=len(found.repairs[0].runs))
    assert worst(found, data, lambda r: r.pose[:, 2] - r.pose[0, 2]) < 1e-9


@pytest.mark.parametrize("speeds", [True, False])
def test_wheel_angles_wrapped(speeds: bool) -> None:
    data = good()
    bad = each(data, lambda r: wheel(r if speeds else replace(r, omega=None), theta=wrapped))
    found = repaired(bad)
    assert the_only(found, "wrapped_wheel_angle") > 8
    assert worst(found, data, theta) < 1e-9


def test_wheel_angles_wrapped_in_a_slow_log_of_fast_wheels() -> None:
    # 5 rad from row to row: only the speeds say how many turns these were.
    t = np.arange(0.0, 4.0, 0.1)
    rate = np.outer(50.0 * np.clip(t, 0.0, 1.0), np.ones(3))
    true = np.cumsum(np.vstack([np.zeros(3), 0.05 * (rate[1:] + rate[:-1])]), axis=0)
    run = Record(name="fast", t_s=t, pose=np.zeros((len(t), 3)), omega=rate, theta=wrapped(true))
    found = repaired(replace(good(), trials=(run,)))
    assert worst(found, replace(good(), trials=(replace(run, theta=true),)), theta) < 1e-9


@pytest.mark.parametrize("absent", [True, False])
def test_a_camera_slower_than_the_log(absent: bool) -> None:
    data = good(4, rate_hz=200.0)
    found = repaired(slow_camera(data, 30.0, RANDOM(0), absent=absent))
    assert kinds(found) == ["slow_camera"] if absent else ["repeated_frames", "slow_camera"]
    frames = sum(int(t.seen.sum()) for t in found.data_set.trials)
    assert frames == pytest.approx(8 * 76, abs=8)
    # The noise of both sets, and what the frames' regular times leave: without these 0.7 times more.
    error = np.concatenate(
        [(a.pose - b.pose)[a.seen] for a, b in zip(found.data_set.trials, data.trials, strict=True)]
    )
    assert data.sigma is not None
    assert np.all(error.std(axis=0) < 1.12 * np.sqrt(2.0) * data.sigma)


def test_a_zero_pose_in_a_long_log_takes_memory_of_its_length_only() -> None:
    data_set = good(count=1, duration_s=30.0)

    def blank(pose: Array) -> Array:
        pose[1500] = 0.0
        return pose

    tracemalloc.start()
    found, _ = without_zeros(posed(data_set, blank))
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.isnan(found.trials[0].pose[1500]).all()
    assert most < 8 * len(found.trials[0].t_s) * 300  # bytes; one number for each pair of rows would be more


@pytest.mark.parametrize(("zero", "kind"), [(True, "zero_frames"), (False, "repeated_frames")])
def test_held_and_zero_frames(zero: bool, kind: str) -> None:
    data = good()
    found = repaired(held_frames(data, RANDOM(0), zero=zero))
    assert the_only(found, kind) > 100
    assert worst(found, data, lambda r: r.pose) == 0.0


def test_a_coarse_camera_repeats_what_it_sees_at_rest() -> None:
    def rounded(pose: Array) -> Array:
        return np.asarray(np.round(pose / 0.002) * 0.002)

    data = good()
    still = replace(
        data, trials=tuple(replace(t, pose=t.pose[:1].repeat(len(t.t_s), 0)) for t in data.trials)
    )
    found = repaired(posed(still, rounded))
    assert found.repairs == ()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("size_m", [0.05, 0.5])
def test_jumps_of_single_frames(seed: int, size_m: float) -> None:
    data = good()
    found = repaired(jumps(data, RANDOM(seed), size_m=size_m))
    assert the_only(found, "jumping_frames") > 60
    assert data.sigma is not None
    left = [
        np.abs(a.pose - b.pose) / data.sigma for a, b in zip(found.data_set.trials, data.trials, strict=True)
    ]
    assert sum(int((np.nan_to_num(e) > 0.0).any(axis=1).sum()) for e in left) <= 2  # jumps within the noise
    assert max(float(np.nanmax(e)) for e in left) < 13.0


def test_a_marker_mistaken_for_another() -> None:
    data = good()
    found = repaired(relocking(data, RANDOM(0)))
    assert the_only(found, "jumping_frames") == 8 * 15
    assert worst(found, data, lambda r: r.pose) == 0.0


def test_a_robot_that_stays_elsewhere_is_an_event_and_no_frame_that_is_off() -> None:
    def moved(record: Record) -> Record:
        return replace(
            record, pose=record.pose + 0.5 * (record.t_s > 1.2)[:, None] * np.array([1.0, 0.0, 0.0])
        )

    assert repaired(each(good(), moved)).repairs == ()


def test_trembling_stamps() -> None:
    data = good()
    found = repaired(jitter(data, RANDOM(0)))
    assert the_only(found, "trembling_stamps") == pytest.approx(0.002, rel=0.1)
    assert worst(found, data, lambda r: r.t_s) < 0.001


def test_samples_that_were_taken_irregularly_keep_their_times() -> None:
    random = RANDOM(0)

    def irregular(record: Record) -> Record:
        t = record.t_s + (0.002 * random.standard_normal(len(record.t_s))).clip(-0.0045, 0.0045)
        assert record.theta is not None
        columns = [np.interp(t, record.t_s, c) for c in record.theta.T]
        return replace(record, t_s=t, theta=np.column_stack(columns))

    assert "trembling_stamps" not in kinds(repaired(each(good(), irregular)))


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_one_clock_that_is_off(factor: float) -> None:
    data = good()
    found = repaired(all_clocks(data, factor))
    assert the_only(found, "clock_rate") == pytest.approx(factor - 1.0, rel=0.05)
    assert worst(found, data, lambda r: r.t_s) < 0.003


def test_times_since_1970() -> None:
    data = good()
    found = repaired(each(data, lambda r: replace(r, t_s=r.t_s + 1.7e9)))
    assert the_only(found, "epoch_time") == 1.7e9
    assert worst(found, data, lambda r: r.t_s) < 1e-6


def test_when_a_cut_run_began_moves_with_its_times() -> None:
    """A run with ``began_s`` was refused if it counted from 1970, and its clock was corrected in part."""
    data = each(good(), lambda r: replace(r, began_s=float(r.t_s[0]) - 2.0))
    late = repaired(each(data, lambda r: replace(r, t_s=r.t_s + 1.7e9, began_s=r.start_s + 1.7e9)))
    slow = repaired(each(data, lambda r: replace(r, t_s=1.02 * r.t_s, began_s=1.02 * r.start_s)))
    stamps = jitter(good(), RANDOM(5)).trials
    trials = tuple(
        replace(t, t_s=s.t_s, began_s=float(s.t_s[0]) - 2.0) for t, s in zip(data.trials, stamps, strict=True)
    )
    uneven = repaired(replace(data, trials=trials))
    for found, kind in ((late, "epoch_time"), (slow, "clock_rate"), (uneven, "trembling_stamps")):
        the_only(found, kind)
        assert worst(found, data, lambda r: r.since_s) < 0.004, kind


@pytest.mark.parametrize(
    ("factor", "unit"), [(60.0 / (2.0 * np.pi), "turns a minute"), (180.0 / np.pi, "degrees a second")]
)
def test_wheel_speeds_in_another_unit_than_the_angles(factor: float, unit: str) -> None:
    data = good()
    found = repaired(each(data, lambda r: wheel(r, omega=lambda v: factor * v)))
    assert the_only(found, "wheel_speed_unit") == pytest.approx(factor)
    assert unit in found.repairs[0].sentence
    assert worst(found, data, omega) < 1e-3 * max(float(np.abs(omega(t)).max()) for t in data.trials)


def test_rows_in_which_a_wheel_is_not_known_yet_or_no_longer_are_left_out() -> None:
    """Seen in a null: the wheel was held still there, its angle and speed disagreed, and friction varied."""

    def cut(record: Record) -> Record:
        angles, speeds = np.array(record.theta), np.array(record.omega)
        angles[-40:, 1], speeds[-40:, 1], speeds[:25, 0] = np.nan, np.nan, np.nan
        return replace(record, theta=angles, omega=speeds)

    true = good(3)
    found = repaired(each(true, cut))
    assert the_only(found, "wheels_unknown") == 65 * len(true.trials)
    for mended, whole in zip(found.data_set.trials, true.trials, strict=True):
        np.testing.assert_array_equal(mended.t_s, whole.t_s[25:-40])
        assert mended.start_s == whole.t_s[0] and mended.omega is not None
        assert np.isfinite(mended.omega).all()


def test_coarse_encoders_by_their_speeds() -> None:
    data = good()
    found = repaired(each(data, lambda r: replace(coarse(r), omega=r.omega)))
    assert the_only(found, "coarse_encoder") == pytest.approx(2.0 * np.pi / 100.0, rel=1e-3)
    assert worst(found, data, theta) < 1e-3


def test_wheels_that_turn_evenly_have_no_ticks() -> None:
    """Equal steps of 209 mrad were taken for an encoder of 30 ticks a turn; its own steps are still found."""
    t = np.arange(250) * 0.02
    still = np.minimum(np.maximum(t - 1.0, 0.0), 3.0)
    for way in (t, -t, still):
        assert tick(np.round(10.4629 * way, 6)) == 0.0
        assert tick(np.round(np.floor(10.4629 * way / 0.15) * 0.15, 6)) == pytest.approx(0.15)


def test_coarse_encoders_alone_are_smoothed() -> None:
    data = good()
    bad = each(data, coarse)
    found = repaired(bad)
    the_only(found, "coarse_encoder")

    def error(spoilt: DataSet) -> float:
        gaps = [omega(a) - omega(b) for a, b in zip(spoilt.trials, data.trials, strict=True)]
        return float(np.sqrt(np.mean(np.square(gaps))))

    assert error(found.data_set) < 0.3 * error(bad)


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (lambda r: turned_wheel(r), "wheel 2 turning the other way"),
        (lambda r: swapped(r), "columns of wheels 1 and 2 swapped"),
        (lambda r: replace(r, pose=r.pose * [-1.0, 1.0, 1.0]), "a mirrored x axis"),
        (lambda r: replace(r, pose=r.pose * [1.0, -1.0, 1.0]), "a mirrored y axis"),
        (lambda r: replace(r, pose=r.pose * [1.0, 1.0, -1.0]), "phi_rad counted clockwise"),
        (lambda r: replace(r, pose=r.pose * [1.0, -1.0, -1.0]), "a mirrored frame"),
        (lambda r: replace(r, pose=r.pose + np.array([0.0, 0.0, np.pi / 2.0])), "subtract π/2"),
        (
            lambda r: replace(r, pose=np.pi / 2.0 * np.array([0.0, 0.0, 1.0]) + r.pose * [1.0, 1.0, -1.0]),
            "a compass course",
        ),
        (lambda r: replace(r, pose=r.pose / [0.3048, 0.3048, 1.0]), "x_m and y_m in feet"),
        (lambda r: replace(r, pose=r.pose * [1000.0, 1000.0, 1.0]), "x_m and y_m in millimetres"),
        (lambda r: replace(r, pose=r.pose * [1.0, 1.0, 180.0 / np.pi]), "degrees instead of radians"),
        (lambda r: wheel(r, theta=np.rad2deg, omega=np.rad2deg), "degrees instead of radians"),
        (lambda r: replace(wheel(r, omega=lambda v: v * 30.0 / np.pi), theta=None), "turns a minute"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_fault_of_every_run_is_named(change: Callable[[Record], Record], cause: str, seed: int) -> None:
    found = repaired(each(good(seed), change))
    assert kinds(found) == []
    (fault,) = check_data_set(found.data_set)
    assert cause in fault.cause


def test_headings_in_degrees_that_are_wrapped_are_named() -> None:
    data = each(good(), heading_turned)
    found = repaired(posed(data, lambda p: p * [1.0, 1.0, 180.0 / np.pi]))
    (fault,) = check_data_set(found.data_set)
    assert "degrees instead of radians" in fault.cause


def test_several_faults_at_once() -> None:
    data = jumps(each(all_clocks(good()), heading_turned), RANDOM(0))
    found = repaired(each(data, lambda r: replace(wheel(r, theta=wrapped), t_s=r.t_s + 1.7e9)))
    assert kinds(found) == [
        "epoch_time",
        "wrapped_heading",
        "wrapped_wheel_angle",
        "clock_rate",
        "jumping_frames",
    ]
    assert worst(found, good(), lambda r: r.t_s) < 0.003


def test_a_run_with_one_pose_is_left_out_and_said() -> None:
    data = good(1)
    pose = np.array(data.trials[1].pose)
    pose[1:] = np.nan
    trials = (data.trials[0], replace(data.trials[1], pose=pose), *data.trials[2:])
    found = repaired(replace(data, trials=trials))
    assert [t.name for t in found.data_set.trials] == [t.name for t in (data.trials[0], *data.trials[2:])]
    assert [(r.kind, r.runs) for r in found.repairs] == [("single_poses", (data.trials[1].name,))]
    assert data.trials[1].name in found.repairs[0].sentence
    alone = repaired(replace(data, trials=(trials[1],))).data_set
    assert len(alone.trials) == 1, "the check names it"
