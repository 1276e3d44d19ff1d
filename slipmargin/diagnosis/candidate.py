"""A candidate: something that may be missing from the model, as a vector of parameters that a fit varies.

A named candidate is an effect of the catalogue; a general one has free coefficients over the
variable it traces.  Both build effects, and the null vector builds one that does nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from types import MappingProxyType
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen, shaped
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect, Effect, Scope, Trace, Variant, WheelEffect
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.places import LINE, PATCH
from slipmargin.physics.relief import beyond


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """Something that may be missing.

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
    near : array (Q, P), optional
        Where they start at a line or a place of the floor that the data point to, with 0 for what says where
        that is.
    build : callable
        Parameter vector → effect.
    nested : bool
        Whether ``null`` does nothing.  A law that takes another's place has no such value: its ``null``
        is where its first fit starts.
    wheels : tuple of str
        The wheels it acts on where it acts on some only.
    wheel_phase : bool
        Whether it depends on where a wheel stands, so that wheel angles need a known zero.
    prior : array (Q, P), optional
        Rows L of a Gaussian prior: |L (x − null) / scale|² is about 1 or less.  It determines the
        parameters that the trials do not.
    usual : array (P,), optional
        Ordinary values, ``null`` by default: a fit that ends at one is not stuck at a bound that is the same.
        They differ where an idle parameter's first start, which its tangent needs, stands in for its null.
    least : array (P,), optional
        What is nearer to its ordinary value than this makes as little sense as what is beyond a bound.
    meant : array (P,), optional
        The side of null that the name means: −1, 1, or 0 for both.
    idle : array (P,) of bool, optional
        Which parameters have no influence at null: tangents are taken at each of their starts.
    scope : Scope, optional
        What it belongs to, which data sets of a campaign may share; None: what its variable says.
    turns_all_ways : bool
        Whether it turns tracks to one side whichever way the robot drives.
    subject : str, optional
        What it is one form of, as others may be: an effect on its wheels, in its group; empty: it has no
        other forms.
    other_half : str
        The name of the effect that says the other half of one thing, if any.
    definitions : tuple of Candidate
        The same parameters with another definition of what they act over: compared with it once all else is
        found, and no candidates of their own.
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
    wheels: tuple[str, ...] = ()
    wheel_phase: bool = False
    prior: Array = field(default_factory=lambda: np.zeros((0, 0)))
    usual: Array | None = None
    least: Array | None = None
    meant: Array | None = None
    idle: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    scope: Scope | None = None
    turns_all_ways: bool = False
    subject: str = ""
    other_half: str = ""
    definitions: tuple[Candidate, ...] = ()
    near: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        count = len(self.keys)
        usual = self.null if self.usual is None else self.usual
        object.__setattr__(self, "usual", frozen("usual", usual, (count,)))
        for key in ("least", "meant"):
            value = getattr(self, key)
            object.__setattr__(self, key, frozen(key, np.zeros(count) if value is None else value, (count,)))
        prior = self.prior if self.prior.size else np.zeros((0, count))
        object.__setattr__(self, "prior", frozen("prior", prior, (None, count)))
        near = self.near if self.near.size else np.zeros((0, count))
        object.__setattr__(self, "near", frozen("near", near, (None, count)))
        for key in ("null", "scale", "low", "high"):
            object.__setattr__(self, key, frozen(key, getattr(self, key), (count,)))
        idle = np.array(self.idle if len(self.idle) else np.zeros(count), dtype=bool)
        shaped("idle", idle, (count,))
        idle.setflags(write=False)
        object.__setattr__(self, "idle", idle)
        object.__setattr__(self, "starts", frozen("starts", self.starts, (None, count)))

    @property
    def size(self) -> int:
        """Number of parameters P."""
        return len(self.keys)

    def is_near(self, where: Sequence[str]) -> bool:
        """Whether it starts at what parameters of the names ``where`` say, if data point to that."""
        return len(self.near) > 0 and set(where) <= set(self.keys)

    def at(self, where: Sequence[str], values: Sequence[float], near: Array) -> Array:
        """The parameters ``near`` (Q, P) with these ``values`` of those that say ``where``."""
        rows = near.copy()
        rows[:, [self.keys.index(key) for key in where]] = values
        return rows

    def where(self, where: Sequence[str], x: Array) -> tuple[float, ...]:
        """What parameters ``x`` (P,) say ``where`` it is."""
        return tuple(float(x[self.keys.index(key)]) for key in where)

    @property
    def thing(self) -> str:
        """What it is, in whichever form or by whichever definition."""
        return self.subject or self.label

    def is_same_as(self, other: Candidate) -> bool:
        """Whether both are one thing."""
        return self.thing == other.thing

    def is_other_form_of(self, other: Candidate) -> bool:
        """Whether both are forms of one thing, and not the same."""
        return bool(self.subject) and self.subject == other.subject and self.label != other.label


