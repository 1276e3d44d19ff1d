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
from slipmargin.model.terms import ForceTerm, Modulation, PoseShift
from slipmargin.model.variables import Basis, Frame, Target, Variable
from slipmargin.robot import LoadRule

_KNOTS = 41


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
    term = Modulation(
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


def plants() -> list[Plant]:
    """Two inventions for every variable of the contract."""
    T, V, two_pi = Trace, Variable, 2.0 * np.pi
    pitch = two_pi / 8

    wave = GeneralEffect(
        traced_to=T.WHEEL_ANGLE,
        part=Part.GRIP,
        terms=(
            Modulation(
                variable=V.WHEEL_ANGLE,
                basis=Basis.FOURIER,
                shape=np.array([pitch, 0.0]),
                target=Target.DRIVE,
                coefficients=np.array([0.0, 0.0, 0.35, -0.2]),
                wheels=np.ones(3),
            ),
        ),
    )
    egg = GeneralEffect(
        traced_to=T.WHEEL_ANGLE,
        part=Part.GRIP,
        terms=(
            Modulation(
                variable=V.WHEEL_ANGLE,
                basis=Basis.FOURIER,
                shape=np.array([two_pi, 0.0]),
                target=Target.BOTH,
                coefficients=np.array([0.4, 0.3]),
                wheels=np.array([0.0, 1.0, 0.0]),
            ),
        ),
    )
    fixed = {"load_rule": LoadRule.STATIC}
    return [
        Plant(name="friction wave over the roller", traces=(T.WHEEL_ANGLE,), effects=(wave,)),
        Plant(name="one worn side of a wheel", traces=(T.WHEEL_ANGLE,), effects=(egg,)),
        Plant(
            name="friction falls with load",
            traces=(T.WHEEL_LOAD, T.WHEEL),
            effects=(friction(T.WHEEL_LOAD, V.WHEEL_LOAD, lambda v: -0.6 * v, -1.0, 1.0),),
            **fixed,
        ),
        Plant(
            name="light wheels lose grip",
            traces=(T.WHEEL_LOAD, T.WHEEL),
            effects=(friction(T.WHEEL_LOAD, V.WHEEL_LOAD, lambda v: np.minimum(0.0, v), -1.0, 1.0),),
            **fixed,
        ),
        Plant(
            name="grip rises with slip",
            traces=(T.SLIP_SPEED,),
            effects=(friction(T.SLIP_SPEED, V.SLIP_SPEED, lambda v: 1.2 * np.sqrt(v), 0.0, 1.0),),
        ),
        Plant(
            name="grip peaks at 8 cm/s",
            traces=(T.SLIP_SPEED,),
            effects=(
                friction(
                    T.SLIP_SPEED, V.SLIP_SPEED, lambda v: 0.5 * np.exp(-(((v - 0.08) / 0.04) ** 2)), 0.0, 0.4
                ),
            ),
        ),
        Plant(
            name="drive grip lost when sliding sideways",
            traces=(T.SLIP_COUPLING,),
            effects=(
                friction(
                    T.SLIP_COUPLING,
                    V.SLIP_ANGLE,
                    lambda a: -0.5 * np.sin(a) ** 4,
                    0.0,
                    np.pi / 2,
                    Target.DRIVE,
                ),
            ),
        ),
        Plant(
            name="roller drag doubles when driven",
            traces=(T.SLIP_COUPLING,),
            effects=(
                friction(
                    T.SLIP_COUPLING,
                    V.SLIP_ANGLE,
                    lambda a: 0.9 * np.cos(a) ** 2,
                    0.0,
                    np.pi / 2,
                    Target.TRANSVERSE,
                ),
            ),
        ),
        Plant(
            name="creep softens with rolling speed",
            traces=(T.SLIP_RATIO,),
            effects=(
                friction(
                    T.SLIP_RATIO,
                    V.ROLLING_SPEED,
                    lambda v: 1.0 / (1.0 + 60.0 * v) - 1.0,
                    0.0,
                    1.5,
                    Target.STIFFNESS,
                ),
            ),
        ),
        Plant(
            name="grip lost at large slip ratio",
            traces=(T.SLIP_RATIO, T.SLIP_SPEED),
            effects=(
                friction(T.SLIP_RATIO, V.SLIP_RATIO, lambda v: -0.45 * np.clip(v, 0.0, 1.0) ** 1.5, 0.0, 2.0),
            ),
        ),
        Plant(
            name="drifts left in proportion to speed",
            traces=(T.VELOCITY,),
            effects=(force(T.VELOCITY, V.VELOCITY_Y, 0, lambda v: -1.2 * v, -1.5, 1.5, Frame.BODY),),
        ),
        Plant(
            name="drag with the cube of the speed",
            traces=(T.VELOCITY,),
            effects=(force(T.VELOCITY, V.VELOCITY_X, 0, lambda v: -4.0 * v**3, -1.5, 1.5, Frame.BODY),),
        ),
        Plant(
            name="sloshing load",
            traces=(T.ACCELERATION,),
            effects=(force(T.ACCELERATION, V.ACCELERATION_Y, 1, lambda a: -0.9 * a, -6.0, 6.0, Frame.BODY),),
        ),
        Plant(
            name="yaws when accelerating",
            traces=(T.ACCELERATION,),
            effects=(force(T.ACCELERATION, V.ACCELERATION_X, 2, lambda a: 0.06 * a, -6.0, 6.0, Frame.BODY),),
        ),
        Plant(
            name="floor grooves",
            traces=(T.HEADING,),
            effects=(
                GeneralEffect(
                    traced_to=T.HEADING,
                    part=Part.GRIP,
                    terms=(
                        Modulation(
                            variable=V.HEADING,
                            basis=Basis.FOURIER,
                            shape=np.array([two_pi, 0.0]),
                            target=Target.BOTH,
                            coefficients=np.array([0.0, 0.0, 0.35, 0.2]),
                            wheels=np.ones(3),
                        ),
                    ),
                ),
            ),
        ),
        Plant(
            name="wind vane",
            traces=(T.HEADING,),
            effects=(
                GeneralEffect(
                    traced_to=T.HEADING,
                    part=Part.LOSSES,
                    terms=(
                        ForceTerm(
                            variable=V.HEADING,
                            basis=Basis.FOURIER,
                            shape=np.array([two_pi, 0.0]),
                            frame=Frame.FLOOR,
                            coefficients=np.array(
                                [[0.0, 0.0, 0.9, 0.0], [0.0, 0.0, 0.0, 0.9], [0.0, 0.0, 0.0, 0.0]]
                            ),
                        ),
                    ),
                ),
            ),
        ),
        Plant(
            name="polished patch",
            traces=(T.POSITION,),
            effects=(
                friction(
                    T.POSITION, V.POSITION_X, lambda x: -0.55 / (1.0 + np.exp(-(x - 0.1) / 0.03)), -3.0, 3.0
                ),
            ),
        ),
        Plant(
            name="dished floor",
            traces=(T.POSITION,),
            effects=(
                force(T.POSITION, V.POSITION_Y, 1, lambda y: -2.2 * np.tanh(2.0 * y), -3.0, 3.0, Frame.FLOOR),
            ),
        ),
        Plant(
            name="wheels warm up",
            traces=(T.TIME,),
            effects=(friction(T.TIME, V.TIME, lambda t: 0.6 * (1.0 - np.exp(-t / 1.2)), 0.0, 3.5),),
        ),
        Plant(
            name="a gust",
            traces=(T.TIME,),
            effects=(
                force(
                    T.TIME,
                    V.TIME,
                    1,
                    lambda t: 1.1 * np.exp(-(((t - 1.6) / 0.4) ** 2)),
                    0.0,
                    3.5,
                    Frame.FLOOR,
                ),
            ),
        ),
        Plant(
            name="a fan on the robot",
            traces=(T.CONSTANT_FORCE,),
            effects=(
                force(T.CONSTANT_FORCE, V.UNITY, 0, lambda u: 0.8 * np.ones_like(u), 0.0, 2.0, Frame.BODY),
            ),
        ),
        Plant(
            name="a twist on the robot",
            traces=(T.CONSTANT_FORCE,),
            effects=(
                force(T.CONSTANT_FORCE, V.UNITY, 2, lambda u: 0.05 * np.ones_like(u), 0.0, 2.0, Frame.BODY),
            ),
        ),
        Plant(
            name="soft tyres",
            traces=(T.COEFFICIENT, T.SLIP_SPEED, T.SLIP_RATIO),
            effects=(
                friction(
                    T.COEFFICIENT, V.UNITY, lambda u: -0.93 * np.ones_like(u), 0.0, 2.0, Target.STIFFNESS
                ),
            ),
        ),
        Plant(
            name="drive grip a third higher",
            traces=(T.COEFFICIENT,),
            effects=(
                friction(T.COEFFICIENT, V.UNITY, lambda u: 0.33 * np.ones_like(u), 0.0, 2.0, Target.DRIVE),
            ),
        ),
        Plant(
            name="one wheel's bearings drag",
            traces=(T.WHEEL,),
            effects=(
                friction(
                    T.WHEEL,
                    V.UNITY,
                    lambda u: 1.5 * np.ones_like(u),
                    0.0,
                    2.0,
                    Target.TRANSVERSE,
                    (0.0, 0.0, 1.0),
                ),
            ),
        ),
        Plant(
            name="one wheel is polished",
            traces=(T.WHEEL,),
            effects=(
                friction(
                    T.WHEEL,
                    V.UNITY,
                    lambda u: -0.4 * np.ones_like(u),
                    0.0,
                    2.0,
                    Target.DRIVE,
                    (1.0, 0.0, 0.0),
                ),
            ),
        ),
        Plant(
            name="drives saturate", traces=(T.ACTUATION,), commands=lambda t, om: 12.0 * np.tanh(om / 12.0)
        ),
        Plant(
            name="drives lose slow commands",
            traces=(T.ACTUATION,),
            commands=lambda t, om: om * om**2 / (om**2 + 4.0),
        ),
        Plant(
            name="barrel distortion of the camera",
            traces=(T.MEASUREMENT,),
            effects=(shift(V.POSITION_X, 0, lambda x: -0.05 * x * np.abs(x), -4.0, 4.0),),
        ),
        Plant(
            name="gyro drift",
            traces=(T.MEASUREMENT,),
            effects=(shift(V.TIME, 2, lambda t: 0.03 * t**1.5, 0.0, 3.5),),
        ),
    ]
