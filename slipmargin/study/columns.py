"""The columns of a study: static limits for all designs at once, limits in motion design by design."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.bounds import cornering, directions, headings, spin
from slipmargin.limits.motion_state import Contact
from slipmargin.physics.loads import LoadRule
from slipmargin.study import statics
from slipmargin.study.batch import Batch, batches
from slipmargin.study.objectives import Kind, names_of
from slipmargin.study.robot_on_surface import RobotOnSurface

#: Directions of motion that limits in motion are taken over [deg], and for cornering.
STEP_DEG, CORNER_STEP_DEG = 1.0, 5.0
#: Steady motion must slip where it needs more than this share of the drive grip [1].
SLIPS = 1.0 + 1e-9
#: Radius of the bend whose speed is reported [m].
BEND_M = 0.5
#: Columns of STATIC kind that are no objective: where the worst heading is.
WORST_AT = "worst_phi_rad"


def static_columns(
    designs: Sequence[RobotOnSurface | None],
    phi_rad: Array | None = None,
    names: Sequence[str] = (*names_of(Kind.STATIC), WORST_AT),
) -> tuple[dict[str, Array], dict[int, str]]:
    """Static columns (D,) of all designs and the reason of each that is impossible (its columns are NaN).

    Only the columns that are asked for by ``names`` are computed.
    """
    found, refused = batches(designs)
    table = columns_of_batches(found, designs, phi_rad, names)
    for column in table.values():
        column[list(refused)] = np.nan
    return table, refused


def columns_of_batches(
    found: Sequence[Batch],
    designs: Sequence[RobotOnSurface | None],
    phi_rad: Array | None = None,
    names: Sequence[str] = (*names_of(Kind.STATIC), WORST_AT),
) -> dict[str, Array]:
    """Static columns (D,) of the designs that are in batches; NaN for the others."""
    phi = statics.headings() if phi_rad is None else phi_rad
    table = {name: np.full(len(designs), np.nan) for name in names}
    for batch in found:
        makers = _makers(batch, phi, designs)
        for name in names:
            table[name][batch.index] = makers[name]()
    return table


def _makers(
    batch: Batch, phi: Array, designs: Sequence[RobotOnSurface | None]
) -> dict[str, Callable[[], Array]]:
    """What makes each static column (D,) of a batch."""

    @cache
    def rollers() -> Array:
        return statics.on_rollers(batch, phi, designs)

    def worst() -> Array:
        return np.asarray(rollers().min(axis=1))

    def isotropy() -> Array:
        best = rollers().max(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(best > 0.0, worst() / best, 0.0)

    return {
        "f_worst": worst,
        "f_mean": lambda: np.asarray(rollers()[:, :-1].mean(axis=1)),
        "f_best": lambda: np.asarray(rollers().max(axis=1)),
        "isotropy": isotropy,
        "f_low_worst": lambda: np.asarray(statics.lowest(batch, phi, designs).min(axis=1)),
        "f_rigid_worst": lambda: np.asarray(statics.on_rigid(batch, phi, designs).min(axis=1)),
        "f_worst_equal": lambda: _under(batch, phi, designs, LoadRule.EQUAL, worst),
        "f_worst_static": lambda: _under(batch, phi, designs, LoadRule.STATIC, worst),
        "yaw_moment_N_m": lambda: statics.yaw_moments(batch, phi, designs),
        "load_least": lambda: statics.least_loads(batch, phi, designs),
        WORST_AT: lambda: np.asarray(phi[np.argmin(rollers(), axis=1)]),
    }


def _under(
    batch: Batch,
    phi: Array,
    designs: Sequence[RobotOnSurface | None],
    rule: LoadRule,
    own: Callable[[], Array],
) -> Array:
    loads = statics.loads_by(batch, rule)
    if np.all(batch.plain) and np.array_equal(loads, batch.rest):
        return own()
    return np.asarray(statics.on_rollers(batch, phi, designs, rule).min(axis=1))


def moving_columns(design: RobotOnSurface) -> dict[str, float]:
    """The objectives of :attr:`Kind.MOTION` of one design."""
    model = design.build()
    way = headings(STEP_DEG)
    ahead = directions(model, way)
    unknown = ahead
    if float(np.max(model.grip.rigid_fraction)) > 0.0:
        unknown = directions(model, way, contact=Contact.UNKNOWN)
    rigid = directions(model, way, contact=Contact.RIGID)
    bends = cornering(model, np.array([1.0 / BEND_M]), headings(CORNER_STEP_DEG))
    values = (
        float(np.min(ahead.starting_m_s2)),
        float(np.mean(ahead.starting_m_s2)),
        _held(float(np.min(ahead.braking_m_s2))),
        _held(float(np.mean(ahead.braking_m_s2))),
        float(np.min(unknown.starting_m_s2)),
        float(np.min(bends.held_m_s)),
        spin(model).starting_rad_s2,
        float(np.mean(ahead.steady_use > SLIPS)),
        float(np.mean(rigid.steady_use > SLIPS)),
        float(np.mean(unknown.steady_use > SLIPS)),
        float(np.max(unknown.steady_use)),
    )
    return dict(zip(names_of(Kind.MOTION), values, strict=True))


def _held(braking_m_s2: float) -> float:
    """A limit of braking, or NaN where it is negative: the robot slips there whether it brakes or not."""
    return braking_m_s2 if braking_m_s2 >= 0.0 else math.nan


def lap_columns(design: RobotOnSurface) -> dict[str, float]:
    """The objectives of :attr:`Kind.LAPS` of one design; infinite where a path has no admissible motion."""
    from slipmargin.study.laps import lap_time

    return {"laps_s": lap_time(design.build())}


def columns_of(design: RobotOnSurface, kinds: tuple[Kind, ...]) -> dict[str, float]:
    """Every column of some kinds of one design; NaN where it has none.

    That is so where the design cannot be built, or where a motion has no limit because it slips anyway.
    """
    out: dict[str, float] = {}
    if Kind.STATIC in kinds:
        out |= {name: float(column[0]) for name, column in static_columns([design])[0].items()}
    names = [name for kind in kinds if kind is not Kind.STATIC for name in names_of(kind)]
    try:
        if Kind.MOTION in kinds:
            out |= moving_columns(design)
        if Kind.LAPS in kinds:
            out |= lap_columns(design)
    except (InputError, NoSolution):
        out |= dict.fromkeys(names, math.nan)
    return {name: value if math.isfinite(value) else math.nan for name, value in out.items()}
