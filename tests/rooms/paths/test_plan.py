"""Plans: the fastest profile by three roads, within every limit, and a reason where there is none."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from strategies import four_wheels, high_kiwi, kiwi

import slipmargin as sm
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.motion_realised import Realised, growth_per_s, realised
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model
from slipmargin.paths import core
from slipmargin.paths.along import Caps
from slipmargin.paths.audit import FINER, audit
from slipmargin.paths.convex import Ellipsoids, convex_profile
from slipmargin.paths.geometry import Geometry
from slipmargin.paths.grid import grid_of
from slipmargin.paths.path import Path, corners, through
from slipmargin.paths.plan import Plan, Request, duration, plan
from slipmargin.paths.sample import at_use, node_times, rolled, stretched, trajectory
from slipmargin.paths.trajectory import LEAST_SAMPLES
from slipmargin.physics.frames import rotate_rows
from slipmargin.report.motion import unsteady
from slipmargin.report.paths import pace
from slipmargin.robot import GripShape, LoadRule, Motor
from slipmargin.robot.warnings import warnings

T = np.linspace(0.0, 2.0 * np.pi, 17)
PATHS = {
    "straight": corners(np.array([[0, 0, 0], [1.0, 0, 0]])),
    "turning": corners(np.array([[0, 0, 0], [1.0, 0.4, 2.0]])),
    "eight": through(np.column_stack([np.sin(T), 0.5 * np.sin(2 * T), 0.5 * np.sin(T)]), closed=True),
    "corner": corners(np.array([[0, 0, 0], [1.0, 0, 0], [1.0, 1.0, 0]]), blend_m=0.2),
}
MODELS = {
    "kiwi": nominal_model(kiwi(), "paper"),
    "mecanum": nominal_model(four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.1), "paper"),
    "motor": nominal_model(
        replace(kiwi(), motor=Motor(max_speed_rad_s=35.0, stall_torque_N_m=0.09)), "paper"
    ),
}


@pytest.fixture(scope="module")
def eight() -> Plan:
    return plan(MODELS["kiwi"], PATHS["eight"], Request(share=0.9, points=200))


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("machine", MODELS)
def test_no_sample_uses_more_than_the_share(machine: str, name: str) -> None:
    found = plan(MODELS[machine], PATHS[name], Request(share=0.85, points=120))
    assert found.max_use <= 0.85 * (1.0 + 1e-6)
    assert np.max(found.audit.torque) <= 1.0 + 1e-6
    assert np.max(found.audit.speed) <= 1.0 + 1e-6
    assert np.min(found.audit.load_N) >= 0.0
    assert found.max_use > 0.8 or machine == "motor"  # and it is no coward
    assert found.audit.use.shape[1] == 21  # 20 times finer than the grid


def test_only_what_changed_is_checked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A way of 60 m was checked as a whole 45 times: half a minute."""
    looked_at: list[int] = []

    def counted(model: Model, motion: Motion, **words: Any) -> Realised:
        looked_at.append(motion.count)
        return realised(model, motion, **words)

    monkeypatch.setattr("slipmargin.paths.audit.realised", counted)
    found = plan(MODELS["mecanum"], PATHS["corner"], Request(share=0.9, points=120))
    whole = found.audit.speed.size
    assert looked_at[0] == looked_at[-1] == whole and max(looked_at[2:-2]) < 0.8 * whole
    r, model = found.request, found.model
    fine = Geometry.of(model, found.path, found.grid, np.linspace(0.0, 1.0, FINER + 1))
    again = audit(model, fine, found.x, found.u, contact=r.contact, share=r.share, caps=r.caps)
    for field in ("use", "settling", "torque", "speed", "load_N", "tipping", "time_s"):
        np.testing.assert_array_equal(getattr(found.audit, field), getattr(again, field))
    half = np.arange(len(found.u)) % 2 == 0
    for known, changed in ((again, half), (again, ~half)):
        part = audit(
            model, fine, 0.9 * found.x, 0.9 * found.u, contact=r.contact, share=r.share, caps=r.caps,
            known=known, changed=changed,
        )  # fmt: skip
        np.testing.assert_array_equal(part.use[~changed], again.use[~changed])
        assert not np.any(part.use[changed] == again.use[changed])


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("machine", MODELS)
def test_the_convex_program_finds_the_same_time(machine: str, name: str) -> None:
    found = plan(MODELS[machine], PATHS[name], Request(share=0.9, points=80))
    same = convex_profile(found.grid.step, found.rows)
    assert found.duration_s == pytest.approx(same.duration_s, rel=1e-3)
    assert found.duration_s >= same.duration_s * (1.0 - 1e-4)


