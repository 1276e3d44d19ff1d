"""Fitting and cross-validation on a problem whose answer is known in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from slipmargin.checks import Array, Index
from slipmargin.diagnosis import search
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.evidence import Intervals, intervals
from slipmargin.diagnosis.findings import _against_name, _quantities
from slipmargin.diagnosis.fit import Fit, evaluate, few_steps, fit, shifted_by
from slipmargin.diagnosis.left_out import folds, leave_one_out, refitted_without
from slipmargin.diagnosis.near import Way
from slipmargin.diagnosis.rivals import instead_of, origin
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, choose
from slipmargin.diagnosis.tangents import free_slopes, score_test_gain
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import AnyEffect, Effect, Trace
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.camera_scale import CameraScale
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_ramp import FloorRamp
from slipmargin.effects.floor_tilt import FloorTilt

TRIALS, SAMPLES = 6, 30


class Line:
    """Residual y − (a u + b v²) per trial: the scale effect carries a, b; a rotation carries c sin u."""

    def __init__(self, truth: tuple[float, float], noise: float, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.u = random.uniform(-1.0, 1.0, (TRIALS, SAMPLES))
        self.v = random.uniform(-1.0, 1.0, (TRIALS, SAMPLES))
        self.y = truth[0] * self.u + truth[1] * self.v + noise * random.standard_normal(self.u.shape)

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        out = []
        for made, rows in zip(effects, trials, strict=True):
            model = np.zeros((len(rows), SAMPLES))
            for effect in made:
                if isinstance(effect, CameraScale):
                    model += (effect.scale_x - 1.0) * self.u[rows] + (effect.scale_y - 1.0) * self.v[rows]
                elif isinstance(effect, CameraRotation):
                    model += effect.rotation_rad * np.sin(3.0 * self.u[rows])
            out.append(self.y[rows] - model)
        return out

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        return self.residuals([way(1.0) for way in ways], [trials] * len(ways))

    def rough(self) -> Line:
        return self


def candidate(kind: type[Effect]) -> Candidate:
    from slipmargin.diagnosis.candidate import named_candidate

    return named_candidate(kind)


EVERY = np.arange(TRIALS)


@settings(deadline=None, max_examples=25)
@given(a=st.floats(-0.3, 0.3), b=st.floats(-0.3, 0.3))
def test_a_linear_fit_is_least_squares(a: float, b: float) -> None:
    problem = Line((a, b), 0.01, 3)
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    design = np.stack([problem.u.ravel(), problem.v.ravel()], axis=1)
    wanted = np.linalg.lstsq(design, problem.y.ravel(), rcond=None)[0]
    np.testing.assert_allclose(found.x - 1.0, wanted, atol=1e-6)


def test_an_effect_that_another_has_made_idle_may_end_anywhere() -> None:
    """A ramp beside a tilt of all the floor was flat, and as short as one may be: a tether was named."""
    ramp, tilt = candidate(FloorRamp), candidate(FloorTilt)
    x = np.concatenate([ramp.starts[0], tilt.starts[0]])
    x[ramp.keys.index("length_m")] = ramp.low[ramp.keys.index("length_m")]
    columns = np.zeros((TRIALS, SAMPLES, len(x)))
    columns[:, :, ramp.size :] = 1e4
    found = Fit(
        structure=(ramp, tilt),
        x=x,
        trials=EVERY,
        residual=np.ones((TRIALS, SAMPLES)),
        jacobian=columns,
        evaluations=0,
    )
    assert found.at_bound() == ["floor_ramp.length_m"] and not found.stuck
    columns[:, :, ramp.keys.index("slope_rad")] = 1e4
    assert replace(found, jacobian=columns).stuck


def test_bounds_hold_and_are_said() -> None:
    problem = Line((3.0, 0.1), 0.0, 1)  # scale_x ends at 2
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    assert found.x[0] == 2.0
    assert found.at_bound() == ["camera_scale.scale_x"]


class Valley(Line):
    """A narrow valley b = a² whose floor falls towards a = 0.4: a tangent holds for a short step only."""

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        out = []
        for made, rows in zip(effects, trials, strict=True):
            (effect,) = made
            assert isinstance(effect, CameraScale)
            a, b = effect.scale_x - 1.0, effect.scale_y - 1.0
            out.append(np.tile(self.at(a, b), (len(rows), 1)))
        return out

    def at(self, a: float, b: float) -> Array:
        return np.array([3e3 * (b - a * a), 1e2 * (a - 0.4)])


def test_a_fit_follows_a_narrow_valley_to_its_end() -> None:
    """A patch of floor was given up after twelve steps, most of them short: it had thirty to go."""
    found = fit(Valley((0.0, 0.0), 0.0, 0), (candidate(CameraScale),), np.array([0.6, 1.16]), EVERY)
    np.testing.assert_allclose(found.x - 1.0, [0.4, 0.16], atol=1e-3)


def test_what_is_out_of_reach_after_the_usual_steps_is_given_up() -> None:
    valley = Valley((0.0, 0.0), 0.0, 0)
    start, known = np.array([0.6, 1.16]), (candidate(CameraScale),)
    done = fit(valley, known, start, EVERY)
    assert fit(valley, known, start, EVERY, give_up_above=1.0).evaluations < 0.6 * done.evaluations


class Saturated(Valley):
    """Far from the truth little changes: first steps are too long, and those that are damped are short."""

    def at(self, a: float, b: float) -> Array:
        return 1e2 * np.tanh(6.0 * np.array([a - 0.4, b - 0.16]))


def test_a_step_that_is_cut_short_says_not_that_a_fit_is_out_of_reach() -> None:
    """A woven floor, the truth, was given up after three short steps; full ones led to the noise."""
    found = fit(
        Saturated((0.0, 0.0), 0.0, 0),
        (candidate(CameraScale),),
        np.array([0.7, 0.7]),
        EVERY,
        give_up_above=1.0,
    )
    np.testing.assert_allclose(found.x - 1.0, [0.4, 0.16], atol=1e-3)


class Bend(Line):
    """A line that bends a little with its first parameter; ``tangents`` counts how often they were taken."""

    tangents = 0

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        out = super().residuals(effects, trials)
        for residual, (effect,), rows in zip(out, effects, trials, strict=True):
            assert isinstance(effect, CameraScale)
            residual -= 0.3 * (effect.scale_x - 1.0) ** 2 * self.v[rows]
        return out

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        self.tangents += 1
        return super().near(effects, ways, trials)


def test_a_jacobian_that_foretells_a_step_is_carried_along_and_the_last_one_is_right() -> None:
    problem = Bend((0.3, 0.2), 0.02, 5)
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    assert problem.tangents == 2, "at the start, and where it ends"
    there = evaluate(problem, found.structure, found.x, EVERY)
    step = found.jacobian.reshape(-1, 2).T @ found.residual.ravel()
    assert np.abs(step).max() < 1e-2 * np.sqrt(found.cost) * np.linalg.norm(there.jacobian)
    np.testing.assert_allclose(found.jacobian, there.jacobian, atol=0.02)
    ends, cost = few_steps(problem, found.structure, np.array([1.0, 1.0]), EVERY)
    assert problem.tangents <= 5 and cost == pytest.approx(found.cost, rel=1e-4)
    np.testing.assert_allclose(ends, found.x, atol=1e-3)


def test_a_tangent_promises_what_a_linear_fit_gains() -> None:
    problem = Line((0.2, -0.1), 0.05, 7)
    base = evaluate(problem, (), np.zeros(0), EVERY)
    (slope,) = free_slopes(problem, base, [candidate(CameraScale)])
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    assert score_test_gain(base.residual, slope) == pytest.approx(base.cost - found.cost, rel=1e-6)


def test_a_tangent_beside_a_fit_is_what_the_fit_cannot_take_up() -> None:
    problem = Line((0.2, -0.1), 0.05, 7)
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    (slope,) = free_slopes(problem, found, [candidate(CameraRotation)])
    own = found.jacobian.reshape(-1, 2)
    assert np.abs(own.T @ slope.reshape(-1)).max() < 1e-9


def test_intervals_cover_the_truth_about_as_often_as_they_say() -> None:
    inside = 0
    for seed in range(60):
        problem = Line((0.2, -0.1), 0.05, 100 + seed)
        found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
        spread = intervals(found)
        inside += int(np.all((spread.low <= [1.2, 0.9]) & (spread.high >= [1.2, 0.9])))
    assert inside >= 50  # both of two parameters, at 95 % each: 54 of 60 on average


def test_an_effect_that_does_nothing_is_left_open_as_often_as_said() -> None:
    left_open = 0
    for seed in range(60):
        problem = Line((0.0, 0.0), 1.0, 500 + seed)
        found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
        spread = intervals(found)
        left_open += spread.may_do_nothing(found.structure[0], found.x, slice(0, 2))
    assert 50 <= left_open < 60  # at 95 %: 57 of 60 on average


def _known(covariance: Array, freedom: float = np.inf) -> Intervals:
    deviation = np.sqrt(np.diag(covariance))
    return Intervals(
        low=-deviation,
        high=deviation,
        deviation=deviation,
        quantile=1.0,
        covariance=covariance,
        freedom=freedom,
        excitation=deviation,
    )


def test_parameters_that_are_uncertain_one_by_one_may_be_certain_together() -> None:
    """Their sum is known to 0.01, their difference not at all: both intervals hold the null."""
    both = candidate(CameraScale)
    tied = _known(np.array([[1.0, -0.9999], [-0.9999, 1.0]]))
    assert not tied.may_do_nothing(both, both.null + 0.2, slice(0, 2))
    assert tied.may_do_nothing(both, both.null + np.array([0.2, -0.2]), slice(0, 2))


def test_a_place_does_not_carry_an_uncertain_force() -> None:
    """Where something drags is well known, how hard it drags is not: its place says nothing for it."""
    drag = candidate(DraggingPoint)
    assert drag.idle.tolist() == [False, True, True]
    x = np.array([2.0, 0.5, 0.5])
    assert _known(np.diag([4.0, 1e-6, 1e-6])).may_do_nothing(drag, x, slice(0, 3))
    assert not _known(np.diag([0.04, 1e-6, 1e-6])).may_do_nothing(drag, x, slice(0, 3))


def test_a_value_that_is_the_contrary_of_the_name_does_not_carry_it() -> None:
    """Rollers in grease dragged more the faster they slid, and it was called a drop of friction."""
    [both] = [
        c for c in named_candidates(("1", "2", "3"), False, ()) if c.label == "stribeck in both directions"
    ]
    x, half = np.array([1.001, 0.28, 1.27]), np.array([0.015, 0.15, 0.12])
    said = _against_name(both, x, x - half, x + half)
    assert said == ["stribeck in both directions.transverse_ratio is 1.27, and the name means less than 1"]
    assert not _against_name(both, 1.9 - x, 1.9 - x - half, 1.9 - x + half)


def test_a_name_needs_a_value_on_the_side_that_it_means() -> None:
    """A dragging castor was a drop of friction: to 0.83 … 1.06 along the wheels, 0.96 … 1.14 across."""
    [both] = [
        c for c in named_candidates(("1", "2", "3"), False, ()) if c.label == "stribeck in both directions"
    ]
    x, half = np.array([0.947, 0.4, 1.051]), np.array([0.113, 0.6, 0.092])
    said = _against_name(both, x, x - half, x + half)
    assert said == [
        f"stribeck in both directions.{key} may as well be 1, and the name means less than 1"
        for key in ("dynamic_ratio", "transverse_ratio")
    ]
    half[0] = 0.04
    assert not _against_name(both, x, x - half, x + half), "one of the two is enough"


def test_few_runs_that_disagree_leave_more_open() -> None:
    """Seven noises from nothing: enough where the noise is known, not where four runs scatter differently."""
    one = candidate(CameraScale)
    x = one.null + np.array([7.0, 0.0])
    assert not _known(np.eye(2)).may_do_nothing(one, x, slice(0, 2))
    assert _known(np.eye(2), 3.0).may_do_nothing(one, x, slice(0, 2))
    assert _known(np.eye(2), 1.0).may_do_nothing(one, 1e3 * x, slice(0, 2))  # two runs say nothing of two


def test_trials_that_disagree_widen_the_interval() -> None:
    """Each trial has its own slope, and the first outweighs the others, so that a jackknife is too sure."""
    inside = narrow = 0
    for seed in range(100):
        problem, random = Line((0.2, -0.1), 0.0, 300 + seed), np.random.default_rng(900 + seed)
        own, noise = random.normal(scale=0.02, size=(TRIALS, 1)), random.standard_normal(problem.u.shape)
        problem.u, problem.v = 500.0 * problem.u, 500.0 * problem.v
        problem.u[0] *= 8.0
        problem.y = (0.2 + own) * problem.u - 0.1 * problem.v + noise
        found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
        spread = intervals(found)
        inside += int(spread.low[0] <= 1.2 <= spread.high[0])
        narrow += int(spread.high[0] - spread.low[0] < 0.2)
    assert inside >= 95
    assert narrow >= 95  # and does not cover by saying nothing


def test_a_parameter_on_its_bound_leaves_the_shift_to_the_others() -> None:
    """The other log moves both slopes, but the second may not go on: the first takes what it can."""
    problem, other = Line((0.2, -0.1), 0.0, 5), Line((0.2, -0.1), 0.0, 5)
    other.y = other.y + 0.1 * other.v
    floor = replace(candidate(CameraScale), high=np.array([2.0, 0.9]))
    found = fit(problem, (floor,), np.array([1.0, 0.9]), EVERY)
    moved = shifted_by(other, found)
    assert moved[1] == pytest.approx(0.0, abs=1e-6)
    free = shifted_by(other, fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY))
    assert free[1] == pytest.approx(0.1, abs=1e-6)


def test_a_fit_whose_time_is_over_ends_with_the_step_it_made() -> None:
    problem, scale = Line((0.2, -0.1), 0.0, 5), (candidate(CameraScale),)
    whole, short = (
        fit(problem, scale, np.array([1.0, 1.0]), EVERY, expired=lambda over=over: over)
        for over in (False, True)
    )
    assert short.evaluations < whole.evaluations
    assert whole.cost <= short.cost < evaluate(problem, scale, np.array([1.0, 1.0]), EVERY).cost


def test_a_candidate_stands_for_a_variable() -> None:
    assert candidate(CameraScale).trace is Trace.MEASUREMENT
    assert candidate(CameraScale).size == 2


def test_an_idle_parameter_stands_where_a_fit_would_start() -> None:
    # With rigid material believed to be as slippery as the rollers, a step of the fraction alone says
    # nothing unless the coefficient already stands where it would matter.
    from slipmargin.diagnosis.candidate import named_candidates

    found = {c.label: c for c in named_candidates(("1", "2", "3"), False, ())}
    assert found["rigid_sector with its coefficient"].null.tolist() == [0.0, 0.5]
    assert found["stribeck"].null.tolist() == [1.0, 0.03]


def test_what_a_candidate_calls_nested_does_nothing_at_null() -> None:
    """Force histories of the null effect and of none agree; a law that takes another's place says so."""
    from planting import smooth_kiwi

    from slipmargin.diagnosis.candidate import named_candidates
    from slipmargin.effects.recipe import with_effects
    from slipmargin.robot import LoadRule
    from slipmargin.sim.signal import linear
    from slipmargin.sim.simulate import simulate

    smooth = smooth_kiwi()
    static = replace(smooth, robot=replace(smooth.robot, load_rule=LoadRule.STATIC))
    nominal = static.build("paper")
    signal = linear(np.array([0.0, 0.5]), np.array([[0.0, 0.0, 0.0], [4.0, -3.0, 2.0]]))
    t = np.linspace(0.0, 0.5, 6)
    plain = simulate(nominal, signal, t).pose
    for candidate in named_candidates(nominal.geometry.names, False, ()):
        if candidate.trace is Trace.MEASUREMENT:
            continue
        same = simulate(with_effects(nominal, (candidate.build(candidate.null),)), signal, t).pose
        assert np.allclose(same, plain, atol=1e-6) == candidate.nested, candidate.label


