"""Drawn robots and models that every room's property tests share.

``robots()`` and ``models()`` draw machines that a maker could build: three to six wheels round a
body, omni or mecanum (or mixed), each with its own radius and direction, any load rule, loads that
press every wheel down, grip directions that make all three wrenches comfortably.  ``effects()`` draws
effects of the catalogue.  ``kiwi()``,
``four_wheels()`` and ``tall()`` are fixed machines for tests that need a known one.

Nothing here is random outside Hypothesis.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from hypothesis import assume, strategies as st

from slipmargin.effects import Effect, WheelEffect
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.model import Model, nominal_model
from slipmargin.physics.loads import sharing_matrix
from slipmargin.robot import (
    Body,
    Coefficients,
    FrictionLaw,
    GripShape,
    LoadRule,
    Motor,
    Robot,
    Surface,
    Wheel,
)

#: Table I of the paper.
PAPER = Surface(
    name="paper",
    roller=Coefficients(drive=0.26, transverse=0.09),
    rigid=Coefficients(drive=0.47, transverse=0.47),
)
CARPET = Surface(
    name="carpet",
    roller=Coefficients(drive=0.25, transverse=0.15),
    rigid=Coefficients(drive=0.56, transverse=0.56),
)

#: Grip rows whose smallest singular value is below this share of the largest are not drawn.
WELL_POSED = 0.08


def kiwi(
    delta_deg: float = 15.0,
    *,
    radius_m: float = 0.095,
    mass_kg: float = 3.0,
    com_m: tuple[float, float] = (0.0, 0.0),
    com_height_m: float = 0.0,
    load_rule: LoadRule = LoadRule.EQUAL,
    load_fractions: tuple[float, ...] | None = None,
    grip: GripShape = GripShape.BOX,
    turned_rad: float = 0.0,
    rigid_fraction: float = 0.1,
) -> Robot:
    """The paper's robot: docs/theory.md, section 1, front wheels at ±(cos δ, sin δ), rear at (0, −1).

    ``turned_rad`` turns the whole machine (wheels and centre of mass) in its body frame.
    """
    delta = math.radians(delta_deg)
    axle = [delta, math.pi - delta, -math.pi / 2]
    wheels = tuple(
        Wheel(
            name=name,
            position_m=radius_m * np.array([math.cos(a + turned_rad), math.sin(a + turned_rad)]),
            drive_direction_deg=math.degrees(a + turned_rad + math.pi / 2),
            radius_m=0.0254,
            rigid_fraction=rigid_fraction,
        )
        for name, a in zip(("right", "left", "rear"), axle, strict=True)
    )
    c, s = math.cos(turned_rad), math.sin(turned_rad)
    turn = np.array([[c, -s], [s, c]])
    return Robot(
        name="kiwi",
        wheels=wheels,
        surfaces=(PAPER, CARPET),
        load_rule=load_rule,
        body=Body(
            mass_kg=mass_kg,
            inertia_kg_m2=mass_kg * radius_m**2,
            com_m=turn @ np.array(com_m),
            com_height_m=com_height_m,
        ),
        load_fractions=None if load_fractions is None else np.array(load_fractions),
        friction=FrictionLaw(grip=grip),
    )


def high_kiwi() -> Robot:
    """A kiwi whose centre of mass stands three reaches high: near its limit its motion is unstable."""
    robot = kiwi(30.0, radius_m=0.1, com_height_m=0.3, load_rule=LoadRule.QUASI_STATIC, rigid_fraction=0.0)
    grip = Coefficients(drive=0.4, transverse=0.06)
    return replace(
        robot,
        body=replace(robot.body, inertia_kg_m2=0.015),
        friction=replace(robot.friction, k_s_per_m=1000.0),
        surfaces=(Surface(name="floor", roller=grip, rigid=grip),),
    )


def four_wheels(
    roller_angle_deg: float = 45.0,
    *,
    grip: GripShape = GripShape.BOX,
    load_rule: LoadRule = LoadRule.STATIC,
    com_height_m: float = 0.0,
) -> Robot:
    """A rectangular four-wheel mecanum robot (X pattern seen from above)."""
    place = np.array([[0.15, 0.2], [-0.15, 0.2], [-0.15, -0.2], [0.15, -0.2]])
    sign = [1.0, -1.0, 1.0, -1.0]
    wheels = tuple(
        Wheel(
            name=name,
            position_m=p,
            drive_direction_deg=90.0,
            radius_m=0.05,
            roller_angle_deg=s * roller_angle_deg,
            rollers=9,
        )
        for name, p, s in zip(("fr", "fl", "rl", "rr"), place, sign, strict=True)
    )
    return Robot(
        name="mecanum",
        wheels=wheels,
        surfaces=(PAPER, CARPET),
        load_rule=load_rule,
        body=Body(mass_kg=12.0, inertia_kg_m2=0.4, com_height_m=com_height_m),
        friction=FrictionLaw(grip=grip),
    )


def tall(
    height_m: float = 0.05,
    rule: LoadRule = LoadRule.QUASI_STATIC,
    wheels: int = 4,
    surface: str = "paper",
) -> Model:
    """Four wheels at a rectangle's corners, or another number on an ellipse."""
    robot = four_wheels(load_rule=rule, com_height_m=height_m)
    if wheels != 4:
        around = np.deg2rad(20.0 + 360.0 / wheels * np.arange(wheels))
        robot = replace(
            robot,
            wheels=tuple(
                Wheel(
                    name=str(i),
                    position_m=np.array([0.15 * np.cos(a), 0.2 * np.sin(a)]),
                    drive_direction_deg=float(np.rad2deg(a)) + 90.0,
                    radius_m=0.05,
                    roller_angle_deg=0.0,
                    rollers=9,
                )
                for i, a in enumerate(around)
            ),
        )
    return nominal_model(robot, surface)


