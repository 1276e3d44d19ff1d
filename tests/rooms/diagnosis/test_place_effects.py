"""Effects at a place of the floor or at a time: planted ones are found where they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipmargin.data.record import Record
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.fit import Fit, build, few_steps, fit
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.ranges import ranges
from slipmargin.diagnosis.refits import fitted as fitted_state
from slipmargin.diagnosis.screen import Screened
from slipmargin.diagnosis.search import _added
from slipmargin.diagnosis.tangents import Columns
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Recipe, Trace
from slipmargin.effects.floor_border import FloorBorder
from slipmargin.effects.floor_patch import FloorPatch
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.push import Push
from slipmargin.io.robot_file import read_recipe, recipe_from_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.limits.motion_friction import friction_in_motion
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import sweep
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate

SIGMA = np.array([5e-4, 5e-4, 2e-3])


@pytest.fixture(scope="module")
def believed() -> Recipe:
    kiwi = read_recipe("ohio-kiwi")
    wheels = tuple(replace(w, rigid_fraction=0.0) for w in kiwi.robot.wheels)
    return Recipe(robot=replace(kiwi.robot, wheels=wheels))


def runs(real: Recipe, seed: int = 3) -> tuple[Record, ...]:
    """Six runs of 2.5 s: start, turn, stop, some with slip, logged at 100 Hz with noise."""
    random, model, made = np.random.default_rng(seed), real.build("paper"), []
    t = np.linspace(0.0, 2.5, 251)
    for number in range(6):
        speeds = random.uniform(-14.0, 14.0, (3, model.count))
        knots = np.array([0.0, 0.1, 0.8, 0.9, 1.6, 1.7, 2.2, 2.3, 2.5])
        still = np.zeros(model.count)
        rows = np.array([still, *np.repeat(speeds, 2, axis=0), still, still])
        omega = np.stack([np.interp(t, knots, row) for row in rows.T], axis=1)
        run = simulate(model, linear(t, omega), t)
        pose = run.pose + SIGMA * random.standard_normal((len(t), 3))
        made.append(Record(name=f"run{number}", t_s=t, pose=pose, omega=omega, theta=run.theta))
    return tuple(made)


def fitted(believed: Recipe, records: tuple[Record, ...], name: str) -> tuple[AnyEffect, float, float]:
    """The best of fits from the best starts of a candidate, piece by piece; chi before and after."""
    trials = tuple(clean(r, SIGMA) for r in records)
    problem = Problem.of(believed, "paper", trials, SIGMA, False).in_pieces(0.5)
    covered, everyone = ranges(trials), np.arange(len(trials))
    reach = covered.covered
    names = problem.model(()).geometry.names
    (candidate,) = [c for c in named_candidates(names, False, (), reach) if c.name == name]
    costs = [
        float(np.sum(r**2))
        for r in problem.residuals(
            [build((candidate,), s) for s in candidate.starts], [everyone] * len(candidate.starts)
        )
    ]
    starts = [candidate.starts[k] for k in np.argsort(costs)[:6]]
    steps = [few_steps(problem, (candidate,), s, everyone) for s in starts]  # some starts lead nowhere
    starts = [x for x, _ in sorted(steps, key=lambda end: end[1])[:3]]
    best = min((fit(problem, (candidate,), s, everyone) for s in starts), key=lambda f: f.cost)
    before = problem.residuals([()], [everyone])[0]
    samples = problem.samples(everyone)
    return (
        best.effects[0],
        float(np.sqrt(np.sum(before**2) / samples)),
        float(np.sqrt(best.cost / samples)),
    )


def test_a_slick_patch_is_found_where_it_is(believed: Recipe) -> None:
    patch = FloorPatch(factor=0.4, centre_x_m=0.12, centre_y_m=-0.08, radius_m=0.16)
    found, before, after = fitted(believed, runs(believed.with_effects(patch)), "floor_patch")
    assert isinstance(found, FloorPatch)
    assert before > 3.0 and after < 1.1
    np.testing.assert_allclose(found.values()[1:4], patch.values()[1:4], atol=0.01)
    assert found.factor == pytest.approx(0.4, abs=0.05)


def test_a_fit_begins_where_the_tangent_puts_a_patch_though_doing_nothing_costs_less(
    believed: Recipe,
) -> None:
    """Seen in a judged set: starts that change nothing kept the one beside the patch from being fitted."""
    patch = FloorPatch(factor=0.8, centre_x_m=0.12, centre_y_m=-0.08, radius_m=0.16)
    trials = tuple(clean(r, SIGMA) for r in runs(believed.with_effects(patch)))
    problem, everyone = Problem.of(believed, "paper", trials, SIGMA, False), list(range(len(trials)))
    names = problem.model(()).geometry.names
    reach = ranges(trials).covered
    (candidate,) = [c for c in named_candidates(names, False, (), reach) if c.name == "floor_patch"]
    beside = np.array([0.4, 0.15, -0.1, 0.2, 0.05])
    idle = [np.array([1.01, 0.9, 0.0, 0.2, 0.05]), np.array([1.01, -0.9, 0.0, 0.2, 0.05])]
    part = Columns(
        trace=candidate.trace,
        label=candidate.label,
        columns=np.zeros((0, 0, 0)),
        prior=np.zeros((0, 0)),
        low=np.zeros(0),
        high=np.zeros(0),
        candidate=candidate,
    )
    entry = Screened(parts=(part,), gain=1.0, step=np.zeros(0), starts=(beside, *idle))
    before = fitted_state(problem, (), np.zeros(0), np.arange(len(trials)), everyone)
    costs = [
        float(np.sum(problem.residuals([build((candidate,), x)], [before.fit.trials])[0] ** 2))
        for x in entry.starts
    ]
    assert costs[0] > max(costs[1:]), "what does nothing costs less than too much beside the place"
    found = _added(before, entry, everyone, np.inf, lambda: False)
    np.testing.assert_allclose(found.fit.x[1:3], patch.values()[1:3], atol=0.02)
    assert found.fit.cost < 0.01 * min(costs)


def test_where_the_floors_origin_is_changes_no_candidate(believed: Recipe) -> None:
    """Seen twenty metres off: no set could be diagnosed there, and a patch was named loads ten metres off."""
    near = runs(believed)[:2]
    shift = np.array([20.0, -31.0, 0.0])
    missed = []
    for records in (near, [replace(r, pose=r.pose + shift) for r in near]):
        trials = tuple(clean(r, SIGMA) for r in records)
        problem, covered = Problem.of(believed, "paper", trials, SIGMA, False), ranges(trials)
        model, everyone = problem.model(()), np.arange(len(trials))
        made = [
            *named_candidates(model.geometry.names, False, (), covered.covered),
            *general_candidates(model, covered, False),
        ]
        points = [
            (c.label, c.build(np.clip(start + 0.5 * c.scale * (np.arange(c.size) == 0), c.low, c.high)))
            for c in made
            for start in (c.starts if len(c.starts) else c.null[None])
        ]
        gaps = problem.residuals([(effect,) for _, effect in points], [everyone] * len(points))
        missed.append([(label, gap) for (label, _), gap in zip(points, gaps, strict=True)])
    assert len(missed[0]) == len(missed[1]) > 200
    for (label, here), (other, there) in zip(*missed, strict=True):
        assert label == other
        assert np.sqrt(np.mean((here - there) ** 2)) < 0.02, label  # of what noise is 1


def test_a_border_between_floors_is_found(believed: Recipe) -> None:
    border = FloorBorder(factor=0.5, offset_m=0.05, direction_rad=0.6)
    found, before, after = fitted(believed, runs(believed.with_effects(border)), "floor_border")
    assert isinstance(found, FloorBorder)
    assert before > 3.0 and after < 1.1
    assert found.values()[:3] == pytest.approx(border.values()[:3], abs=0.02)


def test_a_push_at_one_time_of_every_run_is_found(believed: Recipe) -> None:
    push = Push(force_x_N=3.0, force_y_N=-4.0, moment_N_m=0.1, time_s=1.23, duration_s=0.1)
    found, before, after = fitted(believed, runs(believed.with_effects(push)), "push")
    assert isinstance(found, Push)
    assert before > 1.5 and after < 1.1
    assert found.time_s == pytest.approx(1.23, abs=0.03)
    np.testing.assert_allclose(found.values()[:2], [3.0, -4.0], atol=0.5)


def test_a_patch_under_all_of_a_run_is_another_coefficient(believed: Recipe) -> None:
    """The kernel's distance from a place: a wide patch changes all wheels, one out of reach none."""
    wide = believed.with_effects(FloorPatch(factor=0.5, centre_x_m=0.3, centre_y_m=0.2, radius_m=9.0))
    far = believed.with_effects(FloorPatch(factor=0.5, centre_x_m=50.0, radius_m=9.0))
    half = believed.with_effects(FrictionCoefficients(drive_factor=0.5, transverse_factor=0.5))
    t = np.linspace(0.0, 1.0, 51)
    signal = linear(t, np.outer(np.minimum(t / 0.1, 1.0), [9.0, -4.0, 6.0]))
    poses = [simulate(r.build("paper"), signal, t).pose for r in (wide, half, far, believed)]
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-6)
    np.testing.assert_allclose(poses[2], poses[3], atol=1e-6)
    assert np.max(np.abs(poses[0] - poses[3])) > 1e-3


