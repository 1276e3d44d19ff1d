"""The paper's robot and its simulated runs (sections III.B and IV.C).

Straight line, 0.4 m along X in 3.5 s, heading commanded 0, wheel speeds stepped on and off; every printed
constant comes from :mod:`slipmargin.paper.numbers` (docs/theory.md, section 6).  The initial model
knows rollers only, the improved one the rigid material between them.

The paper prints neither mass, inertia and centre-to-wheel radius nor the rotor angles.  The motion
depends on them through β = m r²/I, r and the angles alone; :data:`FOUND` holds values found by a
search (:mod:`slipmargin.paper.search` runs it again), not read in the paper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen, real
from slipmargin.model import Model, nominal_model
from slipmargin.paper.numbers import published
from slipmargin.robot import Body, Coefficients, FrictionLaw, Robot, Surface, Wheel
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack, stack
from slipmargin.sim.run import Run
from slipmargin.sim.signal import WheelSignal, held
from slipmargin.sim.simulate import simulate

DISTANCE_M, DURATION_S, STILL_S = published("goal_x"), published("duration"), 4.5
DELTA_RAD = math.radians(published("delta"))
#: Not printed; the printed wheel speeds imply it (docs/theory.md, section 1).
WHEEL_M = 0.0254
ROLLERS, RIGID = int(published("rollers")), published("rigid_share")
PITCH_RAD = 2.0 * math.pi / ROLLERS
#: Table I.
SURFACES = tuple(
    Surface(
        name=name,
        roller=Coefficients(
            drive=published(f"{name}_roller_drive"), transverse=published(f"{name}_roller_transverse")
        ),
        rigid=Coefficients(
            drive=published(f"{name}_rigid_drive"), transverse=published(f"{name}_rigid_transverse")
        ),
    )
    for name in ("paper", "carpet")
)
#: Directions of travel as unit velocities of the body [1, 1, 1/m].
ALONG_X, ALONG_Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unprinted:
    """What the paper does not print: centre-to-wheel radius [m], β = m r²/I [1], rotor angles (3,) [rad].

    Angles are measured from the start of a roller sector, wheels in the order of Fig. 3.
    """

    radius_m: float
    beta: float
    angles_rad: Array

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "radius_m", real("radius_m", self.radius_m, above=0.0, cure="give a positive radius [m]"))
        put(self, "beta", real("beta", self.beta, above=0.0, cure="give a positive m r²/I"))
        put(self, "angles_rad", frozen("angles_rad", self.angles_rad, (3,)))


#: Found by a search over the printed results, not published.
FOUND = Unprinted(radius_m=0.095, beta=1.0, angles_rad=np.array([0.131, 0.255, 0.260]))


def paper_robot(*, improved: bool, unprinted: Unprinted = FOUND, delta_rad: float = DELTA_RAD) -> Robot:
    """The paper's robot; mass 3 kg (any: the motion does not depend on it)."""
    axles = (delta_rad, math.pi - delta_rad, -math.pi / 2.0)
    r, mass = unprinted.radius_m, 3.0
    wheels = tuple(
        Wheel(
            name=str(i + 1),
            position_m=r * np.array([math.cos(a), math.sin(a)]),
            drive_direction_deg=math.degrees(a) + 90.0,
            radius_m=WHEEL_M,
            rollers=ROLLERS,
            rigid_fraction=RIGID if improved else 0.0,
        )
        for i, a in enumerate(axles)
    )
    return Robot(
        name="ohio-kiwi",
        wheels=wheels,
        surfaces=SURFACES,
        body=Body(mass_kg=mass, inertia_kg_m2=mass * r**2 / unprinted.beta),
        friction=FrictionLaw(k_s_per_m=published("regularisation_slope")),
    )


def paper_model(surface: str, *, improved: bool, unprinted: Unprinted = FOUND) -> Model:
    """The paper's robot as arrays, on ``paper`` or ``carpet``."""
    return nominal_model(paper_robot(improved=improved, unprinted=unprinted), surface)


@cache
def _speeds(direction: tuple[float, float, float]) -> Array:
    """Wheel speeds (3,) that move the robot at 1 m/s along ``direction`` without slip [rad/s]."""
    return paper_model("paper", improved=False).geometry.wheel_speeds(np.array(direction))


def wheel_rates(direction: tuple[float, float, float] = ALONG_X, *, duration_s: float = DURATION_S) -> Array:
    """The no-slip wheel speeds (3,) of the straight line [rad/s]; printed as +1.16, +1.16, −4.50."""
    return _speeds(direction) * (DISTANCE_M / duration_s)


def command(
    angles_rad: Array,
    direction: tuple[float, float, float] = ALONG_X,
    *,
    duration_s: float = DURATION_S,
) -> WheelSignal:
    """Wheel speeds stepped on at 0 and off at 3.5 s (``duration_s``), from these rotor angles."""
    rates = np.stack([wheel_rates(direction, duration_s=duration_s), np.zeros(3)])
    end = duration_s + STILL_S - DURATION_S
    return held(np.array([0.0, duration_s]), rates, end_s=end, theta0=angles_rad)


def straight_line(
    surface: str,
    *,
    improved: bool,
    unprinted: Unprinted = FOUND,
    samples: int = 901,
    direction: tuple[float, float, float] = ALONG_X,
) -> Run:
    """The paper's run, from the step on until the robot stands still again."""
    model = paper_model(surface, improved=improved, unprinted=unprinted)
    signal = command(unprinted.angles_rad, direction)
    return simulate(model, signal, np.linspace(0.0, STILL_S, samples))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spread:
    """Where the improved model ends from random rotor angles: end pose (R, 3) after stopping."""

    surface: str
    angles_rad: Array
    end: Array

    @property
    def mean(self) -> Array:
        """(3,): x short of the goal [m], y [m], φ [rad]."""
        goal, sign = np.array([DISTANCE_M, 0.0, 0.0]), np.array([-1.0, 1.0, 1.0])
        return np.asarray(goal + sign * self.end.mean(axis=0))

    @property
    def deviation(self) -> Array:
        """(3,) one standard deviation [m, m, rad]."""
        return np.asarray(self.end.std(axis=0, ddof=1))


def spread(
    surface: str,
    *,
    runs: int = 1000,
    seed: int = 0,
    unprinted: Unprinted = FOUND,
    direction: tuple[float, float, float] = ALONG_X,
    rtol: float = 1e-4,
) -> Spread:
    """The improved model from ``runs`` rotor angles drawn evenly: why repeatability is so low."""
    angles = np.random.default_rng(seed).uniform(0.0, PITCH_RAD, (runs, 3))
    model = paper_model(surface, improved=True, unprinted=unprinted)
    end = ends([model], angles, direction=direction, rtol=rtol)
    return Spread(surface=surface, angles_rad=angles, end=end)


def ends(
    models: Sequence[Model],
    angles_rad: Array,
    *,
    which: NDArray[np.int64] | None = None,
    direction: tuple[float, float, float] = ALONG_X,
    rtol: float = 1e-4,
) -> Array:
    """(R, 3) end poses after stopping; run r: ``angles_rad[r]`` on model ``which[r]`` (the first if None)."""
    batch = Batch([command(a, direction) for a in angles_rad], [np.array([0.0, STILL_S])] * len(angles_rad))
    packed = stack([pack(m) for m in models])
    return np.asarray(batch.run(packed, np.zeros(3), which=which, rtol=rtol).pose[:, -1])
