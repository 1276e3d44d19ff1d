"""``slipmargin.sweep``: how hard the robot can be pulled at each orientation before a wheel slips."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import Drawing, RobotLike, checked_margin, held_wheels, model_of, read_robot
from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.robot.warnings import EVERY_SPREAD

if TYPE_CHECKING:
    from slipmargin.data.pulls import PullGroups
    from slipmargin.limits import Isotropic, Sweep
    from slipmargin.limits.uncertainty import SlipChance
    from slipmargin.model import Model
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page

METHODS = ("facets", "clarabel", "cvxpy")
_MOST = 1_000_000
#: An orientation that was not swept is spoken of if it holds less than those that were by this share [1].
_WEAKER = 0.01


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SweepResult(Result):
    """F_emax over orientation with its band, the four numbers to remember, and measured pulls beside it."""

    sweep: Sweep
    limiting: tuple[tuple[str, ...], ...]  #: names of the wheels that slip first, for each orientation
    isotropic: Isotropic
    recommended_N: float
    margin: float
    method: str
    check: float  #: relative difference to a second method [1]
    pulls: PullGroups | None
    outside: int  #: measured pulls outside the orientations swept
    warnings: tuple[str, ...]
    slip_chance: SlipChance | None = None  #: None where no number of the robot is uncertain

    @property
    def phi_rad(self) -> Array:
        """(M,) orientation of the robot under a pull along the floor's +x [rad]."""
        return self.sweep.phi_rad

    @property
    def f_max_N(self) -> Array:
        """(M,) pull before a wheel slips, all wheels on rollers [N]."""
        return self.sweep.f_max_N

    @property
    def f_low_N(self) -> Array:
        """(M,) lowest limit over what the wheels may stand on [N]."""
        return self.sweep.f_low_N

    @property
    def f_high_N(self) -> Array:
        """(M,) highest limit over what the wheels may stand on [N]."""
        return self.sweep.f_high_N

    @property
    def weight_N(self) -> float:
        """m g [N]."""
        return self.sweep.model.inertia.mass_kg * GRAVITY_M_S2

    def measured(self) -> dict[str, Array]:
        """``measured_N, scatter_N, residual_N, pulls`` (M,); NaN where nothing was measured."""
        if self.pulls is None:
            return {}
        groups = [self.pulls.nearest(phi) for phi in self.phi_rad]

        def picked(values: Array) -> Array:
            return np.array([math.nan if g is None else values[g] for g in groups])

        mean = picked(self.pulls.mean_N)
        return {
            "measured_N": mean,
            "scatter_N": picked(self.pulls.sd_N),
            "residual_N": mean - self.f_max_N,
            "pulls": picked(self.pulls.count),
        }

    def summary(self) -> str:
        """Weakest orientation and recommended pull."""
        from slipmargin.report.text import degrees

        phi, force = self.sweep.weakest
        m = self.sweep.model
        return (
            f"sweep of {m.robot} on {m.surface}: weakest {force:.2f} N at φ = {degrees(phi)}, "
            f"recommended {self.recommended_N:.2f} N"
        )

    def lines(self) -> list[str]:
        """Four lines of answer, one of proof, one of measured pulls where there are any."""
        from slipmargin.report.sweep import answer, chance_line, measured_line, proof

        lines = answer(
            self.sweep, self.limiting, self.isotropic, self.weight_N, self.recommended_N, self.margin
        )
        lines.append(proof(self.method, self.check))
        if self.slip_chance is not None:
            lines.append(chance_line(self.slip_chance, self.recommended_N, "N"))
        if self.pulls is not None:
            lines.append(
                measured_line(self.measured()["residual_N"], int(self.pulls.count.sum()), self.outside)
            )
        return lines

    def table_lines(self) -> list[str]:
        """A row an orientation."""
        from slipmargin.report.sweep import table

        return table(self.sweep, self.limiting, self.measured())

    def plot(self) -> Figure:
        """Fig. 8's axes beside the polar plot."""
        from slipmargin.limits.sweep import all_round
        from slipmargin.plots.sweep import sweep_figure

        return sweep_figure(self.sweep, all_round(self.sweep.model), self.pulls, self.recommended_N)

    def panels(self) -> dict[str, Figure]:
        """Each panel of :meth:`plot` as a figure of its own, by name: what a page shows."""
        from slipmargin.limits.sweep import all_round
        from slipmargin.plots.sweep import sweep_panels

        return sweep_panels(self.sweep, all_round(self.sweep.model), self.pulls, self.recommended_N)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.limits_pages import sweep_page

        return sweep_page(
            self.sweep,
            self.limiting,
            self.isotropic,
            self.recommended_N,
            self.margin,
            self.measured(),
            images(self.panels()),
            self.lines(),
            self.warnings,
        )

    def table_text(self) -> str:
        """Columns ``phi_rad,f_max_N,f_low_N,f_high_N,limiting`` and the measured ones."""
        from slipmargin.io.table import columns_text

        limiting = ["+".join(names) for names in self.limiting]
        return columns_text({**self._curves(), "limiting": limiting, **self.measured()})

    def _curves(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("phi_rad", "f_max_N", "f_low_N", "f_high_N")}

    def to_dict(self) -> dict[str, Any]:
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
            **({} if self.slip_chance is None else {"slip_chance": self.slip_chance.table("force_N")}),
            **self._curves(),
            "limiting": self.limiting,
            **self.measured(),
        }


