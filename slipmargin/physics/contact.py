"""The friction force of one contact per unit of load, with its slope, on plain numbers.

Sliding velocities u_W = u·ĝ and u_T = u·f̂; the force on the robot is −N (f_W ĝ + f_T f̂).  With a law's
share σ (:mod:`~slipmargin.physics.friction_laws`; eq. (11) for ``atan``), positive force coefficients
acting against positive sliding:

box         f_W = μ_W σ(k_W u_W),  f_T = μ_T σ(k_T u_T)                       (as published)
ellipse     s = √(u_W² + (μ_T/μ_W)² u_T²):  f = μ_W σ(k s)/s (u_W, (μ_T/μ_W)² u_T)
disc-strip  the disc law μ_W σ(k|u'|) u'/|u'| at u' = (u_W, z): z = u_T unless |f_T| would exceed
            μ_T (the roller's bearing), then the roller spins and z is where |f_T| = μ_T

Each is the gradient of a convex potential: friction power is never positive.  Coupled laws use k_W.
The force is (1 − c)·box + c·coupled, the gradient form of the Minkowski sum of both sets.
Every function returns (f_W, f_T, ∂f_W/∂u_W, ∂f_W/∂u_T, ∂f_T/∂u_W, ∂f_T/∂u_T).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from slipmargin.physics.friction_laws import law_inverse, law_share, law_slope

Slope = tuple[float, float, float, float, float, float]
#: The shapes' numbers for compiled code, in the order of :class:`~slipmargin.physics.grips.GripShape`.
BOX, DISC_STRIP, ELLIPSE = range(3)
#: Below this z a law is its own series: σ(z)/z = σ'(z/√3) up to z⁴.
_SMALL = 1e-3


def box(law: int, uw: float, ut: float, mw: float, mt: float, kw: float, kt: float) -> Slope:
    """The law in each direction alone."""
    a, b = kw * uw, kt * ut
    return (
        mw * law_share(law, a),
        mt * law_share(law, b),
        mw * kw * law_slope(law, a),
        0.0,
        0.0,
        mt * kt * law_slope(law, b),
    )


def secant(law: int, s: float, k: float) -> tuple[float, float]:
    """σ(k s)/s and its derivative over s, divided by s (finite at s = 0)."""
    x = k * s
    z = np.maximum(x, _SMALL)
    q = law_share(law, z) / z
    bend = k * k * k * (law_slope(law, z) - q) / (z * z)
    if x < _SMALL:
        q = law_slope(law, x / np.sqrt(3.0))
    return k * q, bend


def ellipse(law: int, uw: float, ut: float, mw: float, mt: float, k: float) -> Slope:
    """Elliptic law; with μ_T = μ_W the isotropic disc."""
    e = (mt / mw) ** 2
    q, dq = secant(law, np.sqrt(uw * uw + e * ut * ut), k)
    return (
        mw * q * uw,
        mw * e * q * ut,
        mw * (q + dq * uw * uw),
        mw * dq * e * uw * ut,
        mw * dq * e * uw * ut,
        mw * e * (q + dq * e * ut * ut),
    )


def spun(law: int, uw: float, far: float, mw: float, mt: float, k: float) -> Any:
    """z in (0, far) with μ_W σ(k√(u_W² + z²)) z/√(u_W² + z²) = μ_T, by guarded Newton steps."""
    low, high = 0.0, far
    r = mt / mw
    still = law_inverse(law, r) / k  # exact without drive slip, the other part where slip is fast
    z = np.minimum(np.sqrt(still * still + r * r / (1.0 - r * r) * uw * uw), 0.9 * far)
    for _ in range(80):
        q, dq = secant(law, np.sqrt(uw * uw + z * z), k)
        miss = mw * q * z - mt
        if miss > 0.0:
            high = z
        else:
            low = z
        step = miss / (mw * (q + dq * z * z))
        new = z - step
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if np.abs(step) <= 1e-9 * z and new == z - step:  # Newton doubles the digits: the next has all
            return new
        if high - low <= 4e-16 * high:
            return new
        z = new
    return z


def disc_strip(law: int, uw: float, ut: float, mw: float, mt: float, k: float) -> Slope:
    """Disc law of radius μ_W whose transverse part the roller's bearing limits to μ_T."""
    if mt <= 0.0:
        return mw * law_share(law, k * uw), 0.0, mw * k * law_slope(law, k * uw), 0.0, 0.0, 0.0
    q, dq = secant(law, np.sqrt(uw * uw + ut * ut), k)
    if np.abs(mw * q * ut) <= mt:
        cross = mw * dq * uw * ut
        return mw * q * uw, mw * q * ut, mw * (q + dq * uw * uw), cross, cross, mw * (q + dq * ut * ut)
    z = spun(law, uw, np.abs(ut), mw, mt, k)
    q, dq = secant(law, np.sqrt(uw * uw + z * z), k)
    cross = dq * uw * z
    slope = mw * (q + dq * uw * uw - cross * cross / (q + dq * z * z))
    return mw * q * uw, np.copysign(mt, ut), slope, 0.0, 0.0, 0.0


def contact(
    law: int,
    shape: int,
    coupling: float,
    uw: float,
    ut: float,
    mw: float,
    mt: float,
    kw: float,
    kt: float,
) -> Slope:
    """The law of a shape (:data:`BOX`, :data:`DISC_STRIP`, :data:`ELLIPSE`) in its share ``coupling``."""
    if shape == BOX or coupling == 0.0 or mw <= 0.0:
        return box(law, uw, ut, mw, mt, kw, kt)
    c = disc_strip(law, uw, ut, mw, mt, kw) if shape == DISC_STRIP else ellipse(law, uw, ut, mw, mt, kw)
    if coupling == 1.0:
        return c
    b = box(law, uw, ut, mw, mt, kw, kt)
    s, r = coupling, 1.0 - coupling
    return (
        r * b[0] + s * c[0],
        r * b[1] + s * c[1],
        r * b[2] + s * c[2],
        s * c[3],
        s * c[4],
        r * b[5] + s * c[5],
    )
