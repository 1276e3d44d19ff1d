"""The words of motion limits: the answer in a few lines, and the tables by direction and by curvature."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bounds_summary import Bounds
from slipmargin.limits.motion_realised import SLOW_CREEP, settles_slowly
from slipmargin.limits.motion_rows import CAUSES, TIPS
from slipmargin.limits.uncertainty import SlipChance
from slipmargin.limits.weakest_start import BRISK_M_S
from slipmargin.model import Model
from slipmargin.report.sweep import chance_line
from slipmargin.report.text import ROWS, columns, degrees, left_out, thinned

#: A disc-strip limit that is lower by this part is worth a line [1].
WORTH_SAYING = 0.005
#: A strongest direction whose neighbours hold less than this part of it is called narrow [1].
NEEDLE = 0.9


def slower_at_speed(b: Bounds) -> tuple[str, ...]:
    """A sentence where something that follows the speed leaves less than at a start; else none."""
    weak = b.weakest
    if weak.lowest_m_s2 >= (1.0 - WORTH_SAYING) * weak.start_m_s2:
        return ()
    return (
        f"speed: what resists or holds follows the speed: the weakest direction allows {weak.start_m_s2:.4g} "
        f"m/s² at a start and {weak.lowest_m_s2:.4g} m/s² at {BRISK_M_S:g} m/s or half of the motors' top "
        "speed; the recommended acceleration is the lower, limits by direction and safe sets are those of a "
        "start",
    )


def answer(b: Bounds, likely: SlipChance | None = None) -> list[str]:
    """Lines of the answer; the first four are traction, motor, isotropic and recommended."""
    b = b.everywhere
    full, lines = b.full, []
    weak, strong = full.weakest, full.strongest
    lines.append(
        f"traction    {b.traction_m_s2:.4g} m/s² in the weakest direction "
        f"({degrees(full.heading_rad[weak])}; {_tips(b, weak)}{', '.join(full.starting.wheels[weak])}), "
        f"{full.starting_m_s2[strong]:.4g} m/s² in the "
        f"strongest ({degrees(full.heading_rad[strong])}{_narrow(b, strong)})"
        if b.traction_m_s2 > 0.0
        else f"traction    none: {_slipping(b)}"
    )
    motor = f"{b.motor_limit_m_s2:.4g} m/s² at stall torque"
    if b.motor_limit_m_s2 == 0.0:
        motor = "none: drag alone takes more than the stall torque"
    elif math.isinf(b.motor_limit_m_s2):
        motor = "no limit in the robot file"
    lines.append(f"motor       {motor}; the smaller is {b.smaller}")
    lines.append(_isotropic(b))
    lines.append(
        f"recommended {b.recommended_m_s2:.4g} m/s² in any direction, slip margin {b.margin:g}"
        + (f"; {motors_then(b.model)} allow no more" if b.motors_decide else "")
    )
    lines.append(f"braking     {_span(full.braking_m_s2)}; turning at speed {_span(full.turning_m_s2)}")
    up, down = (_rate(v, "rad/s²") for v in (b.spin.starting_rad_s2, b.spin.braking_rad_s2))
    lines.append(f"spinning    up {up}, down {down} (with the margin)")
    lines.append(_steady(b))
    lines += _grip(b) + _still_rollers(b)
    if settles_slowly(b.model):
        lines.append(f"creep       {SLOW_CREEP}")
    if likely is not None:
        lines.append(chance_line(likely, b.recommended_m_s2, "m/s²"))
    if b.even is not None:
        most = np.max(np.abs(b.model.loads.shifts()))
        lines.append(
            f"loads       uneven by up to {most:.3g} N at a wheel; these are the worst limits of that band, "
            f"an even floor holds {np.min(b.even.starting_m_s2):.4g} m/s² in the weakest direction"
        )
    return lines + _sets(b)


def motors_then(model: Model) -> str:
    """What the motors of a robot are counted at where they decide."""
    known = model.drives.max_speed_rad_s is not None
    return "the motors at half of their top speed" if known else "the motors, whose top speed is not known,"


def _rate(value: float, unit: str) -> str:
    """An acceleration, or that the robot slips without one."""
    return f"{value:.4g} {unit}" if value > 0.0 else "none, it must slip"


def _grip(b: Bounds) -> list[str]:
    """How much less rollers hold that turn freely, where the grip is the box and that is worth a line."""
    if b.rolling_m_s2 is None or b.rolling_m_s2 > (1.0 - WORTH_SAYING) * b.traction_m_s2:
        return []
    free = "rollers that turn freely (disc-strip)"
    if b.rolling_m_s2 <= 0.0:
        return [f"grip        box; {free} slip at constant speed in some direction"]
    less = 100.0 * (1.0 - b.rolling_m_s2 / b.traction_m_s2)
    return [
        f"grip        box; {free} hold {b.rolling_m_s2:.4g} m/s² in the weakest direction, {less:.0f} % less"
    ]


def _still_rollers(b: Bounds) -> list[str]:
    """What rollers that do not turn in the strongest direction may add and take, where it is worth a line."""
    s = b.still_rollers
    if s is None or s.helped_m_s2 <= (1.0 + WORTH_SAYING) * np.max(b.full.starting_m_s2):
        return []
    return [
        f"rollers     at {degrees(s.heading_rad)} none turns, and the limit counts none: "
        f"{s.helped_m_s2:.4g} m/s² while their friction helps; once a drift to the side makes it drag: "
        f"{_rate(s.dragged_m_s2, 'm/s²')}"
    ]


def _slipping(b: Bounds) -> str:
    """Where the robot slips without accelerating, and what is left elsewhere."""
    held, rigid = b.full.starting_m_s2 > 0.0, " on rigid sectors" if b.on_rigid_sectors else ""
    wheels = ", ".join(b.full.starting.wheels[b.full.weakest])
    if not np.any(held):
        return f"it must slip at constant speed{rigid} in every direction (wheel {wheels} first)"
    strong = int(np.argmax(b.full.starting_m_s2))
    return (
        f"it must slip at constant speed{rigid} in {np.count_nonzero(~held)} of {len(held)} directions "
        f"(wheel {wheels} first); {b.full.starting_m_s2[strong]:.4g} m/s² in the strongest "
        f"({degrees(b.full.heading_rad[strong])}{_narrow(b, strong)})"
    )


def _tips(b: Bounds, at: int) -> str:
    return "tips at " if b.full.starting.cause[at] == CAUSES[TIPS] else ""


def _narrow(b: Bounds, at: int) -> str:
    """How wide the strongest direction is, where both its neighbours fall off steeply: a needle."""
    values = b.full.starting_m_s2
    beside = max(values[at - 1], values[(at + 1) % len(values)])
    if len(values) < 4 or beside >= NEEDLE * values[at]:
        return ""
    step = np.rad2deg(b.full.heading_rad[1] - b.full.heading_rad[0])
    falls = f"{beside:.4g} m/s²" if beside > 0.0 else "and it must slip"
    return f" only, {falls} {step:.3g}° beside it"


def _span(values: Array) -> str:
    """From the least to the largest; what must slip is said, not printed as a negative number."""
    held = values[values > 0.0]
    slips = len(values) - len(held)
    if not len(held):
        return "none, it must slip in every direction"
    least, most = f"{np.min(held):.4g}", f"{np.max(held):.4g}"
    found = f"{least} m/s²" if least == most else f"{least} to {most} m/s²"
    return found + (f" (it must slip in {slips} of {len(values)} directions)" if slips else "")


def _isotropic(b: Bounds) -> str:
    least = b.traction_m_s2
    if least <= 0.0:
        return f"isotropic   μ g = {b.isotropic_m_s2:.4g} m/s², where the robot slips at constant speed"
    return (
        f"isotropic   μ g = {b.isotropic_m_s2:.4g} m/s², {b.isotropic_m_s2 / least:.3g} times what the "
        "weakest "
        f"direction holds"
    )


def _steady(b: Bounds) -> str:
    slips = int(np.count_nonzero(b.full.steady_use > 1.0))
    if slips and np.all(np.isfinite(b.full.steady_use)):
        where = (
            "every direction"
            if slips == len(b.full.steady_use)
            else f"{slips} of {len(b.full.steady_use)} directions"
        )
        rolling = " on rigid sectors" if b.on_rigid_sectors else ""
        return f"steady      it must slip at constant speed{rolling} in {where}"
    spent = int(np.count_nonzero(np.isinf(b.full.steady_use)))
    if spent:
        return (
            f"steady      constant speed must slip in {spent} of {len(b.full.steady_use)} directions: "
            "drag uses the whole grip of a wheel and leaves none to drive"
        )
    use = f"constant speed uses up to {100 * np.max(b.full.steady_use):.0f} % of the grip"
    rigid = b.rigid_use
    if np.any(np.isnan(rigid)):
        return (
            f"steady      {use}; on rigid sectors not computed: so many wheels have too many contact states"
        )
    if np.max(rigid) <= np.max(b.full.steady_use) * (1.0 + 1e-9):
        return f"steady      {use}"
    if len(b.slipping_rad) == len(rigid):
        return f"steady      {use}; on rigid sectors it must slip in every direction"
    if len(b.slipping_rad):
        return (
            f"steady      {use}; on rigid sectors it must slip in {len(b.slipping_rad)} of {len(rigid)} "
            f"directions"
        )
    return f"steady      {use}, on rigid sectors up to {100 * np.max(rigid):.0f} %"


def _sets(b: Bounds) -> list[str]:
    s = b.inside
    if s is None:
        return [f"box         none: {b.why_not}"]
    return [
        f"box         speed up {_three(s.fast)}, slow down {_three(s.slow)}"
        f" ({', '.join(b.model.convention.short_axes)} m/s², yaw rad/s²)",
        f"circle      {s.circle_m_s2:.4g} m/s² in any direction of motion and of acceleration",
        f"reserved    {s.yaw_rad_s2:.4g} rad/s² of yaw acceleration at once, in box, circle and exports",
        *_speeds(b),
    ]


def _speeds(b: Bounds) -> list[str]:
    """Up to which speeds the sets are there; nothing where no motor and no offset mass limits them."""
    ahead, side, _, turn = b.speeds
    each = [
        f"{v:.4g} {unit} {word}"
        for v, unit, word in (
            (ahead, "m/s", "forward"),
            (side, "m/s", "sideways"),
            (turn, "rad/s", "turning"),
        )
        if math.isfinite(v)
    ]
    if not each:
        return []
    motors = f" of the motors' {'top speed' if b.model.drives.weakest_N_m is None else 'torque'}"
    reserve = f" with {b.margin:.3g}{motors} in reserve" if math.isfinite(ahead) else ""
    return [
        f"speeds      up to {', '.join(each)}, each alone: box, circle and exports are available there"
        + reserve
    ]


def direction_rows(b: Bounds, most: int) -> tuple[list[str], list[list[str]]]:
    """Head and at most ``most`` rows of the limits by direction, the weakest among them."""
    head = ["direction", "speed up [m/s²]", "turn [m/s²]", "brake [m/s²]", "steady use [1]", "limited by"]
    pick = thinned(len(b.full.heading_rad), most, [b.full.weakest])
    return head, [
        [
            degrees(b.full.heading_rad[k]),
            *(_held(v[k]) for v in (b.full.starting_m_s2, b.full.turning_m_s2, b.full.braking_m_s2)),
            f"{b.full.steady_use[k]:.3f}" if math.isfinite(b.full.steady_use[k]) else "slips",
            f"{b.full.starting.cause[k]}: {'+'.join(b.full.starting.wheels[k])}",
        ]
        for k in pick
    ]


def corner_rows(b: Bounds) -> tuple[list[str], list[list[str]]]:
    """Head and rows of the cornering speeds by curvature."""
    corner = b.everywhere.cornering
    return ["curvature [1/m]", "heading held [m/s]", "along the path [m/s]"], [
        [f"{k:g}", f"{np.min(h):.3f} … {np.max(h):.3f}", f"{np.min(t):.3f} … {np.max(t):.3f}"]
        for k, h, t in zip(corner.curvature_per_m, corner.held_m_s, corner.tangent_m_s, strict=True)
    ]


def tables(b: Bounds) -> list[str]:
    """Limits by direction, then cornering speeds by curvature."""
    head, rows = direction_rows(b, ROWS)
    return [
        *columns(head, rows),
        *left_out(len(rows), len(b.full.heading_rad)),
        "",
        *columns(*corner_rows(b)),
    ]


def _held(value: float) -> str:
    """A limit, or that the robot slips without accelerating."""
    return f"{value:.4f}" if value > 0.0 else "slips"


def _three(values: Any) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in values) + ")"
