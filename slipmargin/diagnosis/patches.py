"""Round places of the floor at which the motion leaves what the model says: where a patch may lie.

A small patch answers a tangent only where it is, and there are thousands of places for it.  But only while a
wheel is on it does the robot move otherwise than predicted, in every run.  So no patch is simulated: on each
of many places the error of the motion, as the body sees it, may change as it likes, and elsewhere it must
stay what it is.  Fits start on the places that leave least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from slipmargin.checks import Array, Index
from slipmargin.data.odometry import body_path, bridged
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.spots import Spot, best_spots
from slipmargin.diagnosis.state import State
from slipmargin.effects.confined import acting
from slipmargin.effects.places import PATCH
from slipmargin.physics.compiled import kernel
from slipmargin.physics.frames import rotate_rows

#: Radii that are looked at differ by this factor, and so do the radius and the change of friction of patches
#: beside one.
_WIDER = float(np.sqrt(2.0))
#: So many places of a radius are kept for each that is simulated: thirteen of its grid lie within one.
_WITHIN = 20
#: At least so many samples of all runs together are looked at, if there are as many: every so many of them.
#: In ten runs of three seconds a robot at 1 m/s is then seen every centimetre of its way.
_SAMPLES = 4000


def at_patches(
    before: State, screening: Screening, overdue: Callable[[], bool] = lambda: False
) -> list[Screened]:
    """Entries of candidates that say a patch, with starts on the places that the residual points to.

    The best comes first, and what it takes off is promised.
    """
    out = []
    for entry in screening.entries:
        if entry.stands_alone and entry.structure[0].is_near(PATCH) and not overdue():
            candidate = entry.structure[0]
            own = (candidate.build(candidate.starts[0]),)
            members = before.view.member_of[before.fit.trials]
            runs = before.fit.trials[[bool(acting(own, int(member))) for member in members]]
            radii = candidate.starts[:, candidate.keys.index(PATCH[-1])]
            spots = [
                Spot(candidate.at(PATCH, at, candidate.near), partial(_beside, candidate))
                for at in patches(before, radii, runs, overdue)
            ]
            out += best_spots(before, entry, spots, overdue)
    return out


def _beside(candidate: Candidate, x: Array, share: float) -> Array:
    """Parameters ``x`` (P,) on patches (8, P) beside theirs: moved four ways, wider, narrower, more, less."""
    x_m, y_m, radius_m = candidate.where(PATCH, x)
    step_m, wider = share * SETTINGS.patch_apart * radius_m, _WIDER**share
    moved = [
        (x_m + dx, y_m + dy, radius_m) for dx, dy in ((step_m, 0), (-step_m, 0), (0, step_m), (0, -step_m))
    ]
    sized = [(x_m, y_m, radius_m * wider), (x_m, y_m, radius_m / wider)]
    changed = np.array([x, x])
    changed[:, 0] = candidate.null[0] + (x[0] - candidate.null[0]) * np.array([wider, 1.0 / wider])
    rows = [candidate.at(PATCH, place, x[None]) for place in (*moved, *sized)]
    return np.asarray(np.clip(np.concatenate([*rows, changed]), candidate.low, candidate.high))


def patches(
    before: State, radii_m: Array, runs: Index, overdue: Callable[[], bool] = lambda: False
) -> list[tuple[float, float, float]]:
    """Places and radii [m] that leave least of the error of the motion in some runs, best first.

    Radii are looked at from half of the smallest of ``radii_m`` to the largest.  On a wide floor places may
    lie farther apart than small patches are wide.
    """
    motion = _motion(before, runs)
    wheels, total = motion.wheels, len(motion.seen)
    radius, most = 0.5 * float(radii_m.min()), float(radii_m.max())
    found: list[tuple[float, tuple[float, float, float]]] = []
    while total and radius <= most and not overdue():
        low, high = wheels.min(axis=(0, 1)) - 0.5 * radius, wheels.max(axis=(0, 1)) + 0.5 * radius
        apart = max(SETTINGS.patch_apart * radius, float(max(high - low)) / SETTINGS.patch_places)
        x, y = (np.arange(low[i], high[i] + apart, apart) for i in range(2))
        places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        scores = _scores(places, radius, motion)
        found += [
            (float(scores[k]), (*places[k].tolist(), radius))
            for k in np.argsort(scores, kind="stable")[: _WITHIN * SETTINGS.patches].tolist()
        ]
        radius *= _WIDER
    kept: list[tuple[float, float, float]] = []
    for _, place in sorted(found):
        if not any(_same(place, other) for other in kept):
            kept.append(place)
        if len(kept) == SETTINGS.patches:
            break
    return kept


def _same(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    """Whether a fit from one place reaches the other: one covers the other's middle."""
    return float(np.hypot(one[0] - other[0], one[1] - other[1])) < max(one[2], other[2])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Motion:
    """Where each wheel stands on the floor (T, N, 2), the error of the motion up to there (T, 3), over the
    noise and with a smoothed heading, whether a run begins there (T,), and whether the pose was seen (T,);
    else it lies between others.
    """

    wheels: Array
    errors: Array
    begins: NDArray[np.bool_]
    seen: NDArray[np.bool_]


