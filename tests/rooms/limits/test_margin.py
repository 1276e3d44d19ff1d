"""Margins: distance and factor against facets, spheres and pulls."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import kiwi, models, reals

from slipmargin.errors import InputError
from slipmargin.limits import Pull, margin, wrench_set
from slipmargin.limits.margin import arm, sphere
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.robot import GripShape


@settings(max_examples=30, deadline=None)
@given(models(shapes=tuple(GripShape)), reals(-3.0, 3.0), reals(0.1, 0.9))
def test_factor_is_the_pulls_limit(model: Model, phi: float, share: float) -> None:
    force = limit(model, np.array([phi]), Pull())[0]
    wrench = share * force * Pull().rays(model, np.array([phi]))[0]
    assert margin(wrench_set(model), wrench).factor == pytest.approx(1.0 / share, rel=1e-6)


@settings(max_examples=30, deadline=None)
@given(models(shapes=tuple(GripShape)), reals(-3.0, 3.0), reals(0.0, 0.9))
def test_no_shift_shorter_than_the_distance_slips(model: Model, phi: float, share: float) -> None:
    wrenches = wrench_set(model)
    force = limit(model, np.array([phi]), Pull())[0]
    wrench = share * force * Pull().rays(model, np.array([phi]))[0]
    found = margin(wrenches, wrench)
    per = np.array([1.0, 1.0, found.length_m])
    normals = sphere(3000)

    def room(w: np.ndarray) -> float:  # least slack over many normals: negative only outside
        return float(np.min(wrenches.support(normals / per) + (normals / per) @ w))

    for step in sphere(40):
        assert room(wrench + 0.999 * found.distance_N * step * per) >= -1e-9 * force
    nearest = margin(wrenches, found.nearest)
    assert abs(nearest.distance_N) <= 1e-6 * force
    reach = np.linalg.norm((found.nearest - wrench) / per)
    assert reach == pytest.approx(found.distance_N, rel=1e-9)


def test_the_nearest_point_of_a_curved_set_lies_on_its_boundary() -> None:
    """Searched over normals alone it was 1e-7 of the pull off, and on a drawn robot 1e-5."""
    model = nominal_model(kiwi(grip=GripShape.DISC_STRIP), "paper")
    wrenches, phi = wrench_set(model), np.linspace(0.1, 6.2, 12)
    for force, ray in zip(limit(model, phi, Pull()), Pull().rays(model, phi), strict=True):
        for share in (0.0, 0.3, 0.6, 0.9):
            found = margin(wrenches, share * force * ray)
            assert abs(margin(wrenches, found.nearest).distance_N) <= 1e-9 * force


def test_distance_at_rest_of_one_facet_by_hand() -> None:
    # δ = 30°, paper: the weakest pure force is the support's least value over pure-force normals; with a
    # length so long that moments cost nothing, the nearest slip is a pure moment: m g μ_W r / ℓ.
    wrenches = wrench_set(nominal_model(kiwi(30.0), "paper"))
    found = margin(wrenches, np.zeros(3), length_m=1e6)
    assert found.distance_N == pytest.approx(3.0 * 9.81 * 0.26 * 0.095 / 1e6, rel=1e-9)
    assert found.factor == np.inf


@pytest.mark.parametrize("shape", GripShape)
def test_outside_is_negative(shape: GripShape) -> None:
    found = margin(wrench_set(nominal_model(kiwi(grip=shape), "paper")), np.array([20.0, 0.0, 0.0]))
    assert found.distance_N < 0.0
    assert found.factor < 1.0


def test_default_length_is_the_largest_lever_arm() -> None:
    wrenches = wrench_set(nominal_model(kiwi(radius_m=0.2), "paper"))
    assert arm(wrenches) == pytest.approx(0.2)
    assert margin(wrenches, np.zeros(3)).length_m == pytest.approx(0.2)


def test_limiting_wheels_are_named() -> None:
    assert set(margin(wrench_set(nominal_model(kiwi(), "paper")), np.array([1.0, 0.0, 0.0])).limiting) <= {
        "right",
        "left",
        "rear",
    }


@pytest.mark.parametrize(("wrench", "length"), [(np.zeros(2), None), (np.zeros(3), 0.0), (np.zeros(3), -1.0)])
def test_bad_input_is_refused(wrench: np.ndarray, length: float | None) -> None:
    with pytest.raises(InputError):
        margin(wrench_set(nominal_model(kiwi(), "paper")), wrench, length)
