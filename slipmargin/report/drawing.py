"""A robot seen from above, in characters: wheel numbers, drive directions, signs."""

from __future__ import annotations

import math

import numpy as np

from slipmargin.checks import Array
from slipmargin.model import nominal_model
from slipmargin.report.text import columns
from slipmargin.robot import Convention, Robot, Wheel

WIDTH, HEIGHT = 61, 23  #: characters; a character is twice as high as wide
_LINES = "─╱│╲"  # at 0, 45, 90, 135 degrees
_HEADS = "→↗↑↖←↙↓↘"
#: What the arrows mean.
_ARROWS = {
    Convention.PAPER: (
        "Arrows are the drive directions ŝ: a positive wheel speed moves the contact point along its arrow",
        "over the floor and so drives the robot the other way (⊕ centre of mass, + origin; the stroke inside",
    ),
    Convention.ROS: (
        "Arrows are the drive directions: a positive wheel speed drives the robot along its arrow",
        "(⊕ centre of mass, + origin; the stroke inside",
    ),
}


def drawing(robot: Robot) -> list[str]:
    """Lines of the drawing, front up; arrows are the drive directions.

    The stroke in the middle of a mecanum wheel is the axle of the roller on the floor; ⊕ is the centre
    of mass, + the origin of the body frame.
    """
    places = [_seen(robot, w.position_m) for w in robot.wheels]
    com = _seen(robot, robot.body.com_m)
    low = [min(p[k] for p in [*places, com]) for k in (0, 1)]
    high = [max(p[k] for p in [*places, com]) for k in (0, 1)]
    middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    reach = max((high[0] - low[0]) / (WIDTH - 24), (high[1] - low[1]) / (2 * (HEIGHT - 10)), 1e-9)

    def cell(x: float, y: float) -> tuple[int, int]:
        return (
            round(WIDTH / 2 + (x - middle[0]) / reach - 0.5),
            round(HEIGHT / 2 - (y - middle[1]) / (2 * reach)),
        )

    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    order = sorted(places, key=lambda p: math.atan2(p[1] - middle[1], p[0] - middle[0]))
    for start, end in zip(order, [*order[1:], order[0]], strict=True):
        _line(canvas, cell(*start), cell(*end), "·")
    for number, wheel in enumerate(robot.wheels, 1):
        _wheel(canvas, cell(*places[number - 1]), _way(robot, wheel), wheel, str(number), cell(*middle))
    _put(canvas, *cell(0.0, 0.0), "+")
    _put(canvas, *cell(*com), "⊕")
    lines = ["".join(row).rstrip() for row in canvas]
    while lines and not lines[0]:
        lines.pop(0)
    while lines and not lines[-1]:
        lines.pop()
    front = "front (+Y)" if robot.convention is Convention.PAPER else "front (+X)"
    return [f"{front:^{WIDTH}}".rstrip(), f"{'▲':^{WIDTH}}".rstrip(), *lines]


def speeds(robot: Robot) -> Array:
    """(N, 3) wheel speeds [rad/s] for 1 m/s to the right, 1 m/s forwards, 1 rad/s to the left, without slip.

    In the paper's convention a positive wheel speed moves the contact point along its arrow and so drives
    the robot the other way (eq. 3); in that of ROS it drives the robot along its arrow.
    """
    turned = robot.convention.from_right_forward
    twists = np.array([[*turned(1.0, 0.0), 0.0], [*turned(0.0, 1.0), 0.0], [0.0, 0.0, 1.0]])
    return nominal_model(robot, robot.surfaces[0].name).geometry.wheel_speeds(twists).T


def wheel_words(robot: Robot) -> list[str]:
    """A line a wheel: what it is, how its rollers stand, and which way a positive speed drives the robot."""
    return [f"wheel {w.name}: {_kind(w)}, positive speed drives {_drives(robot, w)}" for w in robot.wheels]


def _kind(wheel: Wheel) -> str:
    if wheel.roller_angle_deg == 0.0:
        return "omni"
    known = "mecanum" if abs(abs(wheel.roller_angle_deg) - 45.0) < 15.0 else "slanted rollers"
    return f"{known}, rollers {wheel.roller_angle_deg:+g}°"