#: Wheels whose grips are nearly parallel: x, y [m], drive direction, roller angle [deg]; then μ_W.
NARROW = {
    "omni": (
        ((0.1679, -0.1059, 44.8, 0), (-0.0311, 0.2554, -166.08, 0), (-0.0299, -0.2459, -33.79, 0)),
        0.4685,
    ),
    "mecanum": (
        (
            (0.2153, -0.0044, -76.44, 30),
            (0.1967, 0.2196, -95.67, 45),
            (-0.1404, 0.2053, -92.9, 45),
            (-0.1814, -0.0301, 9.14, -60),
            (-0.125, -0.1433, -72.14, 30),
            (0.0816, -0.1767, 0.57, -60),
        ),
        0.7977,
    ),
}


def narrow(kind: str, grip: GripShape = GripShape.BOX) -> Robot:
    """A robot of :data:`NARROW`: all grips nearly parallel, μ_T = 0.005."""
    rows, mu = NARROW[kind]
    wheels = tuple(
        Wheel(
            name=f"w{i}",
            position_m=np.array([x, y]),
            drive_direction_deg=drive,
            radius_m=0.05,
            roller_angle_deg=float(roller),
        )
        for i, (x, y, drive, roller) in enumerate(rows, 1)
    )
    floor = Surface(
        name="floor",
        roller=Coefficients(drive=mu, transverse=0.005),
        rigid=Coefficients(drive=0.5, transverse=0.5),
    )
    return Robot(
        name=f"narrow-{kind}",
        wheels=wheels,
        surfaces=(floor,),
        load_rule=LoadRule.EQUAL,
        body=Body(mass_kg=10.0, inertia_kg_m2=0.3, com_m=np.mean([w.position_m for w in wheels], axis=0)),
        friction=FrictionLaw(grip=grip),
    )


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    """Finite floats between two bounds, on a grid of a millionth of the span (no denormals)."""
    return st.integers(0, 1_000_000).map(lambda k: low + (high - low) * k / 1_000_000)


@st.composite
def surfaces(draw: st.DrawFn, name: str = "floor") -> Surface:
    """A floor whose rigid material grips at least as well as its rollers' bearings."""
    roller = Coefficients(drive=draw(reals(0.1, 0.9)), transverse=draw(reals(0.005, 0.5)))
    rigid = Coefficients(drive=draw(reals(0.1, 1.2)), transverse=draw(reals(0.05, 1.2)))
    return Surface(name=name, roller=roller, rigid=rigid)