def test_a_belief_holds_still_what_no_trial_shows_and_nothing_else() -> None:
    problem = Line((0.2, 0.1), 0.01, 3)
    problem.v[:] = 0.0  # nothing depends on the second parameter
    problem.y -= 0.1 * problem.v
    plain = candidate(CameraScale)
    same = replace(plain, prior=np.array([[1.0, -1.0]]))  # believed: both are much the same
    start = np.array([1.0, 1.0])
    seen = fit(problem, (plain,), start, EVERY).x[0]
    held = fit(problem, (same,), start, EVERY)
    assert held.x[0] == pytest.approx(seen, abs=1e-3)
    assert held.x[1] == pytest.approx(held.x[0], abs=1e-3)
    np.testing.assert_allclose(leave_one_out(held)[:, 1], held.x[1], atol=0.02)


class Bent(Line):
    """The same line in the sine of the parameter: a tangent near the crest is far too long."""

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        sines = [
            tuple(replace(e, scale_x=1.0 + 0.4 * np.sin(8.0 * (e.scale_x - 1.0))) for e in made)
            for made in effects
        ]
        return super().residuals(sines, trials)


def test_a_fold_is_judged_by_what_was_fitted_to_the_others() -> None:
    problem = Line((0.2, -0.1), 0.05, 5)
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    parts = folds(range(TRIALS), 3)
    xs, squares = refitted_without(problem, found, parts)
    for x, part in zip(xs, parts, strict=True):
        alone = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), np.delete(EVERY, part))
        np.testing.assert_allclose(x, alone.x, atol=1e-5)
        out = problem.residuals([alone.effects], [part])[0]
        np.testing.assert_allclose(squares[part], np.sum(out**2, axis=1), rtol=1e-4)
    assert squares.sum() > found.cost  # unseen trials are predicted worse than seen ones


