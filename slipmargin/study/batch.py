"""Many designs as arrays, so that static limits are computed for all of them at once.

Designs without effects are read straight off their data sheets (the same equations as
:mod:`slipmargin.model`, one array for all designs); designs with effects are built, one model each.
Loads are shares of m g and forces come out per m g.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.model.parts import on_rollers
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.frames import directions, moment
from slipmargin.physics.grips import polyhedral
from slipmargin.physics.loads import sharing_matrix
from slipmargin.physics.variables import Target
from slipmargin.robot import GripShape, LoadRule, Robot
from slipmargin.study.robot_on_surface import RobotOnSurface

#: A load below minus this share of m g is a wheel off the floor [1].
_OFF = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """D designs with N wheels each.

    ``index`` (D,) places of these designs in the study; ``maps`` (D, 3, N, 2) wrench per unit force along ĝ
    and f̂ about the centre of mass; ``roller``, ``rigid`` (D, N, 2) coefficients; ``rigid_fraction`` (D, N);
    ``rest`` the design's own loads, ``static`` those of statics, (D, N) [shares of m g]; ``weight_N`` (D,);
    ``plain`` (D,): a zonotope describes the design (box grip, no bias, friction and loads known at rest);
    ``level`` (D,): the centre of mass is above the wheels' polygon.
    """

    index: NDArray[np.int_]
    maps: Array
    roller: Array
    rigid: Array
    rigid_fraction: Array
    rest: Array
    static: Array
    weight_N: Array
    plain: NDArray[np.bool_]
    level: NDArray[np.bool_]

    @property
    def wheels(self) -> int:
        """N."""
        return int(self.maps.shape[2])

    def take(self, rows: NDArray[np.bool_]) -> Batch:
        """Some of the designs."""
        return replace(self, **{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def batches(designs: Sequence[RobotOnSurface | None]) -> tuple[list[Batch], dict[int, str]]:
    """Designs grouped by wheel count, and for each design that cannot be built the reason.

    ``None`` stands for a design that was refused earlier; it is left out.
    """
    groups: dict[int, list[tuple[int, RobotOnSurface]]] = {}
    refused: dict[int, str] = {}
    built: dict[int, Model] = {}
    for i, design in enumerate(designs):
        if design is None:
            continue
        if design.recipe.effects:
            try:
                built[i] = design.build()
            except InputError as fault:
                refused[i] = str(fault)
                continue
        groups.setdefault(len(design.robot.wheels), []).append((i, design))
    out = [_batch(rows, built) for _, rows in sorted(groups.items())]
    for batch in out:
        for d in np.flatnonzero(~batch.level | np.any(batch.rest < -_OFF, axis=1)).tolist():
            worst = int(np.argmin(batch.rest[d]))
            refused[int(batch.index[d])] = (
                "the centre of mass is outside the wheels' polygon: the robot falls over"
                if not batch.level[d]
                else f"wheel {worst + 1} would carry {batch.rest[d, worst]:.3g} m g"
            )
    return out, refused


def plain(found: Sequence[Batch], count: int) -> NDArray[np.bool_]:
    """Which of ``count`` designs zonotopes describe."""
    out = np.zeros(count, dtype=bool)
    for batch in found:
        out[batch.index] = batch.plain
    return out


def _batch(rows: list[tuple[int, RobotOnSurface]], built: dict[int, Model]) -> Batch:
    data = _from_robots([m for _, m in rows])
    for d, (i, _) in enumerate(rows):
        if i in built:
            _overwrite(data, d, built[i])
    arm = data.pop("place") - data["com"][:, None]
    data["maps"] = np.stack([_columns(arm, data.pop("grip")), _columns(arm, data.pop("free"))], axis=3)
    angle = np.sort(np.arctan2(arm[..., 1], arm[..., 0]), axis=1)
    gap = np.diff(np.concatenate([angle, angle[:, :1] + 2.0 * np.pi], axis=1), axis=1)
    data.pop("com")
    return Batch(index=np.array([i for i, _ in rows]), level=np.max(gap, axis=1) <= np.pi + 1e-9, **data)


def _from_robots(designs: list[RobotOnSurface]) -> dict[str, Any]:
    robots = [m.robot for m in designs]
    n = len(robots[0].wheels)
    place = np.array([[w.position_m for w in r.wheels] for r in robots])
    turn = np.deg2rad([[w.drive_direction_deg + w.roller_angle_deg for w in r.wheels] for r in robots])
    com = np.array([r.body.com_m for r in robots])
    floor = [r.surface(m.surface) for r, m in zip(robots, designs, strict=True)]
    static = _static(place, com)
    roller = np.array([[(s.roller.drive, s.roller.transverse)] * n for s in floor])
    rigid = np.array([[(s.rigid.drive, s.rigid.transverse)] * n for s in floor])
    fraction = np.array([[w.rigid_fraction for w in r.wheels] for r in robots])
    return {
        "place": place,
        "com": com,
        "grip": directions(turn),
        "free": directions(turn - np.pi / 2.0),
        "roller": on_rollers(roller, rigid, fraction),
        "rigid": rigid,
        "rigid_fraction": fraction,
        "rest": np.array([_shares(r, row) for r, row in zip(robots, static, strict=True)]),
        "static": static,
        "weight_N": np.array([r.body.mass_kg for r in robots]) * GRAVITY_M_S2,
        "plain": np.array([r.friction.grip is GripShape.BOX and r.unevenness_mm is None for r in robots]),
    }


def _overwrite(data: dict[str, Any], d: int, model: Model) -> None:
    """A built model's arrays in place of the data sheet's (``data`` is this module's own)."""
    grip, weight = model.grip, model.inertia.weight_N
    for name, value in (
        ("place", model.geometry.position_m),
        ("com", model.inertia.com_m),
        ("grip", model.geometry.grip),
        ("free", model.geometry.free),
        ("roller", grip.roller),
        ("rigid", grip.rigid),
        ("rigid_fraction", grip.rigid_fraction),
        ("rest", model.loads.rest_N / weight),
        ("weight_N", weight),
    ):
        data[name][d] = value
    data["static"][d] = sharing_matrix(model.geometry.position_m) @ np.array([1.0, *model.inertia.com_m])
    varies = any(t.target is not Target.STIFFNESS for t in grip.multipliers)
    known = polyhedral(grip.shape, grip.coupling) and not varies and not len(model.loads.uneven_N)
    data["plain"][d] = known and not model.external.terms


def _static(place: Array, com: Array) -> Array:
    """(D, N) loads from the centres of mass [m g]: Σ N = 1, Σ N p = com, of least norm."""
    ones = np.ones((*place.shape[:2], 1))
    moments = np.swapaxes(np.concatenate([ones, place], axis=2), 1, 2)
    asked = np.concatenate([np.ones((len(com), 1)), com], axis=1)[:, :, None]
    # Least norm: N = Mᵀ (M Mᵀ)⁻¹ b.
    return np.asarray(
        (np.swapaxes(moments, 1, 2) @ np.linalg.solve(moments @ np.swapaxes(moments, 1, 2), asked))[..., 0]
    )


def _shares(robot: Robot, static: Array) -> Array:
    if robot.load_rule is LoadRule.EQUAL:
        return np.full(len(static), 1.0 / len(static))
    if robot.load_rule is LoadRule.FIXED:
        assert robot.load_fractions is not None
        return robot.load_fractions
    return static


def _columns(arm: Array, way: Array) -> Array:
    lever = moment(arm[..., 0], arm[..., 1], way[..., 0], way[..., 1])
    return np.stack([way[..., 0], way[..., 1], lever], axis=1)
