"""Narrow ridges, short ramps: lines at which wheels change the motion lead to them, where no tangent does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.campaign import Part, joined
from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.crossings import Line, _place, _same, _shapes, at_crossings, lines
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.fit import evaluate
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.search import screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import Trace
from slipmargin.effects.floor_patch import FloorPatch
from slipmargin.effects.floor_ramp import FloorRamp
from slipmargin.effects.floor_seam import FloorSeam
from slipmargin.effects.places import LINE, PATCH
from slipmargin.physics.relief import beyond

SIGMA = np.array([5e-4, 5e-4, 2e-3])
EVERY = np.arange(8)
SEAM = FloorSeam(height_m=0.012, offset_m=-0.11, direction_rad=1.33, width_m=0.05)
RAMP = FloorRamp(slope_rad=0.07, offset_m=0.06, direction_rad=0.6, length_m=0.18)


@pytest.fixture(scope="module")
def crossed() -> DataSet:
    plant = Plant(name="seam", traces=(), effects=(SEAM,))
    made: DataSet = planted(smooth_kiwi(), plant, seed=5, count=8, duration_s=2.5, rate_hz=100.0)
    return made


@pytest.fixture(scope="module")
def ramped() -> DataSet:
    plant = Plant(name="ramp", traces=(), effects=(RAMP,))
    made: DataSet = planted(smooth_kiwi(), plant, seed=6, count=8, duration_s=2.5, rate_hz=100.0)
    return made


def candidates_of(at: Problem) -> list[Candidate]:
    reach = {"position": 0.5, "time": 2.5, "body": 0.2}
    return named_candidates(at.nominal.geometry.names, False, (), reach)


def problem(data: DataSet) -> Problem:
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    return Problem.of(data.recipe, data.surface, trials, SIGMA, False)


def found(of: Problem, *likes: FloorSeam | FloorRamp) -> list[Line]:
    reliefs = [of.model((like,)).external.reliefs[-1] for like in likes or (SEAM,)]
    predicted = of.predict([()], [EVERY])[0]
    return lines(of, evaluate(of, (), np.zeros(0), EVERY), predicted, reliefs, SETTINGS.crossings)


def test_the_line_that_wheels_cross_is_among_the_first(crossed: DataSet) -> None:
    assert any(
        abs(line.offset_m - SEAM.offset_m) <= 0.05
        and abs(line.direction_rad - SEAM.direction_rad) <= 0.2
        and line.sign == 1
        for line in found(problem(crossed))[:3]
    )


def test_of_several_widths_the_one_that_fits_decides(crossed: DataSet) -> None:
    """Lines are not shared out over the widths: those of the better one come first, and no line twice."""
    at, wide = problem(crossed), replace(SEAM, width_m=0.4)
    both = found(at, wide, SEAM)
    assert len(both) == SETTINGS.crossings and both[0].shape == 1
    assert replace(both[0], shape=0) == found(at)[0]


def test_a_strip_that_begins_before_the_floor_that_is_driven_over_is_looked_at() -> None:
    """Every run begins on it and comes off it."""
    strip = FloorRamp(slope_rad=0.05, offset_m=-1.8, direction_rad=0.6, length_m=1.9)
    made = planted(smooth_kiwi(), Plant(name="strip", traces=(), effects=(strip,)), seed=6, count=8)
    assert any(
        abs(line.offset_m - strip.offset_m) <= 0.3 and abs(line.direction_rad - strip.direction_rad) <= 0.2
        for line in found(problem(made), strip)[:3]
    )


def test_a_short_ramp_is_started_where_it_is(ramped: DataSet) -> None:
    """No start of those that are spread over the floor comes near a strip as short as the robot."""
    at = problem(ramped)
    own = [c for c in candidates_of(at) if c.name == "floor_ramp"]
    before = fitted(at, (), np.zeros(0), EVERY, EVERY.tolist())
    plain = screened(before, EVERY.tolist(), own, 0, Watch(report=no_progress))
    (ramp,) = at_crossings(before, plain)
    slope, offset, direction, length, _ = ramp.starts[0]
    assert abs(direction - RAMP.direction_rad) <= 0.3 and slope > 0.0
    assert abs(offset + 0.5 * length - (RAMP.offset_m + 0.5 * RAMP.length_m)) <= 0.1
    (listed,) = (e for e in plain.entries if e.label == ramp.label)
    assert ramp.promise > 1.2 * listed.promise


def test_no_two_lines_are_the_same_whichever_way_their_normals_point(crossed: DataSet) -> None:
    at = problem(crossed)
    far, apart = SETTINGS.crossing_same_rad, SETTINGS.crossing_same_m
    x, y = np.median(np.concatenate([trial.pose[:, :2] for trial in at.trials]), axis=0)
    places = [
        (-float(beyond(line.offset_m, line.direction_rad, x, y)), line.direction_rad) for line in found(at)
    ]
    for one, (offset, direction) in enumerate(places):
        for other, towards in places[one + 1 :]:
            turned = abs(direction - towards)
            assert turned > far or abs(offset - other) > 0.9 * apart  # the middle is taken of fewer samples
            assert np.pi - turned > far or abs(offset + other) > 0.9 * apart


def test_a_strip_is_the_same_seen_from_either_end(crossed: DataSet) -> None:
    """Turned round, it begins where it ended: at minus its offset and its length."""
    relief, centre = problem(crossed).model((RAMP,)).external.reliefs[-1], np.array([0.4, -0.7])
    one = Line(0.5, 0.0, 0, 1)
    turned, beside = (Line(-(0.5 + RAMP.length_m + d), np.pi - 1e-6, 0, -1) for d in (0.0, 0.3))
    place = [_place(line, relief, centre) for line in (one, turned, beside)]
    assert _same(place[0], place[1]) and not _same(place[0], place[2])


def test_a_floor_of_any_size_has_as_many_lines_as_can_be_looked_at(crossed: DataSet) -> None:
    """A camera that is off by kilometres once must not cost memory."""
    far = problem(crossed)
    trials = tuple(replace(t, pose=t.pose + np.array([1e7, 0.0, 0.0])) for t in far.trials[:1])
    assert len(found(replace(far, trials=(*trials, *far.trials[1:])))) == SETTINGS.crossings


def test_runs_too_short_for_a_velocity_have_no_lines(crossed: DataSet) -> None:
    short = tuple(record.first(6) for record in crossed.trials)
    assert not len(found(problem(replace(crossed, trials=short))))


def test_fits_start_on_a_line_as_ridge_and_as_groove() -> None:
    (seam,) = (c for c in named_candidates(("1", "2", "3"), False, ()) if c.name == "floor_seam")
    rows = seam.at(LINE, (0.4, 1.2), seam.near)
    assert {tuple(row) for row in rows[:, 1:3]} == {(0.4, 1.2)}
    assert set(np.sign(rows[:, 0])) == {1.0, -1.0} and len(set(rows[:, 3])) == 2
    patch = next(c for c in named_candidates(("1",), False, ()) if c.name == FloorPatch.name)
    assert seam.is_near(LINE) and not patch.is_near(LINE) and patch.is_near(PATCH)


def test_a_floor_of_its_own_has_lines_as_any_other(crossed: DataSet) -> None:
    """In a campaign over two floors a ridge of the second does not act in the first data set's model."""
    whole = joined(
        "two floors",
        [
            Part(data_set=replace(crossed, name=name), floor=name, loading="bare", instrument="camera")
            for name in ("a", "b")
        ],
    )
    own = in_groups([c for c in candidates_of(problem(crossed)) if c.is_near(LINE)], whole.members)
    there = {c.label: _shapes(problem_of(whole).nominal, c) for c in own if "floor b" in c.label}
    assert {label: len(shapes) for label, shapes in there.items()} == {
        "floor_ramp in floor b": 3,
        "floor_seam in floor b": 2,
    }


