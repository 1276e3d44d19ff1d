"""A candidate: something that may be missing, as a vector of parameters the fit can turn.

A named candidate is an effect of the catalogue; a general one has free coefficients over the
variable it traces.  Both build effects, and the null vector builds one that does nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.effects import AnyEffect, Effect, Trace
from slipmargin.effects.catalogue import CATALOGUE


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """One suspect.

    Parameters
    ----------
    name : str
        Effect name, ``unnamed_<variable>`` for a general form.
    label : str
        Name plus what distinguishes it from others of the name (a wheel, a form).
    trace : Trace
        The variable it stands for.
    named : bool
        Whether it is an effect of the catalogue.
    keys, units : tuple of str
        Parameter names and units (P).
    null, scale, low, high : array (P,)
        Value that does nothing, unit of length of the fit, bounds.
    starts : array (S, P)
        Where fits start.
    build : callable
        Parameter vector → effect.
    nested : bool
        Whether ``null`` does nothing.  A law that takes another's place has no such value: its ``null``
        is where its first fit starts.
    prior : array (Q, P), optional
        Rows L of what is believed beforehand: |L (x − null) / scale|² is about 1 or less.  It holds
        still what no trial shows.
    """

    name: str
    label: str
    trace: Trace
    named: bool
    keys: tuple[str, ...]
    units: tuple[str, ...]
    null: Array
    scale: Array
    low: Array
    high: Array
    starts: Array
    build: Callable[[Array], AnyEffect]
    nested: bool = True
    prior: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        count = len(self.keys)
        prior = self.prior if self.prior.size else np.zeros((0, count))
        object.__setattr__(self, "prior", frozen("prior", prior, (None, count)))
        for key in ("null", "scale", "low", "high"):
            object.__setattr__(self, key, frozen(key, getattr(self, key), (count,)))
        object.__setattr__(self, "starts", frozen("starts", self.starts, (None, count)))

    @property
    def size(self) -> int:
        """Number of parameters P."""
        return len(self.keys)


#: Parameters that mean nothing while their effect's first one is at null.  They stand where a fit
#: would start, so that a step of the first one shows what the effect can do.
_IDLE = ("rigid_coefficient", "stribeck_speed_m_s", "steepness")


def named_candidate(
    effect: type[Effect],
    free: tuple[str, ...] | None = None,
    wheels: tuple[str, ...] = (),
    fixed: Mapping[str, float] | None = None,
    label: str = "",
) -> Candidate:
    """The candidate that turns an effect's parameters (all, or those in ``free``), others ``fixed``."""
    rows = [p for p in effect.parameters if free is None or p.name in free]
    still = {p.name: p.null for p in effect.parameters} | dict(fixed or {})

    def build(values: Array) -> AnyEffect:
        chosen = still | {p.name: float(v) for p, v in zip(rows, values, strict=True)}
        return effect.of(np.array([chosen[p.name] for p in effect.parameters]), wheels)

    sets = [p.starts or (p.null + p.scale,) for p in rows]
    count = max(len(s) for s in sets)
    starts = np.array([[s[min(i, len(s) - 1)] for s in sets] for i in range(count)])
    return Candidate(
        name=effect.name,
        label=effect.name + (f"[{','.join(wheels)}]" if wheels else "") + label,
        trace=effect.traced_to,
        named=True,
        keys=tuple(p.name for p in rows),
        units=tuple(p.unit for p in rows),
        null=np.array([p.starts[0] if p.name in _IDLE and p.starts else p.null for p in rows]),
        scale=np.array([p.scale for p in rows]),
        low=np.array([p.low for p in rows]),
        high=np.array([p.high for p in rows]),
        starts=starts,
        build=build,
        nested=rows[0] is effect.parameters[0],  # the first is the effect's size
    )


#: Effects that belong to one wheel: a candidate for each.
_ONE_WHEEL = ("wheel_radius", "wheel_toe")

#: Effects that act only where wheel speeds are commanded.
_COMMANDED = ("motor_lag", "speed_droop")

#: Effects with a simple and a fuller form: label, free parameters, fixed ones.
_VARIANTS: dict[str, tuple[tuple[str, tuple[str, ...], dict[str, float]], ...]] = {
    "friction_coefficients": (
        ("", ("drive_factor", "transverse_factor"), {}),
        (" with their steepness", ("drive_factor", "transverse_factor", "steepness_factor"), {}),
    ),
    "rigid_sector": (
        ("", ("rigid_fraction",), {}),
        (" with its coefficient", ("rigid_fraction", "rigid_coefficient"), {}),
    ),
    "wheel_loads": (
        ("", ("shift_x_m", "shift_y_m"), {"com_share": 1.0}),
        (" with the centre of mass where stated", ("shift_x_m", "shift_y_m"), {}),
    ),
    "load_transfer": (
        ("", ("com_height_m",), {"com_share": 1.0}),
        (" with the centre of mass where stated", ("com_height_m",), {}),
    ),
    "slip_ratio_friction": (
        ("", ("steepness",), {"share": 1.0}),
        (
            " with its own constants across",
            ("steepness", "transverse_factor", "transverse_coefficient_factor"),
            {"share": 1.0},
        ),
        (" from a crawl on", ("steepness", "crawl_m_s"), {"share": 1.0}),
    ),
    "stribeck": (
        ("", ("dynamic_ratio", "stribeck_speed_m_s"), {}),
        (" in both directions", ("dynamic_ratio", "stribeck_speed_m_s", "transverse_ratio"), {}),
    ),
}


def named_candidates(wheels: tuple[str, ...], commanded: bool, known: tuple[str, ...]) -> list[Candidate]:
    """Every catalogue effect that these data could show.

    Parameters
    ----------
    wheels : tuple of str
        Names of the wheels.
    commanded : bool
        Whether only commanded wheel speeds are known.
    known : tuple of str
        Effects already in the robot file; they are not proposed again.
    """
    found: list[Candidate] = []
    for effect in CATALOGUE:
        if effect.name in known or (effect.name in _COMMANDED and not commanded):
            continue
        if effect.name in _ONE_WHEEL:
            found += [named_candidate(effect, wheels=(wheel,)) for wheel in wheels]
        elif effect.name in _VARIANTS:
            found += [
                named_candidate(effect, free, fixed=fixed, label=label)
                for label, free, fixed in _VARIANTS[effect.name]
            ]
        else:
            found.append(named_candidate(effect))
    return found
