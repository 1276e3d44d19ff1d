"""The paper's simulated runs (sections III.B and IV.C), published beside recomputed.

Straight line, 0.4 m along X in 3.5 s, heading commanded 0, wheel speeds stepped on and off; k = 1000,
eight rollers, 90 % roller and 10 % rigid (docs/theory.md, section 6; Table I for the coefficients).  The
initial model knows rollers only, the improved one the rigid material between them.

The paper prints neither mass, inertia and centre-to-wheel radius nor the rotor angles.  The motion
depends on them through β = m r²/I, r and the angles alone; :data:`FOUND` holds values found by a
search (:mod:`slipmargin.paper.search` runs it again), not read in the paper.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.model import Model, nominal_model
from slipmargin.robot import Body, Coefficients, Robot, Surface, Wheel
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.run import Run
from slipmargin.sim.signal import WheelSignal, held
from slipmargin.sim.simulate import simulate

DISTANCE_M, DURATION_S, STILL_S = 0.4, 3.5, 4.5
DELTA_RAD, WHEEL_M, ROLLERS, RIGID = math.radians(15.0), 0.0254, 8, 0.10
PITCH_RAD = 2.0 * math.pi / ROLLERS
#: Table I.
SURFACES = (
    Surface(
        name="paper",
        roller=Coefficients(drive=0.26, transverse=0.09),
        rigid=Coefficients(drive=0.47, transverse=0.47),
    ),
    Surface(
        name="carpet",
        roller=Coefficients(drive=0.25, transverse=0.15),
        rigid=Coefficients(drive=0.56, transverse=0.56),
    ),
)
#: Final headings the paper measured on carpet, three trials (section IV.C); on paper the text only says
#: "very small, close to the angular measurement precision" (four trials).  Data, not computed here.
MEASURED_CARPET_PHI_RAD = (0.524, 0.506, 0.489)


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


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One published number beside ours; ``difference`` = recomputed − published."""

    key: str
    what: str
    unit: str
    published: float
    recomputed: float
    note: str = ""

    @property
    def difference(self) -> float:
        """Recomputed minus published."""
        return self.recomputed - self.published


def paper_model(surface: str, *, improved: bool, unprinted: Unprinted = FOUND) -> Model:
    """The paper's robot on ``paper`` or ``carpet``; mass 3 kg (any: the motion does not depend on it)."""
    axles = (DELTA_RAD, math.pi - DELTA_RAD, -math.pi / 2.0)
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
    robot = Robot(
        name="ohio-kiwi",
        wheels=wheels,
        surfaces=SURFACES,
        body=Body(mass_kg=mass, inertia_kg_m2=mass * r**2 / unprinted.beta),
    )
    return nominal_model(robot, surface)


def wheel_rates() -> Array:
    """The no-slip wheel speeds (3,) of the straight line [rad/s]; printed as +1.16, +1.16, −4.50."""
    speed = DISTANCE_M / DURATION_S
    return np.array([math.sin(DELTA_RAD), math.sin(DELTA_RAD), -1.0]) * speed / WHEEL_M


def command(angles_rad: Array) -> WheelSignal:
    """Wheel speeds stepped on at 0 and off at 3.5 s, from these rotor angles."""
    rates = np.stack([wheel_rates(), np.zeros(3)])
    return held(np.array([0.0, DURATION_S]), rates, end_s=STILL_S, theta0=angles_rad)


def straight_line(surface: str, *, improved: bool, unprinted: Unprinted = FOUND, samples: int = 901) -> Run:
    """The paper's run, from the step on until the robot stands still again."""
    model = paper_model(surface, improved=improved, unprinted=unprinted)
    return simulate(model, command(unprinted.angles_rad), np.linspace(0.0, STILL_S, samples))


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
    surface: str, *, runs: int = 1000, seed: int = 0, unprinted: Unprinted = FOUND, rtol: float = 1e-4
) -> Spread:
    """The improved model from ``runs`` rotor angles drawn evenly: why repeatability is so low."""
    angles = np.random.default_rng(seed).uniform(0.0, PITCH_RAD, (runs, 3))
    model = pack(paper_model(surface, improved=True, unprinted=unprinted))
    batch = Batch([command(a) for a in angles], [np.array([0.0, STILL_S])] * runs)
    end = batch.run(model, np.zeros(3), rtol=rtol).pose[:, -1]
    return Spread(surface=surface, angles_rad=angles, end=end)


def section_six(unprinted: Unprinted = FOUND) -> tuple[Row, ...]:
    """Every number of the paper's simulations, published beside recomputed."""
    ends = {}
    for surface, improved in (("paper", False), ("paper", True), ("carpet", True)):
        run = straight_line(surface, improved=improved, unprinted=unprinted, samples=10)
        assert run.t_s[7] == DURATION_S
        ends[surface, improved] = run.pose[7], run.pose[-1]
    (at_stop, initial), (_, better), (_, carpet) = ends.values()
    rates = wheel_rates()
    stand = "after stopping"
    return (
        Row(
            key="omega_1",
            what="wheel speed of wheels 1 and 2",
            unit="rad/s",
            published=1.16,
            recomputed=rates[0],
        ),
        Row(key="omega_3", what="wheel speed of wheel 3", unit="rad/s", published=-4.50, recomputed=rates[2]),
        Row(
            key="initial_paper_x_short",
            what="initial model, paper: x short of 0.4 m",
            unit="m",
            published=0.014,
            recomputed=DISTANCE_M - initial[0],
            note=stand,
        ),
        Row(
            key="initial_paper_x_short_at_stop",
            what="initial model, paper: x short of 0.4 m",
            unit="m",
            published=0.014,
            recomputed=DISTANCE_M - at_stop[0],
            note="at t = 3.5 s, before it stands still",
        ),
        Row(
            key="initial_paper_y",
            what="initial model, paper: y",
            unit="m",
            published=-0.009,
            recomputed=initial[1],
            note=stand,
        ),
        Row(
            key="initial_paper_phi",
            what="initial model, paper: φ",
            unit="rad",
            published=-0.016,
            recomputed=initial[2],
            note=stand,
        ),
        Row(
            key="improved_paper_x_short",
            what="improved model, paper: x short of 0.4 m",
            unit="m",
            published=0.053,
            recomputed=DISTANCE_M - better[0],
            note=stand,
        ),
        Row(
            key="improved_paper_y",
            what="improved model, paper: y",
            unit="m",
            published=-0.022,
            recomputed=better[1],
            note=stand,
        ),
        Row(
            key="improved_paper_phi",
            what="improved model, paper: φ",
            unit="rad",
            published=-0.111,
            recomputed=better[2],
            note=stand,
        ),
        Row(
            key="improved_carpet_phi",
            what="improved model, carpet: φ",
            unit="rad",
            published=0.558,
            recomputed=carpet[2],
            note="DISCREPANCY: same size, opposite sign; eq. (10) gives a negative heading",
        ),
    )


def with_angles(unprinted: Unprinted, angles_rad: Array) -> Unprinted:
    """The same robot from other rotor angles."""
    return replace(unprinted, angles_rad=angles_rad)
