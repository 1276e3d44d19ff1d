"""Grips that are nearly a box, and cables that hardly pull: the cone programs answer for any of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from strategies import four_wheels, kiwi, models, reals

from slipmargin.errors import InputError
from slipmargin.limits import Pull, wrench_set
from slipmargin.limits.band import band
from slipmargin.limits.bias import bias_samples, bias_wrench
from slipmargin.limits.cones import cone_limits
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.grips import GripShape
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import Body, Coefficients, FrictionLaw, LoadRule, Robot, Surface, Wheel
from slipmargin.solve.clarabel_ import ALMOST

KIWI = nominal_model(kiwi(rigid_fraction=0.0), "paper")
#: A floor on which the rollers' transverse coefficient is the larger one: the disc is far inside the box.
WIDE = replace(KIWI, grip=replace(KIWI.grip, roller=KIWI.grip.roller[:, :1] * np.array([1.0, 2.5])))


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


def beyond_the_shape(model: Model, shape: GripShape) -> float:
    """The largest share of a box's support that its shape does not reach.

    A disc of radius μ_W against the corner (μ_W, r μ_W) reaches 1/√(1 + r²) of it; a strip narrower than
    the disc, and an ellipse, reach 1/√2 or more.
    """
    ratio = model.grip.roller[:, 1] / model.grip.roller[:, 0]
    widest = max(1.0, float(np.max(ratio))) if shape is GripShape.DISC_STRIP else 1.0
    return 1.0 - 1.0 / float(np.hypot(1.0, widest))


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
@example(WIDE, -5.7, -np.inf, -3.2, GripShape.DISC_STRIP)
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
    # the set lies between the box and a box smaller by a share of the coupling
    box = limit(held(model, 10.0**cable, GripShape.BOX, 1.0), at, Pull())
    assert force[0] <= box[0] * (1.0 + 1e-7)
    if np.isinf(cable):
        assert force[0] >= box[0] * (1.0 - beyond_the_shape(model, shape) * coupling - 1e-7)
    low, high = band(changed, at, Pull())
    assert low[0] <= force[0] * (1.0 + 1e-7) and high[0] >= force[0] * (1.0 - 1e-7)


def test_values_of_the_unknown_that_change_nothing_count_once_and_the_others_count_as_work() -> None:
    """A sweep with a cable of no stiffness took 20 s: 36 equal programs for each of its headings."""
    at = np.linspace(0.0, 3.0, 3100)
    shape = GripShape.ELLIPSE
    assert len(bias_samples(held(KIWI, 0.0, shape, 1.0), at)) == 1
    pulled = held(KIWI, 1.0, shape, 1.0)
    different = bias_samples(pulled, at)
    assert len(different) == len({b.wrench.tobytes() for b in different}) == 9
    np.testing.assert_array_equal(different[0].wrench, bias_wrench(pulled, at))
    with pytest.raises(InputError, match=r"3.35e\+05 wheels in cone programs"):
        band(pulled, at, Pull())


def test_a_cone_too_thin_to_matter_is_a_box_and_one_that_is_not_is_seen() -> None:
    at = np.linspace(0.0, 3.0, 5)
    box = limit(held(KIWI, 0.0, GripShape.BOX, 1.0), at, Pull())
    for coupling, seen in ((1e-9, 0.0), (1e-4, 1e-6)):
        less = 1.0 - limit(held(KIWI, 0.0, GripShape.ELLIPSE, coupling), at, Pull()) / box
        assert np.max(less) <= beyond_the_shape(KIWI, GripShape.ELLIPSE) * coupling + 1e-10
        assert np.max(less) >= seen
    assert np.max(1.0 - limit(held(KIWI, 0.0, GripShape.ELLIPSE, 1.0), at, Pull()) / box) == pytest.approx(
        0.1, abs=0.08
    )


def test_a_wheel_without_drive_friction_has_no_strip() -> None:
    """Its disc is a point, and the strip's width was divided by its radius."""
    whole = nominal_model(four_wheels(grip=GripShape.DISC_STRIP), "paper")
    roller = np.array(whole.grip.roller)
    roller[0, 0] = 0.0
    model = replace(whole, grip=replace(whole.grip, roller=roller))
    at, none = np.linspace(0.0, 3.0, 7), np.zeros(4, dtype=bool)
    with np.errstate(divide="raise", invalid="raise"):
        found = cone_limits(model, at, Pull(), none)
    rays = Pull().rays(model, at)
    for force, normal, ray in zip(found.force_N, found.normals, rays, strict=True):
        leaving = normal / -(normal @ ray)
        assert force == pytest.approx(float(wrench_set(model).support(leaving)), rel=1e-7)
    assert np.all(found.force_N < cone_limits(whole, at, Pull(), none).force_N)


#: Wheels (x, y [m], drive direction, roller angle [deg]), μ_W and μ_T on rollers, mass's place, coupling.
STALLED = (
    (
        (
            (0.15752322552649964, 0.03679171841774746, -90.50065130519434, 0.0),
            (-0.10609389020258132, 0.06353765892279191, -163.11050886373965, 0.0),
            (0.015101409065908039, -0.14896101451735444, -10.276270307393673, 0.0),
        ),
        (0.1, 0.005),
        (0.029913061017694333, -0.02678295305777144),
        LoadRule.EQUAL,
        0.999999,
    ),
    (
        (
            (0.3491913186157592, -0.13588133038164443, 54.059108055898264, 0.0),
            (0.02650253937545385, 0.4277504436488276, -31.27152417484041, 0.0),
            (-0.03533466688499208, -0.2680522581103393, -73.11733176359023, 0.0),
        ),
        (0.9, 0.5),
        (0.08640546093901012, 0.047843259954373864),
        LoadRule.STATIC,
        0.999999,
    ),
)


@pytest.mark.parametrize(("wheels", "mu", "com", "rule", "coupling"), STALLED)
def test_a_thin_ellipse_that_stalled_the_solver_is_answered(
    wheels: tuple[tuple[float, float, float, float], ...],
    mu: tuple[float, float],
    com: tuple[float, float],
    rule: LoadRule,
    coupling: float,
) -> None:
    """Refused once: "left primal residual 1.2e-08"."""
    robot = Robot(
        name="stalled",
        wheels=tuple(
            Wheel(
                name=f"w{i}",
                position_m=np.array([x, y]),
                drive_direction_deg=drive,
                radius_m=0.05,
                roller_angle_deg=turn,
            )
            for i, (x, y, drive, turn) in enumerate(wheels)
        ),
        surfaces=(
            Surface(
                name="floor",
                roller=Coefficients(drive=mu[0], transverse=mu[1]),
                rigid=Coefficients(drive=1.2, transverse=1.2),
            ),
        ),
        load_rule=rule,
        body=Body(mass_kg=10.0, inertia_kg_m2=0.3, com_m=np.array(com)),
        friction=FrictionLaw(grip=GripShape.ELLIPSE),
    )
    model = nominal_model(robot, "floor")
    model = replace(model, grip=replace(model.grip, coupling=coupling))
    found = cone_limits(model, np.deg2rad(np.arange(0.0, 180.0, 15.0)), Pull(), np.zeros(3, dtype=bool))
    for m in range(len(found.force_N)):
        assert found.solution(m).certificate().worst <= ALMOST
