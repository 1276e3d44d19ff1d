"""Pulls of a robot whose effects are known: what diagnoses by pulls are tested and measured on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.pull_problem import setting_limits
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.catalogue import effect_class
from slipmargin.io.robot_file import read_recipe
from slipmargin.physics.sectors import on_rigid, pitch

FULL = np.deg2rad(np.arange(0.0, 360.0, 15.0))
#: The orientations of Fig. 8: "plotting results from 0 to π/2 rad in robot orientation is sufficient".
QUARTER = np.deg2rad(np.arange(0.0, 91.0, 7.5))


def robot(rigid_fraction: float = 0.0) -> Recipe:
    """The paper's robot with this share of rigid material on every wheel."""
    kiwi = read_recipe("ohio-kiwi")
    wheels = tuple(replace(w, rigid_fraction=rigid_fraction) for w in kiwi.robot.wheels)
    return Recipe(robot=replace(kiwi.robot, wheels=wheels))


def planted(name: str, **values: float) -> AnyEffect:
    """An effect of the catalogue, parameters that are not named at null."""
    kind = effect_class(name)
    assert kind is not None
    return kind.of(np.array([values.get(p.name, p.null) for p in kind.parameters]))


def pulled(
    real: Recipe,
    *,
    phi_rad: Array = FULL,
    repeats: int = 2,
    sigma_N: float = 0.06,
    angles: bool = True,
    seed: int = 1,
) -> Pulls:
    """Pulls of a robot from random wheel angles, with noise; ``angles``: whether they are recorded."""
    random = np.random.default_rng(seed)
    model = real.build("paper")
    phi = np.repeat(phi_rad, repeats)
    theta = random.uniform(0.0, 2.0 * np.pi, (len(phi), model.count))
    rigid = on_rigid(theta, pitch(model.grip.rollers), model.grip.rigid_fraction)
    settings = np.array([[p, 0.0, np.nan, np.nan, 0.0] for p in phi])
    force = np.array([setting_limits(model, s[None], r)[0] for s, r in zip(settings, rigid, strict=True)])
    force += sigma_N * random.standard_normal(len(phi))
    return Pulls(phi_rad=phi, force_N=force, theta_rad=theta if angles else None)


def data_set(believed: Recipe, pulls: Pulls) -> DataSet:
    """A data set of pulls alone."""
    return DataSet(
        name="pulls",
        recipe=believed,
        surface="paper",
        wheel_signal=WheelSignal.MEASURED,
        trials=(),
        pulls=pulls,
    )
