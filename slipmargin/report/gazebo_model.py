"""A robot for Gazebo, as SDF and as URDF: wheels that are spheres with two coefficients of friction.

SDF (sdformat.org, collision/surface/friction/ode): ``mu`` is the coefficient along ``fdir1``, ``mu2`` that
across it, ``slip1`` and ``slip2`` are slip speeds a newton of friction [m/(N s)].  ``fdir1`` turns with the
wheel unless ``gz:expressed_in`` names a link that does not, as in Gazebo's own ``mecanum_drive.sdf``, whose
wheels are spheres too.  The engine takes the smaller of two coefficients, so the floor's must not be smaller.
ODE's friction pyramid is the box of docs/theory.md, section 2.  URDF knows no such direction: there it stands
in a ``<gazebo>`` block, which sdformat merges into the collision that it makes of a link, ``LINK_collision``.
"""

from __future__ import annotations

from typing import Any
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

from slipmargin.report.simulator_parts import LEVEL_INERTIA, SimRobot, SimWheel, number, numbers

_GZ = "http://gazebosim.org/schema"
BASE = "base_link"
#: A torque that is no limit, where the robot file gives a wheel speed alone [N m].
_NO_LIMIT = 1e3


def sdf_text(robot: SimRobot) -> str:
    """An SDF model, complete: ``gz sim`` includes it as it is."""
    root = Element("sdf", {"version": "1.9", "xmlns:gz": _GZ})
    root.append(_head(robot))
    model = SubElement(root, "model", name=robot.name)
    chassis = SubElement(model, "link", name=BASE)
    _sdf_inertial(chassis, robot.com_m, robot.chassis_kg, _inertia(robot))
    for wheel in robot.wheels:
        link = SubElement(model, "link", name=link_of(wheel))
        SubElement(link, "pose", relative_to=BASE).text = numbers(*wheel.place_m, 0, 0, 0)
        _sdf_inertial(link, (0.0, 0.0, 0.0), wheel.mass_kg, _ball(wheel))
        for kind in ("collision", "visual"):
            body = SubElement(link, kind, name=kind)
            sphere = SubElement(SubElement(body, "geometry"), "sphere")
            SubElement(sphere, "radius").text = number(wheel.radius_m)
            if kind == "collision":
                _surface(body, wheel)
        joint = SubElement(model, "joint", name=joint_of(wheel), type="revolute")
        SubElement(joint, "parent").text = BASE
        SubElement(joint, "child").text = link_of(wheel)
        axis = SubElement(joint, "axis")
        SubElement(axis, "xyz", expressed_in=BASE).text = numbers(*wheel.axle, 0)
        limits = {
            "lower": -1e16,
            "upper": 1e16,
            "effort": wheel.stall_torque_N_m,
            "velocity": robot.max_speed_rad_s,
        }
        place = SubElement(axis, "limit")
        for name, value in limits.items():
            if value is not None:
                SubElement(place, name).text = number(value)
    return _text(root)


def urdf_text(robot: SimRobot) -> str:
    """A URDF with the friction in ``<gazebo>`` blocks; ``robots from-urdf`` reads it back."""
    root = Element("robot", {"name": robot.name, "xmlns:gz": _GZ})
    root.append(_head(robot))
    SubElement(root, "link", name="base_footprint")
    _urdf_inertial(SubElement(root, "link", name=BASE), robot.com_m, robot.chassis_kg, _inertia(robot))
    fixed = SubElement(root, "joint", name="base_joint", type="fixed")
    SubElement(fixed, "parent", link="base_footprint")
    SubElement(fixed, "child", link=BASE)
    for wheel in robot.wheels:
        name = link_of(wheel)
        link = SubElement(root, "link", name=name)
        _urdf_inertial(link, (0.0, 0.0, 0.0), wheel.mass_kg, _ball(wheel))
        for kind in ("collision", "visual"):
            geometry = SubElement(SubElement(link, kind), "geometry")
            SubElement(geometry, "sphere", radius=number(wheel.radius_m))
        joint = SubElement(root, "joint", name=joint_of(wheel), type="continuous")
        SubElement(joint, "parent", link=BASE)
        SubElement(joint, "child", link=name)
        SubElement(joint, "origin", xyz=numbers(*wheel.place_m))
        SubElement(joint, "axis", xyz=numbers(*wheel.axle, 0))
        torque, top = wheel.stall_torque_N_m, robot.max_speed_rad_s
        if torque is not None or top is not None:  # a limit has both
            SubElement(joint, "limit", effort=number(torque or _NO_LIMIT), velocity=number(top or _NO_LIMIT))
        gazebo = SubElement(root, "gazebo", reference=name)
        _surface(SubElement(gazebo, "collision", name=f"{name}_collision"), wheel)
    return _text(root)


