"""The machine as its maker describes it: data-sheet values, no physics."""

from slipmargin.physics.convention import Convention as Convention
from slipmargin.physics.grips import GripShape as GripShape
from slipmargin.physics.loads import LoadRule as LoadRule
from slipmargin.robot.floor import (
    Coefficients as Coefficients,
    FrictionLaw as FrictionLaw,
    Surface as Surface,
)
from slipmargin.robot.motor import Motor as Motor
from slipmargin.robot.robot import Body as Body, Robot as Robot, Wheel as Wheel
from slipmargin.robot.uncertain import Uncertain as Uncertain, UncertainArray as UncertainArray