def test_a_refit_does_not_follow_a_tangent_that_is_too_long() -> None:
    problem = Bent((0.39, 0.0), 0.01, 2)
    found = evaluate(problem, (candidate(CameraScale),), np.array([1.19, 1.0]), EVERY)
    parts = folds(range(TRIALS), 3)
    for x, part in zip(refitted_without(problem, found, parts)[0], parts, strict=True):
        others = np.delete(EVERY, part)
        cost = [
            float(np.sum(problem.residuals([(found.structure[0].build(v),)], [others])[0] ** 2))
            for v in (found.x, x)
        ]
        assert cost[1] <= cost[0]


def leaving(found: Fit, scores: Array) -> Fit:
    """A fit as if it left these sums of squares in the runs."""
    ones = found.residual / np.linalg.norm(found.residual, axis=1, keepdims=True)
    return replace(found, residual=ones * np.sqrt(scores)[:, None])


def state(structure: tuple[Candidate, ...], chi: float) -> State:
    """Candidates at their null, as if they left this chi."""
    problem = Line((0.2, 0.0), 0.01, 3)
    found = evaluate(problem, structure, np.concatenate([np.zeros(0), *(c.null for c in structure)]), EVERY)
    scores = np.full(TRIALS, chi**2 * SAMPLES)
    return State(
        fit=leaving(found, scores),
        scores=scores,
        samples=float(TRIALS * SAMPLES),
        view=problem,
        parts=(),
        xs=np.zeros((0, len(found.x))),
    )


