"""Everything that follows a slider at once: limits by direction, pure forces, loads, tipping, pulls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits import sweep, wrench_set
from slipmargin.limits.bounds import directions, headings, spin
from slipmargin.limits.motion_rows import CAUSES, TIPS
from slipmargin.limits.weakest_start import weakest_start
from slipmargin.live.settings import Settings
from slipmargin.model import Model
from slipmargin.report.text import degrees, towards
from slipmargin.sets.section import section

#: Step of the directions on the page [deg].
STEP_DEG = 2.0
#: Digits sent to the page: more than a screen shows.
_DIGITS = 6
#: No robot speeds up like this [m/s²]: a wheel that lifts only then never does.
_NEVER_M_S2 = 1e4


def picture(now: Settings) -> dict[str, Any]:
    """What the first tab draws, as plain data; angles are counted from the front, counter-clockwise [rad].

    Raises
    ------
    InputError
        Where the robot is impossible with these settings.
    """
    model = now.design.build()
    heading = headings(STEP_DEG)
    full = directions(model, heading, motor=False)
    safe = weakest_start(model, share=1.0 - now.margin)  # as ``bounds`` has it
    weak = full.weakest
    recommended = max(0.0, safe.lowest_m_s2)
    turn = spin(model, share=1.0 - now.margin)
    ring = section(wrench_set(model).body())
    right, forward = model.convention.right_forward(ring[:, 0], ring[:, 1])
    tips = [cause == CAUSES[TIPS] for cause in full.starting.cause]
    slips = int(np.count_nonzero(full.starting_m_s2 <= 0.0))
    return {
        "angle": _plain(model.convention.from_front(heading)),
        "starting": _plain(np.maximum(full.starting_m_s2, 0.0)),
        "turning": _plain(np.maximum(full.turning_m_s2, 0.0)),
        "braking": _plain(np.maximum(full.braking_m_s2, 0.0)),
        "safe": _plain(np.maximum(safe.by_degree_m_s2[:: round(STEP_DEG)], 0.0)),
        "tips": tips,
        "weakest": {
            "value": _plain(full.starting_m_s2[weak]),
            "angle": _plain(model.convention.from_front(heading[weak])),
            "direction": towards(float(model.convention.from_front(heading[weak]))),
            "wheels": list(full.starting.wheels[weak]),
        },
        "recommended": _plain(recommended),
        "spinning": _plain(turn.starting_rad_s2),
        "section": {"right": _plain(right), "forward": _plain(forward)},
        "wheels": _wheels(model),
        "com": [_plain(v) for v in model.convention.right_forward(*model.inertia.com_m)],
        "tipping": _tipping(model, heading),
        "good": not slips and recommended > 0.0,
        "verdict": _verdict(model, recommended, now.margin, slips, len(heading), any(tips)),
    }


def _plain(values: Any) -> Any:
    """Numbers for JSON, rounded; what is not finite is null."""
    found = np.asarray(values, dtype=float)
    if not found.ndim:
        return float(f"{float(found):.{_DIGITS}g}") if np.isfinite(found) else None
    return [float(f"{v:.{_DIGITS}g}") if np.isfinite(v) else None for v in found.tolist()]


def _wheels(model: Model) -> list[dict[str, Any]]:
    """Place, drive direction and load at rest of each wheel, as seen from above with the front up."""
    g = model.geometry
    right, forward = model.convention.right_forward(g.position_m[:, 0], g.position_m[:, 1])
    drive = model.convention.right_forward(g.drive[:, 0], g.drive[:, 1])
    return [
        {
            "name": name,
            "right": _plain(right[k]),
            "forward": _plain(forward[k]),
            "drive": [_plain(drive[0][k]), _plain(drive[1][k])],
            "load_N": _plain(model.loads.rest_N[k]),
        }
        for k, name in enumerate(g.names)
    ]


def _tipping(model: Model, heading: Array) -> dict[str, Any] | None:
    """The least acceleration at which a wheel carries nothing, its direction and that wheel.

    None where loads do not follow the acceleration, or only one that no robot has.
    """
    if not model.loads.follow_acceleration:
        return None
    ways = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    lost = -(model.loads.at(ways) - model.loads.rest_N)  # per 1 m/s²
    with np.errstate(divide="ignore", invalid="ignore"):
        until = np.where(lost > 1e-12, model.loads.rest_N / lost, np.inf)
    if not np.min(until) <= _NEVER_M_S2:
        return None
    at, wheel = (int(k) for k in np.unravel_index(int(np.argmin(until)), until.shape))
    return {
        "m_s2": _plain(until[at, wheel]),
        "direction": towards(float(model.convention.from_front(heading[at]))),
        "wheel": model.geometry.names[wheel],
    }


def _verdict(model: Model, recommended: float, margin: float, slips: int, count: int, tips: bool) -> str:
    if slips == count:
        return "A wheel slips in every direction as soon as it moves: no acceleration is safe."
    if slips:
        return f"A wheel must slip in {slips} of {count} directions even at constant speed."
    lift = " In some directions a wheel lifts off before one slips." if tips else ""
    return (
        f"{model.robot} may speed up at {recommended:.3g} m/s² in any direction and keep "
        f"{100 * margin:.3g} % of its grip in reserve.{lift}"
    )


def pulls(now: Settings, measured: Path | None = None) -> dict[str, Any]:
    """F_emax over the orientation all round and, from a CSV of pulls, the measured means beside it.

    Raises
    ------
    InputError
        For a fault in the file.
    """
    from slipmargin.data.pulls import gather_pulls
    from slipmargin.io.trial_file import read_pulls

    model = now.design.build()
    phi = np.deg2rad(np.arange(0.0, 360.0 + 1e-9, STEP_DEG))
    try:
        found = sweep(model, phi)
    except NoSolution as fault:
        return {"phi": _plain(phi), "force": None, "why": str(fault), "points": []}
    low, least = found.weakest
    points: list[dict[str, Any]] = []
    if measured is not None:
        read = read_pulls(measured, model.count)
        read.refuse_settings(str(measured))
        groups = gather_pulls(read.phi_rad % (2.0 * np.pi), read.force_N)
        limit = sweep(model, groups.phi_rad).f_max_N
        points = [
            {
                "phi": _plain(groups.phi_rad[k]),
                "mean": _plain(groups.mean_N[k]),
                "low": _plain(groups.low_N[k]),
                "high": _plain(groups.high_N[k]),
                "limit": _plain(limit[k]),
            }
            for k in range(len(groups.phi_rad))
        ]
    return {
        "phi": _plain(phi),
        "force": _plain(found.f_max_N),
        "low": _plain(found.f_low_N),
        "high": _plain(found.f_high_N),
        "weakest": {"force": _plain(least), "phi": degrees(low)},
        "points": points,
    }
