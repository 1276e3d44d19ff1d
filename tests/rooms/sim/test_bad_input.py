"""Refused at the door, or stopped with the time and the reason; never a NaN in an output."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels, kiwi

from slipmargin.errors import InputError, MotionStopped
from slipmargin.model import nominal_model
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable
from slipmargin.robot import LoadRule
from slipmargin.sim.batch import Batch, Ending, Push
from slipmargin.sim.pack import pack, stack
from slipmargin.sim.run import Run
from slipmargin.sim.signal import WheelSignal, angles, held, hermite, linear
from slipmargin.sim.simulate import simulate

T = np.array([0.0, 0.5, 1.0])
W = np.tile([1.0, 1.0, -4.0], (3, 1))


@pytest.mark.parametrize(("make", "says"), [
    (lambda: held(np.array([0.0, 0.0, 1.0]), W), "row 2 is at 0 s"),
    (lambda: linear(np.array([0.0, 2.0, 1.0]), W), "time must increase"),
    (lambda: held(T, np.full((3, 3), np.nan)), "not finite"),
    (lambda: held(T, W[:2]), "has shape"),
    (lambda: held(T, 1e7 * W), "below 1e6"),
    (lambda: held(T, W, end_s=0.5), "after the last row"),
    (lambda: held(T[:1], W[:1]), "makes no motion"),
    (lambda: held(T, W, theta0=np.zeros(2)), "has shape"),
    (lambda: hermite(T, W, W[:, :2]), "for every wheel"),
    (lambda: Push(t_s=np.array([1.0, 0.0]), wrench=np.zeros((2, 3))), "ascending times"),
    (lambda: Batch([], []), "at least one run"),
    (lambda: Batch([held(T, W)], []), "output times of each run"),
    (lambda: Batch([held(T, W)], [T], pushes=[]), "one push"),
    (lambda: Batch([held(T, W), held(T, W[:, :2])], [T, T]), "one robot's runs"),
    (lambda: Batch([held(T, W)], [np.array([0.5, 0.1])]), "ascending output times"),
    (lambda: Batch([held(T, W)], [np.array([0.0, 1.5])]), "within the wheels' data"),
])  # fmt: skip
def test_refused_at_the_door(make, says):
    with pytest.raises(InputError, match=says):
        make()


def test_wrong_wheel_count_is_refused():
    with pytest.raises(InputError, match="the robot has 4"):
        simulate(nominal_model(four_wheels(), "paper"), held(T, W), T)
    with pytest.raises(InputError, match=r"between 1e-13 and 0\.1"):
        simulate(nominal_model(kiwi(), "paper"), held(T, W), T, rtol=1.0)
    model = nominal_model(kiwi(), "paper")
    short = Multiplier(variable=Variable.UNITY, basis=Basis.CONSTANT, coefficients=np.ones(1),
                       shape=np.ones(2),
                       wheels=np.ones(2), target=Target.BOTH)  # fmt: skip
    with pytest.raises(InputError, match="one weight a wheel"):
        pack(replace(model, grip=replace(model.grip, multipliers=(short,))))
    told = replace(short, wheels=np.ones(3), variable=Variable.COMMAND_SPEED)
    with pytest.raises(InputError, match="ROLLING_SPEED"):
        pack(replace(model, grip=replace(model.grip, multipliers=(told,))))
    vast = replace(model, grip=replace(model.grip, k_s_per_m=np.inf))
    with pytest.raises(InputError, match="not finite"):
        pack(vast)


def test_a_force_that_tips_the_robot_stops_it_with_the_time():
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.9)
    model = nominal_model(robot, "carpet")
    signal = held(np.array([2.0, 3.0]), np.zeros((2, 4)))
    push = Push(t_s=np.array([2.0, 3.0]), wrench=np.array([[0.0, 0.0, 0.0], [0.0, 400.0, 0.0]]))
    with pytest.raises(MotionStopped, match="a wheel lifts off") as stop:
        simulate(model, signal, np.linspace(2.0, 3.0, 11), push=push)
    assert 2.0 < stop.value.time_s < 3.0
    outcome = Batch([signal], [np.linspace(2.0, 3.0, 11)], pushes=[push]).run(
        pack(model), np.zeros(3), tell=True
    )
    assert outcome.ending[0] == Ending.TIPS
    assert all(np.isfinite(a).all() for a in (outcome.pose, outcome.slip, outcome.force, outcome.load))
    np.testing.assert_array_equal(outcome.pose[0, -1], outcome.pose[0, -2])


def test_an_overflowing_push_is_a_stop_not_a_nan():
    model = nominal_model(kiwi(), "paper")
    push = Push(t_s=np.array([0.0, 1.0]), wrench=np.array([[0.0, 0.0, 0.0], [1e300, 0.0, 1e305]]))
    batch = Batch([held(T, W)], [T], pushes=[push])
    outcome = batch.run(pack(model), np.zeros(3), max_steps=20000)
    assert outcome.ending[0] != Ending.DONE
    assert np.isfinite(outcome.pose).all()
    with pytest.raises(MotionStopped, match="motion stopped at t ="):
        simulate(model, held(T, W), T, push=push)


def test_too_many_steps_is_an_ending():
    outcome = Batch([held(T, W)], [T]).run(pack(nominal_model(kiwi(), "paper")), np.zeros(3), max_steps=5)
    assert outcome.ending[0] == Ending.TOO_LONG and outcome.stopped_s[0] < 1.0


def test_a_batch_is_its_runs():
    """Several models × several signals in one call give what each gives alone, padded with the last pose."""
    models = [pack(nominal_model(kiwi(delta), "paper")) for delta in (15.0, 30.0)]
    bent = Multiplier(variable=Variable.SLIP_SPEED, basis=Basis.DECAY, coefficients=np.ones(1) * 0.3,
                      shape=np.array([0.03, 2.0]), wheels=np.ones(3))  # fmt: skip
    model = nominal_model(kiwi(), "paper")
    models.append(pack(replace(model, grip=replace(model.grip, multipliers=(bent,)))))
    signals = [held(T, W), linear(T, 0.5 * W), angles(T + 4.0, W * T[:, None])]
    times = [np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 9), np.linspace(4.0, 5.0, 3)]
    which, signal = np.array([0, 1, 2, 2, 0]), np.array([0, 1, 2, 0, 2])
    start = np.arange(15.0).reshape(5, 3) * 0.1
    twist = np.full((5, 3), 0.05)
    together = Batch(signals, times).run(stack(models), start, start_twist=twist, which=which, signal=signal)
    for r in range(5):
        s = signal[r]
        alone = Batch([signals[s]], [times[s]]).run(models[which[r]], start[r], start_twist=twist[r])
        np.testing.assert_array_equal(together.pose[r, : len(times[s])], alone.pose[0])
        np.testing.assert_array_equal(
            together.pose[r, len(times[s]) :], np.tile(alone.pose[0, -1], (9 - len(times[s]), 1))
        )
        np.testing.assert_allclose(alone.pose[0, 0], start[r], atol=1e-15)


def test_a_run_checks_its_shapes():
    run = simulate(nominal_model(kiwi(com_m=(0.01, 0.02)), "paper"), held(T, W), np.linspace(0.0, 1.0, 101),
                   start_twist=np.array([0.05, 0.0, 0.1]))  # fmt: skip
    np.testing.assert_allclose(run.velocity[0], [0.05, 0.0, 0.1], atol=1e-12)
    slope = np.gradient(run.pose, run.t_s, axis=0)[
        20:45
    ]  # the velocity is the floor-frame derivative of the pose
    np.testing.assert_allclose(run.velocity[20:45], slope, atol=2e-3)
    names = list(run.columns())
    assert names[:7] == ["t_s", "x_m", "y_m", "phi_rad", "vx_m_s", "vy_m_s", "wz_rad_s"]
    assert names[7:] == [f"{q}{i}{u}" for q, u in (
        ("theta", "_rad"), ("slip_drive", "_m_s"), ("slip_transverse", "_m_s"), ("force_drive", "_N"),
        ("force_transverse", "_N")) for i in (1, 2, 3)]  # fmt: skip
    assert run.duration_s == 1.0
    with pytest.raises(InputError, match="goes back in time"):
        replace(run, t_s=run.t_s[::-1].copy())
    with pytest.raises(InputError, match="pose: has shape"):
        replace(run, pose=run.pose[:-1])
    assert isinstance(run, Run)


def test_a_signal_checks_its_shapes():
    with pytest.raises(InputError, match="pieces"):
        WheelSignal(knots_s=T, pieces=np.zeros((1, 3, 4)), spin_rad_s=np.zeros(3))