def test_of_equal_explanations_the_named_and_simple_one_is_chosen() -> None:
    one, other = candidate(CameraRotation), candidate(CameraScale)
    unnamed = replace(one, name="unnamed_measurement", named=False)
    assert choose([state((one, other), 1.00), state((one,), 1.01)]).structure == (one,)
    assert choose([state((unnamed,), 1.00), state((one,), 1.01)]).structure == (one,)
    assert choose([state((unnamed,), 1.00), state((one, other), 1.00)]).structure == (one, other)
    assert choose([state((unnamed,), 1.00), state((one,), 1.20)]).structure == (unnamed,)


def test_a_name_stuck_at_a_bound_is_no_name() -> None:
    """A constant twist was called a resistance whose share of yaw stood at its most, so unnamed_velocity."""
    scale = candidate(CameraScale)
    form = replace(candidate(CameraRotation), name="unnamed_constant_force", named=False)
    stuck = state((scale,), 1.00)
    stuck = replace(stuck, fit=replace(stuck.fit, x=np.array([2.0, 1.0])))
    assert stuck.fit.at_bound() and choose([stuck, state((form,), 1.01)]).structure == (form,)
    assert choose([state((scale,), 1.00), state((form,), 1.01)]).structure == (scale,)
    assert choose([stuck, state((form,), 1.20)]).structure == (scale,), "where no form is as good"


