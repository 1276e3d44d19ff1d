"""Grips that are nearly a box, and cables that hardly pull: the cone programs answer for any of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from strategies import kiwi, models, reals

from slipmargin.limits import Pull, wrench_set
from slipmargin.limits.band import band
from slipmargin.limits.bias import bias_wrench
from slipmargin.limits.cones import cone_limits
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.grips import GripShape
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import LoadRule

KIWI = nominal_model(kiwi(rigid_fraction=0.0), "paper")


def held(model: Model, stiffness: float, shape: GripShape, coupling: float) -> Model:
    """The model with a cable anchored at (0.3, −0.2) m and a coupled grip."""
    terms = [
        ForceTerm(
            variable=variable,
            basis=basis,
            frame=Frame.FLOOR,
            coefficients=stiffness * np.array([[x], [y], [0.0]]),
            shape=np.ones(2),
        )
        for variable, basis, x, y in (
            (Variable.UNITY, Basis.CONSTANT, 0.3, -0.2),
            (Variable.POSITION_X, Basis.POLYNOMIAL, -1.0, 0.0),
            (Variable.POSITION_Y, Basis.POLYNOMIAL, 0.0, -1.0),
        )
    ]
    grip = replace(model.grip, shape=shape, coupling=coupling, rigid_fraction=np.zeros(model.count))
    return replace(model, grip=grip, external=ExternalWrench(terms=tuple(terms)))


@settings(max_examples=120, deadline=None)
@given(
    models(max_wheels=4, rules=(LoadRule.EQUAL, LoadRule.STATIC)),
    reals(-9.0, 0.0),
    st.one_of(st.just(-np.inf), reals(-9.0, -1.0)),
    reals(-3.2, 3.2),
    st.sampled_from((GripShape.DISC_STRIP, GripShape.ELLIPSE)),
)
@example(KIWI, float(np.log10(6.5e-5)), -6.0, 0.0524, GripShape.DISC_STRIP)
@example(KIWI, -5.0, -6.0, 0.0524, GripShape.DISC_STRIP)
@example(KIWI, -6.0, -9.0, 0.0524, GripShape.ELLIPSE)
@example(KIWI, -7.0, -8.0, 0.0524, GripShape.DISC_STRIP)
@example(KIWI, float(np.log10(1.0 - 1e-7)), -6.0, 0.0524, GripShape.DISC_STRIP)
def test_any_coupling_and_any_cable(
    model: Model, exponent: float, cable: float, phi: float, shape: GripShape
) -> None:
    coupling, at = 10.0**exponent, np.array([phi])
    changed = held(model, 10.0**cable, shape, coupling)
    force = limit(changed, at, Pull())
    # from above: the closed-form support at the multipliers' normal (weak duality); from below: wheel
    # forces that balance the pull
    found, ray = cone_limits(changed, at, Pull()), Pull().rays(changed, at)[0]
    normal = found.normals[0] / -(found.normals[0] @ ray)
    above = wrench_set(changed, phi_rad=phi).support(normal) + normal @ bias_wrench(changed, at)[0]
    assert force[0] == pytest.approx(float(above), rel=1e-7)
    assert found.solution(0).certificate().primal < 1e-8
    # the set lies between the box and a box smaller by 0.3 of the coupling
    box = limit(held(model, 10.0**cable, GripShape.BOX, 1.0), at, Pull())
    assert force[0] <= box[0] * (1.0 + 1e-7)
    if np.isinf(cable):
        assert force[0] >= box[0] * (1.0 - 0.3 * coupling - 1e-7)
    low, high = band(changed, at, Pull())
    assert low[0] <= force[0] * (1.0 + 1e-7) and high[0] >= force[0] * (1.0 - 1e-7)


def test_a_cone_too_thin_to_matter_is_a_box_and_one_that_is_not_is_seen() -> None:
    at = np.linspace(0.0, 3.0, 5)
    box = limit(held(KIWI, 0.0, GripShape.BOX, 1.0), at, Pull())
    for coupling, seen in ((1e-9, 0.0), (1e-4, 1e-6)):
        less = 1.0 - limit(held(KIWI, 0.0, GripShape.ELLIPSE, coupling), at, Pull()) / box
        assert np.max(less) <= 0.3 * coupling + 1e-10
        assert np.max(less) >= seen
    assert np.max(1.0 - limit(held(KIWI, 0.0, GripShape.ELLIPSE, 1.0), at, Pull()) / box) == pytest.approx(
        0.1, abs=0.08
    )
