# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # The paper's story as a loop: model, residual, cause, better model, new limits
#
# In 2002 the authors had a model with rollers all round.  It disagreed with the measured motion; they looked
# at the wheels, saw rigid material between the rollers, put it in, and the model agreed.  Here `diagnose` is
# given the *initial* model and measured runs, and nothing else.  The runs are simulated, with camera noise:
# so the truth is known, and the answer can be checked.

# %%
# %matplotlib inline
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from IPython.display import display

import slipmargin as sm
from slipmargin.effects import Recipe, Trace
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.robot import Surface

sys.path.append(str(Path.cwd().parent / "benchmarks"))
from planting import Plant, planted

# %% [markdown]
# ## What is believed: rollers all round

# %%
robot = sm.read_robot("ohio-kiwi").robot
roller = robot.surface("paper").roller
believed = Recipe(
    robot=replace(
        robot,
        wheels=tuple(replace(w, rigid_fraction=0.0) for w in robot.wheels),
        surfaces=(Surface(name="paper", roller=roller, rigid=roller),),
    )
)

# %% [markdown]
# ## What is measured: seven short runs of the real machine
#
# The real wheels have rigid material over a tenth of each of their eight sectors, coefficient 0.47.  A camera
# sees the pose with 0.5 mm and 2 mrad of noise, 100 times a second; encoders give wheel speeds and angles.
# `planted` draws starts, stops and turns and simulates them; the data set it returns does not hold the truth.

# %%
truth = Plant(
    name="the real wheels",
    traces=(Trace.WHEEL_ANGLE,),
    effects=(RigidSector(rigid_fraction=0.10, rigid_coefficient=0.47),),
)
measured = planted(believed, truth, seed=3, count=7, duration_s=2.5, rate_hz=100.0)
print(f"{len(measured.trials)} runs; effects in the model that is believed: {len(measured.recipe.effects)}")

# %% [markdown]
# ## Residual: what the believed model gets wrong
#
# Measured minus predicted, in units of the noise.  If nothing were missing, this would be grey.

# %%
result = sm.diagnose(measured, seed=1)
found, figures = result.diagnosis, result.figures()
display(figures["residual"])

# %% [markdown]
# ## Cause: what the residual depends on, and which candidates explain it
#
# The residual is traced to measured variables, then every candidate (named effects, and a general form for
# each variable) is fitted on some runs and judged on others.

# %%
display(figures["where"])
display(figures["candidates"])
(finding,) = found.findings
values = {p.name: p for p in finding.parameters}
fraction, coefficient = values["rigid_fraction"], values["rigid_coefficient"]
sectors = {p.name: p.value for p in finding.derived}["sectors_per_turn"]
print(f"{found.verdict.value}: {finding.name}, traced to {finding.traced_to.value}; {sectors:g} per turn")
print(
    f"rigid fraction {fraction.value:.4f} ({fraction.low:.4f} … {fraction.high:.4f}); "
    f"coefficient {coefficient.value:.3f} ({coefficient.low:.3f} … {coefficient.high:.3f})"
)

# %% [markdown]
# ## Better model: on runs that no fit has seen

# %%
display(figures["held-out"])
for name, score in (("before", found.before), ("after", found.after)):
    print(
        f"{name:<7} {1e3 * score.rmse_position_m:6.2f} mm  {1e3 * score.rmse_heading_rad:6.2f} mrad  "
        f"chi {score.chi:.2f}"
    )

# %% [markdown]
# ## New limits
#
# The corrected recipe goes back into everything: pulls now have a band, and the acceleration limits know that
# a wheel may stand on rigid material.

# %%
change = result.change
display(figures["limits"])
wide = change.after.f_high_N / change.after.f_low_N
print(f"pull: one line before; after, a band up to {wide.max():.2f} times as high as it is low")

# %% [markdown]
# ## The claim, with numbers

# %%
assert found.verdict.value == "effect-found" and finding.name == "rigid_sector"
assert finding.traced_to.value == "wheel_angle" and sectors == 8.0
assert abs(fraction.value - 0.10) <= 0.01 and fraction.low <= 0.10 <= fraction.high
assert abs(coefficient.value - 0.47) <= 0.05
assert found.after.chi < 1.15 < 3.0 < found.before.chi
assert found.after.rmse_position_m < 0.5 * found.before.rmse_position_m
assert change.moved and np.allclose(change.before.f_high_N, change.before.f_low_N) and wide.max() > 2.5
