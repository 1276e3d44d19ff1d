"""One long recording cut into runs, each with a start pose of its own.

Wheels that turn at a run's start have a past: the robot may be slipping, and a camera that is late still
sees what they did before.  Each run therefore begins with a lead-in, rows whose wheels are known and whose
poses are left empty, so that nothing is compared there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import real
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS


def segments(
    record: Record, length_s: float, lead_s: float = SETTINGS.lead_s
) -> tuple[tuple[Record, ...], tuple[str, ...]]:
    """Runs of ``length_s`` seconds [s], with a lead-in of at most ``lead_s``, in which the wheels move.

    The second answer says which parts are left out, and why.

    Raises
    ------
    InputError
        Where the length is not above 0.5 s or the lead-in is negative.
    """
    length_s = real("segment_s", length_s, above=0.5, cure="give the seconds of a run, above 0.5")
    lead_s = real("lead_s", lead_s, low=0.0, cure="give the seconds of a lead-in, from 0")
    t = record.t_s
    found = []
    left: dict[str, list[str]] = {}
    count = int(np.ceil((t[-1] - t[0]) / length_s))
    for k in range(count):
        begin, end = t[0] + k * length_s, t[0] + (k + 1) * length_s
        rows = np.flatnonzero((t >= begin - lead_s) & (t < end))
        own = t[rows] >= begin
        pose = np.array(record.pose[rows])
        pose[~own] = np.nan
        if end - t[-1] > (1.0 - SETTINGS.shortest_segment) * length_s:
            why = f"shorter than {SETTINGS.shortest_segment:g} of that"
        elif own.sum() < 2:
            why = "fewer than two rows"
        elif not _moves(record, rows):
            why = "no wheel moves"
        elif not np.isfinite(pose).all(axis=1).any():
            why = "no pose"
        else:
            why = ""
        if why:
            left.setdefault(why, []).append(f"{begin - t[0]:.6g}")
            continue
        run = replace(record.part(rows), name=f"{record.name}_{k:03d}", pose=pose, began_s=None)
        found.append(run.restamped(run.t_s - run.t_s[0]))
    notes = (
        f"{len(at)} part{'s' * (len(at) > 1)} of {length_s:g} s left out, {why}: "
        f"from {', '.join(at[:8])}{' …' * (len(at) > 8)} s"
        for why, at in left.items()
    )
    return tuple(found), tuple(notes)


def _moves(record: Record, rows: np.ndarray[tuple[int], np.dtype[np.int64]]) -> bool:
    """Whether a wheel turns by a degree at least."""
    if record.theta is not None:
        known = record.theta[rows][:, np.isfinite(record.theta[rows]).any(axis=0)]
        return known.size > 0 and bool(np.max(np.nanmax(known, 0) - np.nanmin(known, 0)) > np.pi / 180.0)
    speeds = record.omega if record.omega is not None else record.omega_cmd
    return speeds is not None and bool(np.any(np.abs(speeds[rows]) > 0.0))
