"""F_emax as a cone program: any grip, any pull, any state; its duals name what binds.

Everything is per m g, moments per m g and a length.  With wheel forces f_i = μ_i ∘ y_i:

    maximise F   s.t.   Σ_i b_i f_i + d F = −w_b,      y_i in the grip's set scaled by N_i(F) = N⁰_i + t_i F.

Box: |y_ij| ≤ N_i (eq. 17).  Ellipse: ‖y_i‖ ≤ N_i.  Disc-strip: f_i = μ_W y_i, also |μ_W y_T| ≤ μ_T N_i.
A blend (1 − κ)·box ⊕ κ·shape has both kinds of variable, f_i = (1 − κ) μ_i ∘ y_i + κ μ_i ∘ y'_i, so that
every cone is of the loads' size however thin its part is.  Where friction depends on the sense of the slip
each force is split into its two senses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.bias import LIFTED, Bias, bias as bias_at_rest, shifts_load
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import refuse_slipping
from slipmargin.limits.wrench_set import WrenchSet, wrench_maps
from slipmargin.model import Model
from slipmargin.physics.grips import GripShape, polyhedral
from slipmargin.sets.facets import length_scale
from slipmargin.solve.assemble import Assembly
from slipmargin.solve.program import ConeFamily, ConeProgram, Solution

_BALANCE = ("balance Fx", "balance Fy", "balance Mz")
_PARTS = ("drive", "transverse")
#: A part of a blend smaller than this is counted to the other [1].  The shape lies in the box and holds the
#: box divided by √2 (a disc-strip whose transverse coefficient is r > 1 times its drive one: by √(1 + r²)),
#: so no support changes by more than (1 − 1/√2) of this, or √2 − 1 at the other end.
THIN = 1e-8


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConeLimits:
    """Answers of a family: F_emax (M,) [N], and for each the program's own solution."""

    family: ConeFamily
    force_N: Array
    normals: Array  #: (M, 3) outward normal of the wrench set where the pull leaves it, unscaled
    x: Array
    s: Array
    z: Array

    def solution(self, m: int) -> Solution:
        """The m-th answer with its certificate."""
        return Solution(
            program=self.family.program(m), x=self.x[m], s=self.s[m], z=self.z[m], solver="Clarabel"
        )


def limit_program(
    model: Model, phi_rad: float, pull: Pull | None = None, rigid: Array | None = None
) -> ConeProgram:
    """The program of eqs (13)–(18) at one heading, per m g; all wheels on rollers by default."""
    return limit_family(model, np.array([phi_rad]), pull, rigid).program(0)


def limit_family(
    model: Model,
    phi_rad: Array,
    pull: Pull | None = None,
    rigid: Array | None = None,
    extreme: Extreme = Extreme.NEUTRAL,
    bias: Bias | None = None,
) -> ConeFamily:
    """The programs of all headings.

    Parameters
    ----------
    phi_rad : (M,)
    rigid : (N,) bool, optional
    bias : Bias, optional
        External wrench and loads; by default those of the model at rest.
    """
    pull = Pull() if pull is None else pull
    rigid = np.zeros(model.count, dtype=bool) if rigid is None else rigid
    weight, maps = model.inertia.weight_N, wrench_maps(model)
    per = _units(maps)
    rays = pull.rays(model, phi_rad)
    mu = coefficients(model, rigid, phi_rad, extreme)
    mu = np.broadcast_to(mu, (len(phi_rad), *mu.shape[1:]))
    bias = bias_at_rest(model, phi_rad) if bias is None else bias
    put = Assembly(count=len(phi_rad))
    put.variable("F", cost=-1.0)
    put.equations(_BALANCE, -bias.wrench / (weight * per))
    put.column("F", _BALANCE, rays / per)
    build = _Wheels(
        put=put,
        names=model.geometry.names,
        maps=maps / per[:, None, None],
        mu=mu,
        load=np.broadcast_to(bias.load_N / weight, (len(phi_rad), model.count)),
        change=pull.load_change(model, rays),
    )
    build.grip(model.grip.shape, model.grip.coupling)
    if pull.height_m != 0.0 or shifts_load(model):
        build.floor()
    return put.family(tuple(f"pull at phi = {phi:.6g} rad" for phi in phi_rad))


