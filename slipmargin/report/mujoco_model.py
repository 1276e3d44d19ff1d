"""A robot for MuJoCo (MJCF): wheels with real rollers, on springs, with speed servos.

MuJoCo knows no direction of contact friction that stays with a wheel, so each wheel carries its rollers:
ellipsoids on hinges around the rim.  The floor's Coulomb cone has the drive coefficient; the hinge of a
roller has the dry friction (``frictionloss``) that makes a wheel pulled across its grip show the transverse
coefficient: μ_T times the wheel's load at rest times the roller's radius.  It does not follow the load, so
where loads shift the transverse friction is that of rest.  A pull along both directions meets a disc and
a strip, not the box (docs/theory.md, section 2: ``grip = "disc-strip"``).

A roller with half axes (a, b, b), its centre c = ρ − b from the axle, reaches
c cos α + √(b² + (a² − b²) cos²γ sin²α) below it at the angle α from the lowest place, γ the roller angle.
With a chosen so that this is ρ at α = 0 and halfway to the next roller, the wheel is round to
a part in a thousand.
"""

from __future__ import annotations

import math
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.report.gazebo_model import BASE, joint_of, link_of
from slipmargin.report.simulator_parts import LEVEL_INERTIA, SimRobot, SimWheel, number, numbers

#: Rollers a wheel.  With fewer a mecanum wheel's contact wanders across its width, which limits omit; with
#: more, neighbours stay on the floor together and the friction of their hinges adds up.
ROLLERS = 16
#: Radius of a roller, and the springs' travel under the weight, as shares of the wheel's radius.
_ROLLER, _SAG = 0.2, 0.01
#: Damping ratio of the springs; a mass that resists their speed only, as a share of what the wheel carries.
_DAMPING, _INERTER = 0.5, 0.1
#: Inertia of a rotor in multiples of carried mass × radius²: the servo is then as stiff as the step bears.
_ROTOR = 10.0
_STEP_S = 0.0005
#: Time constant of a contact [s], the least that MuJoCo allows: a soft contact lets neighbours touch too.
_SOFT_S = 2.0 * _STEP_S


def mjcf_text(robot: SimRobot) -> str:
    """A complete MJCF: floor, robot and a ``<velocity>`` servo for each wheel [rad/s]."""
    root = Element("mujoco", model=robot.name)
    said = [
        f"{robot.name} on {robot.surface}: x forward, y left; a positive wheel speed drives along the wheel.",
        "The servos take wheel speeds in rad/s.",
        *(f"Not in this file: {line}." for line in robot.left_out),
    ]
    root.append(Comment(" ".join(said).replace("--", "- -")))
    SubElement(root, "compiler", angle="radian")
    SubElement(
        root,
        "option",
        timestep=number(_STEP_S),
        cone="elliptic",
        impratio="100",
        integrator="implicitfast",
        gravity=numbers(0, 0, -GRAVITY_M_S2),
        iterations="50",
        tolerance="1e-10",
    )
    default = SubElement(root, "default")
    SubElement(default, "geom", mass="0", solref=numbers(_SOFT_S, 1), solimp="0.9 0.9 0.001")
    SubElement(default, "joint", solreffriction=numbers(2 * _STEP_S, 1), solimpfriction="0.9999 0.9999 0.001")
    world = SubElement(root, "worldbody")
    floor = {"name": "floor", "type": "plane", "size": "20 20 1", "contype": "0", "conaffinity": "1"}
    SubElement(world, "geom", floor, condim="3")
    base = SubElement(world, "body", name=BASE)
    SubElement(base, "freejoint", name="base")
    yaw, level = robot.yaw_inertia_kg_m2, LEVEL_INERTIA * robot.yaw_inertia_kg_m2
    _inertial(base, robot.com_m, robot.chassis_kg, (level, level, yaw))
    servos = SubElement(root, "actuator")
    for wheel in robot.wheels:
        _wheel(base, wheel)
        stiff = number(0.5 * _rotor(wheel) / _STEP_S)
        SubElement(servos, "velocity", name=f"{wheel.name}_speed", joint=joint_of(wheel), kv=stiff)
    indent(root)
    return tostring(root, encoding="unicode") + "\n"


def _inertial(
    body: Element, com_m: tuple[float, float, float], mass_kg: float, inertia: tuple[float, float, float]
) -> None:
    SubElement(body, "inertial", pos=numbers(*com_m), mass=number(mass_kg), diaginertia=numbers(*inertia))


def _wheel(base: Element, wheel: SimWheel) -> None:
    carried, radius, half = wheel.load_N / GRAVITY_M_S2, wheel.radius_m, 0.5 * wheel.drive_rad
    turned = numbers(math.cos(half), 0, 0, math.sin(half))
    body = SubElement(base, "body", name=link_of(wheel), pos=numbers(*wheel.place_m), quat=turned)
    stiffness = wheel.load_N / (_SAG * radius)
    SubElement(
        body,
        "joint",
        name=f"{wheel.name}_spring",
        type="slide",
        axis="0 0 1",
        stiffness=number(stiffness),
        damping=number(2.0 * _DAMPING * math.sqrt(stiffness * carried)),
        springref=number(-_SAG * radius),
        armature=number(_INERTER * carried),
    )
    rotor = number(_rotor(wheel))
    SubElement(body, "joint", name=joint_of(wheel), type="hinge", axis="0 1 0", armature=rotor)
    hub = 0.5 * wheel.mass_kg * radius**2
    _inertial(body, (0.0, 0.0, 0.0), 0.5 * wheel.mass_kg, (0.25 * hub, 0.5 * hub, 0.25 * hub))
    for k in range(ROLLERS):
        _roller(body, wheel, k)


def _rotor(wheel: SimWheel) -> float:
    return _ROTOR * wheel.load_N / GRAVITY_M_S2 * wheel.radius_m**2


def roller_axes(radius_m: float, roller_rad: float) -> tuple[float, float]:
    """Half axes a and b of a roller of a wheel [m]."""
    b, half = _ROLLER * radius_m, math.pi / ROLLERS
    centre = radius_m - b
    grown = (((radius_m - centre * math.cos(half)) / b) ** 2 - 1.0) / math.sin(half) ** 2
    return b * math.sqrt(1.0 + grown / math.cos(roller_rad) ** 2), b


def _roller(hub: Element, wheel: SimWheel, k: int) -> None:
    """The roller that is lowest once the wheel has turned by k shares of a turn."""
    a, b = roller_axes(wheel.radius_m, wheel.roller_rad)
    c, s = math.cos(2.0 * math.pi * k / ROLLERS), math.sin(2.0 * math.pi * k / ROLLERS)
    outward = (s, 0.0, -c)
    axle = (c * math.cos(wheel.roller_rad), math.sin(wheel.roller_rad), s * math.cos(wheel.roller_rad))
    place = numbers(*((wheel.radius_m - b) * v for v in outward))
    body = SubElement(hub, "body", pos=place, xyaxes=numbers(*axle, *outward))
    drag = number(wheel.mu2 * wheel.load_N * b)
    SubElement(body, "joint", type="hinge", axis="1 0 0", frictionloss=drag)
    mass = 0.5 * wheel.mass_kg / ROLLERS
    own = mass * b**2
    _inertial(body, (0.0, 0.0, 0.0), mass, (0.5 * own, 0.6 * own, 0.6 * own))
    size = {"type": "ellipsoid", "size": numbers(a, b, b), "contype": "1", "conaffinity": "0"}
    SubElement(body, "geom", size, condim="3", priority="1", friction=numbers(wheel.mu, 0, 0))
