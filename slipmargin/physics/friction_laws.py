"""Friction laws: which share σ of its grip a contact uses at a slip u, with z = k u and slope k [s/m].

A law is odd, grows from −1 to 1 and is the slope of a convex potential, so friction power is never
positive and a steady creep is unique.  All four faces of every law stand in this file; ``law`` is the
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


def law_slope(law: int, z: Any) -> Any:
    """dσ/dz."""
    if law == TANH:
        t = np.tanh(z)
        return 1.0 - t * t
    if law == RATIONAL:
        return (1.0 + z * z) ** -1.5
    return 2.0 / np.pi / (1.0 + z * z)


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
