"""What ``slipmargin polytope`` computes and says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.io.writes import check_writable
from slipmargin.limits import WrenchSet, wrench_set
from slipmargin.model import Model


def describe(
    model: Model, rigid: bool, outputs: tuple[Path | str | None, ...]
) -> tuple[WrenchSet, dict[str, Any]]:
    """The wrench set, and everything the contract promises of it."""
    check_writable(*outputs)
    if outputs[0] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[0])
    wrenches = wrench_set(model, np.full(model.count, rigid))
    body = wrenches.zonotope()
    normals, offsets = body.half_spaces()
    names = [f"{name} {part}" for name in wrenches.names for part in ("drive", "transverse")]
    return wrenches, {
        "schema": 1,
        "robot": model.robot,
        "surface": model.surface,
        "state": "rigid" if rigid else "rollers",
        "units": {"vertices": ["N", "N", "N m"], "volume": "N^2 N m", "generators": ["N", "N", "N m"]},
        "vertices": body.vertices(),
        "facets": [{"normal": n, "offset": o} for n, o in zip(normals, offsets, strict=True)],
        "volume": body.volume(),
        "generators": body.generators.T,
        "generator_names": names,
        "centre": body.centre,
    }


def summary(found: dict[str, Any]) -> list[str]:
    """Lines for stdout."""
    corners = np.asarray(found["vertices"])
    reach = np.abs(corners).max(axis=0)
    return [
        f"{len(corners)} vertices, {len(found['facets'])} facets, volume {found['volume']:.4g} N² N m "
        f"({found['robot']} on {found['surface']}, all wheels on {found['state']})",
        f"largest |Fx| {reach[0]:.3f} N, |Fy| {reach[1]:.3f} N, |Mz| {reach[2]:.4f} N m, "
        "each with whatever else comes along",
    ]


def draw(wrenches: WrenchSet, model: Model, plot: Path) -> None:
    """The polytope in space and its section at Mz = 0."""
    from slipmargin.plots.polytope import polytope_figure
    from slipmargin.plots.style import save

    save(polytope_figure(wrenches, f"Wrenches without slip: {model.robot}, surface “{model.surface}”"), plot)
