"""Published friction coefficients of omni and mecanum wheels, by name: what a robot file may start from.

Nothing here is a guess.  Each entry says where the numbers were published and how they were measured; what
was not published is left out, and a robot file that uses the entry must give it.  An interval is the spread
that was published or, where only one figure was, what its rounding leaves open.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

Span = tuple[float, float]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedSurface:
    """Coefficients on rollers and on the rigid material between them, each (low, high) or None [1].

    ``wheel`` and ``floor`` say of what, ``method`` how it was measured, ``source`` where it is published, and
    ``remark`` what a user must know.
    """

    name: str
    wheel: str
    floor: str
    drive: Span | None = None
    transverse: Span | None = None
    rigid: Span | None = None
    method: str
    source: str
    remark: str = ""

    def tables(self) -> dict[str, dict[str, Any]]:
        """``roller`` and ``rigid`` as the tables of a robot file, with what is published."""
        pairs = {"drive": self.drive, "transverse": self.transverse}
        found: dict[str, dict[str, Any]] = {"roller": {k: list(v) for k, v in pairs.items() if v is not None}}
        if self.rigid is not None:
            found["rigid"] = {"drive": list(self.rigid), "transverse": list(self.rigid)}
        return found

    @property
    def missing(self) -> tuple[str, ...]:
        """Coefficients on rollers that are not published."""
        pairs = (("drive", self.drive), ("transverse", self.transverse))
        return tuple(name for name, value in pairs if value is None)


_WILLIAMS = (
    "R. L. Williams II, B. E. Carter, P. Gallina, G. Rosati, Dynamic Model with Slip for Wheeled "
    "Omni-Directional Robots, IEEE Transactions on Robotics and Automation 18(3), 2002, Table I"
)
_TILTED = (
    "a vehicle with all wheels aligned on a board that is tilted until it slides, tan of the angle, mean of "
    "several trials; wheels turned so that only rollers (or only rigid material) touch"
)
_ROUNDED = "the paper prints means without a spread: the interval is their rounding only"

_VEX = "VEX Forum, Pull tests for VEX wheels, https://www.vexforum.com/t/pull-tests-for-vex-wheels/20141"
_VEX_PULLED = "static pull test forwards on the tile, force over load; computed by a reader of the thread"
_ANDYMARK = (
    "AndyMark, quoted in Chief Delphi, Omni vs Mecanum CoF, "
    "https://www.chiefdelphi.com/t/omni-vs-mecanum-cof/131663"
)
_DUDA = (
    "S. Duda, G. Gembalczyk, T. Machoczek, Z. Kowalik, Experimental Evaluation of Rolling Resistance in "
    "Omnidirectional Wheels Under Quasi-Static Conditions, Sensors 25(16), 5026, 2025"
)
_DRAWN = (
    "a wheel moved over the floor on a test stand at orientations of 0 to 90°, loads of 117.7 and 215.8 N; "
    "mean resistance over load"
)

#: Every entry, in the order of the list.
LIBRARY = (
    PublishedSurface(
        name="paper-omni-williams2002",
        wheel="omni wheel with 8 rollers",
        floor="paper on a rigid board",
        drive=(0.255, 0.265),
        transverse=(0.085, 0.095),
        rigid=(0.465, 0.475),
        method=_TILTED,
        source=_WILLIAMS,
        remark=_ROUNDED,
    ),
    PublishedSurface(
        name="carpet-omni-williams2002",
        wheel="omni wheel with 8 rollers",
        floor="carpet on a rigid board",
        drive=(0.245, 0.255),
        transverse=(0.145, 0.155),
        rigid=(0.555, 0.565),
        method=_TILTED,
        source=_WILLIAMS,
        remark=_ROUNDED,
    ),
    PublishedSurface(
        name="foam-omni-vex4",
        wheel="VEX omni wheel, 4 inch",
        floor="VEX foam field tiles",
        drive=(0.85, 0.95),
        method=_VEX_PULLED,
        source=_VEX,
        remark="one figure, 0.9, of one rig: the interval is its rounding; foam grips by indentation, so "
        "expect another value at another load",
    ),
    PublishedSurface(
        name="foam-omni-vex275",
        wheel="VEX omni wheels, 2.75 inch, single and double",
        floor="VEX foam field tiles",
        drive=(0.59, 0.84),
        method=_VEX_PULLED,
        source=_VEX,
        remark="from the single (0.59) to the double wheel (0.84)",
    ),
    PublishedSurface(
        name="carpet-omni-andymark6",
        wheel="AndyMark omni wheel, 6 inch",
        floor="carpet (the maker does not say which)",
        drive=(0.95, 1.05),
        method="the maker's data sheet; how it was measured is not stated",
        source=_ANDYMARK,
        remark="one figure, 1.0: the interval is its rounding",
    ),
    PublishedSurface(
        name="carpet-mecanum-andymark6",
        wheel="AndyMark mecanum wheel, 6 inch, rollers at 45°",
        floor="carpet (the maker does not say which)",
        drive=(0.848, 0.990),
        method="the maker's data sheet; how it was measured is not stated",
        source=_ANDYMARK,
        remark="published are 0.6 sideways and 0.7 forwards for the whole wheel; along the roller's axle, "
        "the drive coefficient here, that is 0.6 √2 to 0.7 √2 if the rollers turn freely",
    ),
    PublishedSurface(
        name="concrete-omni-duda2025",
        wheel="omni wheel with two rows of rollers",
        floor="industrial concrete",
        transverse=(0.005, 0.088),
        method=_DRAWN,
        source=_DUDA,
        remark="the abstract gives mean forces from 1.04 to 10.34 N over all angles and both loads: the "
        "interval is 1.04/215.8 to 10.34/117.7 and holds that of pure sideways motion",
    ),
    PublishedSurface(
        name="aluminium-omni-duda2025",
        wheel="omni wheel with two rows of rollers",
        floor="anodised aluminium",
        transverse=(0.005, 0.086),
        method=_DRAWN,
        source=_DUDA,
        remark="as for concrete, mean forces from 1.08 to 10.11 N",
    ),
)


def published(name: str) -> PublishedSurface | None:
    """The entry of that name, or None."""
    return next((entry for entry in LIBRARY if entry.name == name), None)
