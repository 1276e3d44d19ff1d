"""How many rollers a mecanum wheel needs to hold its limit, in an engine with real rollers (MuJoCo).

    python benchmarks/few_rollers.py benchmarks/results/few_rollers.json     needs the extra [mujoco]

The mecanum robot of ``benchmarks/rollers.py`` moves off at shares of its limit on wheels of 9, 18 and 36
rollers.  Where neighbouring rollers take over, the contact wanders along the axle, so wheels of few rollers
work against each other: they creep below the limit.
"""

from __future__ import annotations

import json

import numpy as np
from engines.rollers import Build, Engine, MovingOff
from kept import with_file, write_figures
from rollers import GROSS, LATE_S, cases, limits

ROLLERS, SHARES, HEADINGS_DEG = (9, 18, 36), (0.5, 0.9), (37.0, 97.0)


def creep(rollers: int, heading_deg: float, share: float) -> float:
    """Late creep of the worst wheel per distance driven [1]."""
    machine, heading = cases()["4 mecanum"], np.deg2rad(heading_deg)
    held = float(limits(machine, np.array([heading]))[0])
    motion = MovingOff(heading_rad=float(heading), acceleration_m_s2=share * held)
    log = motion.drive(Engine(machine.robot, machine.surface, Build(rollers=rollers)))
    return float(log.part(motion.end_s - LATE_S, motion.end_s).creep().max())


if __name__ == "__main__":
    file = with_file(__doc__).parse_args().file
    found = {str(n): {f"{s:g}": max(creep(n, h, s) for h in HEADINGS_DEG) for s in SHARES} for n in ROLLERS}
    result = {"slips_above": GROSS, "worst_creep_per_distance": found}
    write_figures(file, result)
    print(json.dumps(result, indent=1))