def link_of(wheel: SimWheel) -> str:
    """The name of a wheel's link."""
    return f"{wheel.name}_wheel"


def joint_of(wheel: SimWheel) -> str:
    """The name of a wheel's joint."""
    return f"{wheel.name}_wheel_joint"


def _head(robot: SimRobot) -> Any:
    said = [
        f"{robot.name} on {robot.surface}: x forward, y left; a positive wheel speed drives along the wheel.",
        "mu acts along fdir1 (the roller's axle on the floor), mu2 across it; slip1, slip2 in m/(N s).",
        "Give the floor at least these coefficients: the engine takes the smaller of two.",
        "Inertias about level axes and the wheels' masses are guesses.",
        *(f"Not in this file: {line}." for line in robot.left_out),
    ]
    return Comment(" ".join(said).replace("--", "- -"))


def _text(root: Element) -> str:
    indent(root)
    return '<?xml version="1.0"?>\n' + tostring(root, encoding="unicode") + "\n"


def _inertia(robot: SimRobot) -> tuple[float, float, float]:
    level = LEVEL_INERTIA * robot.yaw_inertia_kg_m2
    return level, level, robot.yaw_inertia_kg_m2


def _ball(wheel: SimWheel) -> tuple[float, float, float]:
    """Inertia of a wheel as of a ball: alike about every axis, so that it need not be turned."""
    alike = 0.25 * wheel.mass_kg * wheel.radius_m**2
    return alike, alike, alike


_TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def _sdf_inertial(
    link: Element, com_m: tuple[float, float, float], mass_kg: float, inertia: tuple[float, float, float]
) -> None:
    place = SubElement(link, "inertial")
    SubElement(place, "pose").text = numbers(*com_m, 0, 0, 0)
    SubElement(place, "mass").text = number(mass_kg)
    tensor = SubElement(place, "inertia")
    for name, value in zip(_TENSOR, (*inertia, 0.0, 0.0, 0.0), strict=True):
        SubElement(tensor, name).text = number(value)


def _urdf_inertial(
    link: Element, com_m: tuple[float, float, float], mass_kg: float, inertia: tuple[float, float, float]
) -> None:
    place = SubElement(link, "inertial")
    SubElement(place, "origin", xyz=numbers(*com_m))
    SubElement(place, "mass", value=number(mass_kg))
    values = (number(v) for v in (*inertia, 0.0, 0.0, 0.0))
    SubElement(place, "inertia", dict(zip(_TENSOR, values, strict=True)))


def _surface(collision: Element, wheel: SimWheel) -> None:
    """The friction of a wheel, as both formats hold it."""
    ode = SubElement(SubElement(SubElement(collision, "surface"), "friction"), "ode")
    SubElement(ode, "mu").text = number(wheel.mu)
    SubElement(ode, "mu2").text = number(wheel.mu2)
    SubElement(ode, "fdir1", {"gz:expressed_in": BASE}).text = numbers(*wheel.grip, 0)
    SubElement(ode, "slip1").text = number(wheel.slip1)
    SubElement(ode, "slip2").text = number(wheel.slip2)
