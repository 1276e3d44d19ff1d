"""Static limits of many designs at once, against theory and against one model at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strategies import four_wheels, kiwi, robots

from slipmargin.effects import Recipe
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.limits import Pull, pull_limit, sweep, wrench_set
from slipmargin.limits.bias import bias_wrench
from slipmargin.limits.self_check import least_support
from slipmargin.limits.sweep import limit, limit_or_zero
from slipmargin.robot import GripShape, LoadRule, Robot
from slipmargin.study import statics
from slipmargin.study.batch import batches
from slipmargin.study.columns import moving_columns, static_columns
from slipmargin.study.robot_on_surface import RobotOnSurface

# Birth certificate: docs/theory.md, section 2, golden table: F_emax / (m g), equal loads, five decimals.
HEADINGS = np.deg2rad([0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0])
TABLE = {
    ("paper", False, 15.0): (0.16705, 0.17295, 0.19290, 0.19357, 0.19357, 0.20570, 0.21296),
    ("paper", False, 30.0): (0.18196, 0.18838, 0.21011, 0.18838, 0.18196, 0.18838, 0.21011),
    ("paper", True, 15.0): (0.49987, 0.51751, 0.57720, 0.55339, 0.54042, 0.52201, 0.54042),
    ("carpet", False, 15.0): (0.20149, 0.20860, 0.23267, 0.22814, 0.22814, 0.22880, 0.23687),
    ("carpet", True, 15.0): (0.59559, 0.61660, 0.68773, 0.65935, 0.64390, 0.62196, 0.64390),
}


def on(robot: Robot, surface: str = "paper", *effects: object) -> RobotOnSurface:
    return RobotOnSurface(recipe=Recipe(robot=robot, effects=tuple(effects)), surface=surface)  # type: ignore[arg-type]


def test_table_of_section_2_in_one_batch() -> None:
    designs = [on(kiwi(delta), surface) for surface, _, delta in TABLE]
    (batch,), refused = batches(designs)
    assert not refused
    rollers = statics.on_rollers(batch, HEADINGS, designs)
    rigid = statics.on_rigid(batch, HEADINGS, designs)
    for row, (key, wanted) in enumerate(TABLE.items()):
        np.testing.assert_allclose((rigid if key[1] else rollers)[row], wanted, rtol=0.0, atol=0.5e-5)


def test_loads_of_section_3() -> None:
    """docs/theory.md, section 3: δ = 15°, statics gives N_3 = 0.2056 m g and N_1 = N_2 = 0.3972 m g."""
    (batch,), _ = batches([on(kiwi(15.0, load_rule=LoadRule.STATIC)), on(kiwi(15.0))])
    np.testing.assert_allclose(batch.rest[0], [0.3972, 0.3972, 0.2056], rtol=0.0, atol=0.5e-4)
    np.testing.assert_allclose(batch.rest[1], 1.0 / 3.0)
    np.testing.assert_allclose(batch.static[1], batch.rest[0])


def test_limits_in_motion_of_section_4() -> None:
    """docs/theory.md, section 4: starting along +X 0.5017 m/s², braking 1.6388 = g 0.16705, both worst."""
    found = moving_columns(on(kiwi(15.0)))
    assert found["start_worst_m_s2"] == pytest.approx(0.5017, abs=0.5e-4)
    assert found["brake_worst_m_s2"] == pytest.approx(1.6388, abs=0.5e-4)
    assert found["slip_share"] == 0.0


@settings(max_examples=25, deadline=None)
@given(drawn=st.lists(robots(), min_size=1, max_size=4))
def test_a_batch_equals_its_models(drawn: list[Robot]) -> None:
    """Arrays read off the data sheets equal those of models built one by one."""
    designs = [on(robot, robot.surfaces[0].name) for robot in drawn]
    found, refused = batches(designs)
    phi = np.linspace(0.0, 6.0, 9)
    for batch in found:
        force = statics.on_rollers(batch, phi, designs)
        low = statics.lowest(batch, phi, designs)
        for d, i in enumerate(batch.index.tolist()):
            if i in refused:
                continue
            model = designs[i].build()
            np.testing.assert_allclose(
                batch.rest[d] * model.inertia.weight_N,
                model.loads.rest_N,
                rtol=1e-9,
                atol=1e-9 * model.inertia.weight_N,
            )
            alone = sweep(model, phi)
            np.testing.assert_allclose(force[d] * model.inertia.weight_N, alone.f_max_N, rtol=1e-9)
            np.testing.assert_allclose(low[d] * model.inertia.weight_N, alone.f_low_N, rtol=1e-9)


def test_a_wheel_without_rollers_stands_on_rigid_in_a_batch_as_in_a_model() -> None:
    robot = kiwi(15.0)
    wheels = (replace(robot.wheels[0], rigid_fraction=1.0), *robot.wheels[1:])
    designs = [on(replace(robot, wheels=wheels))]
    (batch,), _ = batches(designs)
    model = designs[0].build()
    np.testing.assert_allclose(batch.roller[0], model.grip.roller)
    found = statics.on_rollers(batch, HEADINGS, designs)[0] * model.inertia.weight_N
    np.testing.assert_allclose(found, sweep(model, HEADINGS).f_max_N, rtol=1e-9)


@pytest.mark.parametrize(
    "effect",
    [RigidSector(rigid_fraction=0.4), FloorTilt(tilt_x_rad=0.01, tilt_y_rad=0.02)],
    ids=["rigid_sector", "floor_tilt"],
)
def test_designs_with_effects_are_their_models(effect: object) -> None:
    designs = [on(kiwi(20.0), "paper", effect), on(kiwi(20.0))]
    (batch,), _ = batches(designs)
    found = statics.on_rollers(batch, HEADINGS, designs)
    model = designs[0].build()
    np.testing.assert_allclose(found[0] * model.inertia.weight_N, limit(model, HEADINGS, Pull()), rtol=1e-12)


def test_an_effect_that_does_not_fit_makes_one_design_impossible() -> None:
    heavy = WheelLoads(shift_x_m=0.3, shift_y_m=0.0)
    table, refused = static_columns([on(kiwi(15.0), "paper", heavy), on(kiwi(15.0))])
    assert np.isfinite(table["f_worst"]).tolist() == [False, True]
    assert list(refused) == [0]


@pytest.mark.parametrize("shape", [GripShape.ELLIPSE, GripShape.DISC_STRIP])
def test_a_coupled_grip_is_solved_not_boxed(shape: GripShape) -> None:
    coupled, boxed = on(kiwi(15.0, grip=shape)), on(kiwi(15.0))
    table, _ = static_columns([coupled, boxed], np.linspace(0.0, 2.0 * np.pi, 25))
    assert table["f_worst"][0] < table["f_worst"][1] * (1.0 - 1e-6) or shape is GripShape.DISC_STRIP
    model = coupled.build()
    at = float(table["worst_phi_rad"][0])
    alone = pull_limit(model, at).force_N
    assert table["f_worst"][0] * model.inertia.weight_N == pytest.approx(alone, rel=1e-6)
    assert table["yaw_moment_N_m"][0] <= table["yaw_moment_N_m"][1] * (1.0 + 1e-9)
    direction = np.random.default_rng(0).normal(size=(200_000, 3))
    direction = direction[direction[:, 2] > 0.0]
    by_chance = np.min(wrench_set(model).support(direction) / direction[:, 2])
    assert table["yaw_moment_N_m"][0] <= by_chance * (1.0 + 1e-9)
    assert table["yaw_moment_N_m"][0] >= by_chance * 0.97


def test_the_worst_pull_in_closed_form() -> None:
    """Over every direction, not a grid: min_k h_k / |(n_kx, n_ky)|, from the facets of each model."""
    designs = [on(kiwi(delta)) for delta in (0.0, 13.0, 30.0, 47.0)] + [on(four_wheels())]
    table, _ = static_columns(designs)
    for design, worst in zip(designs, table["f_worst"], strict=True):
        wrenches = wrench_set(design.build())
        flat = np.hypot(wrenches.normals[:, 0], wrenches.normals[:, 1])
        exact = np.min(wrenches.offsets[flat > 1e-9] / flat[flat > 1e-9]) / design.build().inertia.weight_N
        assert exact * (1.0 - 1e-12) <= worst <= exact * (1.0 + 1e-5)  # half a degree apart


def test_only_the_columns_that_are_asked_for_are_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    """What moves one objective took the cone programs of all of them: 12 s for a disc-strip robot."""
    designs = [on(kiwi())]
    whole = static_columns(designs)[0]
    for other in ("lowest", "on_rigid", "yaw_moments", "least_loads"):
        monkeypatch.delattr(statics, other)
    some = static_columns(designs, names=["f_mean", "f_worst_equal"])[0]
    assert list(some) == ["f_mean", "f_worst_equal"]
    assert all(np.array_equal(some[name], whole[name]) for name in some)


def test_a_robot_that_falls_over_says_so() -> None:
    table, refused = static_columns([on(kiwi(15.0, com_m=(0.0, 0.3))), None, on(kiwi(15.0))])
    assert "falls over" in refused[0] and 1 not in refused
    assert np.isnan(table["f_worst"]).tolist() == [True, True, False]
    tilted = four_wheels()
    moved = replace(tilted, body=replace(tilted.body, com_m=np.array([0.14, 0.1])))
    _, refused = static_columns([on(moved)])
    assert "would carry" in refused[0]


def test_static_and_equal_loads_side_by_side() -> None:
    equal, static = on(kiwi(15.0)), on(kiwi(15.0, load_rule=LoadRule.STATIC))
    table, _ = static_columns([equal, static])
    assert table["f_worst"][0] == table["f_worst_equal"][0] == pytest.approx(table["f_worst_equal"][1])
    assert table["f_worst"][1] == table["f_worst_static"][1] == pytest.approx(table["f_worst_static"][0])


@pytest.mark.parametrize("shape", [GripShape.BOX, GripShape.ELLIPSE])
def test_a_slope_counts_at_every_heading_in_the_yaw_moment_and_the_loads(shape: GripShape) -> None:
    flat = kiwi(15.0, com_height_m=0.08, load_rule=LoadRule.STATIC, grip=shape)
    tilt = FloorTilt(tilt_x_rad=0.02, tilt_y_rad=0.05)
    phi = np.linspace(0.0, 2.0 * np.pi, 25)
    table, _ = static_columns([on(flat, "paper", tilt), on(flat)], phi)
    model = on(flat, "paper", tilt).build()
    bias, moments, loads = bias_wrench(model, phi), [], []
    for at, wrench in zip(phi, bias, strict=True):
        # The largest moment by the support function: h(n) ≥ −n·(w_b + (0, 0, ±M)) for every n.
        wrenches = wrench_set(model, phi_rad=float(at))
        loads.append(np.min(wrenches.load_N) / model.inertia.weight_N)
        for sense in (1.0, -1.0):
            moments.append(least_support(wrenches, np.array([0.0, 0.0, sense]), wrench))
    assert table["yaw_moment_N_m"][0] == pytest.approx(min(moments), rel=1e-7)
    assert table["load_least"][0] == pytest.approx(min(loads), rel=1e-12)
    assert table["yaw_moment_N_m"][0] < 0.95 * table["yaw_moment_N_m"][1]
    assert table["load_least"][0] < 0.95 * table["load_least"][1]


def test_a_slope_that_makes_it_slip_at_some_headings_leaves_the_others_their_pull() -> None:
    steep = on(kiwi(15.0), "paper", FloorTilt(tilt_x_rad=0.19, tilt_y_rad=0.0))
    phi = np.linspace(0.0, 2.0 * np.pi, 25)
    table, _ = static_columns([steep], phi)
    alone = limit_or_zero(steep.build(), phi, Pull()) / steep.build().inertia.weight_N
    assert np.min(alone) == 0.0 < np.max(alone)
    assert table["f_best"][0] == pytest.approx(np.max(alone), rel=1e-12)
