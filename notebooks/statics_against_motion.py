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
# # The static limit is not an acceleration limit
#
# Fig. 8 says how hard a *standing* robot can be pulled.  It is tempting to divide by the mass and call the
# result an acceleration.  For this robot that is 3.3 times too optimistic along X. A standing wheel may push
# sideways either way. In motion its rollers turn, and their friction can only be drag.

# %%
# %matplotlib inline
import numpy as np
from IPython.display import display

import slipmargin as sm

robot = sm.read_robot("ohio-kiwi")
rollers = sm.read_robot(robot, rigid_sectors=False)
mass = robot.robot.body.mass_kg

# %% [markdown]
# ## Both limits side by side
#
# Directions are the robot's own: 0° to its right (+X), 90° forward.

# %%
static = sm.sweep(rollers, "paper", from_deg=-90.0, to_deg=0.0, step_deg=90.0).f_max_N[::-1] / mass
moving = sm.bounds(rollers, "paper", step_deg=90.0).bounds.full  # towards its own +X, +Y and back
for k, name in enumerate(("along +X", "along +Y")):
    print(
        f"{name}: pull limit / mass {static[k]:.4f}, speeding up {moving.starting_m_s2[k]:.4f}, "
        f"braking {moving.braking_m_s2[k]:.4f} m/s²"
    )
print(f"too optimistic along +X: {static[0] / moving.starting_m_s2[0]:.2f} times")
print(f"grip that constant speed along +X needs: {100 * moving.steady_use[0]:.0f} %")

# %% [markdown]
# Braking is the exception: there the drag helps, and braking equals the static limit.

# %%
display(sm.bounds(robot, "paper").plot())

# %% [markdown]
# On the right of that picture the middle panel shows the paper's surprise ("even at low rates and
# accelerations"): with a wheel on rigid material constant speed alone needs more grip than there is.
#
# ## Does it really slip there?  Ask the simulator
#
# The simulator knows nothing of limits: eq. (11), three wheels, an integrator.  The wheels are told to speed
# the robot up along +X, from rest, asking each drive force for at most the share λ of its grip.  Friction of
# eq. (11) is never quite without slip; a wheel that really uses λ creeps by tan(πλ/2)/k.


# %%
def peak_slip(asked: float, seconds: float = 1.0):
    """A ramp along +X that asks ``asked`` times the drive force there is: the run and its peak drive slip."""
    # Speeding up needs the steady share plus what the acceleration adds: linear in between.
    steady = float(moving.steady_use[0])
    a = float(moving.starting_m_s2[0]) * (asked - steady) / (1.0 - steady)
    t = np.linspace(0.0, seconds, 201)
    twist = np.zeros((t.size, 3))
    twist[:, 0] = a * t
    omega = rollers.build("paper").geometry.wheel_speeds(twist)  # that roll without slip
    found = sm.simulate(rollers, "paper", np.column_stack([t, omega]), linear=True, step_s=5e-4)
    return found, found.peak_slip_m_s


creep = {}
print("   λ   peak creep [mm/s]   bound [mm/s]")
for asked in (0.8, 0.9, 0.95, 1.05, 1.2):
    run, creep[asked] = peak_slip(asked)
    bound = f"{np.tan(np.pi * asked / 2.0):10.2f}" if asked < 1.0 else "      none"
    print(f"{asked:5.2f} {1e3 * creep[asked]:16.2f} {bound}")
display(run.plot())  # 20 % too fast: the wheels run away from the floor

# %% [markdown]
# Below the limit the creep keeps its bound; above it the slip grows as long as the ramp lasts.  "Slip margin"
# (1 − λ) is therefore a number that a simulation can confirm or refute.
#
# ## The claim, with numbers

# %%
assert np.allclose(moving.starting_m_s2[:2], [0.5017, 1.1958], atol=5e-5)
assert np.allclose(moving.braking_m_s2[:2], [1.6388, 2.0891], atol=5e-5)
assert 3.2 < static[0] / moving.starting_m_s2[0] < 3.35 and np.isclose(static[0], moving.braking_m_s2[0])
assert abs(moving.steady_use[0] - 0.531) < 5e-4
for asked in (0.8, 0.9, 0.95):
    share = 2.0 / np.pi * np.arctan(robot.robot.friction.k_s_per_m * creep[asked])
    assert abs(share - asked) < 0.02, (asked, share)
assert creep[1.2] > 3.0 * creep[0.95] and creep[1.2] > creep[1.05] > creep[0.95]
