"""The tables of the robot file, in the order in which a file has them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.robot.floor import FrictionLaw, Surface
from slipmargin.robot.motor import Motor
from slipmargin.robot.robot import Body, Robot, Wheel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A table of the robot file.

    ``heading`` as the file writes it; the keys are the fields of ``kind`` that stand in ``table``;
    ``path`` leads from a robot to the values: one object, a tuple of them, or None.
    """

    heading: str
    kind: type
    meaning: str
    path: str = ""
    table: str = ""


#: The tables of the robot file, in order.
SECTIONS = (
    Section(heading="", kind=Robot, meaning="What stands before the first table, after `schema = 1`."),
    Section(heading="[body]", kind=Body, path="body", meaning="The robot as one rigid body."),
    Section(
        heading="[loads]",
        kind=Robot,
        table="loads",
        meaning="How the weight is shared.",
    ),
    Section(
        heading="[friction]",
        kind=FrictionLaw,
        path="friction",
        meaning="The friction law of every wheel. Without this table every key has its default.",
    ),
    Section(
        heading="[motor]",
        kind=Motor,
        path="motor",
        meaning="Limits of every wheel's motor, on the wheel side. Without this table there are none.",
    ),
    Section(
        heading="[[wheel]]", kind=Wheel, path="wheels", meaning="One table for each wheel, three or more."
    ),
    Section(
        heading="[surface.NAME]",
        kind=Surface,
        path="surfaces",
        meaning="One table for each floor, one or more; `--surface NAME` picks one.",
    ),
)
