"""Proposed runs in the axes of the robot file: they are computed in the frame of every diagnosis."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from slipmargin.experiment.result import Narrowing, NextRuns, ProposedRun
from slipmargin.physics.convention import Convention
from slipmargin.robot.turned import vectors

_SWAP = {"x": "y", "y": "x"}


def next_runs_in(found: NextRuns, old: Convention, new: Convention) -> NextRuns:
    """The same runs in another convention; themselves where it is the same one."""
    if old is new:
        return found
    space = found.space
    if space is not None:
        (a, b), turned = space.size_m, vectors(np.array(space.middle_m), old, new)
        space = replace(space, middle_m=(float(turned[0]), float(turned[1])), size_m=(b, a))
    return replace(
        found,
        runs=tuple(_run(r, old, new) for r in found.runs),
        narrowings=tuple(_narrowing(n) for n in found.narrowings),
        space=space,
        noise=found.noise[[1, 0, 2]],
        front_rad=new.front_rad,
    )


def _run(run: ProposedRun, old: Convention, new: Convention) -> ProposedRun:
    rows = run.trajectory
    pose, velocity, acceleration = (
        vectors(a, old, new) for a in (rows.pose, rows.velocity, rows.acceleration)
    )
    return replace(
        run,
        words=re.sub(r"(?<=floor's )[xy]\b", lambda m: _SWAP[m[0]], run.words),
        legs=tuple(vectors(leg, old, new) for leg in run.legs),
        trajectory=replace(rows, pose=pose, velocity=velocity, acceleration=acceleration),
        predicted=tuple(vectors(p, old, new) for p in run.predicted),
    )


def _narrowing(narrowing: Narrowing) -> Narrowing:
    """An interval of a parameter along x is one along y in axes that are turned by a quarter."""
    name = re.sub(r"(?<=_)[xy](?=_|$)", lambda m: _SWAP[m[0]], narrowing.parameter)
    return replace(narrowing, parameter=name)
