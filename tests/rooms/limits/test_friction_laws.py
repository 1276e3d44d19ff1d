"""Friction laws in the limits: creeping equilibrium, creep bound, and what does not depend on the law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve
from strategies import four_wheels, kiwi

from slipmargin.limits.bounds import directions
from slipmargin.limits.creep import continued_share
from slipmargin.limits.motion_friction import ROOM, creep_bound, friction_in_motion
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.physics.friction_laws import ATAN, LAWS, RATIONAL, TANH
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

NUMBERS = tuple(range(len(LAWS)))
#: σ⁻¹(0.9), by hand.
AT_NINE_TENTHS = {ATAN: np.tan(0.45 * np.pi), TANH: 0.5 * np.log(19.0), RATIONAL: 0.9 / np.sqrt(0.19)}


def with_law(model: Model, law: int) -> Model:
    return replace(model, grip=replace(model.grip, law=law))


def plain_share(law: int, z: np.ndarray) -> np.ndarray:
    return {ATAN: 2.0 / np.pi * np.arctan(z), TANH: np.tanh(z), RATIONAL: z / np.hypot(1.0, z)}[law]


def multiplier(target: Target, variable: Variable, basis: Basis, by: float, scale: float) -> Multiplier:
    return Multiplier(
        variable=variable,
        basis=basis,
        target=target,
        shape=np.array([scale, 1.0]),
        coefficients=np.array([by]),
        wheels=np.ones(3),
    )


@pytest.mark.parametrize("law", NUMBERS)
@pytest.mark.parametrize("robot", [kiwi(), four_wheels()])
def test_creeping_equilibrium_is_that_of_a_slow_solver(law: int, robot: object) -> None:
    model = with_law(nominal_model(robot, "paper"), law)  # type: ignore[arg-type]
    motion = Motion(velocity=np.array([[0.4, 0.3, 0.5]]), acceleration=np.array([[0.1, -0.2, 0.3]]))
    found = realised(model, motion)
    n, c, k = model.count, model.geometry, model.grip.k_s_per_m
    mass, inertia = model.inertia.mass_kg, model.inertia.inertia_kg_m2

    def wheel(eps: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
        p, g, f, s = c.position_m[i], c.grip[i], c.free[i], c.drive[i]
        v = motion.velocity[0, :2] + motion.velocity[0, 2] * np.array([-p[1], p[0]])
        roll = -(v @ g) / (s @ g)  # rolls without slip along the grip
        extra = eps[:2] + eps[2] * np.array([-p[1], p[0]])
        u = v + roll * s + extra
        return p, g, f, float(u @ g), float(u @ f)

    def residual(eps: np.ndarray) -> np.ndarray:
        out = np.array([mass * 0.1, mass * -0.2, inertia * 0.3])
        for i in range(n):
            p, g, f, uw, ut = wheel(eps, i)
            mu = model.grip.roller[i] * model.loads.rest_N[i]
            force = -mu[0] * plain_share(law, k * uw) * g - mu[1] * plain_share(law, k * ut) * f
            out -= np.array([*force, p[0] * force[1] - p[1] * force[0]])
        return out

    # the centre of mass stands at the origin and turns: its acceleration is that of the origin
    assert np.all(model.inertia.com_m == 0.0)
    eps = fsolve(residual, found.twist[0], xtol=1e-13)
    assert np.max(np.abs(residual(found.twist[0]))) < 1e-8 * model.inertia.weight_N
    use = [abs(plain_share(law, k * wheel(eps, i)[3])) for i in range(n)]
    assert found.use[0] == pytest.approx(use, abs=1e-8)
    assert 0.05 < max(use) < 0.98


@pytest.mark.parametrize("law", NUMBERS)
def test_the_continued_share_is_the_law_and_then_a_line(law: int) -> None:
    z = np.linspace(-2.0, 2.0, 41)
    assert continued_share(law, z) == pytest.approx(plain_share(law, z), abs=1e-15)
    far = continued_share(law, np.array([1e3, 1e3 + 1.0]))
    assert far[0] > 1.0 and far[1] - far[0] == pytest.approx(0.02)


@pytest.mark.parametrize("law", NUMBERS)
def test_limits_that_assume_full_drag_do_not_depend_on_the_law(law: int) -> None:
    base = nominal_model(kiwi(), "paper")
    other = with_law(base, law)
    phi = np.linspace(0.0, 6.0, 7)
    assert np.array_equal(limit(base, phi, Pull()), limit(other, phi, Pull()))
    assert np.array_equal(directions(base, phi).starting_m_s2, directions(other, phi).starting_m_s2)
    # at a speed the drag follows the law
    motion = Motion(velocity=np.array([[1e-3, 0.0, 0.0]]))
    friction = friction_in_motion(other, motion)
    slide = motion.velocity @ other.geometry.lateral_rows().T
    assert friction.drag_low[0] == pytest.approx(0.09 * plain_share(law, 1000.0 * slide), rel=1e-12)


@pytest.mark.parametrize("law", NUMBERS)
@pytest.mark.parametrize("steepness", [1.0, 0.05, 4.0])
def test_the_creep_bound_takes_the_slope_that_the_multipliers_leave(law: int, steepness: float) -> None:
    model = with_law(nominal_model(kiwi(), "paper"), law)
    term = multiplier(Target.STIFFNESS, Variable.UNITY, Basis.CONSTANT, steepness - 1.0, 1.0)
    changed = replace(model, grip=replace(model.grip, multipliers=(term,)))
    motion = Motion(velocity=np.array([[0.3, 0.0, 0.0]]))
    bound = creep_bound(changed, motion, 0.9 - ROOM)
    assert bound == pytest.approx(np.full((1, 3), AT_NINE_TENTHS[law] / (1000.0 * steepness)), rel=1e-12)
    if law == ATAN and steepness == 0.05:
        assert bound[0, 0] == pytest.approx(0.126, abs=3e-4)


def test_friction_that_falls_with_slip_is_taken_at_the_slips_that_a_soft_law_allows() -> None:
    """With a slope of 0.05 of the file's, λ = 0.9 means 126 mm/s, and 6.3 was believed."""
    model = nominal_model(kiwi(), "paper")
    falls = multiplier(Target.DRIVE, Variable.SLIP_SPEED, Basis.DECAY, 0.5, 0.05)  # 1 … 0.5
    soft = multiplier(Target.STIFFNESS_DRIVE, Variable.UNITY, Basis.CONSTANT, -0.95, 1.0)
    grip = replace(model.grip, multipliers=(falls, soft))
    motion = Motion(velocity=np.array([[0.3, 0.0, 0.0]]))
    drive = friction_in_motion(replace(model, grip=grip), motion, share=0.9 - ROOM).drive[0, 0]
    creep = np.tan(0.45 * np.pi) / 50.0
    assert drive == pytest.approx(np.full(3, 0.26 * (0.5 + 0.5 * np.exp(-creep / 0.05))), rel=1e-12)


def test_a_slope_that_falls_with_the_slip_is_followed_to_the_slip_it_leads_to() -> None:
    model = nominal_model(kiwi(), "paper")
    term = multiplier(Target.STIFFNESS_DRIVE, Variable.SLIP_SPEED, Basis.DECAY, 0.5, 0.01)
    motion = Motion(velocity=np.array([[0.3, 0.0, 0.0]]))
    changed = replace(model, grip=replace(model.grip, multipliers=(term,)))
    bound = creep_bound(changed, motion, 0.9 - ROOM)[0, 0]
    k = 1000.0 * (0.5 + 0.5 * np.exp(-bound / 0.01))
    assert bound == pytest.approx(np.tan(0.45 * np.pi) / k, rel=1e-3)
