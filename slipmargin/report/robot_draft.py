"""A robot file to begin with, as commented text: values that are known beside values that are guesses."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

GUESS = "GUESS"
_COLUMN = 43  #: where comments begin

#: What the reader must know of the file's axes and signs.
AXES = (
    "x is forward, y left; a positive wheel speed drives the robot along the wheel's drive direction (0 deg",
    "forwards, 90 deg to the left).  Speed and torque of the motor are those of the wheel.",
)
#: What the limits depend on most, and how to measure it.
MEASURE_FIRST = (
    "MEASURE FIRST, the limits depend on these most:",
    "  1. roller drive and transverse of your floor: block the wheels, and pull the robot with a luggage",
    "     scale until it slides, in many directions all round.  `slipmargin measure` fits both from",
    "     such pulls; one direction alone cannot tell them apart.",
    "  2. body.com_m and com_height_m: each wheel (or side) on a scale gives com_m; the angle to which the",
    "     robot can be tilted before it falls gives the height.",
    "  3. body.mass_kg: the robot on a scale, with battery and everything it carries.  Forces grow with it,",
    "     and what the motors can accelerate falls.",
)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """A value with its comment: where it is from, or that it is a guess."""

    value: Any
    said: str = GUESS


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """What is known, or guessed, of a robot: key → value of each table of its file.

    ``head`` are the lines of the comment at the top; ``wheels`` one mapping a wheel.
    """

    name: str
    head: Sequence[str]
    body: Mapping[str, Value]
    wheels: Sequence[Mapping[str, Value]]
    motor: Mapping[str, Value]


def draft_text(draft: Draft) -> str:
    """The robot file of a draft in the convention of ROS, complete and commented."""
    lines = [f"# {line}".rstrip() for line in (*draft.head, *AXES)]
    lines += ["#", *(f"# {line}".rstrip() for line in MEASURE_FIRST)]
    lines += ["schema = 1", f"name = {json.dumps(draft.name, ensure_ascii=False)}"]
    lines += [
        _line("convention", Value(value="ros", said="x forward, y left, yaw 0 along x (REP 103)")),
    ]
    lines += ["", "[body]", *_lines(draft.body)]
    lines += [
        "",
        "[loads]",
        _line("model", Value(value="quasi-static", said="loads follow the acceleration")),
    ]
    lines += [
        "",
        "[friction]",
        _line("law", Value(value="atan", said="force over slip speed")),
        _line("k_s_per_m", Value(value=1000.0, said=f"{GUESS}; how steeply force grows with slip")),
        _line("grip", Value(value="disc-strip", said="a roller slides in one direction at a time")),
    ]
    if draft.motor:
        lines += ["", "[motor]", *_lines(draft.motor)]
    for wheel in draft.wheels:
        lines += ["", "[[wheel]]", *_lines(wheel)]
    lines += [
        "",
        "# one table for each floor; `--surface NAME` picks one",
        "[surface.floor]",
        _line(
            "roller",
            Value(value={"drive": 0.4, "transverse": 0.06}, said=f"{GUESS}, hard floor; MEASURE FIRST (1)"),
        ),
        _line("rigid", Value(value={"drive": 0.5, "transverse": 0.5}, said=f"{GUESS}")),
        "",
        "[surface.carpet]",
        _line("roller", Value(value={"drive": 0.5, "transverse": 0.12}, said=f"{GUESS}, short carpet")),
        _line("rigid", Value(value={"drive": 0.6, "transverse": 0.6}, said=f"{GUESS}")),
    ]
    return "\n".join(lines) + "\n"


def _lines(table: Mapping[str, Value]) -> list[str]:
    return [_line(key, value) for key, value in table.items()]


def _line(key: str, value: Value) -> str:
    text = f"{key} = {_toml(value.value)}"
    return f"{text:<{_COLUMN}} # {value.said}" if value.said else text


def _toml(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{k} = {_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{value:.6g}" if "." in f"{value:.6g}" or "e" in f"{value:.6g}" else f"{value:.6g}.0"
    return "[" + ", ".join(_toml(v) for v in value) + "]"