def cone_exit(wrenches: WrenchSet, rays: Array, start: Array | None = None) -> tuple[Array, Array]:
    """How far rays (M, 3) from a start (3,) go inside a wrench set of any grip, and its normals there.

    The start is the origin, or a wrench of the set.

    Returns
    -------
    (M,) multiples of each ray, (M, 3) outward normals
    """
    from slipmargin.solve.clarabel_ import solve_family

    weight, per = float(np.sum(wrenches.load_N)), _units(wrenches.maps)
    size = np.sqrt(np.sum((rays / per) ** 2, axis=1))
    put = Assembly(count=len(rays))
    put.variable("F", cost=-1.0)
    origin = np.zeros(3) if start is None else start / per / weight
    put.equations(_BALANCE, np.tile(origin, (len(rays), 1)))
    put.column("F", _BALANCE, -rays / per / size[:, None])
    mu = np.broadcast_to(wrenches.coefficients, (len(rays), *wrenches.coefficients.shape))
    build = _Wheels(
        put=put,
        names=wrenches.names,
        maps=wrenches.maps / per[:, None, None],
        mu=mu,
        load=np.broadcast_to(wrenches.load_N / weight, (len(rays), len(wrenches.names))),
        change=np.zeros((len(rays), len(wrenches.names))),
    )
    build.grip(wrenches.shape, wrenches.coupling)
    x, _, z = solve_family(put.family(tuple(f"ray {m + 1}" for m in range(len(rays)))))
    return x[:, 0] * weight / size, -z[:, :3] / per


def cone_limits(
    model: Model,
    phi_rad: Array,
    pull: Pull | None = None,
    rigid: Array | None = None,
    extreme: Extreme = Extreme.NEUTRAL,
    bias: Bias | None = None,
) -> ConeLimits:
    """Solve the family with Clarabel, one set-up updated.

    Raises
    ------
    NoSolution
        With the first program that has no answer.
    """
    from slipmargin.solve.clarabel_ import solve_family

    family = limit_family(model, phi_rad, pull, rigid, extreme, bias)
    x, s, z = solve_family(family)
    # Stationarity in F: d·λ + … = 1 with λ the balance's multipliers, so −λ is the outward normal.
    return ConeLimits(
        family=family,
        force_N=np.maximum(x[:, 0], 0.0)
        * model.inertia.weight_N,  # never less, but for the solver's rounding
        normals=-z[:, :3] / _units(wrench_maps(model)),
        x=x,
        s=s,
        z=z,
    )


def cone_limit(model: Model, phi_rad: Array, pull: Pull, rigid: Array) -> Array:
    """(M,) F_emax [N] of one contact state.

    Raises
    ------
    NoSolution
        If the robot slips without any pull.
    """
    bias = bias_at_rest(model, phi_rad)
    force = _limit(model, phi_rad, pull, rigid, Extreme.NEUTRAL, bias)
    return refuse_slipping(model, force, phi_rad, bias.load_N)


def cone_extreme(
    model: Model, phi_rad: Array, pull: Pull, rigid: Array, extreme: Extreme, biases: Sequence[Bias]
) -> Array:
    """(M,) least or greatest F_emax over ``biases``; NaN where the robot slips without any pull."""
    every = np.stack([_limit(model, phi_rad, pull, rigid, extreme, bias) for bias in biases])
    slips = np.isnan(every)
    if extreme is Extreme.HIGH:
        best = np.where(slips, -np.inf, every).max(axis=0)
        return np.where(np.all(slips, axis=0), np.nan, best)
    return np.where(np.any(slips, axis=0), np.nan, every.min(axis=0))


def _limit(model: Model, phi_rad: Array, pull: Pull, rigid: Array, extreme: Extreme, bias: Bias) -> Array:
    from slipmargin.solve.clarabel_ import solve_family

    if not model.external.terms:
        return cone_limits(model, phi_rad, pull, rigid, extreme, bias).force_N
    # The ray need not start inside: F = 0 must balance too, so ask how far the set lets it be scaled.
    stands = np.min(bias.load_N, axis=1) >= -LIFTED * model.inertia.weight_N
    out = np.full(len(phi_rad), np.nan)
    if not np.all(stands):
        if np.any(stands):
            out[stands] = _limit(model, phi_rad[stands], pull, rigid, extreme, _rows(bias, stands))
        return out
    pressed = np.maximum(bias.load_N, 0.0)
    load = bias.wrench / (model.inertia.weight_N * _units(wrench_maps(model)))
    size = np.sqrt(np.sum(load**2, axis=1))
    inside = size == 0.0
    if not np.all(inside):
        loaded = ~inside
        unmoved = Bias(wrench=0.0 * bias.wrench[loaded], load_N=pressed[loaded])
        at_rest = limit_family(model, phi_rad[loaded], replace(pull, height_m=0.0), rigid, extreme, unmoved)
        towards = np.array(at_rest.a)
        towards[:, :3, 0] = load[loaded] / size[loaded, None]
        inside[loaded] = solve_family(replace(at_rest, a=towards))[0][:, 0] >= size[loaded]
    if np.any(inside):
        found = cone_limits(model, phi_rad[inside], pull, rigid, extreme, _rows(bias, inside))
        out[inside] = found.force_N
    return out


