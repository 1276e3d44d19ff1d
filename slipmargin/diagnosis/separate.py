"""The trial that would distinguish two candidates which the present trials cannot."""

from __future__ import annotations

from slipmargin.effects import Trace
from slipmargin.effects.catalogue import effect_class
from slipmargin.effects.general import PREFIX

#: What varies one variable while the others stay as they were.
TRIALS: dict[Trace, str] = {
    Trace.WHEEL_ANGLE: "drive slowly (a few wheel turns) with the wheel angles logged, several times "
    "from different "
    "wheel angles",
    Trace.WHEEL_LOAD: "repeat a manoeuvre with a known weight put over one wheel, then over another",
    Trace.SLIP_SPEED: "spin the wheels against a wall (or on the spot) at several speeds, so that the "
    "slip speed "
    "varies and the load does not",
    Trace.SLIP_COUPLING: "pull the robot at 45 degrees to a wheel's drive direction, and straight along it",
    Trace.SLIP_RATIO: "slip by the same amount while rolling slowly and while rolling fast",
    Trace.VELOCITY: "cruise straight at three constant speeds, long enough that starting does not matter",
    Trace.ACCELERATION: "start and stop at different rates along the same line, up to the same speed",
    Trace.HEADING: "repeat one manoeuvre from the same place with the robot turned by 0, 90, 180 and 270 "
    "degrees",
    Trace.POSITION: "repeat one manoeuvre with the same heading in different places of the floor",
    Trace.TIME: "repeat one identical run first, in the middle and last, and after a long pause",
    Trace.CONSTANT_FORCE: "repeat one manoeuvre mirrored: to the left and to the right, forwards and "
    "backwards",
    Trace.COEFFICIENT: "pull tests with locked wheels, along the drive and along the roller direction",
    Trace.WHEEL: "swap two wheels and repeat the same manoeuvre",
    Trace.ACTUATION: "log the measured wheel speeds beside the commands",
    Trace.MEASUREMENT: "push the switched-off robot by hand along a ruler and turn it by a known angle",
}


def trace_of(name: str) -> Trace | None:
    """The variable of an effect's name or label, or None where it is not known."""
    plain = _plain(name)
    if plain.startswith(PREFIX):
        word = plain.removeprefix(PREFIX)
        return next((trace for trace in Trace if trace.value == word), None)
    effect = effect_class(plain)
    return None if effect is None else effect.traced_to


def _plain(label: str) -> str:
    """The effect's name in a candidate's label: without its wheel, its form, its variant."""
    return label.split("[", 1)[0].split(":", 1)[0].split(" ", 1)[0]


def separating_trial(name: str, traced_to: Trace, other: str) -> str:
    """The measurement after which ``name`` (of variable ``traced_to``) and ``other`` differ."""
    trace = trace_of(other)
    effect = effect_class(_plain(other))
    if trace is None:
        return TRIALS[traced_to]
    if trace is not traced_to:
        return f"{TRIALS[traced_to]}; or {TRIALS[trace]}"
    if effect is not None and effect.name != name:
        return effect.confirm
    return TRIALS[trace]