def test_one_wheel_on_a_patch_is_one_wheel_with_less_grip(believed: Recipe) -> None:
    """Each contact for itself, at any heading: a patch under the rear wheel alone, robot turned."""
    rear = believed.build("paper").geometry.position_m[2]
    patch = FloorPatch(factor=0.3, centre_x_m=float(rear[0]), centre_y_m=float(rear[1]), radius_m=0.05)
    one = FrictionCoefficients(drive_factor=0.3, transverse_factor=0.3, wheels=("rear",))
    t = np.linspace(0.0, 0.05, 11)
    signal = linear(t, np.outer(t / 0.05, [3.0, 3.0, 3.0]))
    poses = [simulate(believed.with_effects(e).build("paper"), signal, t).pose for e in (patch, one)]
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-7)


def test_limits_know_that_a_patch_may_be_anywhere_under_the_wheels(believed: Recipe) -> None:
    """Where the robot stands is not known to a sweep: nominal away from the patch, the band with it."""
    phi = np.linspace(0.0, 2.0 * np.pi, 25)
    plain = sweep(believed.build("paper"), phi, Pull())
    patched = believed.with_effects(FloorPatch(factor=0.5, centre_x_m=2.0, radius_m=0.3)).build("paper")
    found = sweep(patched, phi, Pull())
    np.testing.assert_allclose(found.f_max_N, plain.f_max_N, rtol=1e-12)
    np.testing.assert_allclose(found.f_low_N, 0.5 * plain.f_max_N, rtol=1e-9)
    border = believed.with_effects(FloorBorder(factor=0.5, offset_m=1.0)).build("paper")
    np.testing.assert_allclose(sweep(border, phi, Pull()).f_low_N, 0.5 * plain.f_max_N, rtol=1e-9)


