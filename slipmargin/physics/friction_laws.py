"""Friction laws: which share σ of its grip a contact uses at a slip u, with z = k u and slope k [s/m].

A law is odd, grows from −1 to 1 and is the slope of a convex potential, so friction power is never
positive and a steady creep is unique.  All faces of every law stand in this file; ``law`` is the
law's place in :data:`LAWS`.  To add one: a line in :data:`LAWS` and a branch in each function.

==============  ==========================  =============================================================
law             σ(z)                        source
==============  ==========================  =============================================================
``atan``        (2/π) atan z                Williams et al. 2002, eq. (11)
``tanh``        tanh z                      the usual regularised Coulomb law (e.g. Andersson et al. 2007)
``rational``    z/√(1 + z²)                 smoothed Coulomb law; reaches 98 % of the grip at z = 4.9
==============  ==========================  =============================================================

The force on the robot is −μ N σ(k u): against the slip.
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: The laws' names as they stand in robot files.
LAWS = ("atan", "tanh", "rational")
#: Where each stands.
ATAN, TANH, RATIONAL = range(3)


def law_number(name: str) -> int:
    """A law's place in :data:`LAWS`."""
    return LAWS.index(name)


def law_share(law: int, z: Any) -> Any:
    """σ(z): the share of the grip used, −1 … 1."""
    if law == TANH:
        return np.tanh(z)
    if law == RATIONAL:
        return z / np.sqrt(1.0 + z * z)
    return 2.0 / np.pi * np.arctan(z)


def law_slopes(law: int, z: Any, share: Any) -> tuple[Any, Any]:
    """dσ/dz and d²σ/dz² where the law uses the ``share`` σ(z) of the grip."""
    if law == TANH:
        slope = (1.0 - share) * (1.0 + share)
        return slope, -2.0 * share * slope
    per = 1.0 / (1.0 + z * z)
    if law == RATIONAL:
        slope = per * np.sqrt(per)
        return slope, -3.0 * z * per * slope
    slope = 2.0 / np.pi * per
    return slope, -2.0 * z * per * slope


def law_slope(law: int, z: Any) -> Any:
    """dσ/dz."""
    return law_slopes(law, z, law_share(law, z))[0]


def law_potential(law: int, z: Any) -> Any:
    """∫₀ᶻ σ: convex, zero at zero."""
    if law == TANH:
        size = np.abs(z)
        return size + np.log1p(np.exp(-2.0 * size)) - np.log(2.0)
    if law == RATIONAL:
        return np.sqrt(1.0 + z * z) - 1.0
    return 2.0 / np.pi * (z * np.arctan(z) - 0.5 * np.log1p(z * z))


def law_inverse(law: int, share: Any) -> Any:
    """z at which a share of the grip is used; infinite at 1."""
    if law == TANH:
        return np.arctanh(share)
    if law == RATIONAL:
        return share / np.sqrt(1.0 - share * share)
    return np.tan(0.5 * np.pi * share)
