"""The chance of slip, sampled in closed form, is that of sweeps with each draw's coefficients."""

from __future__ import annotations

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
from slipmargin.limits import sweep
from slipmargin.limits.uncertainty import draws, lowest_pulls, slip_chance
from slipmargin.model import nominal_model
from slipmargin.robot import Coefficients, GripShape, Robot, Surface, Uncertain

PHI = np.deg2rad(np.arange(0.0, 360.0, 5.0))
ROLLER = Coefficients(drive=Uncertain((0.26, 0.26), 0.02), transverse=Uncertain((0.06, 0.12)))
FLOOR = Surface(name="paper", roller=ROLLER, rigid=PAPER.rigid)


def on(robot: Robot, floor: Surface = FLOOR) -> Robot:
    return replace(robot, surfaces=(floor,))


def with_factors(floor: Surface, roller: np.ndarray, rigid: np.ndarray) -> Surface:
    pairs = {
        key: Coefficients(drive=float(pair.drive * f[0]), transverse=float(pair.transverse * f[1]))
        for key, pair, f in (("roller", floor.roller, roller), ("rigid", floor.rigid, rigid))
    }
    return replace(floor, **pairs)  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", tuple(GripShape))
@pytest.mark.parametrize("robot", [kiwi(15.0), four_wheels()], ids=["kiwi", "mecanum"])
def test_each_draw_is_its_own_sweep(robot: Robot, shape: GripShape) -> None:
    robot = on(replace(robot, friction=replace(robot.friction, grip=shape)))
    drawn = draws(FLOOR, 400, 3)
    fast = lowest_pulls(nominal_model(robot, "paper"), PHI, drawn)
    for d in range(4):
        exact = on(robot, with_factors(FLOOR, drawn.roller[d], drawn.rigid[d]))
        slow = float(np.min(sweep(nominal_model(exact, "paper"), PHI).f_low_N))
        if shape is GripShape.BOX:
            assert fast[d] == pytest.approx(slow, rel=1e-9)
        else:  # too large by what its finitely many normals leave out
            assert slow * (1.0 - 1e-6) <= fast[d] <= slow * 1.005


def test_draws_with_a_slope_are_their_own_sweeps() -> None:
    robot, drawn = on(kiwi(30.0)), draws(FLOOR, 3, 5)
    tilt = FloorTilt.of(np.array([0.02, 0.01]))
    fast = lowest_pulls(Recipe(robot=robot, effects=(tilt,)).build("paper"), PHI, drawn)
    for d in range(3):
        exact = Recipe(robot=on(robot, with_factors(FLOOR, drawn.roller[d], drawn.rigid[d])), effects=(tilt,))
        assert fast[d] == pytest.approx(np.min(sweep(exact.build("paper"), PHI).f_low_N), rel=1e-9)


def test_one_spread_is_the_normal_distribution() -> None:
    # Without transverse friction the limit is proportional to the drive coefficient, so at a margin m the
    # chance is Φ(−m μ / sd).
    floor = Surface(
        name="paper",
        roller=Coefficients(drive=Uncertain((0.3, 0.3), 0.03), transverse=0.0),
        rigid=PAPER.rigid,
    )
    found = sm.sweep(on(kiwi(30.0), floor), "paper", to_deg=120.0, chance=0.05)
    assert found.slip_chance is not None
    wanted = NormalDist().cdf(-1.0)
    assert found.slip_chance.at_recommended == pytest.approx(wanted, abs=4.0 * np.sqrt(wanted / 10_000))
    limit = found.recommended_N / 0.9
    assert found.slip_chance.force_N == pytest.approx(
        limit * (1.0 + 0.1 * NormalDist().inv_cdf(0.05)), rel=0.01
    )
    assert found.lines()[:4] == sm.sweep(on(kiwi(30.0), floor), "paper", to_deg=120.0).lines()[:4]
    assert "of 10000 draws of the coefficients slip at" in found.lines()[5]
    assert found.to_dict()["slip_chance"]["chance"] == 0.05


def test_the_same_seed_draws_the_same() -> None:
    model = nominal_model(on(kiwi(30.0)), "paper")
    one, two, other = (slip_chance(model, FLOOR, PHI, 4.0, seed=s) for s in (1, 1, 2))
    assert one == two != other


def test_a_chance_without_a_spread_is_refused() -> None:
    with pytest.raises(InputError, match="every coefficient of surface 'paper' is exact"):
        sm.sweep(kiwi(30.0), "paper", chance=0.01)
    with pytest.raises(InputError, match="chance from"):
        sm.sweep(on(kiwi(30.0)), "paper", chance=1e-5)
    assert sm.sweep(kiwi(30.0), "paper", step_deg=30.0).slip_chance is None


def test_a_chance_that_is_not_computed_is_said() -> None:
    robot = on(replace(kiwi(30.0), friction=replace(kiwi().friction, grip=GripShape.ELLIPSE)))
    recipe = Recipe(robot=robot, effects=(FloorTilt.of(np.array([0.02, 0.01])),))
    found = sm.sweep(recipe, "paper", step_deg=45.0)
    assert (
        found.slip_chance is None and "chance: is not computed for the grip 'ellipse'" in found.warnings[-1]
    )
    with pytest.raises(InputError, match="not computed"):
        sm.sweep(recipe, "paper", step_deg=45.0, chance=0.01)


def test_ten_thousand_draws_take_less_than_a_second() -> None:
    model = nominal_model(on(four_wheels()), "paper")
    start = time.process_time()
    slip_chance(model, FLOOR, PHI, 4.0)
    assert time.process_time() - start < 1.0