def _rows(bias: Bias, rows: NDArray[np.bool_]) -> Bias:
    return Bias(wrench=bias.wrench[rows], load_N=bias.load_N[rows])


def _units(maps: Array) -> Array:
    return np.array([1.0, 1.0, length_scale(maps.reshape(3, -1))])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Wheels:
    """Writes the wheels' variables and rows."""

    put: Assembly
    names: tuple[str, ...]
    maps: Array  #: (3, N, 2)
    mu: Array  #: (M, N, 2, 2)
    load: Array  #: (M, N)
    change: Array  #: (M, N)

    @property
    def _two_sided(self) -> bool:
        return bool(np.any(self.mu[..., 0] != self.mu[..., 1]))

    def grip(self, shape: GripShape, coupling: float) -> None:
        """(1 − coupling)·box ⊕ coupling·shape."""
        kappa = 0.0 if polyhedral(shape, coupling) or coupling < THIN else coupling
        kappa = 1.0 if kappa > 1.0 - THIN else kappa
        if kappa < 1.0:
            self.box(1.0 - kappa, "" if kappa == 0.0 else " (box part)")
        if kappa > 0.0:
            self.cone(kappa, shape is GripShape.DISC_STRIP)

    def box(self, part: float, suffix: str) -> None:
        """Variables y with |y_ij| ≤ N_i, which count ``part`` times."""
        for i, name in enumerate(self.names):
            for j, axis in enumerate(_PARTS):
                for key, sign in self._forces(f"{name} {axis}{suffix}", i, j, part * self.mu[:, i, j]):
                    self._bounded(i, {key: sign}, 1.0, f"{key} {'≤ +' if sign > 0 else '≥ −'}μ N")

    def cone(self, part: float, strip: bool) -> None:
        """Variables y with ‖y_i‖ ≤ N_i, and the strip where asked, which count ``part`` times."""
        for i, name in enumerate(self.names):
            across = self.mu[:, i, 0].min(axis=1) if strip else None
            sides = []
            for j, axis in enumerate(_PARTS):
                scale = self.mu[:, i, j] if j == 0 or across is None else np.stack([across, across], axis=1)
                made = self._forces(f"{name} {axis}", i, j, part * scale)
                sides.append({key: 1.0 for key, _ in made})
                if j == 1 and across is not None:
                    for key, sign in made:
                        side = 1 if sign > 0 and not key.endswith("−") else 0
                        width = np.ones_like(across)  # a wheel that drives nowhere has no strip to cut
                        np.divide(self.mu[:, i, 1, side], across, out=width, where=across > 0.0)
                        self._bounded(i, {key: sign}, width, f"{name} strip {'≤' if side else '≥'}")
            self.put.second_order(
                f"{name} grip",
                [
                    ({"F": -self.change[:, i]}, self.load[:, i]),
                    *(({k: -v for k, v in side.items()}, 0.0) for side in sides),
                ],
            )

    def floor(self) -> None:
        """Every wheel stays on the floor: N_i(F) ≥ 0."""
        for i, name in enumerate(self.names):
            self.put.inequality(f"floor under {name}", {"F": -self.change[:, i]}, self.load[:, i])

    def _forces(self, key: str, i: int, j: int, scale: Array) -> list[tuple[str, float]]:
        # Names of the variables of one force, each with the sign by which it is bounded from above.
        if not self._two_sided:
            self.put.variable(key)
            self.put.column(key, _BALANCE, scale[:, 1:] * self.maps[:, i, j])
            return [(key, 1.0), (key, -1.0)]
        for sense, side in (("+", 1), ("−", 0)):
            self.put.variable(key + sense)
            self.put.column(
                key + sense,
                _BALANCE,
                (1.0 if side else -1.0) * scale[:, side : side + 1] * self.maps[:, i, j],
            )
            self.put.inequality(f"{key}{sense} ≥ 0", {key + sense: -1.0}, 0.0)
        return [(key + "+", 1.0), (key + "−", 1.0)]

    def _bounded(self, i: int, row: dict[str, float], part: float | Array, name: str) -> None:
        self.put.inequality(name, {**row, "F": -part * self.change[:, i]}, part * self.load[:, i])
