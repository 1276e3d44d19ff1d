"""Design studies: grids over a robot file, limits of every design, the best design and what limits it."""

from slipmargin.study.objectives import (
    OBJECTIVES as OBJECTIVES,
    Kind as Kind,
    Objective as Objective,
    objective as objective,
)
from slipmargin.study.optimum import Optimum as Optimum, optimum as optimum
from slipmargin.study.pieces import Executor as Executor
from slipmargin.study.quantities import QUANTITIES as QUANTITIES, Quantity as Quantity
from slipmargin.study.reason import Reason as Reason, reason as reason
from slipmargin.study.robot_on_surface import RobotOnSurface as RobotOnSurface
from slipmargin.study.robust import Robust as Robust, parse_interval as parse_interval, robust as robust
from slipmargin.study.study import DesignProblem as DesignProblem, Study as Study, study as study
from slipmargin.study.vary import Vary as Vary, parse_vary as parse_vary
