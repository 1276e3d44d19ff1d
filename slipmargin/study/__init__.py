"""Which machine should we build: grids over a robot file, every limit of every design, the best and why."""

from slipmargin.study.machine import Machine as Machine
from slipmargin.study.objectives import (
    OBJECTIVES as OBJECTIVES,
    Kind as Kind,
    Objective as Objective,
    objective as objective,
)
from slipmargin.study.optimum import Optimum as Optimum, optimum as optimum
from slipmargin.study.pieces import Workshop as Workshop
from slipmargin.study.quantities import QUANTITIES as QUANTITIES, Quantity as Quantity
from slipmargin.study.reason import Reason as Reason, reason as reason
from slipmargin.study.robust import Robust as Robust, parse_interval as parse_interval, robust as robust
from slipmargin.study.study import Question as Question, Study as Study, study as study
from slipmargin.study.vary import Vary as Vary, parse_vary as parse_vary