def sweep(
    robot: RobotLike,
    surface: str,
    *,
    from_deg: float = 0.0,
    to_deg: float = 90.0,
    step_deg: float = 1.0,
    margin: float = 0.1,
    method: str = "facets",
    measured: Path | str | None = None,
    chance: float | None = None,
    seed: int = 0,
) -> SweepResult:
    """The pull before a wheel slips, F_emax, over the orientation φ of a standing robot.

    The pull points along the floor's +x through the centre of mass, at floor height (Williams, Carter,
    Gallina and Rosati 2002, eqs 12 to 18 and Fig. 8).

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    from_deg, to_deg, step_deg : float
        Orientations [deg]; both ends are included where the step meets them.
    margin : float
        Safety margin: the share of the grip kept in reserve, 0 to below 1.
    method : str
        ``facets`` (closed form), ``clarabel`` or ``cvxpy`` (solvers).
    measured : str or Path, optional
        A CSV of measured pulls (``phi_rad,force_N``, one row a pull).
    chance : float, optional
        Chance of slip for which a pull is wanted, 0.001 to 0.5; 0.01 where it is not given.  It needs a
        number with a spread (``"0.26 ± 0.02"`` in the robot file).
    seed : int
        Seed of the drawn numbers, from 0.

    Returns
    -------
    SweepResult
        ``phi_rad`` [rad], ``f_max_N`` (all wheels on rollers), ``f_low_N`` and ``f_high_N`` (over all
        roller/rigid states) [N], each of shape (M,).

    Raises
    ------
    InputError
        For a fault in the robot file, an argument or the file of pulls.
    NoSolution
        If the robot slips without any pull.

    Examples
    --------
    >>> import slipmargin as sm
    >>> found = sm.sweep("ohio-kiwi", "paper", step_deg=15.0)
    >>> (found.f_max_N / found.weight_N).round(4)
    array([0.1671, 0.1729, 0.1929, 0.1936, 0.1936, 0.2057, 0.213 ])
    >>> found
    <sweep of ohio-kiwi on paper: weakest 4.92 N at φ = 0°, recommended 4.42 N>
    """
    from slipmargin.data.settings import SETTINGS
    from slipmargin.limits import isotropic, sweep as limit_sweep
    from slipmargin.limits.self_check import difference, self_check
    from slipmargin.limits.uncertainty import lowest_pulls
    from slipmargin.physics.grips import polyhedral

    recipe = read_robot(robot)
    model, warnings = model_of(recipe, surface, spread=EVERY_SPREAD, band=True)
    drawing, unseeded = Drawing.of(recipe, surface, chance, seed)
    if method not in METHODS:
        raise InputError("method", f"is {method!r}", f"use one of: {', '.join(METHODS)}")
    phi = orientations(from_deg, to_deg, step_deg)
    checked_margin(margin)
    pulls, outside = None, 0
    if measured is not None:
        pulls, outside, unread = _pulls_between(phi, Path(measured), model.count)
        warnings = (*warnings, *unread)
        on = [float(p) for p in pulls.phi_rad if np.min(np.abs(phi - p)) > SETTINGS.same_rad]
        phi = np.sort(np.append(phi, on))
    by_facets = limit_sweep(model, phi)
    if not polyhedral(model.grip.shape, model.grip.coupling):
        method = "cones" if method == "facets" else method
    found = by_facets
    if method not in ("facets", "cones"):
        force_N = np.maximum(_solved(model, phi, method), 0.0)  # a solver's zero may lie below zero
        found = replace(by_facets, f_max_N=force_N + 0.0)  # and −0 would print its sign
    extremes = np.array([found.weakest, found.strongest])
    check = (
        self_check(model, extremes[:, 0], extremes[:, 1])
        if method in ("facets", "cones")
        else difference(model, found.f_max_N, by_facets.f_max_N)
    )
    warnings = (*warnings, *held_wheels(model), *unseeded, *_beyond(model, phi, found.weakest[1]))
    recommended, likely = found.recommended_N(margin), None
    if drawing is not None:
        likely, more = drawing.counted(model, lambda drawn: lowest_pulls(model, phi, drawn), recommended)
        warnings = (*warnings, *more)
    return SweepResult(
        sweep=found,
        limiting=by_facets.limiting(),
        isotropic=isotropic(model),
        recommended_N=recommended,
        margin=margin,
        method=method,
        check=check,
        pulls=pulls,
        outside=outside,
        warnings=warnings,
        slip_chance=likely,
    )