def test_of_two_names_that_the_runs_do_not_tell_apart_the_one_with_fewer_parameters_is_meant() -> None:
    problem = Line((0.2, 0.0), 0.01, 3)

    def state(one: Candidate, scores: Array) -> State:
        found = evaluate(problem, (one,), one.null, EVERY)
        return State(
            fit=leaving(found, scores),
            scores=scores,
            samples=540.0,
            view=problem,
            parts=(),
            xs=np.zeros((0, len(one.null))),
        )

    rotation, scale = candidate(CameraRotation), candidate(CameraScale)
    best = state(scale, np.full(TRIALS, 90.0))
    now_and_then = np.array([1.5, -1.0, 1.0, -1.0, 1.0, -1.0])
    level = state(rotation, best.scores + now_and_then)
    assert level.chi > best.chi and choose([best, level]).structure == (rotation,)
    always = state(rotation, best.scores + 2.0)
    assert choose([best, always]).structure == (scale,)
    # Less in all runs than ln(540) = 6.3 of noise, the worth of one parameter, is no reason for it.
    by_number = state(rotation, best.scores + 0.9)
    assert choose([best, by_number]).structure == (rotation,)
    # What is no better than the shorter form of a law need not be as good as its longer one.
    longer = replace(candidate(DraggingPoint), name=scale.name)
    longest, short = state(longer, best.scores), state(scale, best.scores + 2.0)
    shortest = state(rotation, best.scores + 2.9)
    assert choose([longest, shortest]).structure == (longer,)
    assert choose([longest, short, shortest]).structure == (rotation,)


