"""Data sets with something planted in them: drawn manoeuvres, drawn noise, one undeclared effect."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.diagnosis.sense import measure
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Recipe, Trace
from slipmargin.effects.recipe import with_effects
from slipmargin.io.robot_file import read_recipe
from slipmargin.model import nominal_model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import LoadRule, Robot
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import hermite, linear

SIGMA = np.array([0.0005, 0.0005, 0.002])
#: Knots of a drawn curve: more than a general form of the diagnosis has, which cannot write it exactly.
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


def force(
    trace: Trace,
    variable: Variable,
    axis: int,
    f: Callable[[Array], Array],
    low: float,
    high: float,
    frame: Frame,
) -> GeneralEffect:
    """A force (axis 0, 1) or moment (axis 2) f(variable) on top [N, N m], a polygon from low to high."""
    coefficients = np.zeros((3, _KNOTS))
    coefficients[axis] = f(np.linspace(low, high, _KNOTS))
    term = ForceTerm(
        variable=variable,
        basis=Basis.HATS,
        shape=np.array([low, high]),
        coefficients=coefficients,
        frame=frame,
    )
    return GeneralEffect(traced_to=trace, part=Part.LOSSES, terms=(term,))


def smooth_kiwi() -> Recipe:
    """The paper's robot without rigid sectors and with wheels called 1, 2, 3."""
    recipe = read_recipe("ohio-kiwi")
    wheels = tuple(replace(w, rigid_fraction=0.0, name=str(i + 1)) for i, w in enumerate(recipe.robot.wheels))
    return replace(recipe, robot=replace(recipe.robot, wheels=wheels))


def manoeuvres(
    random: np.random.Generator, robot: Robot, count: int, duration_s: float, rate_hz: float
) -> tuple[Array, list[Array]]:
    """Commanded wheel speeds (T, N) of drawn starts, stops, turns and sweeps; some make wheels slip."""
    t = np.arange(0.0, duration_s + 0.5 / rate_hz, 1.0 / rate_hz)
    model = nominal_model(robot, robot.surfaces[0].name)
    arm, grip, c = model.geometry.position_m, model.geometry.grip, model.geometry
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
    recipe = replace(recipe, robot=replace(recipe.robot, load_rule=rule))
    drives = None if plant is None else plant.commands
    t, commands = manoeuvres(random, recipe.robot, count, duration_s, rate_hz)
    signals, logs = [], []
    for omega in commands:
        asked = omega if drives is None else drives(t, omega)
        real = _lagged(t, asked, lag_s if drives is None else 1e-3)
        theta = random.uniform(0.0, 0.8, omega.shape[1]) + np.vstack(
            [np.zeros(omega.shape[1]), np.cumsum(0.5 * (real[1:] + real[:-1]) * np.diff(t)[:, None], axis=0)]
        )
        signals.append(hermite(t, theta, real) if drives is None else linear(t, real))
        logs.append({"omega": real, "theta": theta} if drives is None else {"omega_cmd": omega})
    return _data_set(random, recipe, plant, Batch(signals, [t] * count), t, logs)


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
    t, commands = manoeuvres(random, recipe.robot, count, duration_s, rate_hz)
    batch = Batch([linear(t, omega) for omega in commands], [t] * count, commanded=True)
    return _data_set(random, recipe, plant, batch, t, [{"omega_cmd": omega} for omega in commands])


def _data_set(
    random: np.random.Generator,
    recipe: Recipe,
    plant: Plant | None,
    batch: Batch,
    t: Array,
    logs: list[dict[str, Array]],
) -> DataSet:
    """Simulate the batch from drawn starts, measure it with noise, log ``logs`` of the wheels."""
    surface = recipe.robot.surfaces[0].name
    effects = () if plant is None else plant.effects
    model = with_effects(nominal_model(recipe.robot, surface), (*recipe.effects, *effects))
    count = len(logs)
    start = np.column_stack([random.uniform(-0.3, 0.3, (count, 2)), random.uniform(-np.pi, np.pi, count)])
    pose = batch.at_clock(model.measurement.clock).run(pack(model), start, rtol=1e-8).pose
    records = []
    for k, (run, log) in enumerate(zip(pose, logs, strict=True)):
        seen = measure(model.measurement, [t], run[None])[0] + SIGMA * random.standard_normal((len(t), 3))
        records.append(Record(name=f"trial{k:02d}", t_s=t, pose=seen, **log))
    return DataSet(
        name="planted",
        recipe=recipe,
        surface=surface,
        trials=tuple(records),
        sigma=SIGMA,
        wheel_signal=WheelSignal.COMMANDED if "omega_cmd" in logs[0] else WheelSignal.MEASURED,
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
