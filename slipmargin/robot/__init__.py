"""The machine as its maker describes it: data-sheet values, no physics."""

from slipmargin.physics.grips import GripShape as GripShape
from slipmargin.physics.loads import LoadRule as LoadRule
from slipmargin.robot.robot import (
    Body as Body,
    Coefficients as Coefficients,
    FrictionLaw as FrictionLaw,
    Motor as Motor,
    Robot as Robot,
    Surface as Surface,
    Wheel as Wheel,
)
