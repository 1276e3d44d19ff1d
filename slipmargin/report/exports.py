"""Motion limits under other tools' own parameter names and units, as text.

Frames: the limits are in the axes of the robot file (its ``convention``); ROS (REP 103), Road Runner,
PathPlanner and Choreo have +x forward and +y to the left.  Sources of the names: nav2_velocity_smoother and
nav2_mppi_controller (Nav2), MecanumDrive.Params (Road Runner 1.0 quickstart; inches and radians),
settings.json (PathPlanner 2025; metres and degrees), the ``config`` of a .chor file (Choreo 2025).

JSON has no comments, so the two JSON files say in a key ``comment`` what they hold.  Both tools pass over
keys that they do not know and drop them when they save: PathPlanner's editor and library ask for their keys
one by one (project_page.dart, RobotConfig.java), Choreo's structs do not deny unknown fields (project.rs).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from slipmargin.errors import InputError
from slipmargin.io.json_text import json_text
from slipmargin.limits.bounds import Directions
from slipmargin.limits.bounds_inside import Inside
from slipmargin.limits.bounds_summary import Bounds, SafeSets
from slipmargin.limits.uncertainty import SlipChance
from slipmargin.model import Model
from slipmargin.report.not_given import with_reasons

_INCH = 0.0254
_SAME = 1e-9  #: [1] directions that differ by less are one: the wheel's rollers stand across it


def export_text(tool: str, found: Bounds, likely: SlipChance | None = None) -> str:
    """The limits as ``tool`` writes them; the chance of slip is in JSON alone.

    Raises
    ------
    InputError
        If the tool is not known.
    NoSolution
        If no acceleration is safe in every direction of motion, so that no number can be given.
    """
    return plain_json(found, likely) if tool == "json" else sets_text(tool, found.sets)


def sets_text(tool: str, found: SafeSets) -> str:
    """:func:`export_text` for the tools that need the safe sets only: all but JSON."""
    if tool not in _OF_SETS:
        raise InputError("export", f"is {tool!r}", f"use one of: {', '.join(TOOLS)}")
    return _OF_SETS[tool](found)


def _sets(found: SafeSets) -> Inside:
    if found.inside is None:
        assert found.refusal is not None
        raise found.refusal
    return found.inside


def _speeds(found: SafeSets) -> list[float | None]:
    """Speed forward, to the side, any way [m/s] and turning [rad/s]; None where no motor limits it."""
    return [v if math.isfinite(v) else None for v in found.speeds]


def _head(found: SafeSets, tool: str, comment: str) -> list[str]:
    model = found.model
    return [
        f"{comment} {tool} limits of {model.robot} on {model.surface}, slip margin {found.margin:g} "
        "(slipmargin)",
        *(f"{comment} {line}" for line in _stated(found)),
        f"{comment} x forward, y left",
    ]


def _stated(found: SafeSets) -> list[str]:
    """The one set that every export comes from, in words."""
    sets = _sets(found)
    lines = [
        f"accelerations: safe in every direction of motion, with {sets.yaw_rad_s2:.4g} rad/s^2 of yaw "
        "acceleration at once",
        "the largest box for tools with a number an axis, the largest circle for tools with one number",
    ]
    if sets.pace is not None:
        taken = f"{100.0 * (1.0 - found.margin):.3g} % of the motors"
        lines.append(
            f"speeds: {100.0 * sets.pace:.3g} % of the wheels' top speed, each axis alone; "
            + (
                f"there these accelerations and drag take {taken}' torque, which falls with the speed"
                if sets.pace < 1.0 - found.margin
                else f"up to there these accelerations take at most {taken}"
            )
        )
    off = math.hypot(*found.model.inertia.com_m)
    if off > 0.0:
        lines.append(
            f"the centre of mass lies {off:.4g} m off the middle: turning at w rad/s while driving takes "
            f"{off:.4g} w^2 m/s^2 of these accelerations"
        )
    return lines


def nav2(found: SafeSets) -> str:
    """YAML for the velocity smoother and the MPPI controller [m/s, m/s², rad/s, rad/s²]."""
    sets = _sets(found)
    fast, slow, even = (_forward(found, v) for v in (sets.fast, sets.slow, sets.even))
    ahead, side, _, turn = _speeds(found)
    speeds = (ahead, side, turn)
    lines = [*_head(found, "Nav2", "#"), "velocity_smoother:", "  ros__parameters:"]
    if all(v is not None for v in speeds):
        lines += [
            f"    max_velocity: {_list(speeds)}  # [m/s, m/s, rad/s], each axis alone",
            f"    min_velocity: {_list([-v for v in speeds if v is not None])}",
        ]
    lines += [
        f"    max_accel: {_list(fast)}  # x, y [m/s^2], theta [rad/s^2]",
        f"    max_decel: {_list([-v for v in slow])}",
        "controller_server:",
        "  ros__parameters:",
        "    FollowPath:  # nav2_mppi_controller::MPPIController",
        f"      ax_max: {even[0]:.4f}  # [m/s^2]",
        f"      ax_min: {-even[0]:.4f}",
        f"      ay_max: {even[1]:.4f}",
        f"      ay_min: {-even[1]:.4f}",
        f"      az_max: {even[2]:.4f}  # [rad/s^2]",
    ]
    for name, value in zip(("vx_max", "vy_max", "wz_max"), speeds, strict=True):
        if value is not None:
            lines.append(f"      {name}: {value:.4f}")
    return "\n".join(lines) + "\n"


def roadrunner(found: SafeSets) -> str:
    """Java fields for MecanumDrive.Params, no file that compiles: inches and radians."""
    sets, drives, wheels = _sets(found), found.model.drives, found.model.geometry
    omni = np.any(np.all(np.abs(wheels.grip - wheels.drive) < _SAME, axis=1))
    lines = [
        "// Paste over the fields of these names in class Params of Road Runner's MecanumDrive.java",
        *_head(found, "Road Runner", "//"),
        *(["// omni wheels: MecanumDrive's kinematics are not this robot's, its limits are"] if omni else []),
        "// path profile parameters (in inches)",
    ]
    if drives.max_speed_rad_s is not None and sets.pace is not None:
        wheel = sets.pace * drives.max_speed_rad_s * float(np.min(found.model.geometry.radius_m))
        lines.append(f"public double maxWheelVel = {wheel / _INCH:.3f};")
    lines += [
        f"public double minProfileAccel = {-sets.circle_m_s2 / _INCH:.3f};",
        f"public double maxProfileAccel = {sets.circle_m_s2 / _INCH:.3f};",
        "// turn profile parameters (in radians)",
    ]
    turn = _speeds(found)[3]
    if turn is not None:
        lines.append(f"public double maxAngVel = {turn:.4f};")
    lines.append(f"public double maxAngAccel = {sets.yaw_rad_s2:.4f};")
    return "\n".join(lines) + "\n"


def pathplanner(found: SafeSets) -> str:
    """Keys of PathPlanner's settings.json: metres, kilograms and degrees."""
    sets, model = _sets(found), found.model
    speed, turn = _speeds(found)[2:]
    table: dict[str, Any] = {
        "comment": "; ".join([*_stated(found), _swerve(found)]),
        "holonomicMode": True,
        "robotMass": model.inertia.mass_kg,
        "robotMOI": model.inertia.inertia_kg_m2,
        "driveWheelRadius": float(np.mean(model.geometry.radius_m)),
        "wheelCOF": sets.coefficient,
        "defaultMaxAccel": sets.circle_m_s2,
        "defaultMaxAngAccel": math.degrees(sets.yaw_rad_s2),
    }
    if speed is not None:
        # Its motor has no torque left at maxDriveSpeed: that is not the speed that plans are kept to.
        table |= {"defaultMaxVel": speed, "maxDriveSpeed": found.held_m_s}
    if turn is not None:
        table["defaultMaxAngVel"] = math.degrees(turn)
    return json_text(table)


