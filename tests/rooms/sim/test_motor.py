"""Wheels that answer to load: exact lags, droop and the torque–speed line against a plain integration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.plain_simulator import acceleration
from scipy.integrate import solve_ivp

from slipmargin.errors import InputError
from slipmargin.model.parts import Drives
from slipmargin.paper.published import FOUND, command, paper_model
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import held, linear
from slipmargin.sim.simulate import simulate

RATES = np.array([[0.0, 0.0, 0.0], [4.0, 2.0, -6.0], [4.0, 2.0, -6.0]])
KNOTS = np.array([0.0, 0.1, 0.4])


def model_with(improved: bool = False, **changes):
    model = paper_model("paper", improved=improved)
    return replace(model, actuators=replace(model.actuators, **changes))


def by_hand(model, asked, seconds, line=None, inertia=None):
    """Pose, speed and angle of the wheels by SciPy, the equations written out again."""

    def rhs(t, s):
        y, omega = s[:6], s[6:9]
        acc, _, force, _ = acceleration(
            model, t, y, (s[9:], omega, np.zeros(3)), np.zeros(3, bool), np.zeros(3)
        )
        xy = force[0][:, None] * model.geometry.grip + force[1][:, None] * model.geometry.free
        torque = -model.geometry.radius_m * np.sum(xy * model.geometry.drive, axis=1)
        tr = model.actuators
        rising = (asked(t + 1e-9) - asked(t)) / 1e-9
        rate = (asked(t) - tr.droop_rad_s_per_N_m * torque - omega) / np.maximum(tr.lag_s, 1e-4)
        rate = rate + np.where(tr.lag_s == 0.0, rising, 0.0)
        if line is not None:
            motor = np.clip(
                torque + inertia * rate, -line[0] * (1 + omega / line[1]), line[0] * (1 - omega / line[1])
            )
            rate = (motor - torque) / inertia
        c, sn, w = np.cos(y[2]), np.sin(y[2]), y[5]
        body = [c * y[3] - sn * y[4], sn * y[3] + c * y[4], w, acc[0] + w * y[4], acc[1] - w * y[3], acc[2]]
        return np.concatenate([body, rate, omega])

    out, start = np.zeros(12), 0.0
    for stop in (0.1, seconds):
        out = solve_ivp(rhs, (start, stop), out, method="LSODA", rtol=1e-9, atol=1e-11).y[:, -1]
        start = stop
    return out


def ramp(t):
    return np.array([4.0, 2.0, -6.0]) * min(t / 0.1, 1.0)


@pytest.mark.parametrize("case", ["droop", "line", "each its own line"])
def test_loaded_wheels_agree_with_a_plain_integration(case):
    model = model_with(lag_s=np.array([0.03, 0.02, 0.0]), droop_rad_s_per_N_m=np.full(3, 8.0))
    line = inertia = None
    if case != "droop":
        stall = 0.035 if case == "line" else np.array([0.035, np.inf, 0.02])
        line, inertia = (stall, 20.0), 2e-4
        drives = Drives(max_speed_rad_s=line[1], stall_torque_N_m=line[0], wheel_inertia_kg_m2=inertia)
        model = replace(model, drives=drives)
    batch = Batch([linear(KNOTS, RATES)], [np.array([0.0, 0.4])], commanded=True)
    outcome = batch.run(pack(model), np.zeros(3), tell=True, rtol=1e-8)
    want = by_hand(model, ramp, 0.4, line, inertia)
    np.testing.assert_allclose(outcome.pose[0, -1], want[:3], rtol=1e-5, atol=1e-8)
    assert outcome.theta is not None
    np.testing.assert_allclose(outcome.theta[0, -1], want[9:], rtol=1e-6)


def test_droop_makes_a_loaded_wheel_slower():
    batch = Batch([linear(KNOTS, RATES)], [np.array([0.0, 0.4])], commanded=True)
    free = batch.run(pack(model_with()), np.zeros(3)).pose[0, -1]
    slow = batch.run(pack(model_with(droop_rad_s_per_N_m=np.full(3, 20.0))), np.zeros(3)).pose[0, -1]
    assert np.hypot(*slow[:2]) < 0.95 * np.hypot(*free[:2])


def test_sectors_of_driven_wheels_are_found():
    """A droop of next to nothing must give the motion of the exact lag, switches included."""
    batch = Batch([command(FOUND.angles_rad)], [np.array([0.0, 4.5])], commanded=True)
    lag = np.full(3, 0.03)
    exact = batch.run(pack(model_with(True, lag_s=lag)), np.zeros(3), rtol=1e-8).pose[0, -1]
    states = pack(model_with(True, lag_s=lag, droop_rad_s_per_N_m=np.full(3, 1e-12)))
    np.testing.assert_allclose(batch.run(states, np.zeros(3), rtol=1e-8).pose[0, -1], exact, atol=3e-7)


def test_an_exact_lag_is_the_exponential():
    """A step of ω through a first-order lag: θ = ω (t − T (1 − e^(−t/T))), after the dead time and gain."""
    model = model_with(lag_s=np.full(3, 0.08), delay_s=0.05, gain=np.array([1.0, 0.9, 1.1]))
    omega = np.array([3.0, -2.0, 1.0])
    batch = Batch([held(np.array([0.0, 0.5]), np.stack([omega, omega]))], [np.array([0.0, 0.04, 0.3, 0.5])],
                  commanded=True)  # fmt: skip
    theta = batch.run(pack(model), np.zeros(3), tell=True).theta
    assert theta is not None
    for k, t in enumerate((0.0, 0.0, 0.25, 0.45)):
        want = model.actuators.gain * omega * (t - 0.08 * (1.0 - np.exp(-t / 0.08)))
        np.testing.assert_allclose(theta[0, k], want, atol=1e-12)


@pytest.mark.parametrize(
    ("wheels", "rtol"),
    [({"lag_s": np.full(3, 0.004)}, 1e-4), ({"droop_rad_s_per_N_m": np.full(3, 8.0)}, 1e-5)],
    ids=["lag", "droop"],
)
def test_what_follows_a_step_of_the_commands_is_not_stepped_over(wheels, rtol):
    """Commands at 30 Hz that are held, wheels that follow at once: poses keep to three tolerances [m]."""
    t = np.arange(60) / 30.0
    speed = 40.0 * np.sin(2.0 * np.pi * t / t[-1])
    signal = held(t, speed[:, None] * np.array([1.0, -0.4, -0.6]))
    model = model_with(**wheels)
    model = replace(model, grip=replace(model.grip, k_s_per_m=3000.0))
    batch = Batch([signal], [t], commanded=True)
    coarse, fine = (batch.run(pack(model), np.zeros(3), rtol=r).pose[0] for r in (rtol, 1e-9))
    assert np.abs(coarse - fine)[:, :2].max() < 3.0 * rtol
    assert np.abs(fine[:, :2]).max() > 0.2


def test_measured_wheels_ignore_the_drives():
    signal, times = [linear(KNOTS, RATES)], [np.array([0.0, 0.4])]
    lazy = pack(model_with(lag_s=np.full(3, 0.2), droop_rad_s_per_N_m=np.full(3, 9.0)))
    plain = pack(model_with())
    batch = Batch(signal, times, commanded=False)
    np.testing.assert_array_equal(batch.run(lazy, np.zeros(3)).pose, batch.run(plain, np.zeros(3)).pose)


def test_a_modulated_command_is_a_scaled_command():
    slack = Multiplier(variable=Variable.COMMAND_SPEED, basis=Basis.CONSTANT, coefficients=np.array([-0.25]),
                       shape=np.ones(2), wheels=np.array([1.0, 0.0, 1.0]))  # fmt: skip
    other = pack(model_with(gain=np.array([0.75, 1.0, 0.75])))
    batch = Batch([linear(KNOTS, RATES)], [np.array([0.0, 0.4])], commanded=True)
    np.testing.assert_allclose(batch.run(pack(model_with(multipliers=(slack,))), np.zeros(3)).pose,
                               batch.run(other, np.zeros(3)).pose, atol=1e-12)  # fmt: skip


def with_motors(stall, inertia=None, model=None):
    drives = Drives(max_speed_rad_s=40.0, stall_torque_N_m=stall, wheel_inertia_kg_m2=inertia)
    return replace(model or model_with(), drives=drives)


def end(model, signal=None, rtol=1e-8, commanded=True):
    """Where the robot ends, and which share of its stall torque its motors used at most."""
    signal = signal or linear(KNOTS, RATES)
    batch = Batch([signal], [np.array([0.0, signal.knots_s[-1]])], commanded=commanded)
    return batch.run(pack(model), np.zeros(3), rtol=rtol).pose[0, -1]


def test_a_weak_motor_ends_elsewhere():
    """0.5 mN m at stall cannot turn wheels that need 40: the robot used to move as if it had no motors."""
    free = end(model_with())
    weak = end(with_motors(5e-4))
    assert np.hypot(*weak[:2]) < 0.2 * np.hypot(*free[:2])
    np.testing.assert_array_equal(end(with_motors(5e-4), commanded=False), free)  # measured wheels turned


def test_motors_that_never_saturate_change_nothing():
    """Along a command without steps the end differs by less than a millionth of the way."""
    np.testing.assert_allclose(end(with_motors(2.0)), end(model_with()), atol=1e-6 * 0.05)


def test_the_inertia_taken_for_a_wheel_decides_nothing():
    """Half of it moves the end of a run with saturated motors by less than 0.5 % of the way."""
    model = with_motors(0.02)
    light = float(model.drives.wheel_inertias(model.inertia.mass_kg, model.geometry.radius_m)[0])
    here, half, free = end(model), end(with_motors(0.02, 0.5 * light)), end(model_with())
    assert np.hypot(*(here - free)[:2]) > 0.05 * np.hypot(*free[:2])  # it does saturate
    assert np.abs(here - half).max() < 0.005 * np.hypot(*free[:2])
    np.testing.assert_array_equal(end(with_motors(0.02, light)), here)


def test_torque_keeps_to_the_line_of_the_motor():
    """Motor torque T + J ω̇ from a run's forces and angles stays within ± stall (1 ∓ ω/max_speed)."""
    stall, inertia = 0.02, 1e-4
    model = with_motors(stall, inertia)
    times = np.linspace(0.0, 0.4, 2001)
    run = simulate(model, linear(KNOTS, RATES), times, commanded=True)
    omega = np.gradient(run.theta, times, axis=0)
    torque = -model.geometry.radius_m * run.force[..., 0] + inertia * np.gradient(omega, times, axis=0)
    line = stall * (1.0 - omega / 40.0)
    assert np.all(torque[5:-5] <= line[5:-5] + 0.02 * stall)
    assert np.max(torque[5:-5] - line[5:-5]) > -0.01 * stall


def test_bad_motors_are_refused():
    with pytest.raises(InputError, match="positive inertia"):
        Drives(wheel_inertia_kg_m2=-1.0)
    slow = replace(model_with(), drives=Drives(max_speed_rad_s=5.0))
    with pytest.raises(InputError, match=r"wheel 3: is commanded to 6 rad/s, the motor reaches 5 rad/s"):
        simulate(slow, linear(KNOTS, RATES), np.array([0.0, 0.4]), commanded=True)
    simulate(slow, linear(KNOTS, RATES), np.array([0.0, 0.4]))  # measured: they did turn so fast
    tilt = Multiplier(variable=Variable.HEADING, basis=Basis.CONSTANT, coefficients=np.ones(1),
                      shape=np.ones(2),
                      wheels=np.ones(3))  # fmt: skip
    with pytest.raises(InputError, match="a drive cannot depend on HEADING"):
        pack(model_with(multipliers=(tilt,)))