def test_limits_in_motion_know_a_patch_where_the_robot_is(believed: Recipe) -> None:
    patched = believed.with_effects(FloorPatch(factor=0.5, centre_x_m=2.0, radius_m=0.5)).build("paper")
    there = Motion(
        velocity=np.array([[0.3, 0.0, 0.0]] * 2),
        heading=np.array([0.3, 0.3]),
        position=np.array([[2.0, 0.0], [0.0, 0.0]]),
    )
    on, off = friction_in_motion(patched, there).drive[0]
    np.testing.assert_allclose(on, 0.5 * off, rtol=1e-9)
    unknown = friction_in_motion(patched, Motion(velocity=np.array([[0.3, 0.0, 0.0]]))).drive[0, 0]
    np.testing.assert_allclose(unknown, on, rtol=1e-9)


def test_a_general_form_from_a_place_keeps_it_in_a_robot_file(believed: Recipe) -> None:
    term = Multiplier(
        variable=Variable.FROM_PLACE,
        basis=Basis.STEP,
        coefficients=np.array([-0.5]),
        shape=np.array([0.2, 0.01]),
        wheels=np.ones(3),
        place=np.array([0.3, -0.2, 0.0]),
    )
    effect = GeneralEffect(traced_to=Trace.POSITION, part=Part.GRIP, terms=(term,))
    (read,) = recipe_from_text(write_recipe(believed.with_effects(effect))).effects
    assert isinstance(read, GeneralEffect) and isinstance(read.terms[0], Multiplier)
    np.testing.assert_array_equal(read.terms[0].place, term.place)


def test_a_sharp_edge_is_ordinary_and_no_doubt_about_the_name() -> None:
    """Regression: a patch found to the millimetre lost its name, since its edge was as sharp as edges are."""
    (patch,) = (c for c in named_candidates(("1", "2", "3"), False, ()) if c.name == "floor_patch")
    x = patch.starts[0].copy()
    x[patch.keys.index("edge_m")] = patch.low[patch.keys.index("edge_m")]

    def stuck(at: np.ndarray) -> list[str]:
        found = Fit(
            structure=(patch,),
            x=at,
            trials=np.zeros(1, dtype=np.int64),
            residual=np.zeros((1, 3)),
            jacobian=np.zeros((1, 3, len(at))),
            evaluations=1,
        )
        return found.at_bound()

    assert stuck(x) == []
    x[patch.keys.index("factor")] = 0.0
    assert stuck(x) == ["floor_patch.factor"]
