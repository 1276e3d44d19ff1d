"""The friction law of one contact per unit of load, with its slope.

Sliding velocities u_W = u·ĝ and u_T = u·f̂; the force on the robot is −N (f_W ĝ + f_T f̂).
With σ(x) = (2/π) atan x, eq. (11) (positive force coefficient: against positive sliding):

box         f_W = μ_W σ(k_W u_W),  f_T = μ_T σ(k_T u_T)                       (as published)
ellipse     s = √(u_W² + (μ_T/μ_W)² u_T²):  f = μ_W σ(k s)/s (u_W, (μ_T/μ_W)² u_T)
disc-strip  the disc law μ_W σ(k|u'|) u'/|u'| at u' = (u_W, z): z = u_T unless |f_T| would exceed
            μ_T (the roller's bearing), then the roller spins and z is where |f_T| = μ_T

Each is the gradient of a convex potential: friction power is never positive.  Coupled laws use k_W.
The force is (1 − c)·box + c·coupled, the gradient form of the Minkowski sum of both sets.
"""

from __future__ import annotations

import math

from slipmargin.sim.compiled import inner

_TWO_PI = 2.0 / math.pi
Slope = tuple[float, float, float, float, float, float]


@inner
def box(uw: float, ut: float, mw: float, mt: float, kw: float, kt: float) -> Slope:
    """(f_W, f_T, ∂f_W/∂u_W, ∂f_W/∂u_T, ∂f_T/∂u_W, ∂f_T/∂u_T) of eq. (11) in each direction."""
    a, b = kw * uw, kt * ut
    return (
        mw * _TWO_PI * math.atan(a),
        mt * _TWO_PI * math.atan(b),
        mw * _TWO_PI * kw / (1.0 + a * a),
        0.0,
        0.0,
        mt * _TWO_PI * kt / (1.0 + b * b),
    )


@inner
def _secant(s: float, k: float) -> tuple[float, float]:
    """σ(k s)/s and its derivative over s, divided by s (finite at s = 0)."""
    x = k * s
    if x < 1e-3:
        return _TWO_PI * k * (1.0 - x * x / 3.0 + x**4 / 5.0), _TWO_PI * k**3 * (-2.0 / 3.0 + 0.8 * x * x)
    q = _TWO_PI * math.atan(x) / s
    return q, (_TWO_PI * k / (1.0 + x * x) - q) / (s * s)


@inner
def ellipse(uw: float, ut: float, mw: float, mt: float, k: float) -> Slope:
    """Elliptic law; with μ_T = μ_W the isotropic disc."""
    e = (mt / mw) ** 2
    q, dq = _secant(math.sqrt(uw * uw + e * ut * ut), k)
    return (
        mw * q * uw,
        mw * e * q * ut,
        mw * (q + dq * uw * uw),
        mw * dq * e * uw * ut,
        mw * dq * e * uw * ut,
        mw * e * (q + dq * e * ut * ut),
    )


@inner
def _spun(uw: float, far: float, mw: float, mt: float, k: float) -> float:
    """z in (0, far) with μ_W σ(k√(u_W² + z²)) z/√(u_W² + z²) = μ_T, by guarded Newton steps."""
    low, high = 0.0, far
    r = mt / mw
    still = math.tan(0.5 * math.pi * r) / k  # exact without drive slip, the other part where slip is fast
    z = min(math.sqrt(still * still + r * r / (1.0 - r * r) * uw * uw), 0.9 * far)
    for _ in range(80):
        q, dq = _secant(math.sqrt(uw * uw + z * z), k)
        miss = mw * q * z - mt
        if miss > 0.0:
            high = z
        else:
            low = z
        step = miss / (mw * (q + dq * z * z))
        new = z - step
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(step) <= 1e-9 * z and new == z - step:  # Newton doubles the digits: the next has all
            return new
        if high - low <= 4e-16 * high:
            return new
        z = new
    return z


@inner
def disc_strip(uw: float, ut: float, mw: float, mt: float, k: float) -> Slope:
    """Disc law of radius μ_W whose transverse part the roller's bearing limits to μ_T."""
    if mt <= 0.0:
        a = k * uw
        return mw * _TWO_PI * math.atan(a), 0.0, mw * _TWO_PI * k / (1.0 + a * a), 0.0, 0.0, 0.0
    q, dq = _secant(math.sqrt(uw * uw + ut * ut), k)
    if abs(mw * q * ut) <= mt:
        cross = mw * dq * uw * ut
        return mw * q * uw, mw * q * ut, mw * (q + dq * uw * uw), cross, cross, mw * (q + dq * ut * ut)
    z = _spun(uw, abs(ut), mw, mt, k)
    q, dq = _secant(math.sqrt(uw * uw + z * z), k)
    cross = dq * uw * z
    slope = mw * (q + dq * uw * uw - cross * cross / (q + dq * z * z))
    return mw * q * uw, math.copysign(mt, ut), slope, 0.0, 0.0, 0.0


@inner
def contact(
    shape: int, coupling: float, uw: float, ut: float, mw: float, mt: float, kw: float, kt: float
) -> Slope:
    """The law of a shape: 0 box, 1 disc-strip, 2 ellipse, in its share ``coupling``."""
    if shape == 0 or coupling == 0.0 or mw <= 0.0:
        return box(uw, ut, mw, mt, kw, kt)
    c = disc_strip(uw, ut, mw, mt, kw) if shape == 1 else ellipse(uw, ut, mw, mt, kw)
    if coupling == 1.0:
        return c
    b = box(uw, ut, mw, mt, kw, kt)
    s, r = coupling, 1.0 - coupling
    return (
        r * b[0] + s * c[0],
        r * b[1] + s * c[1],
        r * b[2] + s * c[2],
        s * c[3],
        s * c[4],
        r * b[5] + s * c[5],
    )
