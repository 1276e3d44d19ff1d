"""What a run tells, and the choice by it: a wheel's radius against its toe, after runs straight ahead."""

from __future__ import annotations

import numpy as np
import pytest
from next_run import CASES, LENGTH_S, data_set, logged, standard_runs

from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.fit import fit
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.watch import Watch
from slipmargin.errors import InputError
from slipmargin.experiment.choose import greedy, pairs
from slipmargin.experiment.gain import evaluated, known, problem_of_drives
from slipmargin.experiment.motions import Motion
from slipmargin.experiment.next_runs import Request, proposed
from slipmargin.experiment.remaining import Question, Remaining
from slipmargin.experiment.result import NextRuns
from slipmargin.experiment.timing import Drive
from slipmargin.paths.trajectory import Trajectory

#: A few motions are enough here.
KINDS = ("spin", "line-y", "turning-line-y", "quarter-turns")
CASE = next(c for c in CASES if c.name == "radius")


def quiet(stage: str, share: float) -> None:
    """Progress that is not shown."""


def left_by(names: tuple[str, ...], question: Question) -> Remaining:
    """Four standard runs and some explanations fitted to them, as a diagnosis would leave them."""
    runs = logged(CASE, standard_runs(CASE, range(0, 8, 2)), 3)
    given = data_set(runs)
    problem = problem_of(given).with_rough()
    every = named_candidates(problem.nominal.geometry.names, False, ())
    structures = [tuple(c for c in every if c.label == name) for name in names]
    everyone = np.arange(len(runs), dtype=np.int64)
    starts = [np.concatenate([np.zeros(0), *(c.starts[0] for c in s)]) for s in structures]
    return Remaining(
        problem=problem,
        fits=tuple(fit(problem, s, x, everyone) for s, x in zip(structures, starts, strict=True)),
        question=question,
        verdict=Verdict.EFFECT_FOUND,
        candidates=tuple(every),
        data_set=given,
    )


@pytest.fixture(scope="module")
def two() -> Remaining:
    return left_by(("wheel_radius[1]", "wheel_toe[1]"), Question.WHICH)


@pytest.fixture(scope="module")
def found(two: Remaining) -> NextRuns:
    return proposed(two, ask(2), Watch(report=quiet), KINDS)


def ask(runs: int) -> Request:
    return Request(runs=runs, size_m=(1.2, 1.0), longest_s=LENGTH_S)


def standard_drive(k: int) -> Drive:
    """A standard run as if it were proposed."""
    run = standard_runs(CASE, range(k, k + 1))[0]
    zero = np.zeros((len(run.t_s), 3))
    rows = Trajectory(
        t_s=run.t_s,
        pose=zero,
        velocity=zero,
        acceleration=zero,
        omega=run.omega,
        use=np.zeros_like(run.omega),
        wheels=("1", "2", "3"),
    )
    return Drive(
        motion=Motion(kind="standard", words="", legs=(zero[:2],)), pace="", repeats=1, trajectory=rows
    )


def test_standard_runs_do_not_tell_them_apart_and_proposed_ones_do(two: Remaining, found: NextRuns) -> None:
    """One more run straight ahead adds next to nothing; the proposed ones a thousand noises and more."""
    one, other = (f.cost for f in two.fits)
    assert abs(one - other) < 25.0
    more = problem_of_drives(two.problem, [standard_drive(k) for k in range(1, 4)], 0)
    for pair in pairs(two, evaluated(more, two.fits)):
        assert pair.contrast.gain(range(3)) < 25.0
    assert found.weakest is not None and found.weakest.expected > 1e4
    assert {r.trajectory.t_s[-1] <= LENGTH_S for r in found.runs} == {True}


def test_linear_steps_agree_with_a_fit_by_simulation(found: NextRuns) -> None:
    """The effects are small, so what a rival can take up is nearly linear."""
    assert len(found.separations) == 2
    for one in found.separations:
        assert one.simulated
        assert one.expected == pytest.approx(one.today + one.by_run[-1], rel=0.3)
        assert one.by_run[0] <= one.by_run[1]


def test_runs_stay_inside_and_keep_the_margin(found: NextRuns) -> None:
    assert found.space is not None and len({r.words for r in found.runs}) == 2
    for run in found.runs:
        assert float(np.max(run.trajectory.use)) <= found.share
        for pose in (run.trajectory.pose, *run.predicted):
            assert found.space.excess_m(pose, found.reach_m) == 0.0


def test_one_explanation_has_its_widest_interval_narrowed() -> None:
    left = left_by(("wheel_radius[1]",), Question.HOW_MUCH)
    narrower = proposed(left, ask(1), Watch(report=quiet), KINDS)
    (one,) = narrower.narrowings
    assert not narrower.separations and one.parameter == "wheel_radius.radius_factor"
    assert one.expected < one.today < 1e-3


def test_a_model_that_cannot_drive_at_all_is_said_so() -> None:
    """A tilt fitted to what a wheel's radius does is steeper than the grip holds."""
    left = left_by(("floor_tilt",), Question.HOW_MUCH)
    with pytest.raises(InputError, match=r"space: is too small: in it no motion of the list keeps"):
        proposed(left, ask(1), Watch(report=quiet), KINDS)


def test_where_nothing_is_missing_runs_show_what_could_hide() -> None:
    """Straight runs cannot see where the camera's marker sits: a run that turns can."""
    left = left_by(("none",), Question.ANYTHING)
    assert left.fits[0].structure == ()
    shown = {n.parameter: n for n in proposed(left, ask(1), Watch(report=quiet), KINDS).narrowings}
    marker = shown["marker_offset.marker_x_m"]
    assert marker.today > 0.1 and marker.expected < 0.01


def test_information_is_that_of_the_runs(two: Remaining) -> None:
    """Twice the noise is a quarter of the information."""
    once, twice = known(two.fits[0], 1.0), known(two.fits[0], 2.0)
    assert np.allclose(once, 4.0 * twice)


def test_the_choice_takes_other_kinds_first() -> None:
    able = [standard_drive(0)] * 2
    other = Drive(
        motion=Motion(kind="other", words="", legs=()), pace="", repeats=1, trajectory=able[0].trajectory
    )
    worth = (3.0, 2.0, 1.0)
    assert greedy(3, [*able, other], lambda runs: (sum(worth[k] for k in runs),)) == [0, 2, 1]
    assert greedy(5, [other], lambda runs: (0.0,)) == [0]
