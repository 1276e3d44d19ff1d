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

import numpy as np

from slipmargin.physics.friction_laws import law_inverse, law_share, law_slope, law_slopes

Slope = tuple[float, float, float, float, float, float]
#: The shapes' numbers for compiled code, in the order of :class:`~slipmargin.physics.grips.GripShape`.
BOX, DISC_STRIP, ELLIPSE = range(3)
#: Below this z a law is its own series: σ(z)/z = σ'(z/√3) up to z⁴.
_SMALL = 1e-3


def box(law: int, uw: float, ut: float, mw: float, mt: float, kw: float, kt: float) -> Slope:
    """The law in each direction alone."""
    a, b = kw * uw, kt * ut
    along, across = law_share(law, a), law_share(law, b)
    rises, rises_across = law_slopes(law, a, along)[0], law_slopes(law, b, across)[0]
    return mw * along, mt * across, mw * kw * rises, 0.0, 0.0, mt * kt * rises_across


def secant(law: int, s: float, k: float) -> tuple[float, float]:
    """σ(k s)/s and its derivative over s, divided by s (finite at s = 0)."""
    x = k * s
    z = np.maximum(x, _SMALL)
    share = law_share(law, z)
    q, bend = through(z, share, law_slopes(law, z, share)[0], k)
    if x < _SMALL:
        q = k * law_slope(law, x / np.sqrt(3.0))
    return q, bend


def through(p: float, share: float, slope: float, k: float) -> tuple[float, float]:
    """:func:`secant` at the slip p = k s, where the law is σ = ``share`` and σ' = ``slope``."""
    q = share / p
    return k * q, k * k * k * (slope - q) / (p * p)


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


def spun(law: int, part: float, drive: float, most: float) -> tuple[float, float, float]:
    """Slip p = k s in (σ⁻¹(r), ``most``) at which f_T is the ``part`` r = μ_T/μ_W of the disc; σ, σ' there.

    The roller spins as fast as makes it so: r/σ(p) is the sine of the slip's angle to ĝ, and the rest of p
    is the ``drive`` slip d = k |u_W|, so that F(p) = p² (1 − r²/σ(p)²) = d².  F grows from 0 at σ(p) = r.
    Guarded steps of Halley's method find p from where a parabola has the value d² that starts like F and
    ends as steeply; of the rational law it is F itself.
    """
    low, high = np.minimum(law_inverse(law, part), most), most
    end, start = (1.0 - part) * (1.0 + part), 2.0 * low * low * law_slopes(law, low, part)[0] / part
    p = low + 2.0 * drive * drive / (start + np.sqrt(start * start + 4.0 * end * drive * drive))
    p, share, slope = np.minimum(p, high), part, 0.0
    for _ in range(80):
        share = law_share(law, p)
        slope, bend = law_slopes(law, p, share)
        per = 1.0 / share
        sine, growth = part * per, slope * per
        left, turn = (1.0 - sine) * (1.0 + sine), p * sine * sine
        miss = p * p * left - drive * drive
        rises = 2.0 * p * (left + turn * growth)
        bends = 2.0 * (left + 4.0 * turn * growth + p * turn * (bend * per - 3.0 * growth * growth))
        if miss > 0.0:
            high = p
        else:
            low = p
        step = miss * rises / np.maximum(rises * rises - 0.5 * miss * bends, 0.5 * rises * rises)
        new = p - step
        if not low <= new <= high:
            new = 0.5 * (low + high)
        step, p = new - p, new
        share, slope = share + step * (slope + 0.5 * step * bend), slope + step * bend
        # Each step has three times as many digits; what moves by so little has its law by its derivatives.
        if np.abs(step) <= 1e-5 * p:
            break
    return p, share, slope


def disc_strip(law: int, uw: float, ut: float, mw: float, mt: float, k: float) -> Slope:
    """Disc law of radius μ_W whose transverse part the roller's bearing limits to μ_T."""
    if mt <= 0.0:
        return mw * law_share(law, k * uw), 0.0, mw * k * law_slope(law, k * uw), 0.0, 0.0, 0.0
    s = np.sqrt(uw * uw + ut * ut)
    q, dq = secant(law, s, k)
    if mt >= mw or np.abs(mw * q * ut) <= mt:
        cross = mw * dq * uw * ut
        return mw * q * uw, mw * q * ut, mw * (q + dq * uw * uw), cross, cross, mw * (q + dq * ut * ut)
    p, share, slope = spun(law, mt / mw, k * np.abs(uw), k * s)
    q, dq = through(p, share, slope, k)
    z = mt / (mw * q)
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