def _drives(robot: Robot, wheel: Wheel) -> str:
    """Where a positive speed takes the robot, counted from its front."""
    back = 0.0 if robot.convention is Convention.ROS else 180.0
    ahead = wheel.drive_direction_deg + back - math.degrees(robot.convention.front_rad)
    angle = math.remainder(ahead, 360.0)
    for known, said in ((0.0, "forwards"), (90.0, "to the left"), (-90.0, "to the right")):
        if abs(angle - known) < 0.05:
            return said
    if abs(angle) > 179.95:
        return "backwards"
    side = "left" if angle > 0.0 else "right"
    if abs(angle) < 90.0:
        return f"forwards, {abs(angle):.4g}° to the {side}"
    return f"backwards, {180.0 - abs(angle):.4g}° to the {side}"


def _seen(robot: Robot, place: Array) -> tuple[float, float]:
    """A place of the body, to the right and forwards [m]."""
    right, forward = robot.convention.right_forward(*place)
    return float(right), float(forward)


def _way(robot: Robot, wheel: Wheel) -> float:
    """The drive direction as it is drawn: counter-clockwise from the robot's right [rad]."""
    return math.radians(wheel.drive_direction_deg) + 0.5 * math.pi - robot.convention.front_rad


def wheel_table(robot: Robot) -> list[str]:
    """What the drawing's signs mean, and a row a wheel."""
    head = ("wheel", "name", "drive [deg]", "rollers [deg]", "1 m/s right", "1 m/s forward", "1 rad/s left")
    rows = [
        (
            str(i),
            w.name,
            f"{w.drive_direction_deg:g}",
            f"{w.roller_angle_deg:g}",
            *(f"{s + 0.0:+.2f}" if abs(s) > 5e-3 else "0" for s in row),
        )
        for i, (w, row) in enumerate(zip(robot.wheels, speeds(robot), strict=True), 1)
    ]
    return [
        *_ARROWS[robot.convention],
        "a mecanum wheel is the axle of the roller on the floor).  Wheel speeds without slip [rad/s] for",
        "",
        *columns(head, rows),
    ]


def _wheel(
    canvas: list[list[str]],
    at: tuple[int, int],
    way: float,
    wheel: Wheel,
    label: str,
    middle: tuple[int, int],
) -> None:
    dx, dy = math.cos(way), math.sin(way)
    steps = 4 if abs(dx) > 0.3 else 2
    step = steps / max(abs(dx), 2 * abs(dy) / 2)
    tip = (at[0] + round(step * dx), at[1] - round(step * dy / 2))
    tail = (at[0] - round(step * dx), at[1] + round(step * dy / 2))
    _line(canvas, tail, tip, _LINES[round(math.degrees(way) / 45) % 4])
    _put(canvas, *tip, _HEADS[round(math.degrees(way) / 45) % 8])
    if wheel.roller_angle_deg:
        _put(canvas, *at, _LINES[round((math.degrees(way) + wheel.roller_angle_deg) / 45) % 4])
    out = math.atan2(at[1] - middle[1], at[0] - middle[0]) if at != middle else 0.0
    sideways = (-dy, dx) if -dy * math.cos(out) - dx * math.sin(out) >= 0 else (dy, -dx)
    where = (at[0] + round(3 * sideways[0]), at[1] - round(1.6 * sideways[1]))
    for k, character in enumerate(label):
        _put(canvas, where[0] + k, where[1], character)


def _line(canvas: list[list[str]], start: tuple[int, int], end: tuple[int, int], character: str) -> None:
    count = max(abs(end[0] - start[0]), abs(end[1] - start[1]), 1)
    for k in range(count + 1):
        _put(
            canvas,
            round(start[0] + (end[0] - start[0]) * k / count),
            round(start[1] + (end[1] - start[1]) * k / count),
            character,
        )


def _put(canvas: list[list[str]], column: int, row: int, character: str) -> None:
    if 0 <= row < len(canvas) and 0 <= column < len(canvas[0]):
        canvas[row][column] = character