def test_what_limits_is_the_row_that_binds() -> None:
    """Five percent of a plan were the fault of caps or motors, of which the robot had none."""
    found = plan(MODELS["kiwi"], PATHS["turning"], Request(points=60))
    assert {found.rows.names[row] for row in found.limited_by} == {"grip"} and np.all(found.limited_by >= 0)
    assert not any("caps" in name or "motors" in name for name, _ in pace(found))
    capped = plan(MODELS["kiwi"], PATHS["turning"], Request(points=60, caps=Caps(speed_m_s=0.2)))
    assert dict(pace(capped))["speed caps or the motors' top speed"] > 0.5
    weak = plan(MODELS["motor"], PATHS["straight"], Request(points=60))
    assert dict(pace(weak))["motors"] > 0.5


def test_toppra_finds_the_same_time() -> None:
    ta = pytest.importorskip("toppra")
    constraint = pytest.importorskip("toppra.constraint")
    ta.setup_logging("ERROR")
    path = PATHS["eight"]
    s = np.linspace(0.0, path.length, 401)
    grid = replace(grid_of(path, 50), s=s, piece=np.zeros(400, dtype=np.int64))
    normals = np.random.default_rng(3).normal(size=(11, 3))
    normals = np.vstack([normals, -normals])
    jets = [path.at(x, grid.piece) for x in (s[:-1], s[1:])]
    a, b = (np.stack([j[order] @ normals.T for j in jets]) for order in (1, 2))
    x, u, high = np.zeros(401), np.zeros(400), np.zeros(401)
    one = np.ones((400, 22))
    assert (
        core.profile(grid.step, a[0], b[0], one, a[1], b[1], one, np.full(401, np.inf), 0.0, 0.0, x, u, high)[
            0
        ]
        == core.OK
    )
    limit = constraint.SecondOrderConstraint(lambda q, v, w: w, lambda q: normals, lambda q: np.ones(22), 3)
    limit.set_discretization_type(1)
    run = ta.algorithm.TOPPRA(
        [limit],
        ta.SplineInterpolator(s, path.pose(s)),
        gridpoints=s,
        solver_wrapper="seidel",
        parametrizer="ParametrizeConstAccel",
    )
    assert duration(grid.step, x) == pytest.approx(run.compute_trajectory(0.0, 0.0).duration, rel=1e-3)


def test_the_samples_are_one_motion(eight: Plan) -> None:
    rows = trajectory(eight, step_s=0.002)
    assert rows.duration_s == pytest.approx(eight.duration_s, rel=1e-12)
    assert rows.velocity == pytest.approx(np.gradient(rows.pose, rows.t_s, axis=0, edge_order=2), abs=5e-3)
    inner = slice(5, -5)
    gained = np.cumsum(rows.acceleration[:-1] * np.diff(rows.t_s)[:, None], axis=0)
    assert (rows.velocity[1:] - rows.velocity[0])[inner] == pytest.approx(gained[inner], abs=2e-2)
    assert rows.velocity[[0, -1]] == pytest.approx(np.zeros((2, 3)), abs=1e-6)
    body = rotate_rows(rows.pose[:, 2], rows.velocity, inverse=True)
    assert rows.omega == pytest.approx(eight.model.geometry.wheel_speeds(body), abs=1e-12)
    # sign: ρ θ̇ ŝ·ĝ = −(v + ω×p)·ĝ, the rear wheel of the kiwi drives along +X
    straight = trajectory(plan(MODELS["kiwi"], PATHS["straight"], Request(points=50)))
    assert np.all(straight.omega[1:-1, 2] < 0.0)
    assert straight.omega[:, 2] == pytest.approx(-straight.velocity[:, 0] / 0.0254, abs=1e-9)
    assert np.max(rows.use) <= 0.9 * (1.0 + 1e-6)
    assert node_times(eight)[-1] == pytest.approx(eight.duration_s)
    assert list(rows.columns())[:4] == ["t_s", "x_m", "y_m", "phi_rad"]