def named_candidate(
    effect: type[Effect],
    variant: Variant | None = None,
    wheels: tuple[str, ...] = (),
    reach: Mapping[str, float] = MappingProxyType({}),
) -> Candidate:
    """The candidate for one variant of an effect: all parameters free where none is given.

    Parameters that have no influence at null stand at their first start value there, so that a step of
    the effect's first parameter shows what the effect can do.  ``reach`` says how far the runs cover
    "position" [m] and "time" [s], and how far from the middle of the "body" its wheels are [m]: starts of
    parameters along these are shares of it.  Places of the floor are counted from "x" and "y" [m].
    """
    variant = variant or Variant(free=tuple(p.name for p in effect.parameters))
    rows = [p for p in effect.parameters if p.name in variant.free]
    held = {p.name: p.null for p in effect.parameters} | dict(variant.fixed)

    def build(values: Array) -> AnyEffect:
        chosen = held | {p.name: float(v) for p, v in zip(rows, values, strict=True)}
        vector = np.array([chosen[p.name] for p in effect.parameters])
        return effect.of(vector, wheels) if issubclass(effect, WheelEffect) else effect.of(vector)

    middle = np.array([reach.get(axis, 0.0) for axis in "xy"])
    begins = np.array([reach.get(p.coordinate, 0.0) for p in rows])
    sets = [tuple(s * reach.get(p.along, 1.0) for s in p.starts) or (p.null + p.scale,) for p in rows]
    count = max(len(s) for s in sets)
    starts = begins + np.array([[s[min(i, len(s) - 1)] for s in sets] for i in range(count)])
    within = np.array([p.within for p in rows])
    if any(p.coordinate == "offset" for p in rows):  # lines lie about the middle as well
        at, normal = ([p.name for p in rows].index(key) for key in LINE)
        starts[:, at] += beyond(0.0, starts[:, normal], *middle)
        within[at] += np.hypot(*middle)
    low = np.maximum([p.low for p in rows], begins - within)
    high = np.minimum([p.high for p in rows], begins + within)
    starts = np.clip(starts, low, high)
    near = [
        p.near or ((0.0,) if p.name in (*LINE, *PATCH) else s[:1]) for p, s in zip(rows, sets, strict=True)
    ]
    subject = effect.name + (f"[{','.join(wheels)}]" if wheels else "")
    return Candidate(
        name=effect.name,
        label=subject + (f" {variant.label}" if variant.label else ""),
        trace=effect.traced_to,
        named=True,
        keys=tuple(p.name for p in rows),
        units=tuple(p.unit for p in rows),
        null=np.array([s if p.idle and p.starts else p.null for p, s in zip(rows, starts[0], strict=True)]),
        scale=np.array([p.scale for p in rows]),
        usual=np.array([p.null if p.usual is None else p.usual for p in rows]),
        meant=np.array([float(p.meant) for p in rows]),
        idle=np.array([p.idle for p in rows]),
        low=low,
        high=high,
        starts=starts,
        near=np.array(list(product(*near)) if any(p.near for p in rows) else []),
        build=build,
        nested=rows[0] is effect.parameters[0],
        wheels=wheels,
        wheel_phase=effect.needs_wheel_phase,
        scope=effect.scope,
        turns_all_ways=effect.turns_all_ways,
        subject=subject,
        other_half=effect.other_half,
        definitions=tuple(
            named_candidate(effect, replace(variant, fixed=fixed, label=label), wheels, reach)
            for fixed, label in _definitions(effect, variant)
        ),
    )


