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
# # A plan, its proof, and the same plan pushed over the limit
#
# Plan the fastest motion along a path so that every wheel keeps 10 % of its grip in reserve.  Feed the
# planned wheel speeds, open loop, to a simulator that knows nothing of limits.  Then drive the same motion
# faster until a wheel would need 110 % of its grip, and see which wheel goes.

# %%
# %matplotlib inline
import numpy as np
from IPython.display import display

import slipmargin as sm

robot = sm.read_robot("ohio-kiwi")

# %% [markdown]
# ## The plan
#
# A metre to the right with a bend.  Left: the path, coloured by the wheel that sets the pace.  Right: the
# speed under its limit curve, and the grip that each wheel uses.

# %%
waypoints = [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [1.0, 0.0, 0.0]]  # x [m], y [m], φ [rad]
result = sm.plan(robot, "paper", waypoints, margin=0.1, points=200, step_s=0.002, verify=True)
found = result.plan
display(result.plot())
print(result)

# %% [markdown]
# ## The proof
#
# The share of its grip that a simulated wheel used follows from its creep: (2/π) atan(k · slip).

# %%
proof = result.simulated["on rollers"]
print(
    f"simulated: wheel {proof.wheel} uses {proof.peak:.4f} of its grip; "
    f"ends {1e3 * proof.drift_m:.1f} mm from the plan (creep, open loop)"
)

# %% [markdown]
# ## Pushed
#
# The same path, faster, until some wheel is asked for 110 % of its grip for 0.4 s on end.  The audit
# (`slipmargin check`) names the wheel before anything moves.

# %%
fast = result.sped_up_to(1.10, hold_s=0.4)
audit = sm.check(robot, "paper", fast)
display(audit.plot())
pushed = result.simulated_again(fast)
asked = np.mean(fast.use > 1.0, axis=0)
named = fast.wheels[int(np.argmax(asked))]
print(
    f"driven {found.duration_s / fast.duration_s:.3f} times as fast; the plan says wheel {named} is "
    f"over its limit {100 * asked.max():.0f} % of the time"
)
print(
    f"simulated: wheel {pushed.wheel} slips at up to {1e3 * pushed.slip_m_s.max():.0f} mm/s; "
    f"ends {1e3 * pushed.drift_m:.0f} mm away"
)
print(f"cure that the audit gives: stretch time by {audit.time_scale_needed:.3f}")

# %% [markdown]
# ## What the plan did not know
#
# This robot's wheels have rigid sectors over a tenth of the circumference.  The plan above is for rollers.
# With the sectors in the simulator its margin is gone, as the paper found on the real machine:

# %%
real = result.simulated["with its rigid sectors"]
print(f"with rigid sectors: wheel {real.wheel} uses {real.peak:.3f}; ends {1e3 * real.drift_m:.0f} mm away")

# %% [markdown]
# ## The claim, with numbers

# %%
assert found.max_use <= 0.9 + 1e-6
assert abs(proof.peak - 0.9) < 0.02 and not proof.slips
assert pushed.slips and pushed.wheel == named
assert not audit.admissible and audit.time_scale_needed > 1.0
assert pushed.drift_m > 1.5 * proof.drift_m and real.peak > proof.peak + 0.02