def test_less_grip_is_never_faster_and_a_better_start_never_slower(eight: Plan) -> None:
    calm = plan(eight.model, eight.path, Request(share=0.75, points=200))
    assert calm.duration_s > eight.duration_s
    moving = plan(eight.model, eight.path, Request(share=0.9, points=200, start_m_s=0.3, end_m_s=0.2))
    assert moving.duration_s < eight.duration_s
    ends = trajectory(moving, step_s=0.01).velocity[[0, -1]]
    assert np.hypot(*ends[:, :2].T) == pytest.approx([0.3, 0.2])


def test_speeds_along_a_spline_are_speeds_over_the_floor() -> None:
    """A spline is written over its chords: 0.5 m/s at its ends was 0.62, and 3.8 m were called 3.6."""
    bent = through(np.array([[0, 0, 0], [1.2, 0, 0], [1.2, 1.2, 0], [0, 1.2, 0]]))
    found = plan(MODELS["kiwi"], bent, Request(points=100, start_m_s=0.2, end_m_s=0.1))
    rows, along = trajectory(found, step_s=0.002), found.profile()
    speed = np.hypot(*rows.velocity[:, :2].T)
    assert speed[[0, -1]] == pytest.approx([0.2, 0.1])
    assert along.speed_m_s[[0, -1]] == pytest.approx([0.2, 0.1])
    assert along.speed_m_s.max() == pytest.approx(speed.max(), rel=1e-3)
    way = np.sum(np.hypot(*np.diff(rows.pose[:, :2], axis=0).T))
    assert along.way_m[-1] == pytest.approx(way, rel=1e-4) and way > 1.03 * bent.length
    with pytest.raises(InputError, match="start speed: is 9 m/s") as refused:
        plan(MODELS["kiwi"], bent, Request(points=100, start_m_s=9.0))
    most = float(re.search(r"at most ([\d.]+) m/s", str(refused.value))[1])  # type: ignore[index]
    faster = trajectory(plan(MODELS["kiwi"], bent, Request(points=100, start_m_s=most)), step_s=0.01)
    assert np.hypot(*faster.velocity[0, :2]) == pytest.approx(most, rel=1e-6)


def test_caps_hold_between_grid_points_too() -> None:
    caps = Caps(speed_m_s=0.4, yaw_rate_rad_s=0.3, wheel_rad_s=14.0)
    found = plan(MODELS["mecanum"], PATHS["eight"], Request(share=0.9, points=100, caps=caps))
    rows = trajectory(found, step_s=0.001)
    top = [
        np.max(np.hypot(rows.velocity[:, 0], rows.velocity[:, 1])) / 0.4,
        np.max(np.abs(rows.velocity[:, 2])) / 0.3,
        np.max(np.abs(rows.omega)) / 14.0,
    ]
    assert max(top) <= 1.0 + 1e-6
    assert max(top) > 0.99


