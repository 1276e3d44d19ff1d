"""Drawn wheel motions and drawn physics for the simulator's tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from strategies import models, reals

from slipmargin.model import Model
from slipmargin.physics.terms import OF_PLACE, ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.sim.signal import WheelSignal, held, hermite, linear

#: A sensible size of each variable that friction may depend on, for the shape of its basis.
SIZE = {
    Variable.UNITY: 1.0,
    Variable.WHEEL_ANGLE: 2.0 * np.pi,
    Variable.WHEEL_LOAD: 1.0,
    Variable.SLIP_SPEED: 0.03,
    Variable.SLIP_RATIO: 0.5,
    Variable.SLIP_ANGLE: 1.0,
    Variable.ROLLING_SPEED: 0.2,
    Variable.VELOCITY_X: 0.2,
    Variable.VELOCITY_Y: 0.2,
    Variable.YAW_RATE: 1.0,
    Variable.SPEED: 0.2,
    Variable.ACCELERATION_X: 1.0,
    Variable.ACCELERATION_Y: 1.0,
    Variable.YAW_ACCELERATION: 5.0,
    Variable.HEADING: 1.0,
    Variable.POSITION_X: 0.1,
    Variable.POSITION_Y: 0.1,
    Variable.TIME: 0.3,
    Variable.SLIP_HEADING: 2.0 * np.pi,
    Variable.SLIP_DIRECTION: 2.0 * np.pi,
    Variable.HUB_SPEED: 0.2,
    Variable.FROM_PLACE: 0.3,
    Variable.BEFORE_LINE: 0.3,
    Variable.PASSING_SPEED: 0.2,
}
#: Variables whose terms have a place, or a share that stands in it.
_PLACED = OF_PLACE | {Variable.PASSING_SPEED}
for _variable in Variable:  # shares and ratios
    SIZE.setdefault(_variable, 0.5)


def wheel_motion(signal: WheelSignal):
    """θ, ω, ω̇ (N,) as plain functions of time, for the reference road."""
    knots, pieces = signal.knots_s, signal.pieces

    def at(t: float):
        k = int(np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(pieces) - 1))
        x = t - knots[k]
        c = pieces[k].T
        return (
            c[0] + x * (c[1] + x * (c[2] + x * c[3])),
            c[1] + x * (2 * c[2] + 3 * x * c[3]),
            2 * c[2] + 6 * x * c[3],
        )

    return at


def no_slip_rates(model: Model, twist: np.ndarray) -> np.ndarray:
    """Wheel speeds (N,) that roll without drive slip at a body twist of the origin (3,)."""
    c = model.geometry
    rows = np.column_stack([c.grip, c.position_m[:, 0] * c.grip[:, 1] - c.position_m[:, 1] * c.grip[:, 0]])
    return -(rows @ twist) / (c.radius_m * np.sum(c.drive * c.grip, axis=1))


@st.composite
def driven(draw: st.DrawFn, **kwargs) -> tuple[Model, WheelSignal]:
    """A drawn robot with 0.25 s of wheel motion, hard enough to slip now and then, and back again."""
    model = draw(models(**kwargs))
    reach = float(np.mean(np.hypot(*model.geometry.position_m.T)))
    limit = 9.81 * 0.3 * float(model.grip.roller[:, 0].min())
    knots = np.array([0.0, 0.07, 0.11, 0.25])
    scale = limit * 0.1 * np.array([1.0, 1.0, 1.0 / reach])
    twists = np.array([[draw(reals(-1.0, 1.0)) for _ in range(3)] for _ in knots]) * scale
    omega = np.array([no_slip_rates(model, t) for t in twists])
    theta0 = np.array([draw(reals(0.0, 6.0)) for _ in range(model.count)])
    kind = draw(st.sampled_from(("held", "linear", "hermite")))
    if kind == "held":
        return model, held(knots, omega, theta0=theta0)
    if kind == "linear":
        return model, linear(knots, omega, theta0=theta0)
    theta = theta0 + np.vstack(
        [np.zeros(model.count), np.cumsum(0.5 * (omega[1:] + omega[:-1]) * np.diff(knots)[:, None], axis=0)]
    )
    return model, hermite(knots, theta, omega)


def basis_shape(basis: Basis, size: float) -> tuple[np.ndarray, int]:
    """Constants and a number of functions of a basis over a variable of this size."""
    shapes = {
        Basis.CONSTANT: ((1.0, 1.0), 1),
        Basis.POLYNOMIAL: ((size, 0.0), 3),
        Basis.FOURIER: ((size, 0.0), 4),
        Basis.HATS: ((-size, size), 5),
        Basis.DECAY: ((size, 2.0), 1),
        Basis.RECIPROCAL: ((size, 3.0 * size), 1),
        Basis.WINDOW: ((0.2 * size, 0.7 * size), 1),
        Basis.ODD: ((size, 0.0), 2),
        Basis.STEP: ((0.5 * size, 0.2 * size), 1),
        Basis.LOBE: ((0.6, 1.3), 1),
    }
    constants, count = shapes[basis]
    return np.array(constants), count


def modulation(variable: Variable, basis: Basis, target: Target, count: int, seed: int) -> Multiplier:
    """A modulation of a moderate size with drawn coefficients; where it needs a floor place, a drawn one."""
    rng = np.random.default_rng(seed)
    shape, size = basis_shape(basis, SIZE[variable])
    elsewhere = np.array([*np.random.default_rng([seed, 1]).uniform(-0.3, 0.3, 2), 0.1 + seed % 6])
    return Multiplier(
        variable=variable,
        basis=basis,
        target=target,
        shape=shape,
        wheels=rng.uniform(0.5, 1.0, count),
        coefficients=0.15 * rng.uniform(-1.0, 1.0, size),
        place=elsewhere if variable in _PLACED else np.zeros(3),
    )


def force(variable: Variable, basis: Basis, frame: Frame, seed: int, newton: float = 0.5) -> ForceTerm:
    """A force term of a moderate size with drawn coefficients."""
    rng = np.random.default_rng(seed)
    shape, size = basis_shape(basis, SIZE[variable])
    rows = newton * rng.uniform(-1.0, 1.0, (3, size)) * np.array([[1.0], [1.0], [0.05]])
    place = np.array([0.07, -0.04]) if frame is Frame.AT_PLACE else np.zeros(2)
    return ForceTerm(
        variable=variable, basis=basis, frame=frame, shape=shape, coefficients=rows, place_m=place
    )


def with_terms(
    model: Model, modulations: tuple[Multiplier, ...] = (), forces: tuple[ForceTerm, ...] = ()
) -> Model:
    """The model with these on top."""
    grip = replace(model.grip, multipliers=(*model.grip.multipliers, *modulations))
    return replace(model, grip=grip, external=replace(model.external, terms=(*model.external.terms, *forces)))
