"""Data sets with something planted in them: drawn manoeuvres, drawn noise, one undeclared effect.

The plants here are inventions of this file: curves over one variable that no catalogue entry holds.
They are drawn through many knots, so the general forms of the diagnosis cannot write them exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnose.sense import measure
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Recipe, Trace
from slipmargin.effects.recipe import with_effects
from slipmargin.io.data_set import DataSet, WheelSignal
from slipmargin.model import nominal_model
from slipmargin.model.terms import ForceTerm, Modulation, PoseShift
from slipmargin.model.variables import Basis, Frame, Target, Variable
from slipmargin.motions.record import Record
from slipmargin.robot import LoadRule, Robot
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import hermite, linear

SIGMA = np.array([0.0005, 0.0005, 0.002])
_KNOTS = 41


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plant:
    """An undeclared effect and the variable a diagnosis should trace it to.

    ``commands`` maps commanded to real wheel speeds (T, N) where the plant is in the drives.
    """

    name: str
    traces: tuple[Trace, ...]
    effects: tuple[AnyEffect, ...] = ()
    commands: Callable[[Array, Array], Array] | None = None
    load_rule: LoadRule = LoadRule.EQUAL


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


def manoeuvres(
    random: np.random.Generator, robot: Robot, count: int, duration_s: float, rate_hz: float
) -> tuple[Array, list[Array]]:
    """Commanded wheel speeds (T, N) of drawn starts, stops, turns and sweeps; some make wheels slip."""
    t = np.arange(0.0, duration_s + 0.5 / rate_hz, 1.0 / rate_hz)
    model = nominal_model(robot, robot.surfaces[0].name)
    arm, grip, c = model.contacts.position_m, model.contacts.grip, model.contacts
    rows = np.column_stack([grip, arm[:, 0] * grip[:, 1] - arm[:, 1] * grip[:, 0]])
    along = c.radius_m * np.sum(c.drive * grip, axis=1)
    reach = float(np.mean(np.hypot(*arm.T)))
    runs = []
    for k in range(count):
        size = random.uniform(0.15, 0.6)
        way = random.uniform(0.0, 2.0 * np.pi)
        turn = random.uniform(-1.0, 1.0) * size / reach * (1.0 if k % 3 == 0 else 0.3)
        top = np.array([size * np.cos(way), size * np.sin(way), turn])
        if k % 4 == 3:
            phase = 2.0 * np.pi * np.cumsum(np.linspace(0.3, random.uniform(1.0, 2.5), len(t))) / rate_hz
            twist = np.outer(np.sin(phase), top)
        else:
            ramp = random.choice([0.02, 0.2, 0.6])
            first = np.clip(t / ramp, 0.0, 1.0) * np.clip((0.5 * duration_s - t) / ramp, 0.0, 1.0)
            second = np.clip((t - 0.55 * duration_s) / ramp, 0.0, 1.0) * np.clip(
                (0.9 * duration_s - t) / ramp, 0.0, 1.0
            )
            other = random.uniform(-0.6, 0.6, 3) * np.array([1.0, 1.0, 0.5 / reach])
            twist = np.outer(first, top) + np.outer(second, other)
        runs.append(-(twist @ rows.T) / along)
    return t, runs


def planted(
    recipe: Recipe,
    plant: Plant | None,
    seed: int,
    *,
    count: int = 10,
    duration_s: float = 3.5,
    rate_hz: float = 200.0,
    lag_s: float = 0.03,
) -> DataSet:
    """A data set of the recipe's robot with a plant that its file does not mention."""
    random = np.random.default_rng(seed)
    rule = LoadRule.EQUAL if plant is None else plant.load_rule
    robot = replace(recipe.robot, load_rule=rule)
    recipe = replace(recipe, robot=robot)
    surface = robot.surfaces[0].name
    nominal = nominal_model(robot, surface)
    effects = () if plant is None else plant.effects
    model = with_effects(nominal, (*recipe.effects, *effects))
    commanded = plant is not None and plant.commands is not None
    t, commands = manoeuvres(random, robot, count, duration_s, rate_hz)
    lag = 1e-3 if commanded else lag_s
    signals, logs = [], []
    for omega in commands:
        asked = plant.commands(t, omega) if plant is not None and plant.commands is not None else omega
        real = _lagged(t, asked, lag)
        theta = random.uniform(0.0, 0.8, omega.shape[1]) + np.vstack(
            [np.zeros(omega.shape[1]), np.cumsum(0.5 * (real[1:] + real[:-1]) * np.diff(t)[:, None], axis=0)]
        )
        signals.append(linear(t, real) if commanded else hermite(t, theta, real))
        logs.append((real, theta))
    start = np.column_stack([random.uniform(-0.3, 0.3, (count, 2)), random.uniform(-np.pi, np.pi, count)])
    pose = Batch(signals, [t] * count).run(pack(model), start, rtol=1e-8).pose
    records = []
    for k in range(count):
        seen = measure(model.sensing, t, pose[k]) + SIGMA * random.standard_normal((len(t), 3))
        real, theta = logs[k]
        wheels = {"omega_cmd": commands[k]} if commanded else {"omega": real, "theta": theta}
        records.append(Record(name=f"trial{k:02d}", t_s=t, pose=seen, **wheels))
    return DataSet(
        name="planted",
        recipe=recipe,
        surface=surface,
        trials=tuple(records),
        sigma=SIGMA,
        wheel_signal=WheelSignal.COMMANDED if commanded else WheelSignal.MEASURED,
    )


def commanded(
    recipe: Recipe,
    plant: Plant,
    seed: int,
    *,
    count: int = 10,
    duration_s: float = 3.5,
    rate_hz: float = 200.0,
) -> DataSet:
    """A data set that logs commands only; the plant's effects are in the drives."""
    random = np.random.default_rng(seed)
    surface = recipe.robot.surfaces[0].name
    model = with_effects(nominal_model(recipe.robot, surface), (*recipe.effects, *plant.effects))
    t, commands = manoeuvres(random, recipe.robot, count, duration_s, rate_hz)
    start = np.column_stack([random.uniform(-0.3, 0.3, (count, 2)), random.uniform(-np.pi, np.pi, count)])
    batch = Batch([linear(t, omega) for omega in commands], [t] * count, commanded=True)
    pose = batch.run(pack(model), start, rtol=1e-8).pose
    records = tuple(
        Record(
            name=f"trial{k:02d}",
            t_s=t,
            omega_cmd=commands[k],
            pose=pose[k] + SIGMA * random.standard_normal((len(t), 3)),
        )
        for k in range(count)
    )
    return DataSet(
        name="commanded",
        recipe=recipe,
        surface=surface,
        trials=records,
        sigma=SIGMA,
        wheel_signal=WheelSignal.COMMANDED,
    )


def _lagged(t: Array, omega: Array, lag_s: float) -> Array:
    """First-order answer of the drives to commands with straight lines between rows."""
    out = np.zeros_like(omega)
    for k in range(1, len(t)):
        h = t[k] - t[k - 1]
        slope = (omega[k] - omega[k - 1]) / h
        decay = np.exp(-h / lag_s)
        out[k] = omega[k] - slope * lag_s + (out[k - 1] - omega[k - 1] + slope * lag_s) * decay
    return out