def test_robust_is_slower_and_safe_in_every_state() -> None:
    slippery = replace(MODELS["kiwi"], grip=replace(MODELS["kiwi"].grip, rigid=np.tile([0.30, 0.13], (3, 1))))
    request = Request(share=0.9, points=100)
    rollers = plan(slippery, PATHS["turning"], request)
    robust = plan(slippery, PATHS["turning"], replace(request, contact=Contact.UNKNOWN))
    assert rollers.duration_s < robust.duration_s
    for bits in range(8):  # as if each wheel stood on what the bit says, all the way
        mask = np.array([bool(bits >> i & 1) for i in range(3)])
        grip = replace(
            slippery.grip, roller=np.where(mask[:, None], slippery.grip.rigid, slippery.grip.roller)
        )
        rows = trajectory(robust, step_s=0.01)
        assert np.max(stretched(replace(slippery, grip=grip), rows, 1.0).use) <= 0.9 * (1.0 + 1e-6)


@pytest.mark.parametrize(
    ("model", "request_", "words"),
    [
        (
            MODELS["kiwi"],
            Request(share=0.5, points=60),
            r"at s = 0 m .* constant speed wheel rear needs 0\.531 of its grip, more than the 0\.5 allowed, "
            r"use a margin below",
        ),
        (MODELS["kiwi"], Request(share=0.9, points=60, contact=Contact.UNKNOWN), "wheels on rollers only"),
        (nominal_model(kiwi(grip=GripShape.ELLIPSE), "paper"), Request(points=60), "turn the heading"),
        (
            nominal_model(replace(kiwi(), motor=Motor(max_speed_rad_s=30.0, stall_torque_N_m=0.02)), "paper"),
            Request(points=60),
            "motor torque of wheel .*stronger motor",
        ),
    ],
)
def test_no_motion_says_where_who_why_and_the_cure(model: Model, request_: Request, words: str) -> None:
    with pytest.raises(NoSolution, match=words):
        plan(model, PATHS["straight"], request_)


def test_impossible_speeds_and_requests_are_refused() -> None:
    with pytest.raises(InputError, match=r"start speed: is 9 m/s at x 0 m, y 0 m, but the path allows"):
        plan(MODELS["kiwi"], PATHS["straight"], Request(points=60, start_m_s=9.0))
    with pytest.raises(InputError, match="end speed"):
        plan(MODELS["kiwi"], PATHS["straight"], Request(points=60, end_m_s=9.0, caps=Caps(speed_m_s=1.0)))
    for bad in ({"share": 1.2}, {"start_m_s": -1.0}, {"end_m_s": np.nan}):
        with pytest.raises(InputError):
            Request(**bad)
    with pytest.raises(InputError, match="step_s"):
        trajectory(plan(MODELS["kiwi"], PATHS["straight"], Request(points=60)), step_s=0.0)


def test_speeding_up_to_a_use(eight: Plan) -> None:
    rows = trajectory(eight, step_s=0.01)
    assert np.max(at_use(eight.model, rows, 1.05).use) == pytest.approx(1.05, abs=2e-3)
    for impossible in (0.5, 1e9):
        with pytest.raises(NoSolution, match="speeding up"):
            at_use(eight.model, rows, impossible)
    with pytest.raises(InputError, match="factor"):
        stretched(eight.model, rows, 0.0)


def test_an_ellipsoid_limits_like_its_box_along_an_axis() -> None:
    path: Path = PATHS["straight"]
    grid = grid_of(path, 60)
    shape = Geometry.of(MODELS["kiwi"], path, grid, np.array([0.0, 1.0]))
    found = plan(MODELS["kiwi"], path, Request(points=60), grid=grid)
    free = replace(found.rows, c=np.full_like(found.rows.c, 1e6))
    round_ = convex_profile(
        grid.step,
        free,
        ellipsoids=Ellipsoids(
            Q=np.diag([1.0 / 0.4, 1.0, 1.0]),
            push=np.swapaxes(shape.push, 0, 1),
            bend=np.swapaxes(shape.bend, 0, 1),
        ),
    )
    assert round_.duration_s == pytest.approx(2.0 * np.sqrt(1.0 / 0.4), rel=2e-3)  # 1 m at ±0.4 m/s²
    with pytest.raises(NoSolution, match="convex profile"):
        convex_profile(grid.step, replace(found.rows, c=-np.abs(found.rows.c)))


