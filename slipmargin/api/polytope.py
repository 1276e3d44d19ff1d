"""``slipmargin.polytope``: every force and moment the wheels can put on the body without slipping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, held_wheels, model_of, read_robot
from slipmargin.checks import Array

if TYPE_CHECKING:
    from slipmargin.limits import WrenchSet
    from slipmargin.model import Model
    from slipmargin.plots.style import Figure
    from slipmargin.sets.hull import Hull
    from slipmargin.sets.zonotope import Zonotope

#: Share of the size of the set [1]: facets nearer to the origin leave out nothing worth a number, and a set
#: that is thinner has no volume to speak of.
THIN = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PolytopeResult(Result):
    """The set of wrenches (Fx, Fy [N], Mz [N m]) about the centre of mass, in the body frame."""

    model: Model
    wrenches: WrenchSet
    body: Zonotope | Hull
    state: str  #: "rollers" or "rigid": what all wheels stand on
    warnings: tuple[str, ...]

    @property
    def vertices(self) -> Array:
        """(V, 3) corners, or points of a curved surface [N, N, N m]."""
        return self.body.vertices()

    @property
    def facets(self) -> tuple[Array, Array]:
        """Normals (F, 3) and offsets (F,): normal · wrench ≤ offset inside."""
        return self.body.half_spaces()

    @property
    def curved(self) -> bool:
        """Whether the grip is coupled, so that the set has curved sides between the points given."""
        return not self.wrenches.polyhedral

    @property
    def left_out(self) -> float:
        """Largest share by which the set reaches beyond the facets given [1]; 0 where they are its own."""
        if not self.curved:
            return 0.0
        normals, offsets = self.facets
        there = offsets > THIN * (np.abs(normals) @ np.max(np.abs(self.vertices), axis=0))
        return float(np.max(self.wrenches.support(normals[there]) / offsets[there] - 1.0))

    def summary(self) -> str:
        """Corners, facets and volume."""
        m = self.model
        return (
            f"polytope of {m.robot} on {m.surface}, all wheels on {self.state}: "
            f"{len(self.vertices)} {self._corners}, volume {self.body.volume():.4g} N² N m"
        )

    def lines(self) -> list[str]:
        """Size of the set, and the largest force and moment."""
        corners, m = self.vertices, self.model
        reach = np.maximum(*(self.wrenches.support(way * np.eye(3)) for way in (1.0, -1.0)))
        lines = [
            f"{len(corners)} {self._corners}, {len(self.facets[0])} facets, "
            f"volume {self.body.volume():.4g} N² N m ({m.robot} on {m.surface}, all wheels on {self.state})",
            f"largest |Fx| {reach[0]:.3f} N, |Fy| {reach[1]:.3f} N, |Mz| {reach[2]:.4f} N m, "
            "each with whatever else comes along",
        ]
        if self.curved:
            lines.append(
                f"grip {m.grip.shape.value}: the surface is curved, and lies up to "
                f"{100 * self.left_out:.2g} % outside these facets"
            )
        return lines

    @property
    def _corners(self) -> str:
        return "points of the surface" if self.curved else "vertices"

    def plot(self) -> Figure:
        """The polytope in space and its section at Mz = 0."""
        from slipmargin.plots.polytope import polytope_figure

        title = f"Wrenches without slip: {self.model.robot}, surface “{self.model.surface}”"
        return polytope_figure(self.wrenches, title, self.model.convention)

    def to_dict(self) -> dict[str, Any]:
        """Vertices, facets, volume and generators (of the box that holds the set, where it is curved)."""
        names = [f"{name} {part}" for name in self.wrenches.names for part in ("drive", "transverse")]
        return {
            "schema": 1,
            "robot": self.model.robot,
            "surface": self.model.surface,
            "grip": self.model.grip.shape,
            "curved": self.curved,
            "state": self.state,
            "units": {"vertices": ["N", "N", "N m"], "volume": "N^2 N m", "generators": ["N", "N", "N m"]},
            "vertices": self.vertices,
            "facets": [{"normal": n, "offset": o} for n, o in zip(*self.facets, strict=True)],
            "volume": self.body.volume(),
            "generators": self.wrenches.generators.T,
            "generator_names": names,
            "centre": self.wrenches.centre,
        }


def polytope(robot: RobotLike, surface: str, *, rigid: bool = False) -> PolytopeResult:
    """All wrenches (Fx, Fy, Mz) that the wheels can put on the body without slipping.

    The set is that of the robot's own grip: for the box (eq. 17 of the paper) a zonotope with all its
    vertices, for a coupled grip the hull of points of its curved surface, which lies inside the set.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    rigid : bool
        All wheels stand on rigid material instead of on rollers.

    Returns
    -------
    PolytopeResult
        ``vertices`` (V, 3) [N, N, N m] about the centre of mass, body frame; ``facets``.

    Raises
    ------
    InputError
        For a fault in the robot file, or a surface that it does not have.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.polytope("ohio-kiwi", "paper")
    <polytope of ohio-kiwi on paper, all wheels on rollers: 28 vertices, volume 85.26 N² N m>
    """
    from slipmargin.limits import wrench_set
    from slipmargin.limits.friction import Extreme, coefficients

    model, warnings = model_of(read_robot(robot), surface)
    warnings = (*warnings, *held_wheels(model))
    state = np.full(model.count, rigid)
    wrenches, least = wrench_set(model, state), coefficients(model, state, np.zeros(1), Extreme.LOW)[0]
    rubs = wrenches.coefficients > 0.0
    part = float(np.min(least[rubs] / wrenches.coefficients[rubs], initial=1.0))
    if part < 1.0 - THIN:
        warnings = (
            *warnings,
            f"friction depends on place, heading, wheel angle or time, and falls to {part:.3g} of what this "
            "set has; `sweep` counts the least",
        )
    body = wrenches.body()
    _refuse_flat(model, wrenches, body)
    return PolytopeResult(
        model=model,
        wrenches=wrenches,
        body=body,
        state="rigid" if rigid else "rollers",
        warnings=warnings,
    )


def _refuse_flat(model: Model, wrenches: WrenchSet, body: Zonotope | Hull) -> None:
    """Refuse a set that is thinner than rounding, a moment counting as its force at the robot's size."""
    from slipmargin.sets.facets import no_volume

    arm_m = float(np.max(np.hypot(*(model.geometry.position_m - model.inertia.com_m).T)))
    size = np.array([1.0, 1.0, arm_m])
    normals = body.half_spaces()[0]
    width = wrenches.support(normals) + wrenches.support(-normals)
    reach = np.max(np.linalg.norm((body.vertices() - wrenches.centre) / size, axis=1))
    if np.min(width / np.linalg.norm(normals * size, axis=1)) < THIN * reach:
        raise no_volume()
