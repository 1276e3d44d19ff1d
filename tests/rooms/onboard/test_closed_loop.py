"""The limiter in a closed loop: random aggressive commands never use more than the margin leaves."""

from __future__ import annotations

import driving
import pytest

import slipmargin as sm

#: How much more than the margin leaves a simulated wheel may use [1].
ALLOWED = 0.02


@pytest.mark.parametrize(
    "named", [("ohio-kiwi", "paper"), ("mecanum4", "floor"), ("robotino", "gray")], ids=lambda n: n[0]
)
def test_a_built_in_robot_keeps_its_margin_where_clipping_each_axis_does_not(named: tuple[str, str]) -> None:
    recipe = sm.read_robot(named[0], rigid_sectors=False)
    limiter, model = sm.Limiter(recipe, named[1], margin=0.2), recipe.build(named[1])
    rows = [driving.compared(model, limiter, seed, 200) for seed in range(2)]
    assert max(row["limiter"] for row in rows) <= 0.8 + ALLOWED
    assert max(row["per axis"] for row in rows) > 0.8 + 2 * ALLOWED
