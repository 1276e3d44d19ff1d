"""The machine as its maker describes it: data-sheet values, no physics."""

from slipmargin.robot.robot import (
    Body as Body,
    Coefficients as Coefficients,
    FrictionLaw as FrictionLaw,
    GripShape as GripShape,
    LoadRule as LoadRule,
    Motor as Motor,
    Robot as Robot,
    Surface as Surface,
    Wheel as Wheel,
)
