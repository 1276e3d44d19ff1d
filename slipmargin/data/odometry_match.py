"""How well the wheels' motion matches the camera's, for the columns as they stand and for others.

A run is cut into short pieces.  In each the wheels alone predict a displacement, and the camera saw one.
Where wheels slip the two differ; but there are pieces without slip in every run, and in these only the
right arrangement of signs, columns and axes matches.  An arrangement is therefore judged by its better
pieces, not by all.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.odometry import body_path, wheel_angles
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pieces:
    """Wheel angles turned (K, N) and body displacements seen (V, K, 3) in V views of the pose."""

    turned: Array
    seen: Array

    @property
    def count(self) -> int:
        """Number of pieces K."""
        return len(self.turned)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arrangement:
    """Another reading of the columns: an order and signs of the wheels, a view of the pose, and its words.

    ``parts`` is the number of faults it consists of.
    """

    words: str
    order: tuple[int, ...]
    signs: tuple[float, ...]
    view: int
    parts: int

    def wheels(self, turned: Array) -> Array:
        """Wheel signals (T, N) put right."""
        return np.asarray(turned[:, list(self.order)] * np.array(self.signs))


#: What may be wrong with the pose: factors of x, y, φ, an angle added to φ in quarter turns, and the words.
VIEWS: tuple[tuple[tuple[float, float, float], int, str], ...] = (
    ((1.0, 1.0, 1.0), 0, ""),
    ((1.0, -1.0, -1.0), 0, "a mirrored frame (turn the sign of y_m and of phi_rad)"),
    ((1.0, 1.0, -1.0), 0, "phi_rad counted clockwise (turn its sign)"),
    ((-1.0, 1.0, 1.0), 0, "a mirrored x axis (turn the sign of x_m)"),
    ((1.0, -1.0, 1.0), 0, "a mirrored y axis (turn the sign of y_m)"),
    ((1.0, 1.0, 1.0), 1, "phi_rad a quarter turn too small (add π/2)"),
    ((1.0, 1.0, 1.0), 2, "phi_rad half a turn off (add π)"),
    ((1.0, 1.0, 1.0), 3, "phi_rad a quarter turn too large (subtract π/2)"),
    ((1.0, 1.0, -1.0), 1, "phi_rad a compass course (use π/2 − phi_rad)"),
)


def pieces(record: Record, signal: WheelSignal) -> Pieces | None:
    """The pieces of a run; None where wheels or pose are missing."""
    if signal is WheelSignal.COMMANDED:
        angle = wheel_angles(record.t_s, None, record.omega_cmd)
    else:
        angle = wheel_angles(record.t_s, record.theta, record.omega)
    rows = np.flatnonzero(record.seen)
    if angle is None or len(rows) < 8:
        return None
    t = record.t_s[rows]
    span = max(SETTINGS.piece_s, SETTINGS.piece_samples * float(np.median(np.diff(t))))
    edges = np.unique(np.searchsorted(t, np.arange(t[0], t[-1] + 1e-9, span)).clip(0, len(t) - 1))
    if len(edges) < 3:
        return None
    pose = record.pose[rows]
    seen = []
    for factors, quarters, _ in VIEWS:
        view = pose * np.array(factors) + np.array([0.0, 0.0, quarters * np.pi / 2.0])
        seen.append(np.diff(body_path(view)[edges], axis=0))
    return Pieces(turned=np.diff(angle[rows][edges], axis=0), seen=np.stack(seen))


def joined(parts: list[Pieces]) -> Pieces:
    """The pieces of several runs."""
    return Pieces(
        turned=np.concatenate([p.turned for p in parts]),
        seen=np.concatenate([p.seen for p in parts], axis=1),
    )


def all_pieces(data_set: DataSet) -> list[Pieces | None]:
    """The pieces of each run."""
    return [pieces(trial.first(), data_set.wheel_signal) for trial in data_set.trials]


def mismatch(part: Pieces, arrangement: Arrangement | None, geometry: WheelGeometry) -> float:
    """What the wheels' motion misses of the measured one in the better moving pieces, as a share of it.

    One factor common to all pieces is allowed (slip, a worn wheel).  NaN where nothing moves.
    """
    turned = part.turned if arrangement is None else arrangement.wheels(part.turned)
    seen = part.seen[0 if arrangement is None else arrangement.view]
    weigh = np.array([1.0, 1.0, geometry.reach_m])
    by, seen = turned @ geometry.no_slip_map().T * weigh, seen * weigh
    went = np.sqrt(np.maximum(np.sum(by**2, axis=1), np.sum(seen**2, axis=1)))
    moving = went > SETTINGS.piece_moves * np.quantile(went, 0.95)
    if not moving.any() or not went.max() > 0.0:
        return float("nan")
    by, seen, went = by[moving], seen[moving], went[moving]
    along, power = np.sum(by * seen, axis=1), np.sum(by**2, axis=1)
    rolls = power > 0.0
    factor = float(np.clip(np.median(along[rolls] / power[rolls]), 0.3, 1.5)) if rolls.any() else 1.0
    misses = np.sqrt(np.sum((seen - factor * by) ** 2, axis=1)) / went
    return float(np.quantile(misses, SETTINGS.better_pieces))


def ratios(part: Pieces, geometry: WheelGeometry) -> tuple[float, float]:
    """How far the robot moved over how far its wheels rolled, and how far it turned: medians over pieces.

    NaN where the wheels say that it does not move, or turn.
    """
    reach = geometry.reach_m
    by, seen = part.turned @ geometry.no_slip_map().T, part.seen[0]
    went = float(np.quantile(np.sqrt(np.sum((by * np.array([1.0, 1.0, reach])) ** 2, axis=1)), 0.95))
    out = []
    for columns, lever in ((slice(0, 2), 1.0), (slice(2, 3), reach)):
        rolled = np.sqrt(np.sum(by[:, columns] ** 2, axis=1))
        moved = np.sqrt(np.sum(seen[:, columns] ** 2, axis=1))
        moving = rolled * lever > SETTINGS.piece_moves * went
        out.append(float(np.median(moved[moving] / rolled[moving])) if moving.any() else float("nan"))
    return out[0], out[1]


def arrangements(names: tuple[str, ...]) -> tuple[Arrangement, ...]:
    """What could be wrong, simplest first: one fault, two faults, three."""
    n = len(names)
    straight = tuple(range(n))
    orders = [straight]
    if n <= SETTINGS.most_permuted:
        orders += [p for p in permutations(range(n)) if p != straight]
    signs: list[tuple[str, tuple[float, ...]]] = [
        ("", (1.0,) * n),
        ("every wheel turning the other way (turn the sign of omega and theta)", (-1.0,) * n),
    ]
    for i in range(n):
        one = tuple(-1.0 if j == i else 1.0 for j in range(n))
        signs.append((f"wheel {names[i]} turning the other way (turn its sign)", one))
    out = []
    for view, (_, _, viewed) in enumerate(VIEWS):
        for order in orders:
            moved = [names[i] for i, j in enumerate(order) if i != j]
            swapped = "columns of wheels " + " and ".join(moved) + " swapped" if moved else ""
            if swapped and view > 2:
                continue
            for signed, factors in signs:
                words = [part for part in (swapped, signed, viewed) if part]
                if words:
                    out.append(
                        Arrangement(
                            words=" and ".join(words),
                            order=order,
                            signs=factors,
                            view=view,
                            parts=len(words) + max(0, len(moved) - 2),
                        )
                    )
    return tuple(sorted(out, key=lambda a: a.parts))