def test_a_run_left_out_says_nothing_against_what_fits_as_well_with_fewer_parameters() -> None:
    """Friction factors lost to a slip speed at the edge of its range: one run alone told what they are."""
    rotation, scale = candidate(CameraRotation), candidate(CameraScale)
    best = state((scale,), 0.95)
    fewer = replace(state((rotation,), 1.14), fit=leaving(state((rotation,), 1.0).fit, best.scores + 0.8))
    assert not fewer.chi <= SETTINGS.as_good_factor * best.chi
    assert choose([best, fewer]).structure == (rotation,)
    more_left = replace(fewer, fit=leaving(fewer.fit, best.scores + 2.0))
    assert choose([best, more_left]).structure == (scale,)
    far = [replace(s, scores=4.0 * s.scores) for s in (best, fewer)]
    assert choose(far).structure == (scale,), "far above the noise a fit says less than a run left out"


def test_one_run_that_nothing_predicts_does_not_speak_alone_against_fewer_parameters() -> None:
    """Friction that falls by 0.3 % with slip speed was called a form with ten parameters, and no other named.

    The name got five of six runs left out better, and the sixth, of which the others say too little, twenty
    times as wrong; both left little more than noise in the runs they were fitted to.
    """
    rotation, scale = candidate(CameraRotation), candidate(CameraScale)
    best = state((scale,), 1.35)
    best = replace(best, fit=leaving(best.fit, np.full(TRIALS, 1.10 * SAMPLES)))
    mostly = np.where(np.arange(TRIALS) == TRIALS - 1, 20.0, 0.9) * best.scores
    fewer = replace(state((rotation,), 1.0), scores=mostly)
    fewer = replace(fewer, fit=leaving(fewer.fit, np.full(TRIALS, 1.24 * SAMPLES)))
    assert choose([best, fewer]).structure == (rotation,)
    rarely = np.where(np.arange(TRIALS) < TRIALS / 2, 20.0, 0.9) * best.scores
    assert choose([best, replace(fewer, scores=rarely)]).structure == (scale,)
    leaves_more = replace(fewer, fit=leaving(fewer.fit, np.full(TRIALS, 2.0 * SAMPLES)))
    assert choose([best, leaves_more]).structure == (scale,)


def test_a_name_that_alone_leaves_nothing_but_noise_is_as_good_where_it_is_worth_adding() -> None:
    """A sticking roller that one run shows was called a patch of the floor, which left more there."""
    rotation, scale = candidate(CameraRotation), candidate(CameraScale)
    best = state((scale,), 1.8)
    alone = replace(state((rotation,), 2.6), fit=leaving(best.fit, state((rotation,), 1.0).scores))
    alone = replace(alone, fit=replace(alone.fit, structure=(rotation,), x=rotation.null))
    before = state((), 5.0)
    assert choose([best, alone]).structure == (scale,)
    assert choose([best, alone], before).structure == (rotation,)
    assert choose([best, replace(alone, scores=before.scores)], before).structure == (scale,)
    leaves = replace(alone, fit=leaving(alone.fit, state((rotation,), 1.5).scores))
    assert choose([best, leaves], before).structure == (scale,)