def _motion(before: State, runs: Index) -> _Motion:
    """The motion that a state leaves in some runs.

    Steps are compared as the body sees them: a heading that went astray does not turn what comes later.
    """
    view, base = before.view, before.fit
    arms = view.model(base.effects).geometry.position_m
    predicted = replace(view, piece=None).predict([base.effects], [runs])[0]
    every = max(1, sum(len(view.trials[int(i)].t_s) for i in runs) // _SAMPLES)
    even = 1 + 2 * max(1, round(0.5 * SETTINGS.patch_heading_s / (every * view.step_s)))
    wheels, errors = [np.zeros((0, len(arms), 2))], [np.zeros((0, 3))]
    begins, seen = [np.zeros(0, dtype=bool)], [np.zeros(0, dtype=bool)]
    for number, pose in zip(runs, predicted, strict=True):
        measured = view.trials[int(number)].pose[::every]
        told = pose[: len(view.trials[int(number)].pose) : every]
        there = np.isfinite(measured).all(axis=1)
        if not there.any() or not np.isfinite(told).all():
            continue  # a prediction that diverged says nothing
        k = np.arange(len(told))
        off = bridged(k.astype(float), measured - told)
        off[:, 2] = uniform_filter1d(off[:, 2], even)  # noise of the heading would turn every step
        at = told + off
        errors.append((body_path(at) - body_path(told)) / view.sigma)
        wheels.append(at[:, None, :2] + rotate_rows(at[:, 2:], arms))
        begins.append(np.asarray(k == 0))
        seen.append(np.asarray(there))
    return _Motion(
        wheels=np.concatenate(wheels),
        errors=np.concatenate(errors),
        begins=np.concatenate(begins),
        seen=np.concatenate(seen),
    )


def _scores(places: Array, radius_m: float, motion: _Motion) -> Array:
    """How badly a patch on each place (Q, 2) explains the error: (Q,), less is better.

    It is the Bayesian information criterion of an error that is free with a wheel on the place and constant
    elsewhere, but for a spread that is not known: what a patch did goes on for a while.
    """
    left, kept, free = (np.zeros(len(places)) for _ in range(3))
    _stretches(
        places, radius_m**2, motion.wheels, motion.errors, motion.begins, motion.seen, left, kept, free
    )
    total = 3.0 * np.count_nonzero(motion.seen)
    # one noise² more, so that what is left is never nothing
    return np.asarray(total * np.log((left + 1.0) / np.maximum(kept, 1.0)) + free * np.log(total))


@kernel
def _stretches(
    places: Any,
    square: float,
    wheels: Any,
    errors: Any,
    begins: Any,
    seen: Any,
    left: Any,
    kept: Any,
    free: Any,
) -> None:
    """What is left of squared errors (T, 3) about their means over stretches with no wheel near a place (Q,).

    Near is what is within a distance, ``square`` of it.  ``kept`` counts the values of such stretches and
    ``free`` the others and one for each mean.  Only what was ``seen`` counts, but a wheel may have been near
    while nothing was seen.
    """
    for place in range(len(places)):
        count, x, y, turn, squares = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(len(wheels) + 1):
            ends, inside = k == len(wheels) or begins[k], False
            if k < len(wheels):
                for w in range(wheels.shape[1]):
                    dx, dy = wheels[k, w, 0] - places[place, 0], wheels[k, w, 1] - places[place, 1]
                    inside = inside or dx * dx + dy * dy < square
            if count > 0.0 and (ends or inside):
                left[place] += squares - (x * x + y * y + turn * turn) / count
                kept[place] += 3.0 * count
                free[place] += 3.0
                count, x, y, turn, squares = 0.0, 0.0, 0.0, 0.0, 0.0
            if k == len(wheels) or not seen[k]:
                continue
            if inside:
                free[place] += 3.0
            else:
                count += 1.0
                x += errors[k, 0]
                y += errors[k, 1]
                turn += errors[k, 2]
                squares += errors[k, 0] ** 2 + errors[k, 1] ** 2 + errors[k, 2] ** 2
