"""The dense check: what a profile really uses, sampled many times finer than its grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.motion_external import tipping
from slipmargin.limits.motion_realised import creep_lasts_s, open_loop_use, realised, settles_slowly, settling
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Contact
from slipmargin.model import Model
from slipmargin.paths.along import Caps, speed_ratio
from slipmargin.paths.geometry import Geometry

#: Samples in each interval.
FINER = 20


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Audit:
    """What a profile uses at samples (n, F) inside its n intervals.

    ``use`` (n, F, N) share of each wheel's grip in the realised distribution, pose held or open loop,
    whichever is more; ``torque`` (n, F, N) share
    of the motor's torque; ``speed`` (n, F) share of the tightest speed cap; ``load_N`` (n, F, N);
    ``tipping`` (n, F, N) share of its load at constant speed that a wheel loses: at 1 it lifts.
    ``settling`` (n, N) is the largest use within the milliseconds after each interval's acceleration
    sets in (the first interval's does not follow another).  Where the creep settles slowly ``driven`` (n,) is
    the largest use of wheels that are driven from the start, counted in ``use`` too, and ``memory_s`` (n,)
    how long a creep lasts; else both are 0.
    """

    use: Array
    settling: Array
    torque: Array
    speed: Array
    load_N: Array
    tipping: Array
    time_s: Array
    driven: Array
    memory_s: Array

    @property
    def most(self) -> Array:
        """Largest use (n, N) in each interval, settling at either end included."""
        after = np.concatenate([self.settling[1:], np.zeros_like(self.settling[:1])])
        return np.asarray(np.max([self.use.max(axis=1), self.settling, after], axis=0))

    @property
    def worst(self) -> tuple[int, int, int]:
        """Interval, sample and wheel of the largest use."""
        i, j, k = np.unravel_index(int(np.argmax(self.use)), self.use.shape)
        return int(i), int(j), int(k)


def audit(
    model: Model,
    geometry: Geometry,
    x: Array,
    u: Array,
    *,
    contact: Contact,
    share: float,
    caps: Caps,
    known: Audit | None = None,
    changed: NDArray[np.bool_] | None = None,
) -> Audit:
    """Check a profile at the samples of ``geometry``.

    With ``changed`` (n,) only intervals that differ from those of the check ``known`` are looked at, and how
    the creep settles into each and out of it; of the others the old figures stand, but for their times.
    Where the creep settles slowly the whole profile is driven from its start instead
    (:func:`~slipmargin.limits.motion_realised.followed`).
    """
    slow = settles_slowly(model)
    if slow:
        known = changed = None
    n, samples = geometry.s.shape
    each, time = (-1, samples, model.count), geometry.times(x, u)
    motion = geometry.motion(x, u, time)
    there = np.ones(n, dtype=bool) if known is None or changed is None else changed
    settles = there | np.concatenate([[False], there[:-1]])
    states = motion.take(np.flatnonzero(np.repeat(there, samples)))
    forces = realised(model, states, contact=contact, share=share)
    driven, lasts = np.zeros((n, samples, model.count)), np.zeros(n)
    drifting = open_loop_use(model, states, contact=contact, share=share)
    if slow:
        driven = drifting.reshape(driven.shape)
        lasts = creep_lasts_s(model, motion, contact=contact, share=share).reshape(n, samples).max(axis=1)
    first = samples * np.flatnonzero(settles)
    jumps = settling(
        model, motion.take(np.maximum(first - 1, 0)), motion.take(first), contact=contact, share=share
    )

    def whole(old: Array | None, fresh: Array, rows: NDArray[np.bool_] = there) -> Array:
        out = np.empty((n, *fresh.shape[1:])) if old is None else old.copy()
        out[rows] = fresh
        return out

    return Audit(
        use=whole(known and known.use, np.maximum(forces.use, drifting).reshape(each)),
        settling=whole(known and known.settling, jumps, settles),
        torque=whole(
            known and known.torque,
            torque_use(model, forces.torque_N_m, model.geometry.wheel_speeds(states.velocity)).reshape(each),
        ),
        speed=np.sqrt(geometry.squared_speed(x)) * speed_ratio(model, geometry, caps),
        load_N=whole(known and known.load_N, forces.load_N.reshape(each)),
        tipping=whole(known and known.tipping, tipping(model, states, forces.load_N).reshape(each)),
        time_s=time,
        driven=driven.max(axis=(1, 2)),
        memory_s=lasts,
    )