def test_of_two_names_that_one_run_does_not_tell_apart_the_more_usual_one_is_meant() -> None:
    names = [effect.name for effect in CATALOGUE]
    pair = sorted((candidate(CameraRotation), candidate(CameraDelay)), key=lambda c: names.index(c.name))
    level = [
        replace(state((one,), 1.0), scores=np.array([left]), samples=1000.0)
        for one, left in zip(pair, (1000.001, 1000.0), strict=True)
    ]
    assert choose(level[::-1]).structure == (pair[0],)


def test_another_log_that_the_runs_refute_does_not_widen_an_interval() -> None:
    """What the parameters move by counts by how probable the runs make the other log."""
    from slipmargin.diagnosis.findings import moved_by

    problem, level, wrong = (Line((0.2, -0.1), 0.0, 5) for _ in range(3))
    random = np.random.default_rng(4)
    problem.y = problem.y + random.standard_normal(problem.y.shape)
    level.y = problem.y + 0.1 * level.v
    wrong.y = problem.y + 0.1 * level.v + 2.0 * np.sin(9.0 * level.u)
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    either = moved_by(level, found)
    assert 0.05 < either[1] <= 0.1 + 1e-6
    assert np.abs(moved_by(wrong, found)).max() < 1e-6


@pytest.mark.parametrize(("piece", "taken"), [(15, True), (None, False)])
def test_far_above_the_noise_a_name_is_taken_where_no_form_may_be(
    monkeypatch: pytest.MonkeyPatch, piece: int | None, taken: bool
) -> None:
    one, other = candidate(CameraRotation), candidate(CameraScale)
    unnamed = replace(other, name="unnamed_measurement", label="unnamed", named=False)
    view = SimpleNamespace(piece=piece)
    before = replace(state((one,), 3.0), view=view)  # type: ignore[arg-type]
    found = {"form": state((one, unnamed), 2.0), "name": state((one, other), 2.5)}
    entry = Screened(parts=(), gain=0.9 * before.fit.cost, step=np.zeros(0))
    listed = Screening(entries=(entry,), total=before.fit.cost, chance=np.zeros(199))
    monkeypatch.setattr(search, "screened", lambda *_: listed)
    monkeypatch.setattr(
        search, "finalists", lambda *_: [SimpleNamespace(label=word, structure=(other,)) for word in found]
    )
    monkeypatch.setattr(search, "_added", lambda _, entry, *__: found[entry.label])
    step = search.take_step(before, range(TRIALS), [], 0, Watch(report=lambda *_: None))
    assert step.taken is taken and step.best is found["name" if taken else "form"]


def test_candidates_of_one_name_are_stuck_each_for_itself() -> None:
    """A wheel at the edge of its range took the name from another that was not."""
    both = tuple(c for c in named_candidates(("1", "2", "3"), False, ()) if c.name == "wheel_radius")[:2]
    assert [c.label for c in both] == ["wheel_radius[1]", "wheel_radius[2]"]
    x = np.concatenate([both[0].high, 0.5 * (both[1].null + both[1].high)])
    nothing = np.zeros((TRIALS, SAMPLES))
    found = Fit(
        structure=both,
        x=x,
        trials=EVERY,
        residual=nothing,
        jacobian=np.zeros((*nothing.shape, len(x))),
        evaluations=0,
    )
    assert found.at_bound() == [f"wheel_radius[1].{key}" for key in both[0].keys]


def test_what_no_trial_shows_is_not_sure() -> None:
    """Its interval was a single number: the inverse of nothing was taken for nothing."""
    problem = Line((0.2, 0.0), 0.05, 3)
    problem.v[:] = 0.0
    found = fit(problem, (candidate(CameraScale),), np.array([1.0, 1.0]), EVERY)
    spread = intervals(found)
    assert spread.high[0] - spread.low[0] < 1.0 and spread.high[1] - spread.low[1] > 100.0


