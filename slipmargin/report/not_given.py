"""Why a number of a result is null: every result passes here before it leaves as JSON.

A number that is not finite, or so large that no robot has it, becomes null, and the key ``not_given`` says
why, one sentence for each key that holds a null.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any

import numpy as np

#: Sizes beyond which a number is no robot's, by the unit at the end of its key, and by any other.
LARGEST = {
    "t_s": 1e12,
    "m_per_N_s": 1e15,
    "m_s2": 1e5,
    "rad_s2": 1e9,
    "m_s": 1e6,
    "N": 1e10,
    "s": 1e9,
    "volume": 1e30,
}
LARGEST_OF_ANY = 1e12
#: A wheel that would need so many times its grip at constant speed has none to speak of [1].
SPENT = 1e3
NO_MOTOR = "no motor in the robot file limits it"
SLIPS = "it slips there whatever the acceleration"
DRAG = f"at constant speed drag leaves no grip to drive with, or less than 1/{SPENT:g} of what it takes"
FLOOR = "no wheel lifted off the floor"
ENDED = "the simulation did not reach the end of the plan: see ended_early"
OTHERS = "it was not asked for, not measured, or is no finite number that a robot has"
#: The last part of a key → why it may be null.
REASONS = {
    "motor_limit_m_s2": NO_MOTOR,
    "top_speed_m_s": NO_MOTOR,
    "top_rad_s": NO_MOTOR,
    "share_of_top_speed": NO_MOTOR,
    "forward": NO_MOTOR,
    "sideways": NO_MOTOR,
    "any_way": NO_MOTOR,
    "yaw_rate_rad_s": "neither a motor nor an offset centre of mass limits it",
    "steady_use": DRAG,
    "steady_use_rigid": f"{DRAG}; or too many wheels have sectors to try every contact state",
    "inside": "no acceleration is safe in every motion: see inside_why_not",
    "ellipsoid": "none was found that is safe in every motion",
    "traction_limit_m_s2": SLIPS,
    "traction_limit_disc_strip_m_s2": SLIPS,
    "dragged_m_s2": SLIPS,
    "held_m_s": SLIPS,
    "tangent_m_s": SLIPS,
    "measured_N": "nothing was measured at this orientation",
    "scatter_N": "fewer than two pulls were measured at this orientation",
    "residual_N": "nothing was measured at this orientation",
    "place": "the loads of the robot file do not follow the centre of mass",
    "place_share": "the loads of the robot file do not follow the centre of mass",
    "lifts_s": FLOOR,
    "end_position_m": ENDED,
    "end_heading_rad": ENDED,
    "pulls": "no pull was measured, or none at this orientation",
    "evidence": "no correction holds on runs that it has not seen: see rejected",
} | {
    f"{safe}{way}_{unit}": SLIPS
    for safe in ("", "safe_", "even_floor_")
    for way in ("starting", "turning", "braking")
    for unit in ("m_s2", "rad_s2")
}


def with_reasons(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the result as plain data in which each null has its sentence under ``not_given``."""
    missing: dict[str, str] = {}
    clean = {str(key): _clean(item, str(key), missing) for key, item in found.items()}
    return clean | ({"not_given": missing} if missing else {})


def _clean(value: Any, path: str, missing: dict[str, str]) -> Any:
    if type(value) is str or (type(value) is float and abs(value) <= SPENT):  # nearly every value of a table
        return value
    if isinstance(value, Enum):
        return _clean(value.value, path, missing)
    if isinstance(value, Mapping):
        return {str(key): _clean(item, f"{path}.{key}", missing) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_clean(item, path, missing) for item in value]
    key = path.rpartition(".")[2]
    if isinstance(value, float | np.floating):
        value = value if abs(float(value)) <= largest(key) else None
    if value is None:
        missing[path] = REASONS.get(key, OTHERS)
    return value


def largest(key: str) -> float:
    """Return the size beyond which a number under a key of this name is no robot's."""
    if key in ("steady_use", "steady_use_rigid"):
        return SPENT
    return next((most for unit, most in LARGEST.items() if f"_{key}".endswith(f"_{unit}")), LARGEST_OF_ANY)
