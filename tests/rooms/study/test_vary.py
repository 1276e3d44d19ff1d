"""Grids over the robot file: what is taken, what is refused, and that each quantity does what it says."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import four_wheels, kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.errors import InputError
from slipmargin.robot import LoadRule, Motor
from slipmargin.robot.fields import keys
from slipmargin.robot.sections import SECTIONS
from slipmargin.study.layouts import ring, rows
from slipmargin.study.quantities import QUANTITIES, own_value
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.robust import parse_interval
from slipmargin.study.vary import applied, parse_vary, product, quantity_of


def design(**changes: object) -> RobotOnSurface:
    return RobotOnSurface(recipe=Recipe(robot=kiwi(**changes)), surface="paper")  # type: ignore[arg-type]


def test_a_range_holds_both_ends_and_means_what_it_prints() -> None:
    assert parse_vary("delta_deg=0:60:0.5").values == tuple(np.arange(121) / 2)
    assert parse_vary("com_x_m=0:0.3:0.1").values == (0.0, 0.1, 0.2, 0.3)
    assert parse_vary("mass_kg = 3, 2.5").values == (3.0, 2.5)
    assert parse_vary("load_model=equal,static").values == ("equal", "static")
    wheels = parse_vary("wheels=3:6:1").values
    assert wheels == (3, 4, 5, 6) and all(isinstance(v, int) for v in wheels)


def test_the_product_changes_the_last_fastest() -> None:
    grids = [parse_vary("delta_deg=10,20"), parse_vary("mass_kg=1,2,3")]
    assert product(design(), grids)[:4] == [(10.0, 1.0), (10.0, 2.0), (10.0, 3.0), (20.0, 1.0)]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is no grid"),
        ("delta_deg", "is no grid"),
        ("=3", "is no grid"),
        ("delta_deg=", "is no grid"),
        ("delta_deg=1:2", "has the range"),
        ("delta_deg=1:2:0", "positive step"),
        ("delta_deg=5:1:1", "swap"),
        ("delta_deg=a:b:c", "takes numbers"),
        ("delta_deg=1,x", "takes numbers"),
        ("delta_deg=1,nan", "finite"),
        ("delta_deg=0:inf:1", "finite"),
        ("delta_deg=0:60:1e-9", "take at most"),
        ("delta_deg=1,1.0", "twice"),
        ("load_model=heavy", "use: equal, static, quasi-static"),
        ("wheels=3.5", "whole numbers"),
        ("delta=1", "did you mean 'delta_deg'?"),
        ("xyz=1", "known: surface, wheels"),
        ("wheel[2].name=1", "is not a number of a wheel"),
    ],
)
def test_a_grid_that_makes_no_sense_is_refused(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says.replace("?", r"\?")):
        parse_vary(text)


def test_an_unknown_key_lists_every_known_one() -> None:
    with pytest.raises(InputError) as told:
        quantity_of("nonsense")
    assert all(q.key in str(told.value) for q in QUANTITIES)


@pytest.mark.parametrize(
    ("texts", "says"),
    [
        ([], "is missing"),
        (["mass_kg=1,2", "mass_kg=3,4"], "varied twice"),
        (["surface=ice"], "not in the robot"),
        (["wheels=3,4", "wheels_in_rows=4,6"], "contradicts"),
        (["mass_kg=1:1000:1", "com_x_m=0:1:1e-4"], "at most"),
    ],
)
def test_a_product_that_makes_no_sense_is_refused(texts: list[str], says: str) -> None:
    with pytest.raises(InputError, match=says):
        product(design(), [parse_vary(t) for t in texts])


def test_each_number_reads_back_as_it_was_put() -> None:
    """A quantity whose get does not see its put would compare designs with the wrong own value."""
    start = RobotOnSurface(recipe=Recipe(robot=kiwi(load_rule=LoadRule.STATIC)), surface="carpet")
    values = {
        "surface": "paper",
        "wheels": 5,
        "wheels_in_rows": 6,
        "load_model": "equal",
        "grip": "ellipse",
        "friction_law": "tanh",
        "roller_angle_deg": 30.0,
        "delta_deg": 22.0,
    }
    for quantity in QUANTITIES:
        if quantity.key in ("front_angle_deg", "rear_angle_deg"):
            continue  # of four wheels: see tests/rooms/study/test_pair_angles.py
        value = values.get(quantity.key, 0.25)
        if quantity.key in ("stall_torque_N_m", "reflected_inertia_kg_m2"):
            continue  # see below: neither stands alone
        assert own_value(quantity, quantity.put(start, value)) == pytest.approx(value), quantity.key


def test_a_roller_angle_keeps_each_wheel_s_sign() -> None:
    car = RobotOnSurface(recipe=Recipe(robot=four_wheels()), surface="paper")
    turned = quantity_of("roller_angle_deg").put(car, 30.0).robot
    assert [w.roller_angle_deg for w in turned.wheels] == [30.0, -30.0, 30.0, -30.0]


def test_what_the_file_says_may_be_varied_is_a_quantity() -> None:
    named = {v for s in SECTIONS for k in keys(s.kind, s.table).values() for v in k.vary}
    assert (
        named <= {q.key for q in QUANTITIES} and {"mass_kg", "com_y_m", "mu_rigid", "friction_law"} <= named
    )


def test_a_friction_law_is_varied_by_name() -> None:
    grid = parse_vary("friction_law=atan,tanh,rational")
    made = [applied(design(), [grid.quantity], (value,)) for value in grid.values]
    assert [m.robot.friction.name for m in made] == ["atan", "tanh", "rational"]
    assert [m.build().grip.law for m in made] == [0, 1, 2]
    with pytest.raises(InputError, match="use: atan, tanh, rational"):
        parse_vary("friction_law=coulomb")


def test_a_motor_needs_a_speed_before_a_torque() -> None:
    torque, inertia = quantity_of("stall_torque_N_m"), quantity_of("reflected_inertia_kg_m2")
    with pytest.raises(InputError, match="vary max_speed_rad_s"):
        torque.put(design(), 0.5)
    fast = quantity_of("max_speed_rad_s").put(design(), 40.0)
    assert torque.put(fast, 0.5).robot.motor == Motor(max_speed_rad_s=40.0, stall_torque_N_m=0.5)
    with pytest.raises(InputError, match="add stall_torque_N_m"):
        inertia.put(fast, 1e-3)
    moved = inertia.put(torque.put(fast, 0.5), 1e-3)
    assert own_value(inertia, fast) is None and own_value(inertia, moved) == 1e-3


def test_the_order_asked_in_does_not_matter() -> None:
    keys = [quantity_of("circle_radius_m"), quantity_of("wheels")]
    one = applied(design(), keys, (0.2, 5)).robot
    two = applied(design(), keys[::-1], (5, 0.2)).robot
    for a, b in zip(one.wheels, two.wheels, strict=True):
        assert np.array_equal(a.position_m, b.position_m)
        assert np.hypot(*a.position_m) == pytest.approx(0.2)


def test_an_impossible_value_names_its_quantity() -> None:
    with pytest.raises(InputError, match="rigid_fraction: cannot be 2"):
        applied(design(), [quantity_of("rigid_fraction")], (2.0,))


def test_a_place_in_the_file() -> None:
    by_name, by_number = quantity_of("wheel[rear].radius_m"), quantity_of("wheel[3].radius_m")
    for quantity in (by_name, by_number):
        robot = quantity.put(design(), 0.03).robot
        assert [w.radius_m for w in robot.wheels] == [0.0254, 0.0254, 0.03]
        assert own_value(quantity, design()) == 0.0254
    with pytest.raises(InputError, match="no wheel '4'"):
        quantity_of("wheel[4].radius_m").put(design(), 0.03)


def test_a_place_in_an_effect() -> None:
    recipe = Recipe(robot=kiwi(), effects=(RigidSector(rigid_fraction=0.2),))
    start = RobotOnSurface(recipe=recipe, surface="paper")
    quantity = quantity_of("effect[rigid_sector].rigid_fraction")
    moved = quantity.put(start, 0.3)
    assert (own_value(quantity, start), own_value(quantity, moved)) == (0.2, 0.3)
    assert moved.build().grip.rigid_fraction.tolist() == [0.3] * 3
    with pytest.raises(InputError, match="has no number 'mass'"):
        quantity_of("effect[1].mass").put(start, 1.0)
    with pytest.raises(InputError, match="the file lists none"):
        quantity_of("effect[1].mass").put(design(), 1.0)


def test_a_ring_of_three_is_the_symmetric_robot() -> None:
    made, symmetric = ring(kiwi(15.0), 3), kiwi(30.0)
    key = [tuple(np.round(w.position_m, 12)) for w in made.wheels]
    for wheel in symmetric.wheels:
        twin = made.wheels[key.index(tuple(np.round(wheel.position_m, 12)))]
        assert np.cos(np.deg2rad(twin.drive_direction_deg - wheel.drive_direction_deg)) == pytest.approx(1.0)


def test_rows_of_four_are_a_mecanum_car() -> None:
    made, car = rows(four_wheels(), 4), four_wheels()
    found = {(tuple(np.round(w.position_m, 12)), w.roller_angle_deg) for w in made.wheels}
    assert found == {(tuple(np.round(w.position_m, 12)), w.roller_angle_deg) for w in car.wheels}


@pytest.mark.parametrize(
    ("make", "count", "says"),
    [
        (ring, 2, "3 to 12"),
        (ring, 13, "3 to 12"),
        (rows, 5, "even number"),
        (rows, 2, "even number"),
        (rows, 14, "3 to 12"),
    ],
)
def test_layouts_refuse_what_cannot_stand(make: object, count: int, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make(four_wheels(), count)  # type: ignore[operator]


def test_layouts_refuse_stated_fractions() -> None:
    fixed = kiwi(load_rule=LoadRule.FIXED, load_fractions=(0.3, 0.3, 0.4))
    with pytest.raises(InputError, match="stated load fractions"):
        ring(fixed, 4)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("mu_drive", "is no interval"),
        ("mu_drive=1", "is no interval"),
        ("mu_drive=a:b", "LOW:HIGH"),
        ("mu_drive=2:1", "no interval"),
        ("mu_drive=0:inf", "no interval"),
        ("grip=box:box", "choice"),
        ("wheels=3:4", "choice or a count"),
        ("xyz=1:2", "known"),
    ],
)
def test_an_interval_that_is_none_is_refused(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        parse_interval(text)


def test_a_roller_angle_below_zero_would_turn_every_roller_round() -> None:
    design = RobotOnSurface(recipe=Recipe(robot=four_wheels()), surface="paper")
    with pytest.raises(InputError, match="each wheel keeps the sign"):
        applied(design, [quantity_of("roller_angle_deg")], [-45.0])
