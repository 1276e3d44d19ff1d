"""Small patches of the floor: places at which the motion leaves the model lead to them; no tangent does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis import patches as patches_of
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.patches import _motion, _stretches, at_patches, patches
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.promise import as_simulated
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.search import _added, screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects.floor_patch import FloorPatch

SIGMA = np.array([5e-4, 5e-4, 2e-3])
EVERY = np.arange(8)
PATCH = FloorPatch(factor=0.2, centre_x_m=0.25, centre_y_m=0.2, radius_m=0.08)
RADII_M = np.array([0.1, 0.3])
#: Half of the smallest, and further ones up to the largest.
RADII_USED = 0.05 * np.sqrt(2.0) ** np.arange(6)


@pytest.fixture(scope="module")
def slick() -> DataSet:
    plant = Plant(name="slick", traces=(), effects=(PATCH,))
    made: DataSet = planted(smooth_kiwi(), plant, seed=5, count=8, duration_s=2.5, rate_hz=100.0)
    return made


def begun(data: DataSet) -> State:
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    problem = Problem.of(data.recipe, data.surface, trials, SIGMA, False)
    return fitted(problem, (), np.zeros(0), EVERY, EVERY.tolist())


def patch_of(state: State) -> Candidate:
    reach = {"position": 0.5, "time": 2.5, "body": 0.2}
    return next(
        c
        for c in named_candidates(state.view.nominal.geometry.names, False, (), reach)
        if c.name == "floor_patch"
    )


def away_m(place: tuple[float, ...]) -> float:
    return float(np.hypot(place[0] - PATCH.centre_x_m, place[1] - PATCH.centre_y_m))


def test_a_place_on_the_patch_is_among_the_first(slick: DataSet) -> None:
    found = patches(begun(slick), RADII_M, EVERY)
    assert len(found) == SETTINGS.patches
    assert any(away_m(place) <= PATCH.radius_m for place in found[:3])
    for k, one in enumerate(found):
        for other in found[:k]:
            assert np.hypot(one[0] - other[0], one[1] - other[1]) >= max(one[2], other[2])


def test_a_gap_in_a_run_is_no_place(slick: DataSet) -> None:
    """While a camera saw nothing the robot turned and drove on: a straight line over it is another motion."""
    pose = slick.trials[0].pose.copy()
    pose[60:110] = np.nan
    holed = replace(slick, trials=(replace(slick.trials[0], pose=pose), *slick.trials[1:]))
    assert any(away_m(place) <= PATCH.radius_m for place in patches(begun(holed), RADII_M, EVERY)[:3])


def test_what_is_left_is_that_about_the_means_of_stretches(slick: DataSet) -> None:
    motion = _motion(begun(slick), EVERY)
    wheels, errors, begins, seen = motion.wheels, motion.errors, motion.begins, motion.seen
    assert seen.all()
    place, radius = np.array([[PATCH.centre_x_m, PATCH.centre_y_m]]), 0.15
    left, kept, free = np.zeros(1), np.zeros(1), np.zeros(1)
    _stretches(place, radius**2, wheels, errors, begins, seen, left, kept, free)
    on_it = (np.hypot(*(wheels - place[0]).transpose(2, 0, 1)) < radius).any(axis=1)
    run = np.cumsum(begins)
    expected, means = 0.0, 0
    for number in range(1, run[-1] + 1):
        own, there = errors[run == number], on_it[run == number]
        cuts = np.flatnonzero(np.diff(there.astype(int))) + 1
        for part, on in zip(np.split(own, cuts), np.split(there, cuts), strict=True):
            if not on[0]:
                expected, means = expected + float(np.sum((part - part.mean(axis=0)) ** 2)), means + 1
    assert left[0] == pytest.approx(expected, rel=1e-9)
    assert kept[0] == 3 * np.count_nonzero(~on_it) and free[0] == 3 * (np.count_nonzero(on_it) + means)


def test_a_fit_starts_on_the_patch(slick: DataSet) -> None:
    """None of the starts that are spread over the floor is as small, or near it: two of six judged sets were
    traced to a roller and to a wheel's angle."""
    before = begun(slick)
    candidate = patch_of(before)
    plain = screened(before, EVERY.tolist(), [candidate], 0, Watch(report=no_progress))
    listed = as_simulated(before, plain)
    (found,) = at_patches(before, listed)
    factor, x_m, y_m, *_ = found.starts[0]
    assert away_m((x_m, y_m)) <= PATCH.radius_m and factor < 1.0
    squares = [np.sum(before.view.residuals([(candidate.build(x),)], [EVERY])[0] ** 2) for x in found.starts]
    assert squares == sorted(squares)
    with_patch = listed.with_better([found])
    fits = [
        _added(
            before, next(e for e in of.entries if e.label == candidate.label), EVERY.tolist(), np.inf, never
        )
        for of in (listed, with_patch)
    ]
    assert fits[0].fit.cost > 100.0 * fits[1].fit.cost and fits[1].fit.cost < 1.1 * fits[1].samples
    for name, value in zip(candidate.keys[:4], fits[1].fit.x, strict=False):
        assert value == pytest.approx(getattr(PATCH, name), abs=0.01)
    assert not at_patches(before, plain, lambda: True)


def test_runs_of_a_few_samples_are_no_fault(slick: DataSet) -> None:
    short = tuple(record.first(6) for record in slick.trials)
    places = np.array(patches(begun(replace(slick, trials=short)), RADII_M, EVERY))
    assert len(places) and np.abs(places[:, :2]).max() < 2.0
    assert np.isclose(places[:, 2:], RADII_USED).any(axis=1).all()


def test_a_wide_floor_takes_no_longer(slick: DataSet, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven runs at one place and one 40 m away: a million places of the smallest patch would lie between."""
    away = replace(slick.trials[0], pose=slick.trials[0].pose + np.array([40.0, 40.0, 0.0]))
    state, counts = begun(slick), []
    far = (replace(state.view.trials[0], pose=away.pose), *state.view.trials[1:])
    wide = replace(state, view=replace(state.view, trials=far))

    def counted(places: Array, radius_m: float, motion: object) -> Array:
        counts.append(len(places))
        return np.arange(float(len(places)))

    monkeypatch.setattr(patches_of, "_scores", counted)
    assert len(patches(wide, RADII_M, EVERY)) == SETTINGS.patches
    assert len(counts) == len(RADII_USED) and max(counts) <= (SETTINGS.patch_places + 1) ** 2
    counts.clear()
    assert patches(wide, RADII_M, EVERY, lambda: True) == [] and not counts


def test_runs_that_nobody_saw_have_no_places(slick: DataSet) -> None:
    before = begun(slick)
    unseen = tuple(replace(trial, pose=np.full_like(trial.pose, np.nan)) for trial in before.view.trials)
    assert patches(replace(before, view=replace(before.view, trials=unseen)), RADII_M, EVERY) == []


def never() -> bool:
    return False
