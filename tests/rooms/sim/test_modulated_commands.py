"""Commands modulated over their own size, between the rows too."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings, strategies as st
from strategies import kiwi

from slipmargin.effects import AnyEffect
from slipmargin.effects.command_dead_band import CommandDeadBand
from slipmargin.effects.command_saturation import CommandSaturation
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.speed_droop import SpeedDroop
from slipmargin.model import nominal_model
from slipmargin.physics.terms import basis_values
from slipmargin.physics.variables import Basis
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear


def turned(t: np.ndarray, omega: np.ndarray, *effects: AnyEffect) -> np.ndarray:
    """How far each wheel turns under commands (T, 3) [rad]."""
    model = with_effects(nominal_model(kiwi(), "paper"), effects)
    batch = Batch([linear(t, omega)], [np.array([0.0, t[-1]])], commanded=True)
    theta = batch.run(pack(model), np.zeros(3), tell=True).theta
    assert theta is not None
    return np.asarray(theta[0, -1] - theta[0, 0])


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), band=st.floats(0.3, 4.0))
def test_a_wheel_stands_while_its_command_crosses_the_band(seed: int, band: float) -> None:
    """Of two rows on either side of the band the wheel heard nothing of it."""
    draw = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(draw.uniform(0.05, 0.5, 4))])
    omega = draw.uniform(-10.0, 10.0, (5, 3))
    fine = np.linspace(0.0, t[-1], 40001)
    asked = np.column_stack([np.interp(fine, t, column) for column in omega.T])
    stands = basis_values(Basis.STEP, np.array([band, 0.05 * band]), 1, np.abs(asked).ravel())[:, 0]
    real = asked * (1.0 - stands.reshape(asked.shape))
    exact = np.trapezoid(real, fine, axis=0)
    np.testing.assert_allclose(turned(t, omega, CommandDeadBand(dead_band_rad_s=band)), exact, atol=2e-4)


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    top=st.floats(1.0, 12.0),
    everyone=st.floats(1.0, 12.0),
    factor=st.floats(0.5, 1.5),
)
def test_a_wheel_turns_no_faster_than_its_top_speed(
    seed: int, top: float, everyone: float, factor: float
) -> None:
    """Between the rows too, whatever its drive makes of a command; the slower of two top speeds counts.

    A wheel with two of them turned at their product over its command, and a gain came after them.
    """
    draw = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.cumsum(draw.uniform(0.05, 0.5, 4))])
    omega = draw.uniform(-10.0, 10.0, (5, 3))
    fine = np.linspace(0.0, t[-1], 40001)
    real = factor * np.column_stack([np.interp(fine, t, column) for column in omega.T])
    real = np.clip(real, -everyone, everyone)
    real[:, 1] = np.clip(real[:, 1], -top, top)
    slow = CommandSaturation(saturation_s_per_rad=1.0 / top, wheels=(kiwi().wheels[1].name,))
    others = CommandSaturation(saturation_s_per_rad=1.0 / everyone)
    gain = SpeedDroop(droop_rad_s_per_N_m=0.0, speed_factor=factor)
    told = turned(t, omega, others, slow, gain)
    np.testing.assert_allclose(told, np.trapezoid(real, fine, axis=0), atol=2e-4)
