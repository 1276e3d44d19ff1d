"""What binds, and derivatives against finite differences and against the linear program's duals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from strategies import four_wheels, kiwi, models

from slipmargin.limits import Pull, pull_limit, sensitivity, sweep
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.robot import GripShape

PHI = np.linspace(0.0, 6.0, 7) + 0.123  # away from symmetric headings, where facets meet
HIGH = Pull(height_m=0.05, point_m=np.array([0.05, 0.02]), direction_rad=0.3)


def shifted(model: Model, i: int, j: int, by: float) -> Model:
    step = np.zeros((model.count, 2))
    step[i, j] = by
    return replace(model, grip=replace(model.grip, roller=model.grip.roller + step))


@pytest.mark.parametrize("pull", [Pull(), HIGH])
@settings(max_examples=30, deadline=None)
@given(model=models(max_wheels=5), pick=st.integers(0, 9))
def test_box_derivatives(pull: Pull, model: Model, pick: int) -> None:
    found = sensitivity(model, PHI, pull)
    i, j = (pick // 2) % model.count, pick % 2
    one = found.meeting == 1
    h = 1e-7
    up, down = limit(shifted(model, i, j, h), PHI, pull), limit(shifted(model, i, j, -h), PHI, pull)
    numeric = (up - down) / (2 * h)
    np.testing.assert_allclose(
        found.per_coefficient_N[one, i, j], numeric[one], rtol=2e-5, atol=2e-6 * model.inertia.weight_N
    )


@pytest.mark.parametrize("shape", [GripShape.ELLIPSE, GripShape.DISC_STRIP])
@pytest.mark.parametrize("robot", [kiwi, four_wheels])
def test_coupled_derivatives(robot: object, shape: GripShape) -> None:
    model = nominal_model(robot(grip=shape), "paper")  # type: ignore[operator]
    for pull in (Pull(), Pull(height_m=0.05, point_m=np.array([0.05, 0.02]))):
        found, h = sensitivity(model, PHI, pull), 1e-4
        for i in range(model.count):
            for j in range(2):
                up = limit(shifted(model, i, j, h), PHI, pull)
                down = limit(shifted(model, i, j, -h), PHI, pull)
                np.testing.assert_allclose(
                    found.per_coefficient_N[:, i, j],
                    (up - down) / (2 * h),
                    atol=3e-4 * model.inertia.weight_N,
                )


@settings(max_examples=30, deadline=None)
@given(models(shapes=tuple(GripShape)))
def test_scaling_every_coefficient_scales_the_force(model: Model) -> None:
    # Euler: F is homogeneous of degree one in the coefficients, so Σ μ ∂F/∂μ = F.
    found = sensitivity(model, PHI)
    total = np.einsum("mij,ij->m", found.per_coefficient_N, model.grip.roller)
    np.testing.assert_allclose(total, found.force_N, rtol=1e-6)
    np.testing.assert_allclose(found.force_N, limit(model, PHI, Pull()), rtol=1e-12)


@settings(max_examples=30, deadline=None)
@given(models(max_wheels=5))
def test_saturated_forces_are_the_binding_rows_of_the_linear_program(model: Model) -> None:
    found = sensitivity(model, PHI[:2])
    for m in range(2):
        if found.meeting[m] == 1:
            rows = pull_limit(model, float(PHI[m])).solution
            held = set(rows.binding(1e-5))
            names = {n.rsplit(" ≤", 1)[0].rsplit(" ≥", 1)[0] for n in held}
            # A row's multiplier is dF/dμ times μ: a coefficient near zero has a small one.
            multiplier = found.per_coefficient_N[m] * model.grip.roller
            facet = multiplier > 1e-4 * multiplier.max()
            sure = {
                f"{w} {p}"
                for w, pair in zip(found.names, facet, strict=True)
                for p, on in zip(("drive", "transverse"), pair, strict=True)
                if on
            }
            assert sure <= names <= set(found.forces()[m])


def test_forces_that_do_not_saturate_do_not_matter() -> None:
    # The paper's robot pulled along +x at φ = 0: rear drive and the front transverse forces are spent; more
    # front drive friction buys nothing.
    model = nominal_model(kiwi(), "paper")
    found = sensitivity(model, np.array([0.0]))
    assert found.forces()[0] == ("right transverse", "left transverse", "rear drive")
    assert found.wheels()[0] == ("right", "left", "rear")
    more = model.grip.roller + np.array([[0.1, 0.0], [0.1, 0.0], [0.0, 0.0]])
    better = replace(model, grip=replace(model.grip, roller=more))
    np.testing.assert_allclose(limit(better, np.array([0.0]), Pull()), found.force_N, rtol=1e-12)


def test_where_facets_meet_the_mean_is_a_supergradient() -> None:
    # δ = 30° at φ = 30°: by symmetry two facets meet.
    model = nominal_model(kiwi(30.0), "paper")
    at = np.array([np.pi / 6])
    found = sensitivity(model, at)
    assert found.meeting[0] > 1
    rng = np.random.default_rng(0)
    for _ in range(20):
        step = 0.02 * rng.uniform(-1, 1, size=(3, 2))
        new = limit(replace(model, grip=replace(model.grip, roller=model.grip.roller + step)), at, Pull())[0]
        assert new <= found.force_N[0] + np.sum(found.per_coefficient_N[0] * step) + 1e-12


def test_sweep_names_its_limiting_wheels() -> None:
    found = sweep(nominal_model(kiwi(), "paper"), PHI)
    assert found.limiting() == found.sensitivity().wheels()
    assert len(found.limiting()) == len(PHI)