@st.composite
def robots(
    draw: st.DrawFn,
    *,
    min_wheels: int = 3,
    max_wheels: int = 6,
    rules: tuple[LoadRule, ...] = tuple(LoadRule),
    shapes: tuple[GripShape, ...] = (GripShape.BOX,),
    motors: bool = False,
) -> Robot:
    """A robot of omni and mecanum wheels, one surface called ``floor``, any of the load rules.

    The static load of every wheel is at least a fifth of m g / N, so no drawn robot tips at rest.
    """
    n = draw(st.integers(min_wheels, max_wheels))
    size = draw(reals(0.05, 0.5))
    kind = draw(st.sampled_from(("omni", "mecanum", "mixed")))
    names, wheels = [f"w{i + 1}" for i in range(n)], []
    for i, name in enumerate(names):
        at = 2.0 * math.pi * (i + draw(reals(-0.3, 0.3))) / n
        far = size * draw(reals(0.6, 1.0))
        if kind == "mecanum" or (kind == "mixed" and draw(st.booleans())):
            roller, drive = draw(st.sampled_from((45.0, -45.0, 30.0, -60.0))), draw(reals(-180.0, 180.0))
        else:
            roller, drive = 0.0, math.degrees(at) + 90.0 + draw(reals(-40.0, 40.0))
        wheels.append(
            Wheel(
                name=name,
                position_m=far * np.array([math.cos(at), math.sin(at)]),
                drive_direction_deg=drive,
                radius_m=draw(reals(0.02, 0.1)),
                roller_angle_deg=roller,
                rollers=draw(st.integers(4, 14)),
                rigid_fraction=draw(reals(0.0, 0.3)),
            )
        )
    place = np.array([w.position_m for w in wheels])
    assume(_posed(wheels, place))
    com, fractions = _centre(draw, place)
    rule = draw(st.sampled_from(rules))
    mass = draw(reals(0.5, 60.0))
    return Robot(
        name=f"drawn-{kind}-{n}",
        wheels=tuple(wheels),
        surfaces=(draw(surfaces()),),
        load_rule=rule,
        body=Body(
            mass_kg=mass,
            inertia_kg_m2=mass * (draw(reals(0.4, 1.2)) * size) ** 2,
            com_m=com,
            com_height_m=draw(reals(0.0, 0.6)) * size,
        ),
        load_fractions=fractions if rule is LoadRule.FIXED else None,
        friction=FrictionLaw(grip=draw(st.sampled_from(shapes))),
        motor=Motor(max_speed_rad_s=draw(reals(5.0, 100.0)), stall_torque_N_m=draw(reals(0.1, 5.0)))
        if motors and draw(st.booleans())
        else None,
    )


@st.composite
def models(
    draw: st.DrawFn,
    *,
    min_wheels: int = 3,
    max_wheels: int = 6,
    rules: tuple[LoadRule, ...] = tuple(LoadRule),
    shapes: tuple[GripShape, ...] = (GripShape.BOX,),
    motors: bool = False,
) -> Model:
    """The nominal model of a drawn robot on its floor."""
    drawn = robots(min_wheels=min_wheels, max_wheels=max_wheels, rules=rules, shapes=shapes, motors=motors)
    return nominal_model(draw(drawn), "floor")


def _posed(wheels: list[Wheel], place: np.ndarray) -> bool:
    grip = np.deg2rad([w.drive_direction_deg + w.roller_angle_deg for w in wheels])
    arm = (place - place.mean(axis=0)) / np.max(np.hypot(*(place - place.mean(axis=0)).T))
    rows = np.stack([np.cos(grip), np.sin(grip), arm[:, 0] * np.sin(grip) - arm[:, 1] * np.cos(grip)])
    singular = np.linalg.svd(rows, compute_uv=False)
    return bool(singular[-1] > WELL_POSED * singular[0])


def _centre(draw: st.DrawFn, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    # At the wheels' centroid the minimum-norm loads are equal; move until one is at most 0.8 lighter.
    n, way = len(place), draw(reals(-math.pi, math.pi))
    step = np.array([math.cos(way), math.sin(way)])
    drop = -np.min(sharing_matrix(place)[:, 1:] @ step) * n
    com = place.mean(axis=0) + draw(reals(0.0, 0.8)) / drop * step
    fractions = sharing_matrix(place) @ np.array([1.0, *com])
    return com, fractions / fractions.sum()


@st.composite
def effects(
    draw: st.DrawFn,
    kinds: Sequence[type[Effect]] = CATALOGUE,
    *,
    reach: float = 2.0,
    least: float = 0.0,
    wheels: tuple[str, ...] = (),
) -> Effect:
    """An effect of the catalogue, every parameter within ``reach`` of its scales from null, in its bounds.

    With ``least`` > 0 every parameter is at least that many scales away from null (or at a bound).
    ``wheels`` are names of which an effect of single wheels may act on some; by default it acts on all.  What
    has no influence on so few wheels stays at null.
    """
    kind = draw(st.sampled_from(kinds))
    values = []
    for p in kind.parameters:
        if wheels and p.least_wheels > len(wheels):
            values.append(p.null)
            continue
        sides = [
            (max(p.low, p.null - reach * p.scale), max(p.low, p.null - least * p.scale)),
            (min(p.high, p.null + least * p.scale), min(p.high, p.null + reach * p.scale)),
        ]
        low, high = draw(st.sampled_from([s for s in sides if s[0] < s[1]]))
        values.append(draw(reals(low, high)))
    if not issubclass(kind, WheelEffect):
        return kind.of(np.array(values))
    some = draw(st.lists(st.sampled_from(wheels), unique=True, max_size=len(wheels) - 1)) if wheels else []
    if some and kind is MotorLag:  # a dead time is that of every wheel
        values[-1] = 0.0
    return kind.of(np.array(values), tuple(some))
