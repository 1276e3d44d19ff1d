"""The report pages of ``bounds`` and ``sweep``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits import Isotropic, Sweep
from slipmargin.limits.bounds_summary import Bounds
from slipmargin.report import bounds as bounds_words, sweep as sweep_words
from slipmargin.report.page import Fact, Image, Page, Picture, Table
from slipmargin.report.result_page import result_page
from slipmargin.report.text import degrees, towards, two_digits


def bounds_page(
    b: Bounds, images: Mapping[str, Image], lines: Sequence[str], warnings: Sequence[str]
) -> Page:
    """What the robot may do on this floor, and what would raise it."""
    front = b.model.convention.from_front
    full = b.everywhere.full
    way = towards(float(front(full.heading_rad[full.weakest])))
    wheels = " and ".join(full.starting.wheels[full.weakest])
    robot, floor = b.model.robot, b.model.surface
    good = b.recommended_m_s2 > 0.0
    lead = (
        f"{robot} on {floor} may speed up at {b.recommended_m_s2:.3g} m/s² in any direction: no wheel slips, "
        f"and {100 * b.margin:g} % of the grip stays in reserve{_motors(b)}."
        if good
        else f"{robot} on {floor} has no safe acceleration: {_slipping(b)}."
    )
    caps = b.speeds
    return result_page(
        title=f"Limits of {robot} on {floor}",
        lead=lead,
        good=good,
        facts=(
            Fact(
                label="Safe in any direction",
                value=f"{b.recommended_m_s2:.3g} m/s²",
                note=f"{100 * b.margin:g} % in reserve",
            ),
            Fact(
                label="Limit in the weakest direction",
                value=f"{max(b.traction_m_s2, 0.0):.3g} m/s²",
                note=f"{way}; slips first: {wheels}",
            ),
            Fact(
                label="With one friction coefficient",
                value=f"{b.isotropic_m_s2:.3g} m/s²",
                note="μ g, what many tools assume",
            ),
            Fact(
                label="Turning on the spot",
                value=f"{b.spin.starting_rad_s2:.3g} rad/s²",
                note="with the reserve",
            ),
        ),
        pictures=(
            Picture(
                name="limits",
                image=images["limits"],
                alt="Polar curves of the acceleration limits by direction of motion",
                caption="Acceleration limit by direction of motion, forwards up.",
            ),
            Picture(
                name="steady",
                image=images["steady"],
                alt="Polar curve of the share of the grip that constant speed needs",
                caption="The share of the grip that constant speed needs; above 1 a wheel slips.",
            ),
            Picture(
                name="cornering",
                image=images["cornering"],
                alt="Cornering speed over curvature",
                caption="How fast a bend may be driven; curvature 2 is a radius of half a metre.",
            ),
        ),
        tables=(
            _table(_by_direction(b), *bounds_words.direction_rows(b, 24)),
            _table("Fastest cornering by curvature", *bounds_words.corner_rows(b)),
        ),
        next_steps=_bounds_next(b, caps[0]),
        lines=lines,
        warnings=warnings,
    )


def _motors(b: Bounds) -> str:
    return f" at least; {bounds_words.motors_then(b.model)} allow no more" if b.motors_decide else ""


def _slipping(b: Bounds) -> str:
    """What constant speed alone does to the wheels, and in how many directions."""
    every = b.everywhere
    slips = b.traction_m_s2 <= 0.0
    stuck = (every.full if slips else every.safe).starting_m_s2 <= 0.0
    count = int(np.count_nonzero(stuck))
    where = f"in {count} of {len(stuck)} directions" if count else "in a few narrow directions"
    if count == len(stuck):
        where = "in every direction"
    if slips:
        return f"a wheel slips even at constant speed {where}"
    return f"constant speed alone needs more than {100 * (1.0 - b.margin):g} % of the grip {where}"


def _by_direction(b: Bounds) -> str:
    ahead = math.degrees(b.model.convention.front_rad)
    return (
        f"Limits by direction of motion, counted counter-clockwise; {ahead:g}° is straight ahead. "
        "Steady use is the share of the grip that constant speed needs"
    )


def _bounds_next(b: Bounds, fastest: float) -> list[str]:
    steps = []
    if b.recommended_m_s2 > 0.0:
        upto = f" They hold up to {fastest:.3g} m/s ahead." if math.isfinite(fastest) else ""
        steps.append(
            "Give these limits to your navigation: `--export nav2 limits.yaml` (or `roadrunner`, "
            f"`pathplanner`, `choreo`).{upto}"
        )
    steps.append(
        "The number depends on the motors, not on friction: check `stall_torque_N_m` and `max_speed_rad_s`."
        if b.motors_decide
        else "The number depends most on friction: pull the robot all round with a luggage scale and let "
        "`slipmargin measure` fit both coefficients."
    )
    if not b.model.loads.follow_acceleration:
        steps.append(
            "The loads here do not follow the acceleration, so tipping is not seen: give "
            '`com_height_m` and `model = "quasi-static"` in the robot file.'
        )
    return steps


#: What the columns of a sweep are.
_BY_ORIENTATION = (
    "The largest pull without slip by orientation φ: with all wheels on rollers, the lowest and the highest "
    "whatever the wheels stand on, and the wheels that slip first"
)


def sweep_page(
    s: Sweep,
    limiting: Sequence[Sequence[str]],
    claim: Isotropic,
    recommended_N: float,
    margin: float,
    measured: Mapping[str, Array],
    images: Mapping[str, Image],
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """How hard the standing robot may be pulled, and how measured pulls compare."""
    (weak, least), (strong, most) = s.weakest, s.strongest
    wheels = " and ".join(limiting[int(np.argmin(s.f_max_N))])
    robot, floor = s.model.robot, s.model.surface
    residual = measured.get("residual_N", np.full(1, np.nan))
    gaps = residual[np.isfinite(residual)]
    facts = [
        Fact(
            label="Safe at every orientation swept",
            value=f"{recommended_N:.3g} N",
            note=f"{100 * margin:g} % in reserve",
        ),
        Fact(
            label="Weakest orientation",
            value=f"{least:.3g} N",
            note=f"φ = {degrees(weak)}; slips first: {wheels}",
        ),
        Fact(label="Strongest orientation", value=f"{most:.3g} N", note=f"φ = {degrees(strong)}"),
        Fact(
            label="With one friction coefficient",
            value=f"{claim.force_N:.3g} N",
            note="μ m g, what many tools assume",
        ),
    ]
    next_steps = [
        "Compare with the real robot: pull it with a luggage scale at several orientations, write "
        "`phi_rad,force_N` rows and run again with `--measured pulls.csv`."
    ]
    if len(gaps):
        facts.append(
            Fact(
                label="Measured minus the model",
                value=f"{np.mean(gaps):+.2g} N",
                note=f"{two_digits(np.sqrt(np.mean(gaps**2)))} N root mean square, {len(gaps)} orientations",
            )
        )
        next_steps = [
            "If the measured pulls lie all above or all below, correct the coefficients "
            "(`slipmargin measure`). If they differ by orientation, let `slipmargin diagnose` find why."
        ]
    lead = (
        f"Standing on {floor}, {robot} holds a pull of {recommended_N:.3g} N at every orientation "
        f"asked: no wheel slips, and {100 * margin:g} % of the grip stays in reserve."
    )
    pulled = measured.get("measured_N", np.full(1, np.nan))
    too_weak = bool(np.any(pulled < recommended_N))
    if too_weak:
        at = int(np.nanargmin(pulled))
        lead = (
            f"{robot} on {floor} is computed to hold a pull of {recommended_N:.3g} N with {100 * margin:g} % "
            f"of the grip in reserve, but it slipped at {pulled[at]:.3g} N, at φ = {degrees(s.phi_rad[at])}. "
            "Do not rely on the limits before they fit."
        )
    band = bool(np.any(s.f_high_N > s.f_low_N * (1.0 + 1e-9)))
    return result_page(
        title=f"Pulls of {robot} on {floor}",
        lead=lead,
        good=recommended_N > 0.0 and not too_weak,
        facts=facts,
        pictures=(
            Picture(
                name="sweep",
                image=images["sweep"],
                alt="Pull before a wheel slips over the orientation",
                caption="The pull at which the first wheel slips."
                + (" The band is what the wheels may stand on, roller or rigid." if band else ""),
            ),
            Picture(
                name="polar",
                image=images["polar"],
                alt="The same as a polar curve seen from the robot",
                caption="The same by direction of the pull, seen from the robot.",
            ),
        ),
        tables=(_table(_BY_ORIENTATION, *sweep_words.rows(s, limiting, measured, 24)),),
        next_steps=next_steps,
        lines=lines,
        warnings=warnings,
    )


def _table(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    return Table(caption=caption, head=tuple(head), rows=tuple(tuple(row) for row in rows))
