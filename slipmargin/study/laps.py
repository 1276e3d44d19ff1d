"""Benchmark paths: how long a design needs for a fixed set of motions, slip margin 10 %.

Four straight metres (forwards, backwards, right, slanting) with the heading held, a square with rounded
corners, heading held, and a figure of eight on which the body turns with the path.  All start and end at
rest; wheels on rollers.
"""

from __future__ import annotations

import math

import numpy as np

from slipmargin.errors import NoSolution
from slipmargin.model import Model
from slipmargin.paths.path import Path, corners, through
from slipmargin.paths.plan import Request, plan
from slipmargin.physics.convention import Convention

#: Share of the grip that a plan may use, and grid points of each path.
SHARE, POINTS = 0.9, 100


def benchmark_paths(convention: Convention = Convention.PAPER) -> dict[str, Path]:
    """The paths by name, forwards where the robot's front is at φ = 0."""
    slant = math.sqrt(0.5)
    straight = {
        "forwards": (0.0, 1.0),
        "backwards": (0.0, -1.0),
        "right": (1.0, 0.0),
        "slanting": (slant, slant),
    }
    turned = convention.from_right_forward
    paths = {
        name: corners(np.array([[0.0, 0.0, 0.0], [*turned(x, y), 0.0]])) for name, (x, y) in straight.items()
    }
    square = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0], [-0.5, 0.0], [0.0, 0.0]])
    paths["square"] = corners(np.column_stack([*turned(*square.T), np.zeros(len(square))]), blend_m=0.2)
    t = np.linspace(0.0, 2.0 * math.pi, 17)[:-1] + math.pi / 16.0
    x, y = 0.5 * np.sin(t), 0.25 * np.sin(2.0 * t)
    way = np.unwrap(np.arctan2(0.5 * np.cos(2.0 * t), 0.5 * np.cos(t)))
    paths["eight"] = through(np.column_stack([*turned(x, y), way - way[0]]), closed=True)
    return paths


def lap_times(model: Model, paths: dict[str, Path] | None = None) -> dict[str, float]:
    """Time for each path [s], those of the benchmark by default; infinite where none is admissible."""
    return {name: _time(model, path) for name, path in (paths or benchmark_paths(model.convention)).items()}


def lap_time(model: Model) -> float:
    """Time for all paths of the benchmark together [s]."""
    return float(sum(lap_times(model).values()))


def _time(model: Model, path: Path) -> float:
    try:
        return plan(model, path, Request(share=SHARE, points=POINTS)).duration_s
    except NoSolution:
        return math.inf