def _beyond(model: Model, phi: Array, least_N: float) -> tuple[str, ...]:
    """What to say where an orientation that was not asked for holds less than all that were."""
    from slipmargin.limits import Pull
    from slipmargin.limits.sweep import limit_or_zero
    from slipmargin.report.text import degrees

    every = np.deg2rad(np.arange(0.0, 360.0, 2.0))
    force = limit_or_zero(model, every, Pull())
    at = int(np.argmin(force))
    if not force[at] < least_N * (1.0 - _WEAKER):
        return ()
    return (
        f"of all orientations the weakest was not swept: {force[at]:.2f} N at φ = {degrees(every[at])}; "
        "the recommended pull holds for those swept (--from 0 --to 360 sweeps all)",
    )


def orientations(from_deg: float, to_deg: float, step_deg: float) -> Array:
    """Orientations from, to and by a step [deg] as an array (M,) [rad].

    Raises
    ------
    InputError
        Placed at the argument.
    """
    for name, value in (("from_deg", from_deg), ("to_deg", to_deg), ("step_deg", step_deg)):
        if not math.isfinite(value) or abs(value) > 1e6:
            raise InputError(name, f"is {value}", "give an angle in degrees")
    if step_deg <= 0.0:
        raise InputError("step_deg", f"is {step_deg:g}", "give a positive step in degrees")
    if to_deg < from_deg:
        raise InputError("to_deg", f"is {to_deg:g}, below the first orientation {from_deg:g}", "swap them")
    count = math.floor((to_deg - from_deg) / step_deg + 1e-9) + 1
    if count > _MOST:
        raise InputError(
            "step_deg", f"is {step_deg:g}: {count} orientations", f"give a step that makes at most {_MOST}"
        )
    return np.asarray(np.deg2rad(from_deg + step_deg * np.arange(count)))


def _pulls_between(phi: Array, file: Path, wheels: int) -> tuple[PullGroups, int, tuple[str, ...]]:
    """The pulls between the first and last orientation (turned by whole turns into it), how many are not.

    A sentence says what of the file is not read.
    """
    from slipmargin.data.pulls import gather_pulls
    from slipmargin.data.settings import SETTINGS
    from slipmargin.io.trial_file import read_pulls

    read = read_pulls(file, wheels)
    read.refuse_settings(str(file))
    turned = phi[0] - SETTINGS.same_rad + np.mod(read.phi_rad - phi[0] + SETTINGS.same_rad, 2.0 * np.pi)
    inside = turned <= phi[-1] + SETTINGS.same_rad
    if not np.any(inside):
        raise InputError("measured", f"no pull of {file} lies in the range swept", "widen the range")
    unread: tuple[str, ...] = ()
    if read.theta_rad is not None:
        unread = ("wheel angles of the pulls are not read: they are compared with all wheels on rollers",)
    return gather_pulls(turned[inside], read.force_N[inside]), int(np.count_nonzero(~inside)), unread


def _solved(model: Model, phi: Array, method: str) -> Array:
    """F_emax by a solver: Clarabel directly, or cvxpy (all orientations as one block where it can)."""
    from slipmargin.limits import Pull, wrench_set
    from slipmargin.limits.bias import bias_wrench, shifts_load
    from slipmargin.limits.cones import cone_limit, limit_family

    if method == "clarabel":
        answer: Array = cone_limit(model, phi, Pull(), np.zeros(model.count, dtype=bool))
        return answer
    from slipmargin.solve import cvxpy_

    wrenches = wrench_set(model)
    if wrenches.polyhedral and not model.grip.multipliers and not shifts_load(model):
        limits = (wrenches.coefficients[..., 1] * wrenches.load_N[:, None]).ravel()
        maps, rays = wrenches.maps.reshape(3, -1), Pull().rays(model, phi)
        return cvxpy_.block_box(maps, limits, rays, bias_wrench(model, phi))
    family = limit_family(model, phi)
    shares = [cvxpy_.solve(family.program(m)).x[0] for m in range(len(phi))]
    return np.array(shares) * model.inertia.weight_N
