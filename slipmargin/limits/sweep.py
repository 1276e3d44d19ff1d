"""How hard the robot can be pulled before a wheel slips, heading by heading (eqs 12–18, Fig. 8)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import NoSolution
from slipmargin.limits.band import band
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import facet_limit, pull_geometry
from slipmargin.limits.sensitivity import Sensitivity, sensitivity
from slipmargin.model import Model
from slipmargin.physics.grips import polyhedral


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Isotropic:
    """What a single coefficient would have claimed: μ m g in every direction."""

    force_N: float
    coefficient: float
    rule: str


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sweep:
    """F_emax over headings: all wheels on rollers, and the band over what the wheels may stand on.

    Parameters
    ----------
    model, pull
        What was asked; the wheels named below are the model's.
    phi_rad, f_max_N, f_low_N, f_high_N : (M,)
        Heading [rad]; limit on rollers, lowest and highest over contact states and unknown variables [N].
        ``f_low_N`` is 0 where in the worst state the robot slips without any pull.
    """

    model: Model
    pull: Pull
    phi_rad: Array
    f_max_N: Array
    f_low_N: Array
    f_high_N: Array

    def __post_init__(self) -> None:
        for name in ("phi_rad", "f_max_N", "f_low_N", "f_high_N"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (None,)))

    @property
    def weakest(self) -> tuple[float, float]:
        """(heading [rad], force [N]) where the least pull breaks the robot away, on rollers."""
        at = int(np.argmin(self.f_max_N))
        return float(self.phi_rad[at]), float(self.f_max_N[at])

    @property
    def strongest(self) -> tuple[float, float]:
        """(heading [rad], force [N]) where it takes the greatest pull, on rollers."""
        at = int(np.argmax(self.f_max_N))
        return float(self.phi_rad[at]), float(self.f_max_N[at])

    def recommended_N(self, margin: float = 0.1) -> float:
        """(1 − margin) times the lowest force of the band: safe in every heading and state swept [N]."""
        return float((1.0 - margin) * np.min(self.f_low_N))

    def sensitivity(self) -> Sensitivity:
        """What limits each heading, and dF/dμ per wheel (all on rollers)."""
        return sensitivity(self.model, self.phi_rad, self.pull)

    def limiting(self) -> tuple[tuple[str, ...], ...]:
        """For each heading the names of the wheels that saturate (and any that lift off)."""
        return self.sensitivity().wheels()


def sweep(model: Model, phi_rad: Array, pull: Pull | None = None, *, with_band: bool = True) -> Sweep:
    """F_emax(φ) by facets for the box grip, by cone programs for the coupled grips.

    Parameters
    ----------
    phi_rad : (M,)
        Headings [rad].
    pull : Pull, optional
        The paper's pull by default: along the floor's +x, through the centre of mass, at floor height.
    with_band : bool
        Without it ``f_low_N`` and ``f_high_N`` repeat ``f_max_N``.

    Raises
    ------
    NoSolution
        If the robot slips without any pull.
    """
    phi = np.atleast_1d(np.asarray(phi_rad, dtype=float))
    pull = Pull() if pull is None else pull
    nominal = limit(model, phi, pull)
    low, high = band(model, phi, pull) if with_band else (nominal, nominal)
    return Sweep(model=model, pull=pull, phi_rad=phi, f_max_N=nominal, f_low_N=low, f_high_N=high)


def all_round(model: Model) -> Sweep:
    """The paper's pull at every half degree, 0 where the robot slips without any: what pictures draw."""
    phi, pull = np.linspace(0.0, 2.0 * np.pi, 721), Pull()
    low, high = band(model, phi, pull)
    nominal = limit_or_zero(model, phi, pull)
    return Sweep(model=model, pull=pull, phi_rad=phi, f_max_N=nominal, f_low_N=low, f_high_N=high)


def limit(model: Model, phi_rad: Array, pull: Pull, rigid: Array | None = None) -> Array:
    """(M,) F_emax [N] of one contact state (all on rollers by default)."""
    state = np.zeros(model.count, dtype=bool) if rigid is None else np.asarray(rigid, dtype=bool)
    if polyhedral(model.grip.shape, model.grip.coupling):
        return facet_limit(pull_geometry(model, phi_rad, pull), state)
    from slipmargin.limits.cones import cone_limit  # clarabel is loaded only where a cone needs it

    return cone_limit(model, phi_rad, pull, state)


def limit_or_zero(model: Model, phi_rad: Array, pull: Pull, rigid: Array | None = None) -> Array:
    """:func:`limit`, but 0 where a slope or a cable alone makes the robot slip."""
    try:
        return limit(model, phi_rad, pull, rigid)
    except NoSolution as fault:
        if not isinstance(fault.evidence, np.ndarray):
            raise
        return np.nan_to_num(fault.evidence, nan=0.0)


def isotropic(model: Model) -> Isotropic:
    """μ m g with the mean of the wheels' drive coefficients on their rollers."""
    mean = float(np.mean(model.grip.roller[:, 0]))
    return Isotropic(
        force_N=mean * model.inertia.weight_N,
        coefficient=mean,
        rule="mean drive coefficient on rollers × m g",
    )
