"""Every number and claim of :mod:`slipmargin.paper.numbers`, computed again by running the package."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.model import Model, nominal_model
from slipmargin.paper.figure8 import figure8_rows
from slipmargin.paper.numbers import CLAIMS, NUMBERS, published
from slipmargin.paper.published import (
    ALONG_Y,
    DISTANCE_M,
    DURATION_S,
    FOUND,
    PITCH_RAD,
    RIGID,
    STILL_S,
    Unprinted,
    command,
    paper_model,
    paper_robot,
    spread,
    straight_line,
    wheel_rates,
)
from slipmargin.paper.rows import TOLERANCE, Row, claim, end_of, number, unchecked
from slipmargin.paper.simulated import Runs, improved_rows, initial_rows, paper_runs
from slipmargin.robot import FrictionLaw, LoadRule
from slipmargin.sim.signal import WheelSignal, linear
from slipmargin.sim.simulate import simulate


def recompute(
    unprinted: Unprinted = FOUND, runs: Runs | None = None
) -> tuple[tuple[Row, ...], tuple[Row, ...]]:
    """Rows of all printed numbers and rows of all claims in words, in the order of the text."""
    runs = paper_runs(unprinted) if runs is None else runs
    rows = {
        row.source.key: row
        for part in (
            _inputs(),
            _motion(unprinted),
            initial_rows(unprinted, runs),
            improved_rows(unprinted, runs),
            figure8_rows(),
        )
        for row in part
    }
    return tuple(rows[p.key] for p in NUMBERS), tuple(rows[p.key] for p in CLAIMS)


def _inputs() -> list[Row]:
    """What the authors chose or measured, and what the text says of Table I."""
    chosen = "an input, chosen by the authors and used in every run here"
    measured = "measured by the authors with a tilted board; an input of every run here"
    robot, slopes = paper_robot(improved=False), (500.0, 2000.0)
    shorts = [
        _short_mm(
            nominal_model(replace(robot, friction=FrictionLaw(k_s_per_m=k)), "paper"),
            command(np.zeros(3)),
            STILL_S,
        )
        for k in slopes
    ]
    effect = ", ".join(f"{mm:.1f} mm at k = {k:g}" for mm, k in zip(shorts, slopes, strict=True))
    rows = [
        unchecked("rollers", "an input, counted on the authors' wheel"),
        unchecked("regularisation_slope", f"{chosen}; initial model on paper, x short: {effect}"),
        unchecked("duration", chosen),
        unchecked("roller_share", "an input, measured on the authors' wheel"),
        unchecked("rigid_share", "an input, measured on the authors' wheel"),
    ]
    rows += [unchecked(p.key, measured) for p in NUMBERS if p.quote.startswith(("Paper\t", "Carpet\t"))]
    quoted = "measured by the authors' experiment; data, not computed here"
    rows += [unchecked(p.key, quoted) for p in NUMBERS if p.key.startswith("measured_")]
    models = {s: paper_model(s, improved=True) for s in ("paper", "carpet")}
    roller, rigid = ({s: getattr(m.grip, part)[0] for s, m in models.items()} for part in ("roller", "rigid"))
    ratio = {s: float(mu[1] / mu[0]) for s, mu in roller.items()}
    alike = float(roller["carpet"][0] / roller["paper"][0])
    higher = float(np.min(rigid["carpet"] / rigid["paper"]))
    both = max(abs(float(mu[0] - mu[1])) for mu in rigid.values())
    wheel = paper_robot(improved=True).wheels[0]
    pitch = 2.0 * math.pi / wheel.rollers
    sector = ((1.0 - wheel.rigid_fraction) * pitch + wheel.rigid_fraction * pitch) / pitch
    return [
        *rows,
        claim(
            "transverse_smaller",
            max(ratio.values()),
            max(ratio.values()) < 1.0,
            f"holds below 1; {ratio['paper']:.2f} on paper, {ratio['carpet']:.2f} on carpet (hardly “much”)",
        ),
        claim(
            "rollers_alike", alike, abs(alike - 1.0) <= TOLERANCE, "holds where they differ by 5 % or less"
        ),
        claim("rigid_higher_on_carpet", higher, higher > 1.0, "holds above 1"),
        claim("rigid_same_both_ways", both, both == 0.0, "holds at 0"),
        claim(
            "sector_adds_up",
            sector,
            abs(sector - 1.0) < 1e-12,
            "eight sectors of 40.5° roller and 4.5° rigid",
        ),
    ]


def _motion(unprinted: Unprinted) -> list[Row]:
    """The commanded motion: distance, geometry, wheel speeds, loads, the same along Y and done smoothly."""
    model = paper_model("paper", improved=False, unprinted=unprinted)
    printed = np.array([published("omega_1"), published("omega_1"), published("omega_3")])
    moved = model.geometry.no_slip_map() @ printed * DURATION_S
    rates = wheel_rates()
    short = {
        improved: DISTANCE_M
        - float(straight_line("paper", improved=improved, unprinted=unprinted, direction=ALONG_Y).pose[-1, 1])
        for improved in (False, True)
    }
    along_x = {
        improved: float(end_of(straight_line("paper", improved=improved, unprinted=unprinted))[0])
        for improved in (False, True)
    }
    smooth = {
        improved: _short_mm(
            paper_model("paper", improved=improved, unprinted=unprinted),
            _smooth(unprinted.angles_rad),
            STILL_S,
        )
        for improved in (False, True)
    }
    sideways = spread("paper", runs=500, unprinted=unprinted, direction=ALONG_Y)
    ends = 1e3 * (DISTANCE_M - sideways.end[:, 1])
    held_back = sideways.angles_rad[:, 2] >= (1.0 - RIGID) * PITCH_RAD
    slow_s, slow = 10.0 * DURATION_S, {}
    for improved in (False, True):
        slow[improved] = _short_mm(
            paper_model("paper", improved=improved, unprinted=unprinted),
            command(unprinted.angles_rad, duration_s=slow_s),
            slow_s + STILL_S - DURATION_S,
        )
    return [
        number(
            "goal_x",
            moved[0],
            "from the printed wheel speeds and a wheel of 25.4 mm, which is not printed but implied by them",
        ),
        number(
            "delta",
            math.degrees(math.asin(-printed[0] / printed[2])),
            "arcsin of the two printed wheel speeds' ratio",
        ),
        number("omega_1", rates[0], "no-slip kinematics, eqs (1) to (3), with a wheel of 25.4 mm"),
        number("omega_3", rates[2], "no-slip kinematics, eqs (1) to (3), with a wheel of 25.4 mm"),
        _loads_row(unprinted),
        claim(
            "y_less_severe_initial",
            short[False],
            short[False] < along_x[False],
            f"along X it is {1e3 * along_x[False]:.1f} mm",
        ),
        claim(
            "y_less_severe_improved",
            short[True],
            short[True] < along_x[True],
            f"along X it is {1e3 * along_x[True]:.1f} mm. From {len(ends)} random rotor angles "
            f"{ends.mean():.0f} ± {ends.std(ddof=1):.0f} mm: wheel 3 stands still and holds the robot back "
            f"where it stands on rigid material ({ends[held_back].mean():.0f} mm there, "
            f"{ends[~held_back].mean():.0f} mm elsewhere)",
        ),
        claim(
            "smoother_commands_slip_less",
            1e-3 * smooth[False],
            1e-3 * smooth[False] < along_x[False],
            f"{1e3 * along_x[False]:.1f} mm with stepped speeds; improved model {smooth[True]:.1f} mm "
            f"instead of {1e3 * along_x[True]:.1f} mm",
        ),
        claim(
            "rigid_matters_at_low_rates",
            1e-3 * (slow[True] - slow[False]),
            1e-3 * (slow[True] - slow[False]) > 0.5 * (along_x[True] - along_x[False]),
            f"{slow[True]:.0f} mm against {slow[False]:.0f} mm; at the printed rate "
            f"{1e3 * along_x[True]:.0f} against {1e3 * along_x[False]:.0f} mm. Most of the initial model's "
            f"{slow[False]:.0f} mm is creep that eq. (11) with k = 1000 allows at any speed",
        ),
        unchecked("kinetic_friction_might_help", "no coefficient of dynamic friction is printed"),
    ]


def _loads_row(unprinted: Unprinted) -> Row:
    """Equal loads with a centred centre of mass contradict moment balance (docs/theory.md, section 3)."""
    models = {
        improved: nominal_model(
            replace(paper_robot(improved=improved, unprinted=unprinted), load_rule=LoadRule.STATIC), "paper"
        )
        for improved in (False, True)
    }
    share = models[False].loads.rest_N / models[False].inertia.weight_N
    turned = [
        float(simulate(m, command(unprinted.angles_rad), np.array([0.0, STILL_S])).pose[-1, 2])
        for m in models.values()
    ]
    return claim(
        "equal_loads",
        float(share[2]),
        abs(float(share[2]) - 1.0 / 3.0) <= TOLERANCE / 3.0,
        f"DISCREPANCY: statics gives {share[2]:.4f} on wheel 3 and {share[0]:.4f} on wheels 1 and 2; "
        f"with these loads φ on paper ends at {turned[0]:.2f} rad (initial), {turned[1]:.2f} rad (improved)",
    )


def _short_mm(model: Model, signal: WheelSignal, end_s: float) -> float:
    return 1e3 * (DISTANCE_M - float(simulate(model, signal, np.array([0.0, end_s])).pose[-1, 0]))


def _smooth(angles_rad: Array) -> WheelSignal:
    """The same wheel displacements by a polynomial of degree 5 that starts and ends at rest."""
    t = np.linspace(0.0, DURATION_S, 701)
    u = t / DURATION_S
    omega = (30.0 * u**2 * (1.0 - u) ** 2)[:, None] * wheel_rates()
    return linear(np.append(t, STILL_S), np.vstack([omega, np.zeros(3)]), theta0=angles_rad)
