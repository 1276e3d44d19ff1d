"""Where safe sets end, and what their ends ask of wheels and motors when they are driven as motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bounds_states import States
from slipmargin.limits.effort import Most
from slipmargin.limits.margin import unit

#: Steps uphill from the worst end of a round set, and how far the slope is looked for in each axis [1].
UPHILL, NEARBY = 3, 1e-3
#: Corners of a box of three axes.
CORNERS = 8


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Ends:
    """Where a set ends: ``corners(*set, sign)`` (R, P, 3), or ``farthest(*set, normals)`` along (R, G, 3)."""

    corners: Callable[..., Array] | None = None
    farthest: Callable[..., Array] | None = None

    def unknown(self, states: States) -> Array:
        """The creep at the ends of a set that has not been driven."""
        if self.corners is not None:
            return states.demands.unknown(CORNERS, len(states.first))
        return states.demands.unknown(*states.normals.shape[:2])

    def driven(self, found: tuple[Array, ...], states: States, creep: Array) -> Most:
        """What the ends of a set ask of each motion at most (1, M).

        ``creep`` of :meth:`unknown` keeps what was found, for the set that is driven next.

        A round set's ends are those along the rows' normals and all round.  Shares of the realised
        distribution are greatest between them: from the worst end of each motion the next one is the farthest
        uphill.
        """
        if self.corners is not None:
            return Most.of([states.effort(self.corners(*found, states.sign), states.run, creep=creep)])
        assert self.farthest is not None
        at = self.farthest(*found, states.normals)
        size = np.max(np.abs(at), axis=(0, 1))
        step, each = np.vstack([np.zeros(3), NEARBY * np.diag(size)])[:, None], np.arange(len(states.kind))
        seen = [states.effort(at, states.kind, creep=creep)]
        shares: tuple[Callable[[Most], Array], ...] = (lambda e: e.use,)
        if states.model.drives.stall_torque_N_m is not None:
            shares = (*shares, lambda e: e.motors)
        for share in shares:
            worst = at[np.argmax(share(seen[0]), axis=0), states.kind][None]
            for _ in range(UPHILL):
                near = states.effort(worst + step, each, near=True)
                seen.append(near.first)
                uphill = (share(near)[1:] - share(near)[0]).T / np.maximum(size, 1e-300)
                worst = self.farthest(*found, uphill[None])
            seen.append(states.effort(worst, each))
        return Most.of(seen)


def sided_corners(fast: Array, slow: Array, sign: Array) -> Array:
    """(8, M, 3): each axis speeds up or slows down; where it stands, it starts either way."""
    return np.stack(
        [
            np.where(sign == 0.0, way * fast, sign * np.where(way > 0.0, fast, -slow))
            for way in np.array(list(product((1.0, -1.0), repeat=3)))
        ]
    )


def even_corners(even: Array, sign: Array) -> Array:
    """(8, M, 3): either way along every axis, whatever the motion."""
    ways = np.array(list(product((1.0, -1.0), repeat=3)))
    return np.broadcast_to((ways * even)[:, None], (CORNERS, *sign.shape))


def circle_end(circle: Array, normal: Array) -> Array:
    """The end of a circle of translations with a yaw acceleration to either side, (R, M, 3)."""
    turn = np.where(normal[..., 2:] < 0.0, -circle[1], circle[1])
    return np.concatenate([circle[0] * unit(normal[..., :2]), turn], axis=-1)


def ellipsoid_end(E: Array, normal: Array) -> Array:
    """The ellipsoid's point farthest along each normal (R, M, 3)."""
    return np.asarray(unit(normal @ E) @ E.T)
