"""How hard can it push, and what stops it: wrench sets, sweeps, bands, margins."""

from slipmargin.limits.cones import limit_program as limit_program
from slipmargin.limits.direction import PullLimit as PullLimit, pull_limit as pull_limit
from slipmargin.limits.friction import Extreme as Extreme
from slipmargin.limits.margin import Margin as Margin, margin as margin
from slipmargin.limits.pull import Pull as Pull
from slipmargin.limits.sensitivity import Sensitivity as Sensitivity, sensitivity as sensitivity
from slipmargin.limits.sweep import (
    Isotropic as Isotropic,
    Sweep as Sweep,
    isotropic as isotropic,
    sweep as sweep,
)
from slipmargin.limits.wrench_set import WrenchSet as WrenchSet, wrench_set as wrench_set
