"""One door for work that grows with the input: an estimate of its size, a limit, and how to raise it.

A limit is what a desk computer does in about ten seconds, or holds in about two gigabytes.  The environment
variable ``SLIPMARGIN_WORK`` raises all of them by a factor: ``SLIPMARGIN_WORK=10 slipmargin bounds …``.
"""

from __future__ import annotations

import math
import os

from slipmargin.errors import InputError

#: The environment variable that raises the limits by a factor.
FACTOR = "SLIPMARGIN_WORK"
#: Contact states that are tried one by one: of standing wheels, of one motion, and of all motions at once.
STANDING_STATES, MOVING_STATES, ROBUST_STATES = 1024, 256, 64
#: Wheels times contact states times directions of motion whose limits are asked for, some 60 µs each.
WHEEL_DIRECTIONS = 150_000
#: Directions in which braking is integrated and simulated, some 0.1 s each.
STOPPED_DIRECTIONS = 120
#: Facets times wheels times contact states that drawn robots are held against, 1 to 4 ms each.
DRAWN_FACETS = 6_000
#: Wheels times cone programs of a band: contact states of both its ends, orientations, values of what cannot
#: be known, and whether the robot stands at all, 15 to 30 µs each.
CONE_WHEELS = 300_000
#: Wheels times steps of one simulated motion, each 1 to 2 µs, and up to 9 where wheels hang in the air.  An
#: ordinary motion takes up to 700 steps a second.
WHEEL_STEPS = 1_500_000
#: Wheels times steps of all simulated runs that a slip monitor learns from: a built-in robot takes 3 million.
TRAINING_STEPS = 8_000_000
#: Grid points of a path, refined where it bends: some 50 from one waypoint to the next.
PATH_POINTS = 15_000
#: Wheels times samples times contact states of one check of a motion, each half a microsecond; a plan that is
#: tightened is checked ten times and more.
WHEEL_STATES = 3_000_000
#: Numbers of a table that a command makes, a planned motion: 3 µs each as CSV and as JSON.
TABLE_NUMBERS = 3_000_000
#: Rows of a table that is read, and of a log on one clock.
ROWS = 2_000_000
#: Bytes of a file that is held whole (a robot, a trajectory), and letters of one line of any text.
FILE_B, LINE = 1 << 29, 1 << 24


def allow(place: str, size: float, most: float, what: str, cure: str) -> None:
    """Refuse work that is too large.

    Parameters
    ----------
    place : str
        The key, column or argument that makes it large.
    size, most : float
        How much there is to do, and how much is done without being asked twice.
    what : str
        What is counted, after its number: "contact states".
    cure : str
        How to ask for less.

    Raises
    ------
    InputError
        With both numbers, the cure and the variable that raises the limit.
    """
    if fits(size, most):
        return
    more = "" if not math.isfinite(size) else f", or set {FACTOR}={math.ceil(size / most):g} to allow it"
    raise InputError(
        place, f"asks for {size:.3g} {what}, and at most {raised(most):.3g} are made", cure + more
    )


def allow_states(place: str, unknown: int, most: int) -> None:
    """Refuse wheels that may stand on too many combinations of rollers and rigid sectors.

    Raises
    ------
    InputError
        As :func:`allow`; ``unknown`` wheels have 2^unknown states.
    """
    cure = f"give sectors to fewer than these {unknown} wheels (rigid_fraction), or leave --robust out"
    allow(place, 2.0**unknown, most, "contact states", cure)


def fits(size: float, most: float) -> bool:
    """Whether work that can be left out is small enough to be done."""
    return size <= raised(most)


def raised(most: float) -> float:
    """A limit as the environment variable raises it."""
    return most * _factor()


def _factor() -> float:
    try:
        factor = float(os.environ.get(FACTOR, "1"))
    except ValueError:
        factor = math.nan
    if not (factor >= 1.0 and math.isfinite(factor)):
        raise InputError(FACTOR, f"is {os.environ[FACTOR][:40]!r}", "give a number from 1", "environment")
    return factor
