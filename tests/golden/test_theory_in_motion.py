"""Birth certificate: docs/theory.md, section 4 ("Motion is not statics"), computed independently.

Paper surface (μ_W 0.26, μ_T 0.09), δ = 15°, m = 3 kg, I = 0.027 kg m², radius 0.095 m, equal loads, φ = 0.
Each tolerance is half a unit of the last digit printed there.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracles.drive_shares import drive_shares
from strategies import kiwi

from slipmargin.limits.motion import acceleration_limit, needed_share
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model

#: g · 0.16705, the static limit per unit of weight on paper along X (docs/theory.md, section 2, table).
STATIC_ALONG_X = 9.81 * 0.16705


@pytest.fixture
def model() -> Model:
    return nominal_model(kiwi(), "paper")


def moving(direction: tuple[float, float, float]) -> Motion:
    return Motion(velocity=np.array([direction]), saturated=True)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "printed"),
    [
        ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.5017),
        ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 1.6388),
        ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 1.1958),
        ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), 2.0891),
        ((0.0, -1.0, 0.0), (0.0, -1.0, 0.0), 1.1958),
        ((0.0, -1.0, 0.0), (0.0, 1.0, 0.0), 2.0891),
    ],
)
def test_the_table_of_section_4(
    model: Model,
    velocity: tuple[float, float, float],
    acceleration: tuple[float, float, float],
    printed: float,
) -> None:
    limit = acceleration_limit(model, moving(velocity), np.array([acceleration]))
    assert limit.value[0] == pytest.approx(printed, abs=5e-5)
    assert limit.cause == ("grip",)


def test_braking_along_x_is_the_static_limit_and_speeding_up_a_third_of_it(model: Model) -> None:
    up = acceleration_limit(model, moving((1.0, 0.0, 0.0)), np.array([[1.0, 0.0, 0.0]])).value[0]
    down = acceleration_limit(model, moving((1.0, 0.0, 0.0)), np.array([[-1.0, 0.0, 0.0]])).value[0]
    assert down == pytest.approx(STATIC_ALONG_X, abs=5e-5 * 9.81)
    assert STATIC_ALONG_X / up == pytest.approx(3.3, abs=0.05)  # "3.3 times too optimistic"


def test_steady_motion_already_uses_half_the_grip(model: Model) -> None:
    share = drive_shares(model, moving((1.0, 0.0, 0.0)))[0]
    # "0.531 of μ_W N on wheel 3 and 0.266 on wheels 1, 2 along X"
    assert np.abs(share) == pytest.approx([0.266, 0.266, 0.531], abs=5e-4)
    assert needed_share(model, moving((1.0, 0.0, 0.0)))[0] == pytest.approx(0.531, abs=5e-4)


def test_the_realised_distribution_agrees_where_the_drag_is_full(model: Model) -> None:
    fast = Motion(velocity=np.array([[50.0, 0.0, 0.0]]), acceleration=np.zeros((1, 3)))
    rear = 2.0 * np.cos(np.pi / 12) / (1.0 + np.sin(np.pi / 12)) * 0.09 / 0.26  # Σ Fx = Σ Mz = 0 by hand
    assert realised(model, fast).use[0] == pytest.approx([rear / 2, rear / 2, rear], abs=2e-5)


def test_on_rigid_sectors_some_directions_must_slip_even_at_constant_speed(model: Model) -> None:
    way = np.deg2rad(np.arange(0.0, 360.0, 5.0))
    every = Motion(velocity=np.column_stack([np.cos(way), np.sin(way), 0.0 * way]), saturated=True)
    rollers, rigid = (needed_share(model, every, contact=c) for c in (Contact.ROLLERS, Contact.UNKNOWN))
    assert np.max(rollers) < 1.0 < np.max(rigid)
