"""The C header of a limiter: its tables as text, its switches, and how many operations a call takes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.motion_realised import LIGHTEST
from slipmargin.onboard.c_calls import CALLS, DECLARATIONS
from slipmargin.onboard.c_code import ROWS
from slipmargin.onboard.limiter import LARGEST, LEAST_LEFT, SHORTER, tolerance
from slipmargin.onboard.table import CREEPS, LimitTable, threes


def c_header(table: LimitTable, *, version: str, robot_hash: str, source: str) -> str:
    """The header as text.

    Parameters
    ----------
    version : str
        Version of this package.
    robot_hash : str
        What identifies the robot file's content.
    source : str
        The command or call that made it.
    """
    guard = "SLIPMARGIN_LIMIT_H"
    return "\n".join(
        [
            _comment(table, version, robot_hash, source),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#include <math.h>",
            DECLARATIONS,
            *_switches(table),
            "",
            *_tables(table),
            ROWS,
            CALLS,
            f"#endif /* {guard} */",
            "",
        ]
    )


def operations(table: LimitTable) -> dict[str, int]:
    """Most floating-point operations (+ − × ÷ √, comparisons) of each function, an upper bound."""
    n, cases, count = table.count, len(table.rest_low_N), row_count(table)
    moving, motor = int(table.transfers), int(table.stall_torque_N_m is not None)
    band = int(not _same(table.rest_low_N, table.rest_high_N))
    friction, partly = 60, 0.0 < table.coupling < 1.0
    drag = n * (12 + (1 if _exact_drag(table) else 2) * (2 if partly else 1) * (friction + 10))
    external = 20 + (2 * n + 116) * int(table.turned)
    sharing = (12 * n + 24 * len(threes(table.along)[0]) + 8) if table.shares_by_load else 0
    load = 2 + 6 * moving  # adding a part of a load
    wheel = 54 + n * (8 + load) + 2 * load + 24 * n * band
    wheel += motor * (70 + 12 * int(np.any(table.spin)) + 2 * load + 24 * n * band)
    making = drag + external + sharing + 8 * n
    making += cases * (n * (1 + 18 * moving) + 3 * (5 + n * (1 + load)) + n * wheel)
    reading = 56 * count
    turning = 60
    toward = turning + 60 + 3 * (making + reading + 40)
    rounds = 2 if table.shares_by_load else 1
    return {
        "sm_limit_twist": 2 * toward + 60 + 8 * n,
        "sm_limit_acceleration": turning + 60 + rounds * (making + count * 16 + 20),
        "sm_margin": turning + drag + external + 20 * n + 20 + sharing + cases * (12 + n * 30),
    }


def row_count(table: LimitTable) -> int:
    """Rows that a call looks at."""
    n, cases = table.count, len(table.rest_low_N)
    kinds = 2 if table.stall_torque_N_m is None else 4
    return kinds * n * cases + (n if table.transfers else 0)


def _comment(table: LimitTable, version: str, robot_hash: str, source: str) -> str:
    counts = operations(table)
    wheels = ", ".join(f"{i}: {_plain(name)}" for i, name in enumerate(table.names))
    lines = [
        f"Slip limiter of robot {_plain(table.robot)} on surface {_plain(table.surface)}.",
        f"Written by slipmargin {version} with: {_plain(source)}",
        f"Robot file: sha256 {robot_hash}.  Change the robot file and write this file anew; do not edit it.",
        "",
        "C99 and C++17, single precision; #define SM_DOUBLE before including it for double.  No allocation,",
        "no global state, nothing of the mathematics library but the square root.  Do not compile it with",
        "-ffast-math: it would drop the tests for numbers that are not finite.",
        "",
        f"Units: m, s, rad, kg, N.  Axes: the body frame of the robot file ({table.axes}).",
        f"Wheels: {wheels}.",
        f"Share of the grip that may be used: {table.share:.6g}.  What is kept back of the whole:",
        *(f"  {part:<8.4g} {why}" for part, why in _kept_back(table) if part > 0.0),
        "Most floating-point operations (+ - * / sqrt and comparisons) of a call, whatever the input:",
        *(f"  {name:<22} {count}" for name, count in counts.items()),
        "",
        "  sm_limit_twist         the next velocity command: towards the wanted one, within the margin",
        "  sm_limit_acceleration  an acceleration cut back to the margin, its direction kept",
        "  sm_margin              share of the grip in use now, and the wheel that uses most",
    ]
    return "/*\n" + "\n".join(f" * {line}".rstrip() for line in lines) + "\n */"


def _kept_back(table: LimitTable) -> tuple[tuple[float, str], ...]:
    """What is taken off the whole grip, and why."""
    return (
        (table.margin, "the margin"),
        (CREEPS, "creep, which overshoots where the acceleration changes"),
        (table.uneven, "uneven creep: a wheel uses that much more than its part of the grip"),
    )


def _plain(text: str) -> str:
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in text).replace("*/", "* /")


def _switches(table: LimitTable) -> list[str]:
    stall, top = table.stall_torque_N_m, table.top_speed_rad_s
    named: list[tuple[str, str, str]] = [
        ("SM_WHEELS", str(table.count), "wheels"),
        ("SM_CASES", str(len(table.rest_low_N)), "cases of the loads: more than one on an uneven floor"),
        ("SM_LAW", str(table.law), "friction law: 0 atan, 1 tanh, 2 rational"),
        (
            "SM_COUPLED",
            str(int(table.coupled)),
            "whether drag takes from the drive grip",
        ),
        ("SM_PARTLY", str(int(0.0 < table.coupling < 1.0)), "whether of a part of it only"),
        ("SM_EXACT_DRAG", str(int(_exact_drag(table))), "whether the drag is known, not a range"),
        ("SM_EXACT_REST", str(int(_same(table.rest_low_N, table.rest_high_N))), "whether the loads are"),
        ("SM_EXACT_WRENCH", str(int(_same(table.wrench_low, table.wrench_high))), "and the external wrench"),
        ("SM_TRANSFERS", str(int(table.transfers)), "whether accelerating shifts load"),
        ("SM_SHARES_BY_LOAD", str(int(table.shares_by_load)), "whether loads decide who gives what force"),
        ("SM_THREES", str(len(threes(table.along)[0])), "three wheels out of all"),
        ("SM_MOTOR", str(int(stall is not None)), "whether the motors' torque is known"),
        ("SM_SPIN", str(int(np.any(table.spin))), "whether wheels and rotors have an inertia"),
        ("SM_TOP_SPEED", str(int(top is not None)), "whether the motors' top speed is known"),
        ("SM_FLOOR", str(int(table.turned)), "whether the floor slopes, so that the heading matters"),
        ("SM_SHARE", _number(table.share), "share of the grip that may be used"),
        ("SM_COUPLING", _number(table.coupling), "part of the grip that is coupled"),
        ("SM_STALL", _number(stall or 0.0), "stall torque at the wheel [N m]"),
        ("SM_FASTEST", _number(top or 0.0), "top speed of a wheel [rad/s]"),
        ("SM_LIGHTEST", _number(LIGHTEST * table.mean_load_N), "least load that counts [N]"),
        ("SM_LEAST_LEFT", _number(LEAST_LEFT), "least share of the grip beside the drag that counts"),
        ("SM_PULL", _number(table.pull_m_s2), "acceleration that the grip alone would give [m/s^2]"),
        ("SM_SLACK", _number(table.share * (1.0 + tolerance(table))), "and with the tolerance of a row"),
        ("SM_LARGEST", _number(LARGEST), "largest input that counts"),
        ("SM_HUGE", _number(1e30), "more than any share"),
    ]
    assert SHORTER == (1.0, 0.25), "sm_toward tries these parts"
    return [f"#define {name} {value} /* {meaning} */" for name, value, meaning in named]


def _exact_drag(table: LimitTable) -> bool:
    """Whether the drag is known, not a range."""
    drags = (table.drag, table.slope, table.coupled_drag, table.coupled_slope)
    return all(_same(*ends) for ends in (drags if table.coupled else drags[:2]))


def _tables(table: LimitTable) -> list[str]:
    rows: list[tuple[str, Array, str]] = [
        ("sm_mass", table.mass, "mass, mass, yaw inertia"),
        ("sm_com", table.com_m, "centre of mass [m]"),
        ("sm_along", table.along.T, "wrench of a unit force along each wheel's grip"),
        ("sm_across", table.across.T, "and across it"),
        ("sm_spread", table.spread, "drive forces that share a wrench"),
        ("sm_lateral", table.lateral, "lateral slip per twist [m/s]"),
        ("sm_rolling", table.rolling, "wheel speed per twist [rad/s]"),
        ("sm_drive", table.drive, "drive coefficient, the least"),
        ("sm_transverse", table.drag, "transverse coefficient, the least and the greatest"),
        ("sm_slope", table.slope, "slope of the friction law across the rollers [s/m]"),
        ("sm_rest", _middle(table.rest_low_N, table.rest_high_N), "loads without acceleration [N]"),
        ("sm_transfer", table.per_acceleration_kg, "change of the loads per acceleration [kg]"),
        ("sm_wrench", _middle(table.wrench_low, table.wrench_high), "external wrench [N, N, N m]"),
        ("sm_viscous", table.viscous, "external wrench per twist"),
    ]
    if table.coupled:
        rows.append(("sm_coupled_drag", table.coupled_drag, "the same of the coupled part"))
        rows.append(("sm_coupled_slope", table.coupled_slope, "and its slope [s/m]"))
        rows.append(("sm_most_beside", table.most_beside, "drag that leaves it nothing to drive"))
    if not _same(table.rest_low_N, table.rest_high_N):
        rows.append(
            ("sm_rest_half", 0.5 * (table.rest_high_N - table.rest_low_N), "and how far they may be off")
        )
    if not _same(table.wrench_low, table.wrench_high):
        rows.append(("sm_wrench_half", 0.5 * (table.wrench_high - table.wrench_low), "how far it may be off"))
    if table.turned:
        rows.append(("sm_floor", table.floor_wrench, "wrench of the slope in floor axes [N, N, N m]"))
        rows.append(("sm_floor_moment", table.floor_moment_N_m, "and its sum of height x force [N m]"))
        rows.append(("sm_floor_loads", table.floor_loads, "change of the loads per such moment [1/m]"))
    if table.stall_torque_N_m is not None:
        rows.append(("sm_torque_force", table.torque_force, "motor torque per drive force [m]"))
        rows.append(("sm_torque_drag", table.torque_drag, "and per drag [m]"))
        rows.append(("sm_spin", table.spin, "and per rate of the twist, of wheels and rotors"))
    text = [_array(name, np.asarray(values), meaning) for name, values, meaning in rows]
    if table.shares_by_load:
        wheels, weight, spread = threes(table.along)
        text += [
            "/* every three wheels, what their grips' product counts, and how they share a wrench alone */",
            f"static const int sm_three[{len(wheels)}][3] = {{{_places(wheels)}}};",
            _array("sm_three_weight", weight, ""),
            *_blocks("sm_three_spread", spread),
        ]
    return text


def _places(wheels: NDArray[np.intp]) -> str:
    return ", ".join(f"{{{a}, {b}, {c}}}" for a, b, c in wheels)


def _blocks(name: str, values: Array) -> list[str]:
    body = ",\n".join("  {" + ", ".join(f"{{{_row(row)}}}" for row in block) + "}" for block in values)
    sides = "".join(f"[{size}]" for size in values.shape)
    return [f"static const sm_real {name}{sides} = {{\n{body}}};"]


def _middle(low: Array, high: Array) -> Array:
    return 0.5 * (low + high)


def _same(low: Array, high: Array) -> bool:
    return bool(np.array_equal(low, high))


def _array(name: str, values: Array, meaning: str) -> str:
    sides = "".join(f"[{size}]" for size in values.shape)
    note = f"/* {meaning} */\n" if meaning else ""
    if values.ndim == 1:
        return f"{note}static const sm_real {name}{sides} = {{{_row(values)}}};"
    body = ",\n".join(f"  {{{_row(row)}}}" for row in values)
    return f"{note}static const sm_real {name}{sides} = {{\n{body}}};"


def _row(values: Array) -> str:
    return ", ".join(_number(float(v)) for v in values)


def _number(value: float) -> str:
    assert math.isfinite(value)
    return f"SM_C({value!r})"
