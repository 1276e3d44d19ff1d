"""The first run after installation: what the second process compiles is what the kernel asks for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from slipmargin.paper.published import straight_line
from slipmargin.sim import cold, motion


def test_the_kernel_is_compiled_for_the_arguments_it_gets() -> None:
    straight_line("paper", improved=True, samples=3)
    assert motion.run.signatures == [cold._KERNEL]


def test_the_parts_are_compiled_for_the_arguments_they_get() -> None:
    # compile_apart finds nothing to do: every part is in the cache under the very types it is listed with
    run = straight_line("paper", improved=True, samples=3)
    assert np.isfinite(run.pose).all()
    cold.compile_apart()
    for function, kinds in cold._APART:
        assert tuple(kinds) in function.signatures
        assert all(isinstance(one, type(two)) for one, two in zip(function.signatures[0], kinds, strict=True))
        assert len(function.signatures) == 1


_RUN = """
from hashlib import sha256
from slipmargin.effects.floor_patch import FloorPatch
from slipmargin.effects.floor_ramp import FloorRamp
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.stribeck import Stribeck
from slipmargin.paper.published import FOUND, STILL_S, command, paper_model
from slipmargin.sim.simulate import simulate
import numpy as np

effects = (
    FloorRamp(slope_rad=0.02, offset_m=0.1),
    FloorPatch(factor=0.7, centre_x_m=0.2),
    RollingResistance(coefficient=0.02, viscous_N_s_per_m=0.3),
)
digest = sha256()
creep = SlipRatioFriction(share=0.3, steepness=20.0)
for law in (Stribeck(dynamic_ratio=0.8, stribeck_speed_m_s=0.02), creep):
    model = with_effects(paper_model("paper", improved=True), (*effects, law))
    for rtol in (1e-4, 1e-6):
        run = simulate(model, command(FOUND.angles_rad), np.linspace(0.0, STILL_S, 400), rtol=rtol)
        digest.update(run.pose.tobytes())
found = digest.hexdigest()
"""


def test_the_last_digit_does_not_follow_from_what_was_compiled_together(tmp_path: Path) -> None:
    # here the kernel's parts come from the cache; there the compiler sees all of them as one piece
    here: dict[str, str] = {}
    exec(_RUN, here)
    alone = "from slipmargin.sim import batch\nbatch.warm_up = lambda: None\n"
    there = subprocess.run(
        [sys.executable, "-c", f"{alone}{_RUN}print(found)"],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert there.stdout.split()[-1] == here["found"]