@pytest.mark.parametrize(("start", "end"), [(0.3, 0.0), (0.0, 0.3), (0.6, 0.5)])
def test_a_path_may_begin_and_end_at_speed_whatever_the_motor(start: float, end: float) -> None:
    """Any stall torque made a start at 0.3 m/s impossible: the torque–speed line was touched at rest."""
    way = through(np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]))
    found = plan(MODELS["motor"], way, Request(start_m_s=start, end_m_s=end))
    assert np.sqrt(found.x[[0, -1]]) == pytest.approx([start, end])
    rest = plan(MODELS["motor"], way)
    assert found.duration_s < rest.duration_s and np.sqrt(rest.highest[0]) > 0.6


def test_motors_are_used_as_far_as_their_line_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three passes ended where each next one still went faster: 6 % of the time on a straight path."""
    way = through(np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]))
    found = plan(MODELS["motor"], way)
    monkeypatch.setattr("slipmargin.paths.plan.SETTLING", 40)
    monkeypatch.setattr("slipmargin.paths.plan.MOST_SETTLING", 40)
    assert found.duration_s == pytest.approx(plan(MODELS["motor"], way).duration_s, rel=1e-4)


CAR = nominal_model(
    replace(
        four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.1),
        motor=Motor(max_speed_rad_s=32.0, stall_torque_N_m=2.3),
    ),
    "paper",
)


def test_no_torque_is_asked_for_at_the_motors_top_speed() -> None:
    """Ten metres straight ahead could not be planned, five and six could: 1e-12 N m of 1e-12 N m."""
    found = plan(CAR, through(np.array([[0, 0, 0], [0, 10.0, 0]])), Request(share=0.9))
    assert np.max(found.audit.speed) == pytest.approx(1.0, abs=1e-9)  # at the motors' top speed
    assert np.max(found.audit.torque) <= 0.9 * (1.0 + 1e-6)


def test_a_coarse_grid_is_not_slower_than_a_fine_one() -> None:
    """The rows of a motor over a long interval stopped the robot in the middle: 12 percent of the time."""
    around = through(np.array([[0, 0, 0], [0, 5.0, 0], [-5.0, 5.0, 3.0]]))
    times = [plan(CAR, around, Request(share=0.9, points=n)).duration_s for n in (25, 100, 400)]
    assert max(times) <= 1.003 * min(times)


@pytest.mark.parametrize("asked", [0.8, 1.2, 2.0, 3.0])
@pytest.mark.parametrize("end", ["start_m_s", "end_m_s"])
def test_the_speed_that_is_said_to_be_possible_is(end: str, asked: float) -> None:
    """1.15 m/s was refused with 'at most 1.109', 1.109 with 'at most 0.3705', and 1.1 could be planned."""
    short = corners(np.array([[0, 0, 0], [0.1, 0, 0]]))
    with pytest.raises(InputError, match=end.split("_")[0] + " speed") as refused:
        plan(CAR, short, Request(points=60, **{end: asked}))
    most = float(re.search(r"at most ([\d.]+) m/s", str(refused.value))[1])  # type: ignore[index]
    assert 0.3 < most < asked
    found = plan(CAR, short, Request(points=60, **{end: most}))
    reached = found.x[0] if end == "start_m_s" else found.x[-1]
    assert np.sqrt(reached) == pytest.approx(most, rel=1e-6)
    with pytest.raises(InputError):
        plan(CAR, short, Request(points=60, **{end: most * 1.02}))


def test_what_does_not_settle_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motor that was asked for too much was called a wheel that uses 0.78 of its grip."""
    monkeypatch.setattr("slipmargin.paths.plan.ROUNDS", 1)
    around = through(np.array([[0, 0, 0], [0, 5.0, 0], [-5.0, 5.0, 3.0]]))
    with pytest.raises(NoSolution, match=r"wheel \w+ still uses 0\.9\d* of its motor torque, where 0\.9 is"):
        plan(CAR, around, Request(share=0.9, points=60))


