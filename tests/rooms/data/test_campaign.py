"""Several data sets of one robot: joined, taken apart again, refused where they do not belong together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import planted, smooth_kiwi

from slipmargin.data.campaign import Part, apart, each, joined
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair
from slipmargin.data.segments import segments
from slipmargin.errors import InputError
from slipmargin.robot import Robot


def part(name: str, floor: str = "a", loading: str = "as stated", count: int = 2, seed: int = 1) -> Part:
    data = planted(smooth_kiwi(), None, seed, count=count, duration_s=0.5, rate_hz=50.0)
    return Part(data_set=replace(data, name=name), floor=floor, loading=loading, instrument="the same")


def test_joined_runs_remember_their_data_set_and_come_apart_again() -> None:
    one, two = part("one"), part("two", floor="b", count=3)
    whole = joined("both", [one, two])
    assert [t.name for t in whole.trials][:3] == ["one/trial00", "one/trial01", "two/trial00"]
    assert whole.member_of == (0, 0, 1, 1, 1)
    assert [m.floor for m in whole.members] == ["a", "b"]
    back = apart(whole)
    assert [d.name for d in back] == ["one", "two"] and [len(d.trials) for d in back] == [2, 3]
    assert apart(one.data_set) == (one.data_set,)


def test_each_member_is_mended_for_itself_and_named() -> None:
    def without_first(data: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
        said = Repair(kind="x", runs=(data.trials[0].name,), size=1.0, unit="1", sentence="left out.")
        return replace(data, trials=data.trials[1:]), (said,)

    whole, said = each(joined("both", [part("one"), part("two", count=3)]), without_first)
    assert whole.member_of == (0, 1, 1)
    assert [r.sentence for r in said] == ["one: left out.", "two: left out."]


def test_what_does_not_belong_together_is_refused_by_name() -> None:
    one = part("one")
    with pytest.raises(InputError, match=r"data_set\[2\].*called 'one'"):
        joined("x", [one, part("one")])
    with pytest.raises(InputError, match="there is none"):
        joined("x", [])
    robot: Robot = one.data_set.recipe.robot
    for key, value in (
        ("radius_m", 0.05),
        ("roller_angle_deg", 45.0),
        ("rigid_fraction", 0.3),
        ("rollers", 5),
    ):
        wheels = tuple(replace(w, **{key: value}) for w in robot.wheels)
        other = replace(one.data_set.recipe, robot=replace(robot, wheels=wheels))
        with pytest.raises(InputError, match="other wheels"):
            joined("x", [one, replace(one, data_set=replace(one.data_set, name="two", recipe=other))])
    commands = tuple(replace(t, omega_cmd=t.omega, omega=None, theta=None) for t in one.data_set.trials)
    said = replace(one.data_set, name="two", trials=commands, wheel_signal=WheelSignal.COMMANDED)
    with pytest.raises(InputError, match="commanded"):
        joined("x", [one, replace(one, data_set=said)])


def recording(seconds: float = 10.0, rest_s: float = 0.0) -> Record:
    t = np.arange(0.0, seconds, 0.02)
    turned = 3.0 * np.maximum(0.0, t - rest_s)
    pose = np.column_stack([0.1 * turned, 0.0 * t, 0.2 * turned])
    return Record(name="long", t_s=t, pose=pose, theta=np.column_stack([turned, -turned, turned]))


def test_a_recording_is_cut_into_runs_that_share_no_pose_and_keep_their_past() -> None:
    record = recording()
    runs, left = segments(record, 2.5, 0.4)
    assert [r.name for r in runs] == ["long_000", "long_001", "long_002", "long_003"]
    assert sum(int(r.seen.sum()) for r in runs) == len(record.t_s)
    assert runs[0].seen.all() and not left
    for run in runs[1:]:
        assert run.t_s[0] == 0.0
        assert 19 <= int(np.argmax(run.seen)) <= 21, "0.4 s at 50 Hz"
        assert run.theta is not None and np.isfinite(run.theta).all()


def test_parts_of_a_recording_in_which_nothing_moves_are_no_runs() -> None:
    assert [r.name for r in segments(recording(rest_s=5.2), 2.5)[0]] == ["long_002", "long_003"]
    assert len(segments(recording(11.0), 2.5)[0]) == 4, "a last second is too short"
    cut = replace(recording(), t_s=recording().t_s + 100.0, began_s=90.0)
    assert {r.start_s for r in segments(cut, 2.5)[0]} == {0.0}, "each is a run of its own"
    with pytest.raises(InputError, match="segment_s"):
        segments(recording(), 0.2)


def test_a_missing_encoder_row_leaves_a_run_in() -> None:
    record = recording()
    theta = np.array(record.theta)
    theta[60::125] = np.nan
    assert len(segments(replace(record, theta=theta), 2.5)[0]) == 4
