"""A bound on the creep of wheels that is proven, not planned (docs/theory.md, section 4, creep bound).

The creep twist ε of wheels with prescribed speeds follows M dε/dt = −Σ b_i c_i σ(k b_i·ε) + w(t) − C(ε), with
C what the robot's own turning adds.  Where the asked wrench w stays within the share λ of the drive grip,
w·ε ≤ λ Σ c_i |s_i| with s_i = b_i·ε, and the energy V = ½ ε·M ε falls wherever

    Σ c_i |s_i| (σ(k |s_i|) − λ) > m v |ε_v| |ε_ω|,

since |C(ε)·ε| is at most the right-hand side (v the speed driven; 0 where the pose is held).  So a robot that
starts from rest never crosses the smallest V at which it falls in every direction.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.limits.margin import sphere
from slipmargin.model import Model
from slipmargin.physics.friction_laws import law_inverse, law_share

#: Directions of creep that are tried, and what their gaps may hide of the bound [1].
DIRECTIONS, BETWEEN = 4000, 1.02
#: Steps of the search along a direction, and the largest k·s that it goes to [1].
_STEPS, _FAR = 400, 1e4


def proven_creep(model: Model, share: float, *, speed_m_s: float = 0.0) -> Array:
    """Fastest drive slip (N,) [m/s] of each wheel while no more than a share of the drive grip is asked.

    Infinite where creep and turning may feed each other at that speed.  Friction as on rollers, without
    multipliers of it; the loads at rest.

    Parameters
    ----------
    share : float
        λ, the share of the drive grip within which some distribution of drive forces gives what is asked.
    speed_m_s : float
        The fastest the robot drives while nothing corrects its pose; 0 where its pose is held.
    """
    lam = real("share", share, low=0.0, high=0.999, cure="give a share from 0 to 0.999")
    along, mass = model.wrench_maps()[0], model.inertia.diagonal
    if lam == 0.0:
        return np.zeros(model.count)
    grip, k = model.grip.roller[:, 0] * model.loads.rest_N, model.grip.k_s_per_m
    ways = sphere(DIRECTIONS) / np.sqrt(mass)  # V = ½ r²
    slips = np.abs(ways @ along)
    coupling = model.inertia.mass_kg * speed_m_s * np.hypot(ways[:, 0], ways[:, 1]) * np.abs(ways[:, 2])
    first = float(law_inverse(model.grip.law, lam)) / k / float(np.max(slips))
    radius = np.geomspace(1e-3 * first, _FAR * first, _STEPS)
    for r in radius:
        slip = r * slips
        falls = (slip * (law_share(model.grip.law, k * slip) - lam)) @ grip
        if np.all(falls > r**2 * coupling):
            break
    else:
        return np.full(model.count, np.inf)
    step = radius[1] / radius[0]
    return np.asarray(BETWEEN * step * r * np.sqrt(np.sum(along**2 / mass[:, None], axis=0)))