def test_the_first_list_knows_what_a_ridge_on_the_best_line_takes_off(crossed: DataSet) -> None:
    """With little time a ridge was never simulated where it is: fits of all that it is not came first."""
    at = problem(crossed)
    before = fitted(at, (), np.zeros(0), EVERY, EVERY.tolist())
    plain = screened(before, EVERY.tolist(), candidates_of(at), 0, Watch(report=no_progress))
    (ridge,) = (e for e in at_crossings(before, plain) if e.label == "floor_seam")
    squares = [np.sum(at.residuals([(ridge.structure[0].build(x),)], [EVERY])[0] ** 2) for x in ridge.starts]
    assert squares == sorted(squares)
    noise = 2.0 * ridge.structure[0].size * max(1.0, before.chi**2)
    assert ridge.promise == pytest.approx(before.fit.cost - squares[0] - noise, rel=1e-3)
    merged = plain.with_better([ridge])
    (first,) = (e for e in merged.entries if e.label == ridge.label)
    assert first.promise == ridge.promise > 0.5 * before.fit.cost
    assert np.array_equal(first.starts[0], ridge.starts[0])
    names = [e for e in merged.entries if e.stands_alone and e.named]
    assert max(names, key=lambda e: e.promise) is first


def test_what_promises_less_changes_nothing(crossed: DataSet) -> None:
    at = problem(crossed)
    before = fitted(at, (), np.zeros(0), EVERY, EVERY.tolist())
    own = [c for c in named_candidates(at.nominal.geometry.names, False, ()) if c.name == "floor_nap"]
    plain = screened(before, EVERY.tolist(), own, 0, Watch(report=no_progress))
    worse = [replace(e, promise=e.promise - 1.0) for e in plain.entries]
    assert plain.with_better(worse).entries == plain.entries


def test_a_narrow_ridge_is_found(crossed: DataSet) -> None:
    """None of three judged sets was named: every start was a ridge four times as wide as this one."""
    answer = diagnose(crossed, seed=1)
    assert answer.verdict is Verdict.EFFECT_FOUND
    (finding,) = answer.findings
    assert finding.name == "floor_seam" and finding.traced_to is Trace.POSITION
    for parameter in finding.parameters:
        assert parameter.low <= getattr(SEAM, parameter.name) <= parameter.high
    assert answer.before.chi > 2.0 and answer.after.chi < 1.15
