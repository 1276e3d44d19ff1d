"""The wrench polytope in three dimensions, and its section at zero moment."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from slipmargin.checks import Array
from slipmargin.limits import WrenchSet
from slipmargin.physics.convention import Convention
from slipmargin.plots.style import BLUE, GREY, INK, ORANGE, SKY, styled
from slipmargin.sets.hull import Hull
from slipmargin.sets.section import section
from slipmargin.sets.zonotope import Zonotope


@styled
def polytope_figure(wrenches: WrenchSet, title: str, convention: Convention = Convention.PAPER) -> Figure:
    """All wrenches (Fx, Fy, Mz) on the left, the pure forces (Mz = 0) on the right.

    Both of the robot's own grip; a coupled one has a curved surface, drawn through points of it.
    """
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.1, 1.0))
    space = figure.add_subplot(grid[0], projection="3d")
    assert isinstance(space, Axes3D)
    body = wrenches.body()
    draw_polytope(space, body)
    space.set_title(title)
    draw_section(figure.add_subplot(grid[1]), body, convention)
    return figure


def draw_polytope(axes: Axes3D, body: Zonotope | Hull) -> Axes3D:
    """Faces shaded by height, the section at Mz = 0 as a line."""
    corners = body.vertices()
    size = np.abs(corners).max(axis=0)
    polygons, shades = [], []
    light = np.array([0.4, -0.5, 0.77])
    for face, normal in _faces(body, corners, size):
        polygons.append(face)
        shades.append(0.5 + 0.5 * float(normal @ light))
    base, white = np.array([0.0, 0.447, 0.698]), np.ones(3)
    colours = [np.append(white + (base - white) * (0.85 - 0.6 * s), 0.72) for s in shades]
    edges: dict[str, Any] = {"edgecolors": INK, "linewidths": 0.7}
    if isinstance(body, Hull):
        edges = {"edgecolors": colours, "linewidths": 0.2}
    axes.add_collection3d(Poly3DCollection(polygons, facecolors=colours, **edges))
    ring = section(body)
    axes.plot(*np.vstack([ring, ring[:1]]).T, np.zeros(len(ring) + 1), color=ORANGE, lw=2.2)
    axes.set(
        xlim=(-size[0], size[0]),
        ylim=(-size[1], size[1]),
        zlim=(-size[2], size[2]),
        xlabel="Fx [N]",
        ylabel="Fy [N]",
        zlabel="Mz [N m]",
    )
    axes.locator_params(nbins=5)
    axes.view_init(elev=22, azim=-55)
    axes.set_box_aspect((1, 1, 0.9), zoom=0.95)
    return axes


def draw_section(axes: Axes, body: Zonotope | Hull, convention: Convention = Convention.PAPER) -> Axes:
    """The forces that come without a moment: the section of the polytope at Mz = 0."""
    ring = section(body)
    axes.fill(*ring.T, fc=SKY, alpha=0.3, ec="none")
    axes.plot(*np.vstack([ring, ring[:1]]).T, color=ORANGE, label="section at Mz = 0")
    reach = np.hypot(ring[:, 0], ring[:, 1])
    edges = np.roll(ring, -1, axis=0) - ring
    span = np.clip(-np.sum(ring * edges, axis=1) / np.sum(edges**2, axis=1), 0.0, 1.0)
    near = ring + span[:, None] * edges
    least = near[np.argmin(np.hypot(near[:, 0], near[:, 1]))]
    radius = float(np.hypot(*least))
    turn = np.linspace(0.0, 2 * np.pi, 361)
    axes.plot(
        radius * np.cos(turn),
        radius * np.sin(turn),
        color=BLUE,
        lw=1.0,
        ls=(0, (5, 3)),
        label=f"in every direction: {radius:.3g} N",
    )
    axes.plot(*least, marker="o", ms=5, mfc="white", mec=INK, ls="none")
    axes.axhline(0.0, color=GREY, lw=0.6)
    axes.axvline(0.0, color=GREY, lw=0.6)
    far = 1.28 * float(reach.max())
    axes.set(
        xlim=(-far, far),
        ylim=(-far, far),
        aspect="equal",
        xlabel=f"Fx, {convention.axes[0]} [N]",
        ylabel=f"Fy, {convention.axes[1]} [N]",
        title="Pure forces on the body (Mz = 0)",
    )
    axes.legend(loc="upper right")
    return axes


def _faces(body: Zonotope | Hull, corners: Array, size: Array) -> Iterator[tuple[Array, Array]]:
    """Corners of each face in turn, and its outward unit normal in the picture."""
    if isinstance(body, Hull):
        for face in corners[body.faces()]:
            normal = np.cross((face[1] - face[0]) / size, (face[2] - face[0]) / size)
            outward = normal * np.sign(normal @ (face.mean(axis=0) / size))
            yield face, outward / np.linalg.norm(outward)
        return
    normals, offsets = body.half_spaces()
    for normal, offset in zip(normals, offsets, strict=True):
        face = corners[np.abs(corners @ normal - offset) < 1e-9 * np.max(np.abs(offsets))]
        unit = normal * size / np.linalg.norm(normal * size)
        yield face[_around(face / size, normal * size)], unit


def _around(points: Array, normal: Array) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    centred = points - points.mean(axis=0)
    first = centred[0] / np.linalg.norm(centred[0])
    second = np.cross(normal / np.linalg.norm(normal), first)
    return np.argsort(np.arctan2(centred @ second, centred @ first))
