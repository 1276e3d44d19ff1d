"""How hard can it push, and what stops it: wrench sets, sweeps, bands, margins."""

from slipmargin.limits.pull import Pull as Pull
from slipmargin.limits.sweep import (
    Isotropic as Isotropic,
    Sweep as Sweep,
    isotropic as isotropic,
    sweep as sweep,
)
from slipmargin.limits.wrench_set import WrenchSet as WrenchSet, wrench_set as wrench_set