def _definitions(effect: type[Effect], variant: Variant) -> list[tuple[dict[str, float], str]]:
    """What is fixed in a variant under each other definition, and the variant's label then."""
    return [
        ({**variant.fixed, name: value}, ", ".join(filter(None, (variant.label, f"{name} {value:g}"))))
        for name, values in effect.definitions.items()
        if name not in variant.free and name not in variant.fixed
        for value in values
    ]


def named_candidates(
    wheels: tuple[str, ...],
    commanded: bool,
    known: tuple[str, ...],
    reach: Mapping[str, float] = MappingProxyType({}),
    *,
    timed: bool = True,
    angles: bool = True,
    coupled: bool = False,
) -> list[Candidate]:
    """Every effect of the catalogue that these data could show.

    Parameters
    ----------
    wheels : tuple of str
        Names of the wheels.
    commanded : bool
        Whether only commanded wheel speeds are known.
    known : tuple of str
        Effects already in the robot file; they are not proposed again.
    reach : mapping
        How far the runs cover "position" [m] and "time" [s], from the middle "x" and "y" [m] of where they
        were, and how far the "body" reaches [m], for starts that are spread over them.
    timed : bool
        Whether the rows have time stamps, which limit how wrong the clock may be, not only a nominal rate.
    angles : bool
        Whether the logs hold wheel angles.
    coupled : bool
        Whether the grip has one law for all directions.
    """
    found: list[Candidate] = []
    for effect in CATALOGUE:
        if effect.name in known or (effect.needs_commands and not commanded):
            continue
        if effect.needs_wheel_angles and not angles:
            continue
        stamped = effect.is_the_clock and timed
        for variant in effect.variants or (None,):
            if variant is not None:
                able = {
                    p.name
                    for p in effect.parameters
                    if p.least_wheels <= len(wheels) and not (coupled and p.needs_own_law_across)
                }
                variant = replace(variant, free=tuple(name for name in variant.free if name in able))
            made = [named_candidate(effect, variant, on, reach) for on in _tried_on(effect, wheels)]
            found += [_stamped(c) for c in made] if stamped else made
    return found


def _tried_on(effect: type[Effect], wheels: tuple[str, ...]) -> list[tuple[str, ...]]:
    """The wheels that an effect is tried on; none named are all of them."""
    if not issubclass(effect, WheelEffect):
        return [()]
    return [()] * effect.all_wheels + [(wheel,) for wheel in wheels if effect.one_wheel]


def _stamped(clock: Candidate) -> Candidate:
    """The candidate for a clock that stamps every row: as far off as such clocks are when they are off."""
    most = SETTINGS.stamped_clock
    low, high = (np.clip(b, clock.null - most, clock.null + most) for b in (clock.low, clock.high))
    least = np.full(clock.size, SETTINGS.stamped_clock_least)
    return replace(clock, low=low, high=high, starts=np.clip(clock.starts, low, high), least=least)


def equation_of(candidate: Candidate, effect: object) -> str:
    """What an effect of a candidate says, in a sentence: a named one's own, or what is free."""
    if isinstance(effect, Effect):
        return " ".join((type(effect).__doc__ or "").split())
    return f"free coefficients over {candidate.trace.value} ({candidate.label.split(': ')[-1]})"
