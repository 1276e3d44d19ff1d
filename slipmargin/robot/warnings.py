"""Sentences for a robot whose file says what cannot all be so, or says something that has no effect."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import numpy as np

from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.grips import GripShape
from slipmargin.physics.loads import LoadRule, load_centre, sharing_matrix, transfer
from slipmargin.robot.mistakes import unlikely
from slipmargin.robot.robot import Robot
from slipmargin.robot.uncertain import spread


def warnings(robot: Robot) -> tuple[str, ...]:
    """One sentence for each contradiction, key without effect and unlikely number; empty if there is none."""
    found = [contradiction(robot), _height_without_effect(robot)]
    found += [*_coefficients_without_effect(robot), *unlikely(robot)]
    return tuple(sentence for sentence in found if sentence is not None)


#: Share of draws outside their key's range above which a spread is spoken of [1].
CUT_OFF = 0.01
#: Of which keys a command draws the spread, as beginnings of their names: of none, of friction alone, of all.
NO_SPREAD: tuple[str, ...] = ()
FRICTION_SPREAD = ("surface.",)
EVERY_SPREAD = ("",)


def uncertain_keys(robot: Robot, surface: str) -> tuple[str, ...]:
    """The keys of the robot file that have a spread, on one of its surfaces."""
    return tuple(_uncertain(robot, surface))


def _uncertain(robot: Robot, surface: str) -> dict[str, Any]:
    body, floor = robot.body, robot.surface(surface)
    found = {
        **{f"body.{k}": getattr(body, k) for k in ("mass_kg", "inertia_kg_m2", "com_m", "com_height_m")},
        "loads.fractions": robot.load_fractions,
        **{
            f"surface.{surface}.{material}.{k}": getattr(getattr(floor, material), k)
            for material in ("roller", "rigid")
            for k in ("drive", "transverse")
        },
    }
    return {key: value for key, value in found.items() if spread(value)}


def cut_off(robot: Robot, surface: str) -> tuple[str, ...]:
    """A sentence for each spread of which a share of draws that counts would be no robot."""
    found = []
    for key, value in _uncertain(robot, surface).items():
        for one in getattr(value, "each", (value,)):
            sd = getattr(one, "sd", None)
            if sd is None:
                continue
            outside = sum(
                NormalDist().cdf(sign * (end - one) / sd) for sign, end in zip((1, -1), one.span, strict=True)
            )
            if outside > CUT_OFF:
                found.append(
                    f"{key}: {100.0 * outside:.2g} % of what {one.written()} may be lies outside the range "
                    "of the key, and is taken at its edge; give a smaller spread, or an interval"
                )
    return tuple(found)


def unused(robot: Robot, surface: str, *, spread: tuple[str, ...], band: bool) -> tuple[str, ...]:
    """A sentence for what the file says of its own uncertainty and a command does not use.

    Parameters
    ----------
    spread : tuple of str
        How the keys begin whose spreads the command draws from, such as :data:`FRICTION_SPREAD`.
    band : bool
        Whether it counts the band of loads.
    """
    found = []
    names = [key for key in uncertain_keys(robot, surface) if not key.startswith(spread)]
    if names:
        found.append(
            f"{', '.join(names)}: taken at the middle; the spread counts in bounds, sweep and plan, that of "
            "friction in a design of several robots too"
        )
    if robot.unevenness_mm is not None and not band:
        found.append(
            "loads.unevenness_mm: taken as an even floor; the band of loads counts in bounds, sweep, plan, "
            "check, design and explore only"
        )
    return tuple(found)


def contradiction(robot: Robot) -> str | None:
    """The sentence for a robot whose stated wheel loads contradict its centre of mass.

    Returns
    -------
    str or None
        By how much the worst wheel's load is off and where the centre of mass would have to be, or None
        where the loads agree to 1 % of m g / N.
    """
    place = np.array([w.position_m for w in robot.wheels])
    n = len(place)
    fractions = np.full(n, 1.0 / n) if robot.load_rule is LoadRule.EQUAL else robot.load_fractions
    if fractions is None:
        return None
    static = sharing_matrix(place) @ np.array([1.0, *robot.body.com_m])
    gap = fractions - static
    if np.max(np.abs(gap)) < 0.01 / n:
        return None
    worst = int(np.argmax(np.abs(gap)))
    need = np.round(load_centre(place, fractions), 9) + 0.0  # no minus zero, no 1e-19
    return (
        f"loads: the {robot.load_rule.value} load model gives wheel {robot.wheels[worst].name} "
        f"{fractions[worst]:.4f} m g, but statics with the centre of mass at "
        f"({robot.body.com_m[0]:.4g}, {robot.body.com_m[1]:.4g}) m gives it {static[worst]:.4f} m g; "
        f"these loads need the centre of mass at ({need[0]:.4g}, {need[1]:.4g}) m"
    )


def _height_without_effect(robot: Robot) -> str | None:
    if robot.body.com_height_m == 0.0 or robot.load_rule is LoadRule.QUASI_STATIC:
        return None
    shift = transfer(robot.geometry.position_m, robot.body.mass_kg, robot.body.com_height_m)
    most = float(np.max(np.linalg.norm(shift, axis=1)))
    share = most * len(robot.wheels) / (robot.body.mass_kg * GRAVITY_M_S2)
    return (
        f"body.com_height_m: the {robot.load_rule.value} load model shifts no load with the acceleration, "
        f"but at a height of {robot.body.com_height_m:g} m each 1 m/s² shifts up to {most:.3g} N "
        f'({100 * share:.3g} % of m g / N) at a wheel; use model = "quasi-static"'
    )


def _coefficients_without_effect(robot: Robot) -> list[str]:
    found = []
    sectors = any(w.rigid_fraction > 0.0 for w in robot.wheels)
    rollers = any(w.rigid_fraction < 1.0 for w in robot.wheels)
    for surface in robot.surfaces:
        if not rollers and surface.roller != surface.rigid:
            found.append(
                f"surface.{surface.name}.roller: has no effect, since every wheel is rigid all round "
                "(rigid_fraction = 1)"
            )
        if sectors and surface.roller == surface.rigid:
            found.append(
                f"surface.{surface.name}: roller and rigid have the same coefficients, so rigid_fraction "
                "and rollers of the wheels have no effect on this floor"
            )
        for key, pair in (("roller", surface.roller), ("rigid", surface.rigid)):
            if robot.friction.grip is GripShape.DISC_STRIP and pair.transverse > pair.drive:
                found.append(
                    f'surface.{surface.name}.{key}: the grip "disc-strip" holds the force within the drive '
                    f"coefficient {pair.drive:g}, so the transverse one acts as {pair.drive:g}, "
                    f"not {pair.transverse:g}"
                )
    return found