def choreo(found: SafeSets) -> str:
    """The ``config`` of a .chor file; its torque is what is left of the motors at its speed.

    ``vmax`` times the radius is how fast a swerve module may move any way, which rollers make a wheel turn
    faster for than that.
    """
    model, sets = found.model, _sets(found)
    radius, stall = float(np.mean(model.geometry.radius_m)), model.drives.weakest_N_m
    any_way = _speeds(found)[2]
    vmax = None if any_way is None else any_way / radius
    tmax = None
    if stall is not None and sets.pace is not None:
        tmax = (1.0 - found.margin) * stall * (1.0 - sets.pace)
    values: dict[str, tuple[float | None, str]] = {
        "mass": (model.inertia.mass_kg, "kg"),
        "inertia": (model.inertia.inertia_kg_m2, "kg m ^ 2"),
        "gearing": (1.0, ""),
        "radius": (radius, "m"),
        "vmax": (vmax, "rad / s"),
        "tmax": (tmax, "N * m"),
        "cof": (sets.coefficient, ""),
    }
    config = {
        name: {"exp": f"{value:.6g} {unit}".strip(), "val": value}
        for name, (value, unit) in values.items()
        if value is not None
    }
    said = [*_stated(found), _swerve(found)]
    if vmax is not None:
        said.append(
            "vmax: what the robot drives in every direction, over the radius (angled rollers make wheels "
            "turn faster than that)"
        )
    return json_text({"comment": "; ".join(said), "config": config})


