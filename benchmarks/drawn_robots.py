"""Random robots of every kind that the limits know, for the benchmarks that draw them."""

from __future__ import annotations

import numpy as np

from slipmargin.errors import InputError
from slipmargin.model import Model, nominal_model
from slipmargin.physics.loads import sharing_matrix
from slipmargin.robot import (
    Body,
    Coefficients,
    FrictionLaw,
    GripShape,
    LoadRule,
    Motor,
    Robot,
    Surface,
    Wheel,
)


def wheel_set(
    place_m: np.ndarray, aim_deg: np.ndarray, turn_deg: np.ndarray, radius_m: float
) -> tuple[Wheel, ...]:
    """Wheels w1 … wN at (N, 2) places, driving and with rollers turned by (N,) angles."""
    return tuple(
        Wheel(
            name=f"w{i + 1}",
            position_m=place,
            drive_direction_deg=float(aim),
            radius_m=radius_m,
            roller_angle_deg=float(turn),
        )
        for i, (place, aim, turn) in enumerate(zip(place_m, aim_deg, turn_deg, strict=True))
    )


def floor_of(drive: float, transverse: float) -> Surface:
    """A floor named floor, on whose rigid material wheels grip alike in both directions."""
    return Surface(
        name="floor",
        roller=Coefficients(drive=drive, transverse=transverse),
        rigid=Coefficients(drive=drive, transverse=drive),
    )


def drawn_robot(rng: np.random.Generator) -> Model:
    """Three to six wheels, omni, mecanum or both, any grip and load rule, mass off centre and raised."""
    while True:
        n, size = int(rng.integers(3, 7)), rng.uniform(0.08, 0.4)
        kind = rng.choice(("omni", "mecanum", "mixed"))
        at = 2.0 * np.pi * (np.arange(n) + rng.uniform(-0.25, 0.25, n)) / n
        place = size * rng.uniform(0.7, 1.0, n)[:, None] * np.column_stack([np.cos(at), np.sin(at)])
        mecanum = (rng.random(n) < 0.5) if kind == "mixed" else np.full(n, kind == "mecanum")
        aim = np.where(mecanum, 90.0, np.rad2deg(at) + 90.0 + rng.uniform(-25.0, 25.0, n))
        turn = np.where(mecanum, np.where(np.arange(n) % 2 == 0, 45.0, -45.0), 0.0)
        radius = rng.uniform(0.025, 0.08)
        wheels = wheel_set(place, aim, turn, radius)
        rule = LoadRule(rng.choice([r.value for r in LoadRule]))
        way = rng.uniform(-np.pi, np.pi)
        lean = np.array([np.cos(way), np.sin(way)])
        reach = 1.0 / (n * -np.min(sharing_matrix(place)[:, 1:] @ lean))  # where a wheel would carry nothing
        com = place.mean(axis=0) + rng.uniform(0.0, 0.5) * reach * lean
        fractions = sharing_matrix(place) @ np.array([1.0, *com])
        mass, drive = rng.uniform(1.0, 40.0), rng.uniform(0.2, 0.9)
        motor = None
        if rng.random() < 0.5:
            top = rng.uniform(1.0, 4.0) / radius
            stall = (
                rng.uniform(0.4, 3.0) * drive * mass * 9.81 / n * radius
            )  # from weak to slipping at standstill
            motor = Motor(max_speed_rad_s=top, stall_torque_N_m=stall if rng.random() < 0.8 else None)
        floor = floor_of(drive, drive * rng.uniform(0.03, 0.3))
        try:
            robot = Robot(
                name=f"drawn-{kind}-{n}",
                wheels=wheels,
                surfaces=(floor,),
                load_rule=rule,
                load_fractions=fractions / fractions.sum() if rule is LoadRule.FIXED else None,
                body=Body(
                    mass_kg=mass,
                    inertia_kg_m2=mass * (rng.uniform(0.5, 0.9) * size) ** 2,
                    com_m=com,
                    com_height_m=size * rng.uniform(0.0, 0.8),
                ),
                friction=FrictionLaw(grip=GripShape(rng.choice([g.value for g in GripShape]))),
                motor=motor,
            )
            model = nominal_model(robot, "floor")
        except InputError:
            continue
        along = model.wrench_maps()[0] / np.array([[1.0], [1.0], [size]])
        if np.linalg.svd(along, compute_uv=False)[-1] > 0.3:
            return model
