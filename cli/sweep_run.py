"""What ``slipmargin sweep`` computes, between its options and its report."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.pulls import SAME_RAD, PullGroups, gather_pulls
from slipmargin.io.table import columns_text
from slipmargin.io.trial_file import read_pulls
from slipmargin.io.writes import check_writable, write_text
from slipmargin.limits import Isotropic, Pull, Sweep, isotropic, sweep, wrench_set
from slipmargin.limits.bias import bias_wrench
from slipmargin.limits.self_check import self_check
from slipmargin.model import Model
from slipmargin.physics.constants import GRAVITY_M_S2

from .render import refuse

METHODS = ("facets", "clarabel", "cvxpy")
_MOST = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepRun:
    """A sweep with everything that its table, its four lines and its picture say."""

    sweep: Sweep
    limiting: tuple[tuple[str, ...], ...]
    isotropic: Isotropic
    recommended_N: float
    margin: float
    method: str
    check: float  #: relative difference to the second road [1]
    pulls: PullGroups | None
    outside: int  #: pulls outside the orientations swept

    @property
    def weight_N(self) -> float:
        """m g [N]."""
        return self.sweep.model.inertia.mass_kg * GRAVITY_M_S2

    def measured(self) -> dict[str, Array]:
        """``measured_N, scatter_N, residual_N, pulls`` a row; NaN where nothing was measured."""
        if self.pulls is None:
            return {}
        groups = [self.pulls.nearest(phi) for phi in self.sweep.phi_rad]
        pick = {
            name: np.array([math.nan if g is None else values[g] for g in groups])
            for name, values in (
                ("measured_N", self.pulls.mean_N),
                ("scatter_N", self.pulls.sd_N),
                ("pulls", self.pulls.count),
            )
        }
        return {
            "measured_N": pick["measured_N"],
            "scatter_N": pick["scatter_N"],
            "residual_N": pick["measured_N"] - self.sweep.f_max_N,
            "pulls": pick["pulls"],
        }

    def write(self, out: Path | None, plot: Path | None) -> None:
        """The CSV and the figure; the figure is drawn before the CSV is written."""
        if plot is not None:
            from slipmargin.plots.style import save
            from slipmargin.plots.sweep import sweep_figure

            circle = sweep(self.sweep.model, np.linspace(0.0, 2.0 * np.pi, 721))
            save(sweep_figure(self.sweep, circle, self.pulls, self.recommended_N), plot)
        if out is not None:
            write_text(out, columns_text({**self._contract(), **self.measured()}))

    def _contract(self) -> dict[str, Any]:
        return {
            "phi_rad": self.sweep.phi_rad,
            "f_max_N": self.sweep.f_max_N,
            "f_low_N": self.sweep.f_low_N,
            "f_high_N": self.sweep.f_high_N,
            "limiting": ["+".join(names) for names in self.limiting],
        }

    def as_json(self) -> dict[str, Any]:
        """Everything, as numbers."""
        model = self.sweep.model
        (weak, least), (strong, most) = self.sweep.weakest, self.sweep.strongest
        return {
            "schema": 1,
            "robot": model.robot,
            "surface": model.surface,
            "grip": model.grip.shape,
            "method": self.method,
            "self_check": self.check,
            "weight_N": self.weight_N,
            "weakest": {"phi_rad": weak, "force_N": least},
            "strongest": {"phi_rad": strong, "force_N": most},
            "isotropic": {"force_N": self.isotropic.force_N, "coefficient": self.isotropic.coefficient},
            "recommended": {"force_N": self.recommended_N, "margin": self.margin},
            **self._contract(),
            "limiting": self.limiting,
            **self.measured(),
        }


def run_sweep(
    model: Model,
    degrees: tuple[float, float, float],
    method: str,
    margin: float,
    measured: Path | None,
    outputs: tuple[Path | str | None, ...],
) -> SweepRun:
    """Everything the command needs, with its options checked before any work is done.

    Raises
    ------
    InputError
        Placed at the option or in the file of pulls.
    """
    if method not in METHODS:
        refuse("--method", f"is {method!r}", f"use one of: {', '.join(METHODS)}")
    phi = orientations(*degrees)
    check_writable(*outputs)
    if outputs[1] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[1])
    pulls, outside = None, 0
    if measured is not None:
        pulls, outside = _pulls_between(phi, measured, model.count)
        on = [float(p) for p in pulls.phi_rad if np.min(np.abs(phi - p)) > SAME_RAD]
        phi = np.sort(np.append(phi, on))
    by_facets = sweep(model, phi)
    if not wrench_set(model).polyhedral:
        method = "cones" if method == "facets" else method
    found = by_facets
    if method not in ("facets", "cones"):
        found = replace(by_facets, f_max_N=_solved(model, phi, method))
    extremes = np.array([found.weakest, found.strongest])
    check = (
        self_check(model, extremes[:, 0], extremes[:, 1])
        if method in ("facets", "cones")
        else float(np.max(np.abs(found.f_max_N / by_facets.f_max_N - 1.0)))
    )
    return SweepRun(
        sweep=found,
        limiting=by_facets.limiting(),
        isotropic=isotropic(model),
        recommended_N=found.recommended_N(margin),
        margin=margin,
        method=method,
        check=check,
        pulls=pulls,
        outside=outside,
    )


def orientations(start: float, stop: float, step: float) -> Array:
    """From, to and step [deg] as an array [rad], both ends included where the step meets them.

    Raises
    ------
    InputError
        Placed at ``--from``, ``--to`` or ``--step``.
    """
    for option, value in (("--from", start), ("--to", stop), ("--step", step)):
        if not math.isfinite(value) or abs(value) > 1e6:
            refuse(option, f"is {value}", "give an angle in degrees")
    if step <= 0.0:
        refuse("--step", f"is {step:g}", "give a positive step in degrees")
    if stop < start:
        refuse("--to", f"is {stop:g}, below --from {start:g}", "swap them")
    count = math.floor((stop - start) / step + 1e-9) + 1
    if count > _MOST:
        refuse("--step", f"is {step:g}: {count} orientations", f"give a step that makes at most {_MOST}")
    return np.asarray(np.deg2rad(start + step * np.arange(count)))


def _pulls_between(phi: Array, file: Path, wheels: int) -> tuple[PullGroups, int]:
    """The pulls between the first and last orientation (turned by whole turns into it), how many are not."""
    read = read_pulls(file, wheels)
    turned = phi[0] - SAME_RAD + np.mod(read.phi_rad - phi[0] + SAME_RAD, 2.0 * np.pi)
    inside = turned <= phi[-1] + SAME_RAD
    if not np.any(inside):
        refuse("--measured", f"no pull of {file} lies between --from and --to", "widen the range")
    return gather_pulls(turned[inside], read.force_N[inside]), int(np.count_nonzero(~inside))


def _solved(model: Model, phi: Array, method: str) -> Array:
    """F_emax by a solver: Clarabel directly, or cvxpy (all orientations as one block where it can)."""
    from slipmargin.limits.cones import cone_limit, limit_family

    if method == "clarabel":
        answer: Array = cone_limit(model, phi, Pull(), np.zeros(model.count, dtype=bool))
        return answer
    from slipmargin.solve import cvxpy_

    wrenches = wrench_set(model)
    if wrenches.polyhedral and not model.grip.multipliers:
        limits = (wrenches.coefficients[..., 1] * wrenches.load_N[:, None]).ravel()
        maps, rays = wrenches.maps.reshape(3, -1), Pull().rays(model, phi)
        return cvxpy_.block_box(maps, limits, rays, bias_wrench(model, phi))
    family = limit_family(model, phi)
    shares = [cvxpy_.solve(family.program(m)).x[0] for m in range(len(phi))]
    return np.array(shares) * model.inertia.weight_N
