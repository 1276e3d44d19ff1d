"""Audits: derivatives from samples, the worst point, and the time scaling that cures."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.effects import GeneralEffect, Part, Recipe, Trace
from slipmargin.errors import InputError
from slipmargin.limits.motion import acceleration_limit
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import nominal_model
from slipmargin.paths.check import check, derivatives
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.paths.trajectory import Trajectory
from slipmargin.paths.verify import on_rollers, verify
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.report.paths import check_lines
from slipmargin.robot import Coefficients, LoadRule, Motor, Surface

KIWI = nominal_model(kiwi(), "paper")


def bang(a: float, t: np.ndarray) -> np.ndarray:
    """Along +X from rest with acceleration a, (T, 3)."""
    return np.column_stack([0.5 * a * t**2, 0.0 * t, 0.0 * t])


def test_parabolas_are_differentiated_exactly_at_uneven_times() -> None:
    rng = np.random.default_rng(2)
    t = np.cumsum(rng.uniform(0.003, 0.03, 200))
    pose = np.column_stack([1 + 2 * t - 0.7 * t**2, 0.3 * t**2, -t])
    velocity, acceleration = derivatives(t, pose)
    assert velocity == pytest.approx(np.column_stack([2 - 1.4 * t, 0.6 * t, -1 + 0 * t]), abs=1e-8)
    assert acceleration == pytest.approx(np.tile([-1.4, 0.6, 0.0], (200, 1)), abs=1e-6)


def test_a_robot_that_comes_to_rest_does_not_turn_round_in_its_last_step() -> None:
    """A parabola to one side gave it 1.6 mm/s backwards, and the drag turned round: 0.84 used for 0.70."""
    t = np.linspace(0.0, 1.0, 51)
    stops = np.column_stack([-((1.0 - t) ** 3), 0.0 * t, 0.0 * t])
    for pose in (stops, stops[::-1]):
        velocity, _ = derivatives(t, pose)
        assert velocity[-1, 0] * velocity[-2, 0] >= 0.0 and velocity[0, 0] * velocity[1, 0] >= 0.0
    assert derivatives(t, stops)[0][-1, 0] == 0.0 and derivatives(t, stops)[0][0, 0] == pytest.approx(
        3.0, rel=1e-3
    )


@pytest.mark.parametrize("step", [0.002, 0.01, 0.03])
def test_a_jump_in_acceleration_is_never_overshot(step: float) -> None:
    t = np.arange(0.0, 2.0, step)
    x = np.where(t < 1.003, 0.5 * t**2, 0.5 * 1.003**2 + 1.003 * (t - 1.003) - 0.5 * 2.0 * (t - 1.003) ** 2)
    _, a = derivatives(t, np.column_stack([x, x, x]))
    assert np.max(a) <= 1.0 + 1e-6 and np.min(a) >= -2.0 - 1e-6


def test_smoothing_tames_measured_noise() -> None:
    t = np.linspace(0.0, 3.0, 301)
    noisy = bang(0.3, t) + np.random.default_rng(0).normal(scale=5e-4, size=(len(t), 3))
    rough, smooth = (check(KIWI, t, noisy, smooth_s=s) for s in (0.0, 0.3))
    assert smooth.max_use < 1.0 < rough.max_use
    assert smooth.unsmoothed is not None and smooth.unsmoothed.max_use == rough.max_use
    said = check_lines(KIWI, smooth)
    assert said[-1] == f"smoothing   over 0.3 s decides: without it {check_lines(KIWI, rough)[0]}"
    assert check(KIWI, t, bang(0.3, t), smooth_s=0.3).unsmoothed is None


def test_a_window_that_averages_a_motion_away_is_refused() -> None:
    """Four seconds of smoothing made a jerk of two seconds admissible, without a word."""
    t = np.linspace(0.0, 2.0, 201)
    with pytest.raises(
        InputError, match=r"smooth_s: is 4 s, .* motion of 2 s away, .* a tenth of the motion, 0\.2 s"
    ):
        check(KIWI, t, bang(3.0, t), smooth_s=4.0)
    with pytest.raises(InputError, match="smooth_s: is -1"):
        check(KIWI, t, bang(3.0, t), smooth_s=-1.0)
    assert not check(KIWI, t, bang(3.0, t), smooth_s=0.2).admissible


def test_the_verdict_turns_at_the_limit() -> None:
    limit = acceleration_limit(
        KIWI, Motion(velocity=np.array([[1.0, 0, 0]]), saturated=True), np.array([[1.0, 0, 0]])
    ).value[0]
    t = np.linspace(0.0, 3.0, 301)
    below, above = (check(KIWI, t, bang(part * limit, t)) for part in (0.97, 1.03))
    assert below.admissible and below.time_scale_needed == 1.0
    assert not above.admissible and above.worst[3] == 2  # the rear wheel
    assert above.max_use == pytest.approx(0.531 + 1.03 * 0.469, abs=4e-3)
    # stretched by s the acceleration falls with s²: the cure is √1.03
    assert above.time_scale_needed == pytest.approx(np.sqrt(1.03), rel=2e-3)
    cured = check(KIWI, t * above.time_scale_needed, bang(1.03 * limit, t))
    assert cured.max_use <= 1.0 + 2e-4


def test_what_four_digits_show_at_the_limit_is_at_it() -> None:
    t = np.linspace(0.0, 3.0, 301)
    pose = bang(0.2, t)
    most = check(KIWI, t, pose).max_use
    at, above = (check(KIWI, t, pose, share=most - off) for off in (4e-5, 2e-4))
    assert at.admissible and not above.admissible


def test_a_plan_driven_faster_is_cured_by_the_same_factor() -> None:
    way = through(np.array([[0, 0, 0], [0.6, 0.4, 0.4], [1.2, 0.0, 0.0]]))
    rows = trajectory(plan(KIWI, way, Request(share=0.9, points=100)), step_s=0.01)
    assert check(KIWI, rows.t_s, rows.pose, share=0.9).admissible
    c, s = np.cos(3.0), np.sin(3.0)  # the whole world turned by 3 rad, headings jumping at ±π
    x, y, phi = rows.pose.T
    wrapped = np.column_stack([c * x - s * y, s * x + c * y, np.angle(np.exp(1j * (phi + 3.0)))])
    fast = check(KIWI, 0.8 * rows.t_s, wrapped, share=0.9)
    assert fast.time_scale_needed == pytest.approx(1.25, rel=5e-3)


def test_no_slowing_down_helps_where_constant_speed_slips() -> None:
    t = np.linspace(0.0, 3.0, 100)
    found = check(KIWI, t, np.column_stack([t, 0 * t, 0 * t]), contact=Contact.UNKNOWN)
    assert np.isinf(found.time_scale_needed) and not found.admissible


def test_motors_and_tipping_count() -> None:
    weak = nominal_model(replace(kiwi(), motor=Motor(max_speed_rad_s=20.0, stall_torque_N_m=0.2)), "paper")
    t = np.linspace(0.0, 3.0, 200)
    quick = check(weak, t, np.column_stack([0.6 * t, 0 * t, 0 * t]))  # 0.6/0.0254 = 23.6 rad/s
    assert not quick.admissible and np.max(quick.speed) == pytest.approx(0.6 / 0.0254 / 20.0)
    assert quick.time_scale_needed >= 0.6 / 0.0254 / 20.0 * (1.0 - 1e-5)
    tall = nominal_model(four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.9), "paper")
    jerk = check(tall, t, np.column_stack([0 * t, 1.5 * t**2, 0 * t]))
    assert np.min(jerk.load_N) < 0.0 and not jerk.admissible


def test_bad_trajectories_are_named() -> None:
    t = np.linspace(0.0, 1.0, 20)
    with pytest.raises(InputError, match="at least 6"):
        check(KIWI, t[:5], np.zeros((5, 3)))
    twice = t.copy()
    twice[7] = twice[6]
    with pytest.raises(InputError, match=r"row 8: is at .* not after"):
        check(KIWI, twice, np.zeros((20, 3)))
    gap = t.copy()
    gap[0] = -1e11  # beside steps of 0.05 s no digit of an acceleration is left
    with pytest.raises(InputError, match=r"row 2: is 1e\+11 s after the row before and 0.0526316 s before"):
        check(KIWI, gap, np.zeros((20, 3)))
    gap[0] = -1e4  # a long rest is read
    assert check(KIWI, gap, np.zeros((20, 3))).admissible
    with pytest.raises(InputError, match="finite"):
        check(KIWI, t, np.full((20, 3), np.nan))
    with pytest.raises(InputError, match="margin"):
        check(KIWI, t, np.zeros((20, 3)), share=0.0)


def test_standing_still_needs_no_cure() -> None:
    t = np.linspace(0.0, 1.0, 20)
    found = check(KIWI, t, np.zeros((20, 3)))
    assert found.admissible and found.max_use == 0.0


MOTORS = nominal_model(replace(kiwi(), motor=Motor(max_speed_rad_s=20.0, stall_torque_N_m=0.9)), "paper")


@pytest.mark.parametrize("contact", list(Contact))
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (1.23456789, -2.3, 0.7), (1e6, 1e-9, 400.0)])
def test_motors_at_a_standstill_need_nothing(pose: tuple[float, float, float], contact: Contact) -> None:
    t = np.linspace(0.0, 1.0, 20)
    with np.errstate(all="raise"):
        found = check(MOTORS, t, np.tile(pose, (20, 1)), contact=contact)
    assert found.admissible and found.max_use < 1e-9
    assert np.max(found.torque) < 1e-6 and np.max(found.speed) < 1e-6
    words = check_lines(MOTORS, found)
    assert words[2:] == [
        "motors      at most 0.0000 of the torque they have",
        "wheels      at most 0.0000 of their top speed",
    ]


def test_no_torque_left_at_the_top_speed_is_said_in_words() -> None:
    """The torque that is left at the top speed is none: a share of it has no number."""
    t = np.linspace(0.0, 3.0, 200)
    found = check(MOTORS, t, np.column_stack([0.6 * t, 0 * t, 0 * t]))  # 0.6/0.0254 = 23.6 rad/s
    words = check_lines(MOTORS, found)
    assert not any("inf" in line for line in words)
    assert words[2].startswith("motors      have no torque left at their top speed: wheel rear at t = ")
    assert words[3].startswith("wheels      at most 1.1811 of their top speed: wheel rear at t = ")
    assert ", but more than all of a motor's torque, 1 allowed: wheel rear at t = " in words[0]
    assert "; 1.1811 of a wheel's top speed, 1 allowed: wheel rear at t = " in words[0]


def test_what_lifts_and_what_lacks_torque_is_named_with_its_time() -> None:
    weak = nominal_model(replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.02)), "paper")
    t = np.linspace(0.0, 2.0, 100)
    words = check_lines(weak, check(weak, t, bang(0.3, t)))
    assert words[0].startswith("not admissible: uses at most") and ": wheel rear at t = " in words[2]
    grip, _, cause = words[0].partition(" of a wheel's grip, 1 allowed, but ")
    assert float(grip.split()[-1]) < 1.0  # the first line named the grip alone, which is within its limit
    assert " of a motor's torque, 1 allowed: wheel rear at t = " in cause
    tall = nominal_model(four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.9), "paper")
    words = check_lines(tall, check(tall, t, np.column_stack([0 * t, 1.5 * t**2, 0 * t])))
    (tips,) = [line for line in words if line.startswith("tips")]
    assert "wheel " in tips and " at t = " in tips and tips.endswith(": it lifts off")
    assert words[0].split(" of what lifts a wheel, 1 allowed: wheel ")[0].split()[-1] == tips.split()[1]


def test_tipping_keeps_the_margin_and_has_its_own_share() -> None:
    """0.95 of the acceleration that lifts a wheel passed with any margin: only lifting off counted."""
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.9)
    sticky = Surface(
        name="sticky",
        roller=Coefficients(drive=2.0, transverse=0.01),
        rigid=Coefficients(drive=2.0, transverse=2.0),
    )
    tall, t = nominal_model(replace(robot, surfaces=(sticky,)), "sticky"), np.linspace(0.0, 0.5, 100)
    lifting = 9.81 * 0.2 / 0.9  # forwards, over the rear wheels
    drive = np.column_stack([0 * t, 0.5 * 0.95 * lifting * t**2, 0 * t])
    found = check(tall, t, drive)
    assert found.admissible and np.max(found.tipping) == pytest.approx(0.95, abs=1e-6)
    strict = check(tall, t, drive, share=0.9)
    assert not strict.admissible and strict.max_use < 0.9
    assert strict.time_scale_needed == pytest.approx(np.sqrt(0.95 / 0.9), rel=1e-5)
    words = [line for line in check_lines(tall, strict) if line.startswith("tipping")]
    assert words and words[0].startswith(
        "tipping     at most 0.9500 of what lifts a wheel, 0.9 allowed: wheel f"
    )


def test_a_share_of_the_torque_is_kept_too() -> None:
    t = np.linspace(0.0, 1.0, 100)
    weak = nominal_model(replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.06)), "paper")
    loose = check(weak, t, bang(0.3, t))
    assert np.max(loose.torque) > 0.0
    scaled = replace(
        kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.06 * float(np.max(loose.torque)) / 0.95)
    )
    model = nominal_model(scaled, "paper")
    assert np.max(check(model, t, bang(0.3, t)).torque) == pytest.approx(0.95, abs=1e-6)
    assert check(model, t, bang(0.3, t)).admissible
    assert not check(model, t, bang(0.3, t), share=0.9).admissible


def test_no_torque_at_the_top_speed_is_no_excess() -> None:
    """0/0 and rounding over 0 were infinite."""
    speed = np.array([[20.0, -20.0, 10.0]])
    with np.errstate(all="raise"):
        share = torque_use(MOTORS, np.array([[0.0, 1e-18, 0.45]]), speed)
        lost = torque_use(MOTORS, np.array([[0.1, -0.1, 0.0]]), speed)
    assert share.tolist() == [[0.0, pytest.approx(1e-18 / 0.9), 1.0]]
    assert lost.tolist() == [[np.inf, np.inf, 0.0]]


@pytest.mark.parametrize(("axis", "size", "quick_s", "slow_s"), [(2, 1.5, 0.12, 0.8), (1, 0.005, 0.02, 0.3)])
def test_what_only_needs_to_be_slower_is_told_how_much(
    axis: int, size: float, quick_s: float, slow_s: float
) -> None:
    """A turn on the spot and a few millimetres at a walking pace: little slides across there at any speed."""
    t = np.linspace(0.0, 1.0, 61)
    pose = np.zeros((61, 3))
    pose[:, axis] = size * (10.0 * t**3 - 15.0 * t**4 + 6.0 * t**5)
    quick, slow = (check(KIWI, seconds * t, pose, share=0.9) for seconds in (quick_s, slow_s))
    assert slow.admissible and not quick.admissible
    assert 1.0 < quick.time_scale_needed < slow_s / quick_s


@pytest.mark.parametrize(("heading", "turns"), [(90.0, ["14.3 times"]), (0.5 * np.pi, [])])
def test_headings_that_look_like_degrees_are_said(heading: float, turns: list[str]) -> None:
    """A path of 8 m on which the robot turned by 259 rad was planned without a word."""
    found = sm.plan("omni4", "floor", [[0, 0, 0], [1, 0, heading]], points=50).warnings
    said = [line for line in found if line.endswith("headings are in radians")]
    assert len(said) == len(turns) and all(word in line for line, word in zip(said, turns, strict=True))


@pytest.mark.parametrize(
    ("headings", "told"),
    [
        ([3.1, -3.1], ["waypoints 1 and 2: the robot turns -355.2° .* phi_rad = 3.1832 for waypoint 2$"]),
        (
            [3.1, -3.1, -2.9, 3.0],
            [
                "waypoints 1 and 2: .* phi_rad = 3.1832 for waypoint 2, and add 6.2832 to those after it$",
                "waypoints 3 and 4: the robot turns 338° between them; .* phi_rad = 3 for waypoint 4$",
            ],
        ),
        ([0.0, 3.142, 0.0, -3.1], []),
    ],
)
def test_headings_that_turn_the_long_way_round_are_said(headings: list[float], told: list[str]) -> None:
    """From 3.1 to -3.1 a robot turned by 355°, where 5° the other way lead to the same heading."""
    places = [[float(k), 0.0, heading] for k, heading in enumerate(headings)]
    found = sm.plan("omni4", "floor", places, points=50)
    said = [line for line in found.warnings if line.startswith("waypoints")]
    assert len(said) == len(told)
    assert all(re.match(words, line) for words, line in zip(told, said, strict=True))
    short = np.unwrap(headings)
    if told:
        mended = sm.plan("omni4", "floor", [[float(k), 0.0, p] for k, p in enumerate(short)], points=50)
        assert not any(line.startswith("waypoints") for line in mended.warnings)


def test_a_circle_at_constant_speed_asks_the_wheels_for_no_acceleration() -> None:
    """A force by the acceleration that the wheels ask for: check counted the one towards the middle."""
    push = ForceTerm(
        variable=Variable.ACCELERATION_X,
        basis=Basis.POLYNOMIAL,
        shape=np.array([1.0, 0.0]),
        coefficients=np.array([[2.0], [0.0], [0.0]]),
        frame=Frame.BODY,
    )
    effect = GeneralEffect(traced_to=Trace.ACCELERATION, part=Part.LOSSES, terms=(push,))
    model = on_rollers(Recipe(robot=kiwi(), effects=(effect,)).build("paper"))
    t, radius = np.linspace(0.0, 2.0, 401), 0.8
    phi = 0.75 * t
    pose = np.column_stack([radius * np.cos(phi), radius * np.sin(phi), phi])
    found = check(model, t, pose)
    rows = Trajectory(
        t_s=t,
        pose=pose,
        velocity=found.velocity,
        acceleration=found.acceleration,
        omega=found.omega,
        use=found.use,
        wheels=model.geometry.names,
    )
    assert found.use[200] == pytest.approx(verify(model, rows).share[2000], abs=2e-3)
