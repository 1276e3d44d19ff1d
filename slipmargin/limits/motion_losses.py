"""The wrench that is no wheel's doing (rolling resistance, slope, cable) at a state of motion."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_probes import probes
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Frame

#: Below this speed a force against the motion fades out: v/√(v² + v₀²) [m/s], [rad/s].
SLOW_M_S, SLOW_RAD_S = 1e-3, 1e-2


def losses_in_motion(model: Model, motion: Motion) -> tuple[Array, Array]:
    """Lowest and highest wrench (M, 3) on the body about its centre of mass, body frame [N, N, N m].

    Equal where every variable is known.  The viscous part of the transverse friction,
    −c u·f̂ on each wheel, is here too, since no load bounds it.
    """
    low, high = np.zeros((motion.count, 3)), np.zeros((motion.count, 3))
    for term in model.external.terms:
        each = _term(model, motion, term)
        low, high = low + each.min(axis=0), high + each.max(axis=0)
    viscous = model.grip.viscous_N_s_per_m[1]
    if viscous:
        slide = motion.velocity @ model.geometry.lateral_rows().T
        drag = -viscous * slide @ model.wrench_maps()[1].T
        low, high = low + drag, high + drag
    return low, high


def _term(model: Model, motion: Motion, term: ForceTerm) -> Array:
    nothing = np.zeros((motion.count, model.count))
    v = probes(model, motion, nothing, 0.0, term.variable, term.basis, term.shape)[..., 0]
    wrench = np.broadcast_to(term.wrench(v), (len(v), motion.count, 3))
    if term.frame is Frame.BODY:
        return np.asarray(wrench)
    if term.frame is Frame.FLOOR:
        return _from_floor(motion, wrench)
    v, spin = motion.velocity[:, :2], motion.velocity[:, 2]
    ahead = v / np.sqrt(np.sum(v**2, axis=1, keepdims=True) + SLOW_M_S**2)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    out = np.empty(wrench.shape)
    out[..., :2] = -wrench[..., :1] * ahead + wrench[..., 1:2] * left
    out[..., 2] = -wrench[..., 2] * spin / np.sqrt(spin**2 + SLOW_RAD_S**2)
    return out


def _from_floor(motion: Motion, wrench: Array) -> Array:
    """R(φ)ᵀ of the force; over all headings where φ is unknown."""
    phi = (
        np.linspace(-np.pi, np.pi, 73)[:, None, None]
        if motion.heading is None
        else motion.heading[None, None]
    )
    c, s = np.cos(phi), np.sin(phi)
    x = c * wrench[None, ..., 0] + s * wrench[None, ..., 1]
    y = -s * wrench[None, ..., 0] + c * wrench[None, ..., 1]
    moment = np.broadcast_to(wrench[None, ..., 2], x.shape)
    out = np.stack([x, y, moment], axis=-1)
    return out.reshape(-1, *out.shape[2:])
