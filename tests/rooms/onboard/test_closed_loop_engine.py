"""The limiter on an engine with real rollers (MuJoCo): what it lets through hardly slips."""

from __future__ import annotations

import driving
import numpy as np
import pytest

import slipmargin as sm

pytest.importorskip("mujoco", reason="the engine with real rollers needs MuJoCo")

from engines.rollers import Engine


def slipped(engine: Engine, twists: np.ndarray) -> float:
    """Largest drive slip [m/s] of any wheel, over 20 ms, while the wheels follow twists on straight lines."""
    t = driving.TICK_S * np.arange(len(twists))
    speeds = engine.geometry.wheel_speeds(twists)

    def at(now: float) -> np.ndarray:
        return np.array([np.interp(now, t, column) for column in speeds.T])

    log = engine.run(at, float(t[-1]))
    mean = np.apply_along_axis(lambda c: np.convolve(c, np.ones(20) / 20.0, "valid"), 0, log.slip_m_s)
    return float(np.max(np.abs(mean)))


@pytest.mark.parametrize("named", [("ohio-kiwi", "paper"), ("omni4", "floor")], ids=lambda n: n[0])
def test_commands_that_it_lets_through_hardly_slip_on_real_rollers(named: tuple[str, str]) -> None:
    recipe = sm.read_robot(named[0], rigid_sectors=False, load_model="quasi-static")
    model, limiter = recipe.build(named[1]), sm.Limiter(recipe, named[1], margin=0.2)
    wanted = driving.wishes(model, 3, 100)
    kept = driving.commanded(driving.slip_limit(limiter), wanted)
    change = np.abs(np.diff(kept, axis=0)) / driving.TICK_S
    clipped = driving.commanded(driving.axis_limit(1.5 * change.max(axis=0)), wanted)
    little = slipped(Engine(recipe.robot, named[1]), kept)
    much = slipped(Engine(recipe.robot, named[1]), clipped)

    assert little < 0.02 < much
