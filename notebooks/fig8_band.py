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
# # Fig. 8, and why its measured points scatter
#
# Williams, Carter, Gallina and Rosati (2002) pulled a three-wheel robot with a spring scale at several
# orientations φ and compared the force at breakaway with a linear program (eqs 12–18).  They found that
# "the experimental repeatability is very low".  Here is their curve, and a reason.

# %%
# %matplotlib inline
import numpy as np
from IPython.display import display

import slipmargin as sm

robot = sm.read_robot("ohio-kiwi")

# %% [markdown]
# ## The curve
#
# All wheels stand on rollers: 0.26 along the drive direction, 0.09 across it (Table I, paper floor).  The
# blue line is F_emax(φ).  The band around it is what the next section is about.

# %%
curve = sm.sweep(robot, "paper")  # every degree from 0° to 90°
weight = curve.weight_N
display(curve.plot())

# %% [markdown]
# One coefficient for the whole robot would have promised μ m g in every direction.  It overstates by:

# %%
claimed = curve.isotropic.force_N
overstated = 100.0 * (claimed / curve.f_max_N - 1.0)
print(f"μ m g = {claimed:.2f} N overstates F_emax by {overstated.min():.0f} to {overstated.max():.0f} %")

# %% [markdown]
# ## The band
#
# Between two rollers a wheel stands on rigid rim, a tenth of the way round.  There the coefficient is 0.47
# in both directions.  Three wheels, each on one or the other: eight contact states, and a pull test meets
# one of them without knowing which.  The band runs from the lowest to the highest of the eight.

# %%
for surface in ("paper", "carpet"):
    found = sm.sweep(robot, surface)
    ratio = found.f_high_N / found.f_low_N
    print(f"{surface:<7} highest over lowest state: {ratio.min():.2f} to {ratio.max():.2f} times")

# %% [markdown]
# A pull test repeated with other wheel angles may give nearly three times the force.  So: note the wheel
# angles of every pull (`theta{i}_rad` in `pulls.csv`), or trust the lower edge of the band.
#
# ## Where the curve comes from
#
# The forces and moments that three wheels can resist form a polytope (a zonotope: the image of a box).
# F_emax is where a ray leaves it.

# %%
display(sm.polytope(robot, "paper").plot())

# %% [markdown]
# ## The claim, with numbers
#
# Against values computed independently (per unit of weight, every 15°), and the size of the band.

# %%
every_15 = np.array([0.16705, 0.17295, 0.19290, 0.19357, 0.19357, 0.20570, 0.21296])
rigid_15 = np.array([0.49987, 0.51751, 0.57720, 0.55339, 0.54042, 0.52201, 0.54042])
assert np.allclose(curve.f_max_N[::15] / weight, every_15, atol=5e-6)
assert np.allclose(curve.f_high_N[::15] / weight, rigid_15, atol=5e-6)  # the highest state: all on rigid
assert np.allclose(curve.f_low_N, curve.f_max_N)  # on paper the lowest state is all on rollers
ratio = curve.f_high_N / curve.f_low_N
assert ratio.min() > 2.5 and ratio.max() < 3.0
assert round(overstated.min()) == 22 and round(overstated.max()) == 56
