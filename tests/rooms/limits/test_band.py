"""The band against every one of the 2^N states, and what unknown variables do to it."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import kiwi, models

from slipmargin.limits import Pull, isotropic, sweep
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.ranges import span
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.physics.terms import ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import GripShape, LoadRule

PHI = np.linspace(0.0, 6.0, 7)


def with_term(
    model: Model,
    variable: Variable,
    basis: Basis,
    values: list[float],
    shape: tuple[float, float],
    target: Target = Target.BOTH,
) -> Model:
    term = Multiplier(
        variable=variable,
        basis=basis,
        coefficients=np.array(values),
        shape=np.array(shape),
        wheels=np.ones(model.count),
        target=target,
    )
    return replace(model, grip=replace(model.grip, multipliers=(*model.grip.multipliers, term)))


@settings(max_examples=25, deadline=None)
@given(models(max_wheels=5))
def test_band_is_the_extremes_over_every_state(model: Model) -> None:
    may = [(False, True) if f > 0.0 else (False,) for f in model.grip.rigid_fraction]
    every = np.array([limit(model, PHI, Pull(), np.array(state)) for state in product(*may)])
    found = sweep(model, PHI)
    np.testing.assert_allclose(found.f_low_N, every.min(axis=0), rtol=1e-12)
    np.testing.assert_allclose(found.f_high_N, every.max(axis=0), rtol=1e-12)


@pytest.mark.parametrize("shape", [GripShape.ELLIPSE, GripShape.DISC_STRIP])
def test_band_of_a_coupled_grip(shape: GripShape) -> None:
    model = nominal_model(kiwi(grip=shape), "paper")
    every = np.array([limit(model, PHI, Pull(), np.array(s)) for s in product((False, True), repeat=3)])
    found = sweep(model, PHI)
    np.testing.assert_allclose(found.f_low_N, every.min(axis=0), rtol=1e-8)
    np.testing.assert_allclose(found.f_high_N, every.max(axis=0), rtol=1e-8)


def test_robot_without_rigid_sectors_has_a_line() -> None:
    found = sweep(nominal_model(kiwi(rigid_fraction=0.0), "paper"), PHI)
    np.testing.assert_array_equal(found.f_low_N, found.f_max_N)
    np.testing.assert_array_equal(found.f_high_N, found.f_max_N)


def test_all_rigid_wheels_stand_on_rigid_material() -> None:
    model = nominal_model(kiwi(rigid_fraction=1.0), "paper")
    found = sweep(model, PHI)
    rigid = limit(model, PHI, Pull(), np.ones(3, dtype=bool))
    np.testing.assert_allclose(found.f_low_N, rigid)
    np.testing.assert_allclose(found.f_high_N, rigid)


def test_heading_dependence_is_known_in_a_sweep() -> None:
    model = with_term(
        nominal_model(kiwi(rigid_fraction=0.0), "paper"),
        Variable.HEADING,
        Basis.FOURIER,
        [0.0, 0.2],
        (2 * np.pi, 0.0),
    )
    plain = sweep(nominal_model(kiwi(), "paper"), PHI).f_max_N
    found = sweep(model, PHI)
    np.testing.assert_allclose(found.f_max_N, plain * (1.0 + 0.2 * np.sin(PHI)), rtol=1e-12)
    np.testing.assert_array_equal(found.f_low_N, found.f_max_N)


@pytest.mark.parametrize(
    ("variable", "basis", "values", "shape", "low", "high"),
    [
        (Variable.WHEEL_ANGLE, Basis.FOURIER, [0.0, 0.3], (2 * np.pi / 8, 0.0), 0.7, 1.3),
        (Variable.TIME, Basis.DECAY, [0.4], (10.0, 1.0), 0.6, 1.0),
        (Variable.POSITION_X, Basis.HATS, [0.0, -0.5, 0.2], (0.0, 2.0), 0.5, 1.2),
        (Variable.POSITION_Y, Basis.WINDOW, [-0.25], (1.0, 2.0), 0.75, 1.0),
        (Variable.POSITION_X, Basis.POLYNOMIAL, [0.1], (1.0, 0.0), 0.9, 1.1),
    ],
)
def test_unknown_variables_widen_the_band(
    variable: Variable, basis: Basis, values: list[float], shape: tuple[float, float], low: float, high: float
) -> None:
    base = nominal_model(kiwi(rigid_fraction=0.0), "paper")
    plain, found = sweep(base, PHI).f_max_N, sweep(with_term(base, variable, basis, values, shape), PHI)
    np.testing.assert_allclose(found.f_max_N, plain, rtol=1e-12)  # at v = 0
    np.testing.assert_allclose(found.f_low_N, low * plain, rtol=1e-4)
    np.testing.assert_allclose(found.f_high_N, high * plain, rtol=1e-4)


@pytest.mark.parametrize(
    "variable", [Variable.SLIP_SPEED, Variable.SPEED, Variable.YAW_RATE, Variable.SLIP_RATIO]
)
def test_nothing_moves_at_rest(variable: Variable) -> None:
    base = nominal_model(kiwi(), "paper")
    model = with_term(base, variable, Basis.DECAY, [0.5], (0.1, 1.0))
    found, plain = sweep(model, PHI), sweep(base, PHI)
    np.testing.assert_array_equal(found.f_max_N, plain.f_max_N)
    np.testing.assert_array_equal(found.f_high_N, plain.f_high_N)


def test_stiffness_moves_no_limit() -> None:
    base = nominal_model(kiwi(), "paper")
    model = with_term(base, Variable.UNITY, Basis.CONSTANT, [-0.5], (1.0, 0.0), Target.STIFFNESS)
    np.testing.assert_array_equal(sweep(model, PHI).f_max_N, sweep(base, PHI).f_max_N)


def test_load_dependence_takes_the_loads_at_rest() -> None:
    model = with_term(
        nominal_model(kiwi(load_fractions=(0.5, 0.3, 0.2), load_rule=LoadRule.FIXED), "paper"),
        Variable.WHEEL_LOAD,
        Basis.POLYNOMIAL,
        [-0.2],
        (1.0, 0.0),
        Target.DRIVE,
    )
    mu = coefficients(model, np.zeros(3, dtype=bool), PHI)
    want = 0.26 * (1.0 - 0.2 * (np.array([1.5, 0.9, 0.6]) - 1.0))
    np.testing.assert_allclose(mu[0, :, 0, 1], want, rtol=1e-12)
    np.testing.assert_allclose(mu[0, :, 1], 0.09)


@pytest.mark.parametrize("shape", [GripShape.BOX, GripShape.ELLIPSE])
def test_nap_holds_better_one_way(shape: GripShape) -> None:
    # Friction 1 + 0.2 cos(heading of the slip): a robot dragged along +x slips along +x and holds better
    # than one dragged along −x.
    model = with_term(
        nominal_model(kiwi(rigid_fraction=0.0, grip=shape), "paper"),
        Variable.SLIP_HEADING,
        Basis.FOURIER,
        [0.2],
        (2 * np.pi, 0.0),
    )
    plain = limit(nominal_model(kiwi(grip=shape), "paper"), PHI, Pull())
    with_nap, against = limit(model, PHI, Pull()), limit(model, PHI, Pull(direction_rad=np.pi))
    assert np.all(with_nap > plain)
    assert np.all(against < plain)
    assert np.all(with_nap < 1.2 * plain)


def test_place_dependent_force_widens_the_band() -> None:
    base = nominal_model(kiwi(rigid_fraction=0.0), "paper")
    term = ForceTerm(
        variable=Variable.POSITION_X,
        basis=Basis.HATS,
        shape=np.array([0.0, 1.0]),
        frame=Frame.FLOOR,
        coefficients=np.array([[0.0, 0.5], [0.0, 0.0], [0.0, 0.0]]),
    )
    for shape, rtol in ((GripShape.BOX, 1e-12), (GripShape.ELLIPSE, 1e-7)):
        bare = replace(base, grip=replace(base.grip, shape=shape))
        plain = limit(bare, PHI, Pull())
        found = sweep(replace(bare, external=replace(bare.external, terms=(term,))), PHI)
        np.testing.assert_allclose(found.f_max_N, plain, rtol=rtol)
        np.testing.assert_allclose(found.f_low_N, plain - 0.5, rtol=rtol)
        np.testing.assert_allclose(found.f_high_N, plain, rtol=rtol)


def test_forces_against_the_motion_are_silent_at_rest() -> None:
    base = nominal_model(kiwi(), "paper")
    drag = ForceTerm(
        variable=Variable.UNITY,
        basis=Basis.CONSTANT,
        shape=np.ones(2),
        coefficients=np.array([[1.0], [0.0], [0.0]]),
        frame=Frame.AGAINST_MOTION,
    )
    model = replace(base, external=replace(base.external, terms=(drag,)))
    np.testing.assert_array_equal(sweep(model, PHI).f_max_N, sweep(base, PHI).f_max_N)


def test_time_only_runs_forwards() -> None:
    assert span(Basis.POLYNOMIAL, np.array([2.0, 0.0]), Variable.TIME, 1).min() == 0.0
    assert span(Basis.POLYNOMIAL, np.array([2.0, 0.0]), Variable.POSITION_X, 1).min() == -2.0


def test_extremes_bracket_the_neutral_value() -> None:
    model = with_term(nominal_model(kiwi(), "paper"), Variable.POSITION_X, Basis.HATS, [0.3, 0.4], (1.0, 2.0))
    low, mid, high = (
        coefficients(model, np.zeros(3, dtype=bool), PHI, e)
        for e in (Extreme.LOW, Extreme.NEUTRAL, Extreme.HIGH)
    )
    assert np.all(low <= mid)
    assert np.all(mid <= high)


def test_isotropic_claim_states_its_rule() -> None:
    model = nominal_model(kiwi(), "paper")
    claim = isotropic(model)
    assert claim.force_N == pytest.approx(0.26 * 3.0 * 9.81)
    assert "mean drive" in claim.rule
    assert np.all(sweep(model, PHI).f_max_N < claim.force_N)


def test_recommended_force_is_below_the_band() -> None:
    found = sweep(nominal_model(kiwi(), "paper"), PHI)
    assert found.recommended_N(0.1) == pytest.approx(0.9 * found.f_low_N.min())


def test_rigid_material_that_grips_less_turns_the_band_over() -> None:
    # Slippery plastic between the rollers: now all-rigid is the lowest state and all-rollers the highest.
    model = nominal_model(kiwi(), "paper")
    slick = replace(model, grip=replace(model.grip, rigid=0.5 * model.grip.roller))
    found = sweep(slick, PHI)
    np.testing.assert_allclose(found.f_high_N, found.f_max_N, rtol=1e-12)
    np.testing.assert_allclose(found.f_low_N, 0.5 * found.f_max_N, rtol=1e-12)


def pushed(
    basis: Basis, shape: tuple[float, float], newton: list[float], grip: GripShape = GripShape.BOX
) -> Model:
    """A kiwi that a force over time drags along the floor's −x or +x."""
    model = nominal_model(kiwi(grip=grip), "paper")
    term = ForceTerm(
        variable=Variable.TIME,
        basis=basis,
        shape=np.array(shape),
        coefficients=np.array([newton, [0.0] * len(newton), [0.0] * len(newton)]),
        frame=Frame.FLOOR,
    )
    return replace(model, external=replace(model.external, terms=(term,)))