def _swerve(found: SafeSets) -> str:
    """What the friction coefficient of a tool for swerve drives stands for."""
    return (
        f"friction: with {_sets(found).coefficient:.4g}, all that modules in the wheels' places do is safe "
        "for this robot, turning included"
    )


def plain_json(found: Bounds, likely: SlipChance | None = None) -> str:
    """The same as ``--json``."""
    return json_text(with_reasons(bounds_table(found, likely)))


def _load_band(model: Model, even: Directions) -> dict[str, Any]:
    """Shifts of the wheels' loads at the band's corners, and the limits on an even floor."""
    return {"shifts_N": model.loads.shifts()[1:], "even_floor_starting_m_s2": even.starting_m_s2}


def bounds_table(found: Bounds, likely: SlipChance | None = None) -> dict[str, Any]:
    """Everything as numbers; axes are the robot file's."""
    full, safe, corner, sets = found.full, found.safe, found.cornering, found.inside
    return {
        "schema": 1,
        "robot": found.model.robot,
        "surface": found.model.surface,
        "margin": found.margin,
        "traction_limit_m_s2": found.traction_m_s2,
        "motor_limit_m_s2": _finite(found.motor_limit_m_s2),
        "smaller": found.smaller,
        "recommended_m_s2": found.recommended_m_s2,
        "recommended_limited_by": found.recommended_cause,
        "isotropic_m_s2": found.isotropic_m_s2,
        **({} if likely is None else {"slip_chance": likely.table("acceleration_m_s2")}),
        **({} if found.rolling_m_s2 is None else {"traction_limit_disc_strip_m_s2": found.rolling_m_s2}),
        **({} if found.still_rollers is None else {"still_rollers": asdict(found.still_rollers)}),
        **({} if found.even is None else {"load_band": _load_band(found.model, found.even)}),
        "heading_rad": full.heading_rad,
        "starting_m_s2": full.starting_m_s2,
        "turning_m_s2": full.turning_m_s2,
        "braking_m_s2": full.braking_m_s2,
        "steady_use": [_finite(v) for v in full.steady_use],
        "steady_use_rigid": [_finite(v) for v in found.rigid_use],
        "limiting": full.starting.wheels,
        "cause": full.starting.cause,
        "safe_starting_m_s2": safe.starting_m_s2,
        "safe_turning_m_s2": safe.turning_m_s2,
        "safe_braking_m_s2": safe.braking_m_s2,
        "top_speed_m_s": [_finite(v) for v in found.top_m_s],
        "spin": {
            "starting_rad_s2": found.spin.starting_rad_s2,
            "braking_rad_s2": found.spin.braking_rad_s2,
            "steady_use": _finite(found.spin.steady_use),
            "top_rad_s": _finite(found.spin.top_rad_s),
        },
        "cornering": {
            "curvature_per_m": corner.curvature_per_m,
            "held_m_s": corner.held_m_s,
            "tangent_m_s": corner.tangent_m_s,
        },
        "inside": None
        if sets is None
        else {
            "axes": ["ax_m_s2", "ay_m_s2", "alpha_rad_s2"],
            "speeding_up": sets.fast,
            "slowing_down": sets.slow,
            "box": sets.even,
            "ellipsoid": sets.ellipsoid,
            "circle_m_s2": sets.circle_m_s2,
            "yaw_reserved_rad_s2": sets.yaw_rad_s2,
            "module_coefficient": sets.coefficient,
            "share_of_top_speed": sets.pace,
            "speed_m_s": dict(
                zip(("forward", "sideways", "any_way"), [_finite(v) for v in found.speeds[:3]], strict=True)
            ),
            "yaw_rate_rad_s": _finite(found.speeds[3]),
        },
        "inside_why_not": found.why_not,
    }


def _forward(found: SafeSets, box: Any) -> list[float]:
    """(x, y, yaw) → (forward, left, yaw): half sizes, so the sign does not matter."""
    side, ahead = found.model.convention.right_forward(float(box[0]), float(box[1]))
    return [abs(ahead), abs(side), float(box[2])]


def _list(values: Any) -> str:
    return "[" + ", ".join(f"{v:.4f}" for v in values) + "]"


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


_OF_SETS: dict[str, Callable[[SafeSets], str]] = {
    "nav2": nav2,
    "roadrunner": roadrunner,
    "pathplanner": pathplanner,
    "choreo": choreo,
}
#: What limits can be exported for.
TOOLS = (*_OF_SETS, "json")