def test_a_wheel_that_is_rigid_all_round_does_not_stand_on_rollers() -> None:
    """Its plan was made for rollers that it has not got, and missed by 990 mm."""
    rollers = kiwi()
    rim = replace(rollers, wheels=tuple(replace(w, rigid_fraction=1.0) for w in rollers.wheels))
    model = nominal_model(rim, "paper")
    np.testing.assert_array_equal(model.grip.roller, model.grip.rigid)
    assert not np.array_equal(model.grip.rigid, nominal_model(rollers, "paper").grip.roller)
    with pytest.raises(NoSolution, match="even at constant speed wheel"):
        plan(model, PATHS["straight"], Request(points=60))
    assert any("no effect, since every wheel is rigid all round" in said for said in warnings(rim))


@pytest.mark.parametrize("margin", [0.1, 0.22, 0.35, 0.5])
def test_a_high_robot_is_unstable_where_the_simulator_lifts_a_wheel(margin: float) -> None:
    """A plan kept its share of tipping, the simulator lifted a wheel, and no word said why."""
    high = high_kiwi()
    found = sm.plan(high, "floor", [[0, 0, 0], [0, 3, 0]], margin=margin, points=60, verify=True)
    (proof,) = found.simulated.values()
    grows = growth_per_s(found.plan.model, found.plan.states())
    told = any("let a small slip grow" in said for said in found.warnings)
    assert told == (np.max(grows) > 0.0) == (proof.lifts_s is not None) == (margin < 0.3)
    rows = found.trajectory
    checked = sm.check(high, "floor", rows, margin=margin)
    assert told == any("let a small slip grow" in said for said in checked.warnings)
    bounded = sm.bounds(high, "floor", margin=margin, step_deg=15.0)
    assert told == any("starts and stops at the limit" in said for said in bounded.warnings)


def test_low_robots_and_loads_that_do_not_shift_are_stable() -> None:
    for name in ("mecanum", "kiwi"):
        found = plan(MODELS[name], PATHS["turning"], Request(points=60))
        assert np.max(growth_per_s(found.model, found.states())) <= 0.0
        assert not unsteady(found.model, found.states())


def test_a_table_too_coarse_to_be_checked_is_refused() -> None:
    """A step longer than the motion gave two rows of a robot at rest, which the simulation proved."""
    found = plan(MODELS["kiwi"], PATHS["straight"], Request(points=60))
    with pytest.raises(
        InputError, match=r"step_s: is 100 s and gives 2 rows over .* needs 6, take a step up to"
    ) as no:
        trajectory(found, step_s=100.0)
    longest = float(no.value.cure.split()[-2])
    assert len(trajectory(found, step_s=longest).t_s) == LEAST_SAMPLES


def test_a_table_that_leads_off_the_plans_end_is_said() -> None:
    """Steps of 0.3 s led a turning robot 0.1 m off, and the simulation was blamed."""
    way = [[0, 0, 0], [1, 0, 6.0]]
    fine, coarse = (sm.plan("mecanum4", "floor", way, points=60, step_s=step) for step in (0.005, 0.3))
    assert not any(line.startswith("step: ") for line in fine.warnings)
    (said,) = (line for line in coarse.warnings if line.startswith("step: "))
    assert "a row every 0.3 s, lead " in said and said.endswith("take a shorter step")
    assert rolled(fine.trajectory) == pytest.approx(fine.trajectory.pose[-1], abs=1e-3)
    # the simulator agrees: what it adds is creep
    proof = coarse.simulated_again(coarse.trajectory)
    off = rolled(coarse.trajectory) - coarse.trajectory.pose[-1]
    assert proof.drift_m == pytest.approx(float(np.hypot(*off[:2])), abs=0.02)
