"""The chance of slip, sampled in closed form, is that of limits with each draw's numbers."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest
from strategies import PAPER, four_wheels, kiwi

import slipmargin as sm
from slipmargin.effects import Recipe
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.errors import InputError
from slipmargin.limits import rows, sweep, uncertainty
from slipmargin.limits.bounds import directions
from slipmargin.limits.motion import needed_share
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.uncertainty import Draws, counted, draws, lowest_pulls
from slipmargin.limits.uncertainty_motion import DIRECTIONS, lowest_starts, needed_shares
from slipmargin.limits.wrench_set import box_normals
from slipmargin.model import nominal_model
from slipmargin.robot import (
    Body,
    Coefficients,
    GripShape,
    LoadRule,
    Robot,
    Surface,
    Uncertain,
    UncertainArray,
)
from slipmargin.robot.uncertain import read
from slipmargin.robot.warnings import cut_off

PHI = np.deg2rad(np.arange(0.0, 360.0, 5.0))
ROLLER = Coefficients(drive=Uncertain((0.26, 0.26), 0.02), transverse=Uncertain((0.06, 0.12)))
FLOOR = Surface(name="paper", roller=ROLLER, rigid=PAPER.rigid)
#: A body of which nothing is known exactly.
UNSURE = Body(
    mass_kg=Uncertain((12.0, 12.0), 0.5),
    inertia_kg_m2=Uncertain((0.3, 0.5)),
    com_m=UncertainArray((Uncertain((-0.01, 0.02)), Uncertain((0.0, 0.0), 0.005, (-1.0, 1.0)))),
    com_height_m=Uncertain((0.02, 0.05)),
)


def on(robot: Robot, floor: Surface = FLOOR) -> Robot:
    return replace(robot, surfaces=(floor,))


def unsure(robot: Robot, shape: GripShape = GripShape.BOX, rule: LoadRule = LoadRule.QUASI_STATIC) -> Robot:
    return on(replace(robot, body=UNSURE, load_rule=rule, friction=replace(robot.friction, grip=shape)))


def drawn_from(robot: Robot, count: int = 400, seed: int = 3) -> Draws:
    return draws(robot, nominal_model(robot, "paper"), count, seed)


@pytest.mark.parametrize("shape", tuple(GripShape))
@pytest.mark.parametrize("robot", [kiwi(15.0), four_wheels()], ids=["kiwi", "mecanum"])
def test_each_draw_is_its_own_sweep(robot: Robot, shape: GripShape) -> None:
    robot = unsure(robot, shape)
    model, drawn = nominal_model(robot, "paper"), drawn_from(robot)
    fast = lowest_pulls(model, PHI, drawn)
    for d in range(4):
        slow = float(np.min(sweep(drawn.model(model, d), PHI).f_low_N))
        if shape is GripShape.BOX:
            assert fast[d] == pytest.approx(slow, rel=1e-9)
        else:  # too large by what its finitely many normals leave out
            assert slow * (1.0 - 1e-6) <= fast[d] <= slow * 1.01


@pytest.mark.parametrize("rule", [LoadRule.EQUAL, LoadRule.STATIC, LoadRule.QUASI_STATIC])
def test_a_draw_is_the_robot_that_its_numbers_describe(rule: LoadRule) -> None:
    robot = unsure(four_wheels(), rule=rule)
    model, drawn = nominal_model(robot, "paper"), drawn_from(robot)
    for d in range(3):
        made = drawn.model(model, d)
        body = Body(
            mass_kg=float(robot.body.mass_kg * drawn.mass[d]),
            inertia_kg_m2=float(robot.body.inertia_kg_m2 * drawn.inertia[d]),
            com_m=np.asarray(robot.body.com_m) + drawn.com_shift_m[d],
            com_height_m=0.0,
        )
        plain = nominal_model(replace(robot, body=body), "paper")
        np.testing.assert_allclose(made.loads.rest_N, plain.loads.rest_N, rtol=1e-12)
        np.testing.assert_allclose(made.wrench_maps()[0], plain.wrench_maps()[0], atol=1e-12)
    # The height is drawn with the rest: P = −m h S, so P over m lies between the ends of the height.
    ratio = drawn.per_acceleration_kg[:, 0, 1] / (
        drawn.mass * nominal_model(unsure(four_wheels()), "paper").loads.per_acceleration_kg[0, 1]
    )
    middle = float(UNSURE.com_height_m)
    if rule is LoadRule.QUASI_STATIC:
        assert 0.02 / middle <= ratio.min() < 0.65 and 1.35 < ratio.max() <= 0.05 / middle
    else:
        assert not np.any(ratio)


@pytest.mark.parametrize("contact", [Contact.ROLLERS, Contact.UNKNOWN])
@pytest.mark.parametrize("shape", tuple(GripShape))
@pytest.mark.parametrize("robot", [kiwi(15.0), four_wheels()], ids=["kiwi", "mecanum"])
def test_each_draw_is_its_own_start_and_its_own_motion(
    robot: Robot, shape: GripShape, contact: Contact
) -> None:
    robot = unsure(robot, shape)
    model, drawn = nominal_model(robot, "paper"), drawn_from(robot, 200)
    fast = lowest_starts(model, drawn, contact)
    rng = np.random.default_rng(0)
    motion = Motion(velocity=rng.normal(size=(40, 3)), acceleration=0.5 * rng.normal(size=(40, 3)))
    need = needed_shares(model, drawn, motion, contact)
    heading = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    for d in range(4):
        own = drawn.model(model, d)
        slow = np.min(directions(own, heading, contact=contact, motor=False).starting_m_s2)
        assert fast[d] == pytest.approx(max(0.0, slow), rel=1e-9, abs=1e-12)
        assert need[d] == pytest.approx(np.max(needed_share(own, motion, contact=contact)), rel=1e-9)


def test_a_draw_that_lifts_a_wheel_counts_as_slipping() -> None:
    tall = replace(UNSURE, com_height_m=Uncertain((2.0, 2.5)))
    robot = replace(unsure(four_wheels()), body=tall)
    model, drawn = nominal_model(robot, "paper"), drawn_from(robot, 20)
    heading = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    for d in range(4):
        slow = directions(drawn.model(model, d), heading, motor=False).starting
        assert "tips" in slow.cause
        assert lowest_starts(model, drawn)[d] == pytest.approx(np.min(slow.value), rel=1e-9)
    hard = Motion(velocity=np.array([[0.1, 0.0, 0.0]]), acceleration=np.array([[5.0, 0.0, 0.0]]))
    assert np.all(np.isinf(needed_shares(model, drawn, hard)))


def test_the_load_band_counts_in_the_chance() -> None:
    robot = replace(unsure(four_wheels()), suspension_N_per_mm=20.0, unevenness_mm=0.5)
    model, drawn = nominal_model(robot, "paper"), drawn_from(robot, 50)
    level = nominal_model(unsure(four_wheels()), "paper")
    assert np.all(lowest_starts(model, drawn) < lowest_starts(level, drawn))
    assert np.all(lowest_pulls(model, PHI, drawn) < lowest_pulls(level, PHI, drawn))
    for d in range(3):
        own = drawn.model(model, d)
        assert lowest_pulls(model, PHI, drawn)[d] == pytest.approx(np.min(sweep(own, PHI).f_low_N), rel=1e-9)


def test_fractions_are_drawn_and_add_up() -> None:
    robot = replace(
        on(kiwi(30.0)),
        load_rule=LoadRule.FIXED,
        load_fractions=UncertainArray((Uncertain((0.3, 0.3), 0.02), Uncertain((0.3, 0.4)), 0.35)),
    )
    drawn = drawn_from(robot)
    share = drawn.rest_N / (robot.body.mass_kg * 9.81)
    np.testing.assert_allclose(share.sum(axis=1), 1.0, rtol=1e-12)
    assert np.ptp(share[:, 0]) > 0.05


def test_draws_with_a_slope_are_their_own_sweeps() -> None:
    robot = on(kiwi(30.0))
    tilt = FloorTilt.of(np.array([0.02, 0.01]))
    model = Recipe(robot=robot, effects=(tilt,)).build("paper")
    drawn = draws(robot, model, 3, 5)
    fast = lowest_pulls(model, PHI, drawn)
    for d in range(3):
        assert fast[d] == pytest.approx(np.min(sweep(drawn.model(model, d), PHI).f_low_N), rel=1e-9)
    fast = lowest_starts(model, drawn)
    heading = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    for d in range(3):
        slow = np.min(directions(drawn.model(model, d), heading, motor=False).starting_m_s2)
        assert fast[d] == pytest.approx(slow, rel=1e-9)


def test_draws_about_other_centres_share_their_facets(monkeypatch: pytest.MonkeyPatch) -> None:
    """The facets were made anew for each of ten thousand draws: minutes with twenty-four wheels."""
    robot = on(replace(kiwi(30.0), body=replace(UNSURE, mass_kg=12.0), load_rule=LoadRule.QUASI_STATIC))
    model = Recipe(robot=robot, effects=(FloorTilt.of(np.array([0.02, 0.01])),)).build("paper")
    drawn, made = draws(robot, model, 3, 5), []
    assert np.all(np.ptp(drawn.com_shift_m, axis=0) > 1e-3)
    slow = [np.min(sweep(drawn.model(model, d), PHI).f_low_N) for d in range(3)]
    monkeypatch.setattr(uncertainty, "box_normals", lambda maps: made.append(maps) or box_normals(maps))
    monkeypatch.setattr(rows, "box_normals", None)
    np.testing.assert_allclose(lowest_pulls(model, PHI, drawn), slow, rtol=1e-9)
    assert len(made) == 1


def test_one_spread_is_the_normal_distribution() -> None:
    # Without transverse friction the limit is proportional to the drive coefficient, so at a margin m the
    # chance is Φ(−m μ / sd).
    floor = Surface(
        name="paper",
        roller=Coefficients(drive=Uncertain((0.3, 0.3), 0.03), transverse=0.0),
        rigid=PAPER.rigid,
    )
    robot = replace(
        on(kiwi(30.0), floor), wheels=tuple(replace(w, rigid_fraction=0.0) for w in kiwi(30.0).wheels)
    )
    pull = sm.sweep(robot, "paper", to_deg=120.0, chance=0.05)
    start = sm.bounds(robot, "paper", step_deg=5.0, chance=0.05)
    wanted = NormalDist().cdf(-1.0)
    for found, recommended in ((pull, pull.recommended_N), (start, start.recommended_m_s2)):
        likely = found.slip_chance
        assert likely is not None
        assert likely.at_recommended == pytest.approx(wanted, abs=4.0 * np.sqrt(wanted / 10_000))
        assert likely.value == pytest.approx(
            recommended / 0.9 * (1.0 + 0.1 * NormalDist().inv_cdf(0.05)), rel=0.01
        )
    assert pull.lines()[:4] == sm.sweep(robot, "paper", to_deg=120.0).lines()[:4]
    assert "of 10000 draws of the uncertain numbers slip at" in pull.lines()[5]
    assert any("of 10000 draws of the uncertain numbers slip at" in line for line in start.lines())
    assert pull.to_dict()["slip_chance"]["force_N"] == pull.slip_chance.value  # type: ignore[union-attr]
    assert start.to_dict()["slip_chance"]["chance"] == 0.05
    assert json.loads(start.export_text("json"))["slip_chance"]["chance"] == 0.05


def test_a_plan_says_its_chance_and_the_margin_for_another() -> None:
    robot, way = unsure(four_wheels()), [[0.0, 0.0, 0.0], [0.6, 0.3, 0.0]]
    found = sm.plan(robot, "paper", way, points=60, chance=0.02)
    likely = found.plan_chance
    assert likely is not None and likely.margin is not None and likely.duration_s is not None
    assert likely.at_plan > 0.02 and likely.margin > 0.1 and likely.duration_s > found.duration_s
    again = sm.plan(robot, "paper", way, points=60, margin=likely.margin).plan_chance
    assert again is not None and 0.01 < again.at_plan <= 0.02 and again.chance is None
    assert "2 % with --margin" in "\n".join(found.lines())
    assert found.to_dict()["slip_chance"]["margin"] == likely.margin


def test_the_same_seed_draws_the_same() -> None:
    robot = on(kiwi(30.0))
    model = nominal_model(robot, "paper")
    one, two, other = (
        counted(lowest_pulls(model, PHI, drawn_from(robot, 1000, s)), 4.0, chance=0.01, seed=s)
        for s in (1, 1, 2)
    )
    assert one == two != other


def test_a_chance_without_a_spread_is_refused() -> None:
    for command in (sm.sweep, sm.bounds):
        with pytest.raises(InputError, match="every number of the robot on surface 'paper' is exact"):
            command(kiwi(30.0), "paper", chance=0.01)
        with pytest.raises(InputError, match="chance from"):
            command(on(kiwi(30.0)), "paper", chance=1e-5)
    assert sm.sweep(kiwi(30.0), "paper", step_deg=30.0).slip_chance is None


def test_a_seed_without_a_spread_is_said_to_be_idle() -> None:
    idle = "seed has no effect: every number of the robot on surface 'paper' is exact"
    track = [(0.0, 0.0, 0.0), (0.2, 0.0, 0.0)]
    for found in (
        sm.sweep(kiwi(30.0), "paper", step_deg=30.0, seed=3),
        sm.bounds(kiwi(30.0), "paper", step_deg=90.0, seed=3),
        sm.plan(kiwi(30.0), "paper", track, seed=3),
    ):
        assert idle in found.warnings
    for seed, robot in ((0, kiwi(30.0)), (3, on(kiwi(30.0)))):
        assert not any("seed" in w for w in sm.sweep(robot, "paper", step_deg=30.0, seed=seed).warnings)


def test_a_chance_that_is_not_computed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = on(replace(kiwi(30.0), friction=replace(kiwi().friction, grip=GripShape.ELLIPSE)))
    recipe = Recipe(robot=robot, effects=(FloorTilt.of(np.array([0.02, 0.01])),))
    found = sm.sweep(recipe, "paper", step_deg=45.0)
    assert (
        found.slip_chance is None and "chance: is not computed for the grip 'ellipse'" in found.warnings[-1]
    )
    with pytest.raises(InputError, match="not computed"):
        sm.sweep(recipe, "paper", step_deg=45.0, chance=0.01)
    monkeypatch.setattr(uncertainty, "_ONE_BY_ONE", 1e4)
    boxed = Recipe(robot=on(kiwi(30.0)), effects=recipe.effects)
    assert (
        "is not computed for 3 wheels at 3 headings" in sm.sweep(boxed, "paper", step_deg=45.0).warnings[-1]
    )
    heavy = Recipe(robot=unsure(kiwi(30.0)), effects=(FloorTilt.of(np.array([0.02, 0.01])),))
    assert "uncertain mass" in sm.bounds(heavy, "paper", step_deg=45.0).warnings[-1]


def test_a_spread_that_reaches_beyond_its_key_is_spoken_of() -> None:
    robot = kiwi()
    said = []
    for text in ("3 ± 2", "3 ± 0.3"):
        body = replace(robot.body, mass_kg=read("mass_kg", text, lambda _, v: float(v), "", (0.0, np.inf)))
        said.append(cut_off(replace(robot, body=body), "paper"))
    assert len(said[0]) == 1 and "body.mass_kg: 6.7 %" in said[0][0] and said[1] == ()


def test_commands_that_use_no_spread_say_so() -> None:
    robot = replace(unsure(four_wheels()), suspension_N_per_mm=20.0, unevenness_mm=0.5)
    said = sm.polytope(robot, "paper").warnings
    assert any(s.startswith("body.mass_kg, body.inertia_kg_m2, body.com_m") for s in said)
    assert any(s.startswith("loads.unevenness_mm: taken as an even floor") for s in said)
    design = sm.design(robot, "paper", "mass_kg=11,12", static=True)
    assert design.warnings == said[-2:-1], "the band of loads counts there"
    whole = sm.sweep(robot, "paper", from_deg=0.0, to_deg=360.0, step_deg=1.0).sweep
    least = np.min(whole.f_low_N) / whole.model.inertia.weight_N
    column = design.study.columns["f_low_worst"]
    assert column[1] == pytest.approx(least, rel=1e-3) and least < 0.99 * np.min(whole.f_max_N) / (
        whole.model.inertia.weight_N
    )
    for used in (sm.sweep(robot, "paper", step_deg=45.0), sm.bounds(robot, "paper", step_deg=45.0)):
        assert not any("middle" in s or "even floor" in s for s in used.warnings)


@pytest.mark.parametrize("shape", [GripShape.BOX, GripShape.DISC_STRIP])
def test_ten_thousand_draws_take_less_than_a_second(shape: GripShape) -> None:
    robot = unsure(four_wheels(), shape)
    model = nominal_model(robot, "paper")
    start = time.process_time()
    counted(lowest_starts(model, draws(robot, model, 10_000, 0)), 1.0, chance=0.01, seed=0)
    assert time.process_time() - start < 1.0
    if shape is GripShape.BOX:
        start = time.process_time()
        lowest_pulls(model, PHI, draws(robot, model, 10_000, 0))
        assert time.process_time() - start < 1.0


def test_a_chance_is_found_where_small_shares_cannot_begin_that_fast() -> None:
    """Its bisection tries margins at which the start speed is too high: that refused the whole plan."""
    robot, way = unsure(kiwi()), [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    fast = {"points": 60, "start_speed_m_s": 1.3}
    assert sm.plan(robot, "paper", way, **fast).duration_s > 0.0
    found = sm.plan(robot, "paper", way, chance=0.05, **fast)
    assert found.plan_chance is not None and found.plan_chance.chance == 0.05
