"""Drawn robots: three omni wheels, four omni wheels, four mecanum wheels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from judged.simulator import GRAVITY, GRIPS, LAWS, Array, Machine, sharing, transfer

KINDS = ("three", "four", "mecanum")


@dataclass(frozen=True, slots=True, kw_only=True)
class Wishes:
    """What a family asks of the robot it is planted in."""

    plain_loads: bool = False  #: equal loads, no height, centre of mass at the origin
    box: bool = False
    no_rigid: bool = False
    no_motor: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """A robot as its file describes it, and the same as numbers."""

    kind: str
    machine: Machine
    text: str


def _wheels(rng: np.random.Generator, kind: str) -> tuple[Array, Array, Array]:
    """Places (N, 2), drive directions and roller angles in degrees."""
    if kind == "three":
        reach = rng.uniform(0.08, 0.18)
        spread = float(rng.choice([15.0, 30.0, 30.0, float(np.round(rng.uniform(10.0, 35.0)))]))
        axle = np.array([spread, 180.0 - spread, -90.0])
        direction = axle + 90.0
        roller = np.zeros(3)
        place = reach * np.column_stack([np.cos(np.radians(axle)), np.sin(np.radians(axle))])
    elif kind == "four":
        reach = rng.uniform(0.1, 0.22)
        spread = float(np.round(rng.uniform(38.0, 52.0)))
        axle = np.array([spread, 180.0 - spread, 180.0 + spread, -spread])
        direction = axle + 90.0
        roller = np.zeros(4)
        place = reach * np.column_stack([np.cos(np.radians(axle)), np.sin(np.radians(axle))])
    else:
        half_x, half_y = rng.uniform(0.09, 0.2), rng.uniform(0.1, 0.22)
        place = np.array([[half_x, half_y], [-half_x, half_y], [-half_x, -half_y], [half_x, -half_y]])
        direction = np.full(4, 90.0)
        roller = np.array([45.0, -45.0, 45.0, -45.0])
    return np.round(place, 4), direction, roller


def draw_robot(rng: np.random.Generator, wishes: Wishes) -> Robot:
    """A robot with drawn dimensions, masses, coefficients, load rule, friction law and grip."""
    kind = KINDS[int(rng.integers(3))]
    position, direction, roller = _wheels(rng, kind)
    n = len(position)
    reach = float(np.mean(np.hypot(*position.T)))
    mass = float(np.round(rng.uniform(2.0, 14.0), 2))
    inertia = float(np.round(mass * reach**2 * rng.uniform(0.45, 1.0), 4))
    radius = float(np.round(rng.uniform(0.025, 0.06), 4))
    rollers = int(rng.integers(6, 13))
    mu_w = float(np.round(rng.uniform(0.22, 0.55), 3))
    mu_t = float(np.round(mu_w * rng.uniform(0.12, 0.4), 3))
    mu_r = np.round(mu_w * rng.uniform(1.2, 1.9, size=2), 3)
    k = float(np.round(np.exp(rng.uniform(np.log(250.0), np.log(1200.0)))))
    law = int(rng.choice([0, 0, 1, 2]))
    shape = 0 if wishes.box else int(rng.choice([0, 0, 0, 0, 1, 2]))
    fraction = (
        0.0 if wishes.no_rigid else float(rng.choice([0.0, 0.0, 0.0, np.round(rng.uniform(0.04, 0.15), 3)]))
    )
    rule = "equal" if wishes.plain_loads else str(rng.choice(["equal", "equal", "static", "quasi-static"]))
    com, height = np.zeros(2), 0.0
    if rule != "equal":
        com = np.round(rng.uniform(-0.12, 0.12, size=2) * reach, 4)
    if rule == "quasi-static":
        height = float(np.round(rng.uniform(0.2, 0.7) * reach, 3))
    motor = not wishes.no_motor and bool(rng.random() < 0.4)
    share = sharing(position)
    s, g = np.radians(direction), np.radians(direction + roller)
    weight = mass * GRAVITY
    machine = Machine(
        mass=mass,
        inertia=inertia,
        com=com,
        com_height=height,
        position=position,
        drive=np.column_stack([np.cos(s), np.sin(s)]),
        grip=np.column_stack([np.cos(g), np.sin(g)]),
        free=np.column_stack([-np.sin(g), np.cos(g)]),
        radius=np.full(n, radius),
        rollers=np.full(n, float(rollers)),
        rigid_fraction=np.full(n, fraction),
        mu_drive=np.full(n, mu_w),
        mu_transverse=np.full(n, mu_t),
        mu_rigid=np.tile(mu_r, (n, 1)),
        k=np.full(n, k),
        law=law,
        shape=shape,
        coupling=1.0 if shape else 0.0,
        rest=np.full(n, weight / n) if rule == "equal" else share @ (weight * np.array([1.0, *com])),
        per_acceleration=np.zeros((n, 2)),
        per_moment=np.ascontiguousarray(share[:, 1:]),
    )
    if height > 0.0:
        machine = machine._replace(per_acceleration=transfer(machine, height))
    lines = [
        "schema = 1",
        f'name = "{kind}"',
        "",
        "[body]",
        f"mass_kg = {mass}",
        f"inertia_kg_m2 = {inertia}",
        f"com_m = [{com[0]}, {com[1]}]",
        f"com_height_m = {height}",
        "",
        "[loads]",
        f'model = "{rule}"',
        "",
        "[friction]",
        f'law = "{LAWS[law]}"',
        f"k_s_per_m = {k}",
        f'grip = "{GRIPS[shape]}"',
    ]
    if motor:  # far stronger than these runs ask: it must change nothing
        stall = float(np.round(8.0 * mu_w * weight * radius, 2))
        lines += ["", "[motor]", "max_speed_rad_s = 400.0", f"stall_torque_N_m = {stall}"]
    for i in range(n):
        lines += [
            "",
            "[[wheel]]",
            f'name = "{i + 1}"',
            f"position_m = [{position[i, 0]}, {position[i, 1]}]",
            f"drive_direction_deg = {direction[i]}",
            f"radius_m = {radius}",
            f"roller_angle_deg = {roller[i]}",
            f"rollers = {rollers}",
            f"rigid_fraction = {fraction}",
        ]
    lines += [
        "",
        "[surface.floor]",
        f"roller = {{ drive = {mu_w}, transverse = {mu_t} }}",
        f"rigid = {{ drive = {mu_r[0]}, transverse = {mu_r[1]} }}",
        "",
    ]
    return Robot(kind=kind, machine=machine, text="\n".join(lines))
