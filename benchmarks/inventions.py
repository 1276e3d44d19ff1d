"""Thirty effects that no catalogue entry holds: two for every variable a residual may be traced to.

They are curves over one variable, drawn through many knots, so the general forms of the diagnosis
cannot write them exactly.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from planting import Plant

from slipmargin.checks import Array
from slipmargin.effects import GeneralEffect, Part, Trace
from slipmargin.physics.terms import ForceTerm, Multiplier, PoseShift
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import LoadRule

_KNOTS = 41
_TURN = 2.0 * np.pi


def curve(f: Callable[[Array], Array], low: float, high: float) -> tuple[Basis, Array, Array]:
    """A function as a polygon through many knots: basis, shape, coefficients."""
    v = np.linspace(low, high, _KNOTS)
    return Basis.HATS, np.array([low, high]), np.asarray(f(v), dtype=float)


def friction(
    trace: Trace,
    variable: Variable,
    f: Callable[[Array], Array],
    low: float,
    high: float,
    target: Target = Target.BOTH,
    wheels: tuple[float, ...] = (1.0, 1.0, 1.0),
) -> GeneralEffect:
    """Friction times 1 + f(variable)."""
    basis, shape, coefficients = curve(f, low, high)
    term = Multiplier(
        variable=variable,
        basis=basis,
        shape=shape,
        coefficients=coefficients,
        target=target,
        wheels=np.array(wheels),
    )
    return GeneralEffect(traced_to=trace, part=Part.GRIP, terms=(term,))


def force(
    trace: Trace,
    variable: Variable,
    axis: int,
    f: Callable[[Array], Array],
    low: float,
    high: float,
    frame: Frame,
) -> GeneralEffect:
    """A force (axis 0, 1) or moment (axis 2) f(variable) on top [N, N m]."""
    basis, shape, values = curve(f, low, high)
    coefficients = np.zeros((3, _KNOTS))
    coefficients[axis] = values
    term = ForceTerm(variable=variable, basis=basis, shape=shape, coefficients=coefficients, frame=frame)
    return GeneralEffect(traced_to=trace, part=Part.LOSSES, terms=(term,))


def shift(
    variable: Variable, axis: int, f: Callable[[Array], Array], low: float, high: float
) -> GeneralEffect:
    """A fault f(variable) of the measured pose [m, m, rad]."""
    basis, shape, values = curve(f, low, high)
    coefficients = np.zeros((3, _KNOTS))
    coefficients[axis] = values
    term = PoseShift(variable=variable, basis=basis, shape=shape, coefficients=coefficients)
    return GeneralEffect(traced_to=Trace.MEASUREMENT, part=Part.SENSING, terms=(term,))


def wave(
    trace: Trace,
    variable: Variable,
    period: float,
    coefficients: tuple[float, ...],
    target: Target = Target.BOTH,
    wheels: tuple[float, ...] = (1.0, 1.0, 1.0),
) -> GeneralEffect:
    """Friction times 1 + a Fourier series over an angle."""
    term = Multiplier(
        variable=variable,
        basis=Basis.FOURIER,
        shape=np.array([period, 0.0]),
        target=target,
        coefficients=np.array(coefficients),
        wheels=np.array(wheels),
    )
    return GeneralEffect(traced_to=trace, part=Part.GRIP, terms=(term,))


def vane() -> GeneralEffect:
    """A force on the floor that turns twice as fast as the robot [N]."""
    term = ForceTerm(
        variable=Variable.HEADING,
        basis=Basis.FOURIER,
        shape=np.array([_TURN, 0.0]),
        frame=Frame.FLOOR,
        coefficients=np.array([[0.0, 0.0, 0.9, 0.0], [0.0, 0.0, 0.0, 0.9], [0.0, 0.0, 0.0, 0.0]]),
    )
    return GeneralEffect(traced_to=Trace.HEADING, part=Part.LOSSES, terms=(term,))


def level(size: float) -> Callable[[Array], Array]:
    """The same everywhere."""
    return lambda v: size * np.ones_like(v)


def invention(name: str, effect: GeneralEffect, *also: Trace, load_rule: LoadRule = LoadRule.EQUAL) -> Plant:
    """A plant of one effect, right if traced to its own variable or one of ``also``."""
    return Plant(name=name, traces=(effect.traced_to, *also), effects=(effect,), load_rule=load_rule)


def plants() -> list[Plant]:
    """Two inventions for every variable of the contract."""
    T, V, G, F = Trace, Variable, Target, Frame
    static = LoadRule.STATIC
    return [
        invention(
            "friction wave over the roller",
            wave(T.WHEEL_ANGLE, V.WHEEL_ANGLE, _TURN / 8, (0.0, 0.0, 0.35, -0.2), G.DRIVE),
        ),
        invention(
            "one worn side of a wheel",
            wave(T.WHEEL_ANGLE, V.WHEEL_ANGLE, _TURN, (0.4, 0.3), wheels=(0.0, 1.0, 0.0)),
        ),
        invention(
            "friction falls with load",
            friction(T.WHEEL_LOAD, V.WHEEL_LOAD, lambda v: -0.6 * v, -1.0, 1.0),
            T.WHEEL,
            load_rule=static,
        ),
        invention(
            "light wheels lose grip",
            friction(T.WHEEL_LOAD, V.WHEEL_LOAD, lambda v: np.minimum(0.0, v), -1.0, 1.0),
            T.WHEEL,
            load_rule=static,
        ),
        invention(
            "grip rises with slip",
            friction(T.SLIP_SPEED, V.SLIP_SPEED, lambda v: 1.2 * np.sqrt(v), 0.0, 1.0),
        ),
        invention(
            "grip peaks at 8 cm/s",
            friction(
                T.SLIP_SPEED, V.SLIP_SPEED, lambda v: 0.5 * np.exp(-(((v - 0.08) / 0.04) ** 2)), 0.0, 0.4
            ),
        ),
        invention(
            "drive grip lost when sliding sideways",
            friction(T.SLIP_COUPLING, V.SLIP_ANGLE, lambda a: -0.5 * np.sin(a) ** 4, 0.0, _TURN / 4, G.DRIVE),
        ),
        invention(
            "roller drag doubles when driven",
            friction(
                T.SLIP_COUPLING, V.SLIP_ANGLE, lambda a: 0.9 * np.cos(a) ** 2, 0.0, _TURN / 4, G.TRANSVERSE
            ),
        ),
        invention(
            "creep softens with rolling speed",
            friction(
                T.SLIP_RATIO, V.ROLLING_SPEED, lambda v: 1.0 / (1.0 + 60.0 * v) - 1.0, 0.0, 1.5, G.STIFFNESS
            ),
        ),
        invention(
            "grip lost at large slip ratio",
            friction(T.SLIP_RATIO, V.SLIP_RATIO, lambda v: -0.45 * np.clip(v, 0.0, 1.0) ** 1.5, 0.0, 2.0),
            T.SLIP_SPEED,
        ),
        invention(
            "drifts left in proportion to speed",
            force(T.VELOCITY, V.VELOCITY_Y, 0, lambda v: -1.2 * v, -1.5, 1.5, F.BODY),
        ),
        invention(
            "drag with the cube of the speed",
            force(T.VELOCITY, V.VELOCITY_X, 0, lambda v: -4.0 * v**3, -1.5, 1.5, F.BODY),
        ),
        invention(
            "sloshing load", force(T.ACCELERATION, V.ACCELERATION_Y, 1, lambda a: -0.9 * a, -6.0, 6.0, F.BODY)
        ),
        invention(
            "yaws when accelerating",
            force(T.ACCELERATION, V.ACCELERATION_X, 2, lambda a: 0.06 * a, -6.0, 6.0, F.BODY),
        ),
        invention("floor grooves", wave(T.HEADING, V.HEADING, _TURN, (0.0, 0.0, 0.35, 0.2))),
        invention("wind vane", vane()),
        invention(
            "polished patch",
            friction(
                T.POSITION, V.POSITION_X, lambda x: -0.55 / (1.0 + np.exp(-(x - 0.1) / 0.03)), -3.0, 3.0
            ),
        ),
        invention(
            "dished floor",
            force(T.POSITION, V.POSITION_Y, 1, lambda y: -2.2 * np.tanh(2.0 * y), -3.0, 3.0, F.FLOOR),
        ),
        invention(
            "wheels warm up", friction(T.TIME, V.TIME, lambda t: 0.6 * (1.0 - np.exp(-t / 1.2)), 0.0, 3.5)
        ),
        invention(
            "a gust",
            force(T.TIME, V.TIME, 1, lambda t: 1.1 * np.exp(-(((t - 1.6) / 0.4) ** 2)), 0.0, 3.5, F.FLOOR),
        ),
        invention("a fan on the robot", force(T.CONSTANT_FORCE, V.UNITY, 0, level(0.8), 0.0, 2.0, F.BODY)),
        invention("a twist on the robot", force(T.CONSTANT_FORCE, V.UNITY, 2, level(0.05), 0.0, 2.0, F.BODY)),
        invention(
            "soft tyres",
            friction(T.COEFFICIENT, V.UNITY, level(-0.93), 0.0, 2.0, G.STIFFNESS),
            T.SLIP_SPEED,
            T.SLIP_RATIO,
        ),
        invention(
            "drive grip a third higher", friction(T.COEFFICIENT, V.UNITY, level(0.33), 0.0, 2.0, G.DRIVE)
        ),
        invention(
            "one wheel's bearings drag",
            friction(T.WHEEL, V.UNITY, level(1.5), 0.0, 2.0, G.TRANSVERSE, (0.0, 0.0, 1.0)),
        ),
        invention(
            "one wheel is polished",
            friction(T.WHEEL, V.UNITY, level(-0.4), 0.0, 2.0, G.DRIVE, (1.0, 0.0, 0.0)),
        ),
        Plant(
            name="drives saturate", traces=(T.ACTUATION,), commands=lambda t, om: 12.0 * np.tanh(om / 12.0)
        ),
        Plant(
            name="drives lose slow commands",
            traces=(T.ACTUATION,),
            commands=lambda t, om: om * om**2 / (om**2 + 4.0),
        ),
        invention(
            "barrel distortion of the camera",
            shift(V.POSITION_X, 0, lambda x: -0.05 * x * np.abs(x), -4.0, 4.0),
        ),
        invention("gyro drift", shift(V.TIME, 2, lambda t: 0.03 * t**1.5, 0.0, 3.5)),
    ]
