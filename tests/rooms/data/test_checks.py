"""Bad data are told by name: each fault put into good data and found there, good data found good."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from real_logs import EXCERPT, logs

from slipmargin.data.checks import check_data_set
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.io.importers.plug import import_files
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.robot_file import read_recipe


def real(floor: str = "gray_0.1") -> DataSet:
    return DataSet(
        name="real",
        recipe=read_recipe("robotino"),
        surface="gray",
        wheel_signal=WheelSignal.MEASURED,
        trials=import_files(RobotinoImporter(), logs(EXCERPT / floor)).records,
    )


def spoilt(change: Callable[[Record], Record]) -> str:
    good = real()
    return "\n".join(map(str, check_data_set(replace(good, trials=tuple(map(change, good.trials))))))


def wheels(order: list[int], sign: tuple[float, float, float] = (1, 1, 1)) -> Callable[[Record], Record]:
    return lambda r: replace(r, theta=r.theta[:, order] * np.array(sign), omega_cmd=None)  # type: ignore[index]


def pose(*factor: float) -> Callable[[Record], Record]:
    return lambda r: replace(r, pose=r.pose * np.array(factor))


@pytest.mark.parametrize("floor", ["table_0.1", "gray_0.1", "gray_0.2"])
def test_a_quarter_of_slip_is_no_fault_of_the_data(floor: str) -> None:
    assert check_data_set(real(floor)) == ()


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (wheels([1, 0, 2]), "columns of wheels 1 and 2 swapped"),
        (wheels([0, 2, 1]), "columns of wheels 2 and 3 swapped"),
        (wheels([1, 2, 0]), "columns of wheels 1 and 2 and 3 swapped"),
        (wheels([0, 1, 2], (-1, -1, -1)), "every wheel turning the other way"),
        (wheels([0, 1, 2], (1, -1, 1)), "wheel 2 turning the other way"),
        (pose(1, -1, -1), "a mirrored frame"),
        (pose(1000, 1000, 1), "x_m and y_m in millimetres"),
        (pose(100, 100, 1), "x_m and y_m in centimetres"),
        (lambda r: replace(r, theta=np.rad2deg(r.theta), omega_cmd=None), "degrees instead of radians"),
        (lambda r: replace(r, t_s=1000.0 * r.t_s), "time in milliseconds"),
        (lambda r: replace(r, t_s=1e-6 * r.t_s), "multiply it by 1000"),
        (lambda r: replace(r, t_s=r.t_s + np.where(r.t_s > 3.0, 60.0, 0.0)), "a clock that was set"),
        (lambda r: replace(r, theta=0.0 * r.theta), "dead channel or the wrong column for the wheels"),
        (lambda r: replace(r, pose=0.0 * r.pose), "dead channel or the wrong column for the pose"),
    ],
)
def test_each_fault_is_named(change: Callable[[Record], Record], cause: str) -> None:
    told = spoilt(change)
    assert cause in told
    assert told.count("\n") == 0 and "likely cause" in told  # one line, and no other suspicion


def test_runs_with_one_pose_each_are_named() -> None:
    """Nothing could be compared, and the answer was that no effect is missing."""
    told = spoilt(with_one_pose)
    assert "only one pose was measured" in told and "(and 7 more)" in told


def with_one_pose(record: Record) -> Record:
    pose = np.array(record.pose)
    pose[1 + int(np.argmax(record.seen)) :] = np.nan
    return replace(record, pose=pose)


def test_one_line_a_fault_however_many_trials() -> None:
    assert "(and 7 more)" in spoilt(lambda r: replace(r, t_s=1000.0 * r.t_s))


def test_heading_in_degrees() -> None:
    def turning(record: Record) -> Record:  # a spin: 0.2 m/s at every wheel's rim
        t = np.linspace(0.0, 4.0, 200)
        theta = -np.outer(t, np.full(3, 5.0))
        phi = 5.0 * 0.04 / 0.125 * t
        return Record(
            name=record.name, t_s=t, theta=theta, pose=np.stack([0.001 * t, 0.0 * t, np.rad2deg(phi)], axis=1)
        )

    assert "degrees instead of radians" in spoilt(turning)


def test_without_wheels_only_the_clock_is_judged() -> None:
    good = real()
    bare = tuple(
        replace(t, theta=None, omega_cmd=np.full((len(t.t_s), 3), 1e-9), current=None) for t in good.trials
    )
    assert check_data_set(replace(good, trials=bare, wheel_signal=WheelSignal.COMMANDED)) != ()
    still = tuple(replace(t, pose=0.0 * t.pose) for t in bare)
    (found,) = check_data_set(replace(good, trials=still, wheel_signal=WheelSignal.COMMANDED))
    assert "nothing moves in any run" in str(found), "it was called a model that misses nothing"


def test_a_clock_that_was_set_is_found_in_a_long_file() -> None:
    """It was said to jump at 1.235e+04 s."""
    last = real().trials[0].t_s

    def late(record: Record) -> Record:
        return replace(record, t_s=record.t_s + 12345.0 + np.where(record.t_s > 3.0, 60.0, 0.0))

    assert f" s at {12345.0 + last[last <= 3.0][-1]:.2f} s" in spoilt(late)
