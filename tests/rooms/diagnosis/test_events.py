"""A kick in one run is an event: told, cut out, and never given the name of an effect."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record
from slipmargin.diagnosis import telling
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.events import cut_apart, find_events
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Event, Verdict
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.search import search
from slipmargin.diagnosis.searched import _apart, _cut, searched
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.effects.push import Push
from slipmargin.effects.wheel_loads import WheelLoads


def kicked(record: Record, at_s: float) -> Record:
    """Within 0.05 s the robot is moved 4 cm and turned 0.15 rad; then it goes on as before."""
    pose = np.array(record.pose)
    first = int(np.searchsorted(record.t_s, at_s))
    share = np.clip((record.t_s - at_s) / 0.05, 0.0, 1.0)
    c, s = np.cos(0.15 * share), np.sin(0.15 * share)
    arm = pose[:, :2] - pose[first, :2]
    pose[:, 0] = pose[first, 0] + c * arm[:, 0] - s * arm[:, 1] + 0.04 * share
    pose[:, 1] = pose[first, 1] + s * arm[:, 0] + c * arm[:, 1]
    pose[:, 2] += 0.15 * share
    return replace(record, pose=pose)


@pytest.fixture(scope="module")
def data() -> DataSet:
    return planted(smooth_kiwi(), None, seed=77, count=6, duration_s=2.5, rate_hz=100.0)


def test_a_kick_is_told_and_explains_nothing(data: DataSet) -> None:
    trials = (*data.trials[:3], kicked(data.trials[3], 1.2), *data.trials[4:])
    found = diagnose(replace(data, trials=trials), seed=1)
    assert found.verdict is Verdict.NO_MISSING_EFFECT and found.findings == ()
    assert {e.trial for e in found.events} == {"trial03"}
    assert all(e.t_s == pytest.approx(1.2, abs=0.15) for e in found.events)
    assert found.before.chi == pytest.approx(1.0, abs=0.08)


def test_a_kick_in_a_run_that_was_not_searched_leaves_the_search_as_it_was(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    loads = Plant(name="loads", traces=(), effects=(WheelLoads(shift_x_m=0.007, shift_y_m=-0.005),))
    data = planted(smooth_kiwi(), loads, seed=5, count=8, duration_s=2.0, rate_hz=50.0)
    monkeypatch.setattr(telling, "SETTINGS", replace(SETTINGS, most_searched=SETTINGS.folds))
    ran: list[Index] = []

    def spied(*given: Any) -> tuple[Problem, State, list[Round]]:
        found = search(*given)
        ran.append(found[1].fit.trials)
        return found

    monkeypatch.setattr("slipmargin.diagnosis.searched.search", spied)
    plain = diagnose(data, seed=1)
    looked = searched(data, 1).rounds[0].before.fit.trials
    unsearched = next(i for i, t in enumerate(plain.trials) if not t.held_out and i not in looked)
    trials = tuple(kicked(t, 1.0) if i == unsearched else t for i, t in enumerate(data.trials))
    ran.clear()
    found = diagnose(replace(data, trials=trials), seed=1)
    assert len(ran) == 1, "searched twice"
    assert {e.trial for e in found.events} == {data.trials[unsearched].name}
    assert [f.name for f in found.findings] == [f.name for f in plain.findings] == ["wheel_loads"]
    assert found.after.chi == pytest.approx(plain.after.chi, rel=0.02)
    assert len(found.trials) == len(plain.trials) + 1 and found.steps[0].taken == plain.steps[0].taken


def test_nothing_happened_where_nothing_did(data: DataSet) -> None:
    assert diagnose(data, seed=1).events == ()


def test_a_run_is_cut_where_something_happened(data: DataSet) -> None:
    event = Event(trial="trial02", t_s=1.0, channel="x", size_sigma=50.0)
    parts, runs = cut_apart(data.trials, [event])
    assert runs == (0, 1, 2, 2, 3, 4, 5)
    before, after = parts[2], parts[3]
    assert before.t_s[-1] <= 0.9 + 1e-9 and after.t_s[0] >= 1.1 - 1e-9
    whole = data.trials[2]
    np.testing.assert_array_equal(before.pose, whole.pose[: len(before.t_s)])
    np.testing.assert_array_equal(after.theta, whole.theta[-len(after.t_s) :])
    assert before.name != after.name and before.name.startswith("trial02")


def test_a_part_too_short_to_tell_anything_is_dropped(data: DataSet) -> None:
    event = Event(trial="trial00", t_s=0.2, channel="x", size_sigma=50.0)
    parts, runs = cut_apart(data.trials, [event])
    assert len(parts) == 6 and runs == (0, 1, 2, 3, 4, 5)
    assert 0.29 < parts[0].t_s[0] < 0.32


@pytest.mark.parametrize(("wrong", "told"), [(False, True), (True, False)])
def test_what_only_the_effects_make_did_not_happen(data: DataSet, wrong: bool, told: bool) -> None:
    """A ridge in the wrong place kicked the prediction of a held-out run, which was cut out of the test."""
    run = data.trials[1] if wrong else kicked(data.trials[1], 1.2)
    trials = (data.trials[0], run, *data.trials[2:])
    problem = problem_of(replace(data, trials=trials))
    plain = np.array([t.pose for t in data.trials])
    predicted = plain.copy()
    if wrong:
        predicted[1] = kicked(data.trials[1], 1.2).pose
    events = find_events(problem, predicted, plain, np.arange(len(trials)))
    assert {e.trial for e in events} == ({run.name} if told else set())


def test_after_an_event_wheels_stand_where_they_have_turned_to(data: DataSet) -> None:
    """Without logged angles the later part of a run began at the phase of its start."""
    speeds = replace(data, trials=tuple(replace(t, theta=None) for t in data.trials))
    found = searched(speeds, 1)
    event = Event(trial="trial02", t_s=1.0, channel="x", size_sigma=50.0)
    cut = _cut(found, speeds, (event,))
    first, second = (i for i, run in enumerate(cut.runs) if run == 2)
    record = speeds.trials[2]
    assert record.omega is not None
    until = int(np.searchsorted(record.t_s, cut.problem.trials[second].t_s[0]))
    turned = np.trapezoid(record.omega[: until + 1], record.t_s[: until + 1], axis=0)
    phases = cut.problem.wheel_phases
    np.testing.assert_allclose(phases[second] - phases[first], turned, atol=1e-6)


def test_after_an_event_time_goes_on(data: DataSet) -> None:
    """What happens at one time of every run happened a second too late in the later part of a cut one."""
    push = Push(force_x_N=20.0, force_y_N=-10.0, time_s=1.6, duration_s=0.2)
    plant = Plant(name="push", traces=(), effects=(push,))
    pushed = planted(smooth_kiwi(), plant, seed=77, count=2, duration_s=2.5, rate_hz=100.0)
    problem, runs = _apart(pushed, (Event(trial="trial00", t_s=0.8, channel="x", size_sigma=50.0),))
    assert runs == (0, 0, 1)
    left = problem.residuals([(push,), ()], [np.arange(3)] * 2)
    assert np.sqrt(np.mean(left[0][1][left[0][1] != 0.0] ** 2)) < 1.2
    assert np.sqrt(np.mean(left[1][1][left[1][1] != 0.0] ** 2)) > 3.0