@given(low=st.floats(0.9, 0.99))
@settings(deadline=None, max_examples=10)
def test_a_fold_keeps_to_a_bound_as_a_fit_does(low: float) -> None:
    """Two slopes that hang together, one on its bound: the step of both, clipped, goes uphill."""
    problem = Line((0.2, -0.3), 0.0, 5)
    problem.u, problem.v = 50.0 * problem.u, 45.0 * problem.u + 5.0 * problem.v
    noise = np.random.default_rng(1).normal(size=problem.u.shape)
    problem.y = 0.2 * problem.u - 0.3 * problem.v + noise
    own = replace(candidate(CameraScale), low=np.array([0.5, low]))
    found = fit(problem, (own,), np.array([1.0, 1.0]), EVERY)
    assert found.x[1] == low
    parts = folds(range(TRIALS), 3)
    for x, part in zip(refitted_without(problem, found, parts)[0], parts, strict=True):
        alone = fit(problem, (own,), np.array([1.0, 1.0]), np.delete(EVERY, part))
        np.testing.assert_allclose(x, alone.x, atol=1e-4)
    for trial, x in enumerate(leave_one_out(found)):
        alone = fit(problem, (own,), np.array([1.0, 1.0]), np.delete(EVERY, trial))
        np.testing.assert_allclose(x, alone.x, atol=1e-4)


def test_what_follows_from_parameters_is_as_sure_as_they_are_together() -> None:
    """Of two that vary against each other the sum is known; no end lies beyond the ends of all of them."""
    own = candidate(FloorGrain)
    x = np.array([0.3, 0.4])
    none = np.zeros((0, 0))
    final = Fit(
        structure=(own,),
        x=x,
        trials=np.zeros(0, dtype=np.int64),
        residual=none,
        jacobian=none[..., None],
        evaluations=0,
    )
    stand_in = SimpleNamespace(model=lambda *_: None)
    across = 0.05 * np.array([0.8, -0.6])  # of the same amplitude, to first order
    spread = replace(_known(np.outer(across, across)), low=x - 0.1, high=x + 0.1)
    amplitude = _quantities(stand_in, final, spread, 0)[0]
    assert amplitude.value == pytest.approx(0.5) and amplitude.high - amplitude.low < 1e-4
    spread = replace(_known(np.diag([0.01, 0.01])), low=x, high=x + 0.1)
    amplitude = _quantities(stand_in, final, spread, 0)[0]
    assert amplitude.low == pytest.approx(0.5) and 0.59 < amplitude.high < 0.65


def test_the_evidence_of_an_effect_is_that_of_its_own_state() -> None:
    """Where what a round took fails on unseen runs, another was told with the p-value of the first."""
    names = {c.label: c for c in named_candidates(("1",), False, ())}
    first, second = names["camera_scale"], names["camera_rotation"]
    taken, other = state((first,), 1.1), state((second,), 3.0)
    screening = Screening(entries=(), total=1.0, chance=np.linspace(0.0, 0.99, 99))
    step = Round(before=state((), 4.0), screening=screening, tried=(taken, other), best=taken, taken=True)
    assert origin(first, (first,), [step]) == (step, taken)
    assert origin(second, (second,), [step]) == (step, other)
    assert step.p_value_of(other) > 5.0 * step.p_value_of(taken)
    assert [r.new for r in instead_of(other, 0, [step])] == [(first,)]


def test_of_names_that_the_runs_left_out_do_not_tell_apart_the_one_that_leaves_noise_is_meant() -> None:
    """One run alone shows a ridge: predicted from the others it is off by as much as beside a wrong name."""
    one, other = (
        state((candidate(kind),), chi) for kind, chi in ((CameraScale, 2.81), (CameraRotation, 2.8))
    )
    noise = np.full(TRIALS, 0.9 * SAMPLES)
    one = replace(one, fit=leaving(one.fit, noise))
    other = replace(other, fit=leaving(other.fit, np.where(np.arange(TRIALS) == 1, 30.0, 1.0) * noise))
    assert one.fit.cost < one.samples < other.fit.cost / SETTINGS.noise_chi**2
    assert choose([other, one]) is one