def test_a_push_from_the_start_on_is_over_as_well() -> None:
    """A push that helps at t = 0 was taken to last: the pull that was recommended slips after it."""
    at_once, later = (
        sweep(pushed(Basis.WINDOW, (start, start + 0.1), [-2.0]), PHI).f_low_N for start in (0.0, 0.5)
    )
    np.testing.assert_allclose(at_once, later, rtol=1e-9)
    assert np.all(at_once <= sweep(nominal_model(kiwi(), "paper"), PHI).f_low_N + 1e-9)


@pytest.mark.parametrize("shape", [GripShape.ELLIPSE, GripShape.DISC_STRIP])
def test_the_band_of_a_coupled_grip_sees_every_knot(shape: GripShape) -> None:
    """A set inside another one holds no more; five values over time missed a peak between them."""
    hats = (Basis.HATS, (0.0, 6.0), [0.0, 2.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    box, inside = (sweep(pushed(*hats, grip), PHI).f_low_N for grip in (GripShape.BOX, shape))
    assert np.all(inside <= box * (1.0 + 1e-7))
    at_peak = sweep(pushed(Basis.CONSTANT, (1.0, 0.0), [2.5], shape), PHI).f_low_N
    assert np.all(inside <= at_peak * (1.0 + 1e-7))
