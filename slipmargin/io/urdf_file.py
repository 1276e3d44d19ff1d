"""A robot from a URDF or xacro file, read through ``yourdfpy`` (and ``xacrodoc``): the extra ``[urdf]``.

URDF: lengths in metres, masses in kilograms, angles in radians; a joint turns about ``axis`` in its own
frame (wiki.ros.org/urdf/XML/joint), inertia tensors stand at the centre of mass
(wiki.ros.org/urdf/XML/inertial), and a body's x axis is forward, its y axis left (REP 103).  A wheel with
the axis a that turns at a positive rate rolls towards a × ẑ, so that is its drive direction: the sign of
the wheel speed is the joint's.
"""

from __future__ import annotations

import contextlib
import io
import logging
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.extra import need
from slipmargin.io.source import DAMAGE, read_text
from slipmargin.physics.frames import moment

#: What the libraries stumble over in a damaged file: xacro evaluates names that nobody gave.
_DAMAGE = (*DAMAGE, NameError)
#: An axis this far from level belongs to no wheel that stands on the floor [1].
_LEVEL = 0.1
#: Links that stand on the floor by ROS's custom (REP 105 and REP 120).
_ON_FLOOR = ("base_footprint", "footprint")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfWheel:
    """A wheel joint: place and axis in the body frame, and what is known of its wheel."""

    name: str
    place_m: Array  #: (3,)
    drive_deg: float
    radius_m: float | None
    roller_deg: float | None  #: None where the file has no rollers
    rollers: int | None
    max_speed_rad_s: float | None
    max_torque_N_m: float | None


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfRobot:
    """What a URDF tells of a robot: SI, in the frame of its base link (x forward, y left, z up)."""

    name: str
    frame: str
    wheels: tuple[UrdfWheel, ...]
    mass_kg: float
    com_m: Array  #: (3,) in the body frame
    inertia_kg_m2: float
    floor_z_m: float | None
    notes: tuple[str, ...]


def read_urdf(path: Path, arguments: Mapping[str, str] | None = None) -> UrdfRobot:
    """The robot of a URDF file, or of a ``.xacro`` file with its arguments.

    Raises
    ------
    InputError
        Where a library is missing, the file is no URDF, or it has fewer than three wheel joints.
    """
    try:
        text = _expanded(path, arguments)
        return _robot(_parsed(text))
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None


def _expanded(path: Path, arguments: Mapping[str, str] | None) -> str:
    if path.suffix != ".xacro":
        if arguments:
            raise InputError("--xacro-args", f"is for .xacro files, {path.name} is none", "leave it out")
        return read_text(path)
    read_text(path)  # whether it is there and is text
    need("URDF", "xacrodoc", "urdf")
    from xml.parsers.expat import ExpatError

    from xacro import XacroException
    from xacrodoc import XacroDoc

    try:
        return str(XacroDoc.from_file(str(path), subargs=dict(arguments or {})).to_urdf_string())
    except (XacroException, ExpatError, OSError, *_DAMAGE) as fault:
        raise InputError(
            "",
            f"xacro cannot expand it ({' '.join(str(fault).split())[:200]})",
            "give --xacro-args NAME:=VALUE",
        ) from None


def _parsed(text: str) -> Any:
    need("URDF", "yourdfpy", "urdf")
    from xml.etree import ElementTree

    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as fault:
        line, column = fault.position
        raise InputError(f"{line}:{column + 1}", "is no XML", "export the URDF again") from None
    if root.tag != "robot":
        raise InputError("1:1", f"is <{root.tag[:40]}>, not <robot>", "give a URDF file")
    import yourdfpy

    logging.getLogger("yourdfpy").setLevel(logging.ERROR)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            model = yourdfpy.URDF.load(
                io.BytesIO(ElementTree.tostring(root, encoding="utf-8")),
                build_scene_graph=False,
                load_meshes=False,
            )
    except _DAMAGE as fault:
        raise InputError(
            "",
            f"is no URDF that can be read ({type(fault).__name__}: {' '.join(str(fault).split())[:120]})",
            "check it with `check_urdf`",
        ) from None
    if not model.robot.links:
        raise InputError("robot", "holds no link", "give the URDF of a whole robot")
    return model.robot


def _robot(model: Any) -> UrdfRobot:
    links = {link.name: link for link in model.links}
    joints = {joint.child: joint for joint in model.joints}
    for joint in model.joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                raise InputError(
                    f"joint {joint.name}", f"names the link {end!r}, which is not there", "add it"
                )
    places = {name: _place(name, joints) for name in links}
    frame = "base_link" if "base_link" in links else next(n for n in links if n not in joints)
    to_body = np.linalg.inv(places[frame])
    places = {name: to_body @ place for name, place in places.items()}
    notes: list[str] = []
    wheels = _wheels(model, links, joints, places, notes)
    mass, com, inertia = _mass(links, places)
    if mass <= 0.0:
        notes.append("no link has a mass")
    return UrdfRobot(
        name=str(model.name or "robot"),
        frame=frame,
        wheels=wheels,
        mass_kg=mass,
        com_m=com,
        inertia_kg_m2=inertia,
        floor_z_m=_floor(places, wheels),
        notes=tuple(notes),
    )


def _place(name: str, joints: Mapping[str, Any]) -> Array:
    """The transform (4, 4) from a link to its tree's root, all joints at zero."""
    found, seen = np.eye(4), set()
    while name in joints:
        if name in seen:
            raise InputError(f"link {name}", "is its own ancestor", "remove the loop of joints")
        seen.add(name)
        joint = joints[name]
        origin = np.eye(4) if joint.origin is None else np.asarray(joint.origin, dtype=float)
        if origin.shape != (4, 4) or not np.isfinite(origin).all():
            raise InputError(f"joint {joint.name}", "its origin is not finite", "give finite xyz and rpy")
        found, name = origin @ found, joint.parent
    return np.asarray(found)


def _axis(joint: Any, places: Mapping[str, Array]) -> Array:
    axis = np.array([1.0, 0.0, 0.0]) if joint.axis is None else np.asarray(joint.axis, dtype=float)
    size = float(np.linalg.norm(axis))
    if axis.shape != (3,) or not 0.0 < size < math.inf:
        raise InputError(f"joint {joint.name}", "its axis has no direction", "give three numbers, not all 0")
    return np.asarray(places[joint.child][:3, :3] @ axis / size)


def _wheels(
    model: Any,
    links: Mapping[str, Any],
    joints: Mapping[str, Any],
    places: Mapping[str, Array],
    notes: list[str],
) -> tuple[UrdfWheel, ...]:
    """The joints that turn wheels: without end, about a level axis, on no other joint that turns.

    A mecanum wheel's rollers are joints of their own on the wheel's; steered wheels and casters are not used.
    """
    turning = [j for j in model.joints if j.type == "continuous"]
    level = [j for j in turning if abs(_axis(j, places)[2]) < _LEVEL]
    named = [j for j in level if "wheel" in f"{j.name} {j.child}".lower()]
    candidates = named or level
    found, moved = [], {j.child for j in model.joints if j.type not in ("fixed", None)}
    for joint in candidates:
        carriers = [c for c in _ancestors(joint.parent, joints) if c in moved]
        if carriers:
            if not any(joints[c] in level for c in carriers):
                notes.append(
                    f"joint {joint.name} is steered or sprung ({joints[carriers[0]].name}): left out"
                )
            continue
        found.append(_wheel(joint, turning, links, joints, places))
    if len(found) < 3:
        kinds = ", ".join(f"{j.name} ({j.type})" for j in model.joints)[:200] or "none"
        raise InputError(
            "joint",
            f"{len(found)} wheels: joints of type continuous about a level axis, fixed to the body",
            f"describe three or more (there are: {kinds})",
        )
    return tuple(found)


def _ancestors(link: str, joints: Mapping[str, Any]) -> list[str]:
    found = []
    while link in joints:
        found.append(link)
        link = joints[link].parent
    return found


def _wheel(
    joint: Any, turning: Sequence[Any], links: Mapping[str, Any], joints: Mapping[str, Any], places: Any
) -> UrdfWheel:
    a = _axis(joint, places)
    drive = np.array([a[1], -a[0]]) / math.hypot(a[0], a[1])  # a × ẑ
    rollers = [j for j in turning if j is not joint and joint.child in _ancestors(j.child, joints)]
    roller = None
    if rollers:
        lowest = min(rollers, key=lambda j: float(places[j.child][2, 3]))
        way = _axis(lowest, places)[:2]
        if math.hypot(*way) > _LEVEL:
            turn = math.atan2(float(moment(*drive, *way)), float(drive @ way))
            roller = math.degrees(math.remainder(turn, math.pi))
    limit = joint.limit
    return UrdfWheel(
        name=str(joint.name),
        place_m=places[joint.child][:3, 3],
        drive_deg=math.degrees(math.atan2(drive[1], drive[0])),
        radius_m=_radius(links[joint.child]),
        roller_deg=roller,
        rollers=len(rollers) or None,
        max_speed_rad_s=_positive(getattr(limit, "velocity", None)),
        max_torque_N_m=_positive(getattr(limit, "effort", None)),
    )


def _positive(value: Any) -> float | None:
    return float(value) if value is not None and 0.0 < float(value) < math.inf else None


def _radius(link: Any) -> float | None:
    """Radius of the wheel's cylinder or sphere: what it collides with before how it looks [m]."""
    for shape in (*link.collisions, *link.visuals):
        geometry = shape.geometry
        for part in (getattr(geometry, "cylinder", None), getattr(geometry, "sphere", None)):
            if part is not None:
                return _positive(part.radius)
    return None


def _mass(links: Mapping[str, Any], places: Mapping[str, Array]) -> tuple[float, Array, float]:
    """Mass [kg], centre of mass (3,) [m] and yaw inertia about it [kg m²] of all links."""
    parts = []
    for name, link in links.items():
        held = link.inertial
        if held is None or not held.mass:
            continue
        at = places[name] @ (np.eye(4) if held.origin is None else np.asarray(held.origin, dtype=float))
        tensor = np.zeros((3, 3)) if held.inertia is None else np.asarray(held.inertia, dtype=float)
        parts.append((float(held.mass), at[:3, 3], float((at[:3, :3] @ tensor @ at[:3, :3].T)[2, 2])))
    if not parts or not np.isfinite([p[0] for p in parts]).all() or sum(p[0] for p in parts) <= 0.0:
        return 0.0, np.zeros(3), 0.0
    masses, places_m = np.array([p[0] for p in parts]), np.array([p[1] for p in parts])
    com = masses @ places_m / masses.sum()
    away = np.sum((places_m - com)[:, :2] ** 2, axis=1)
    return float(masses.sum()), np.asarray(com), float(sum(p[2] for p in parts) + masses @ away)


def _floor(places: Mapping[str, Array], wheels: Sequence[UrdfWheel]) -> float | None:
    """Height of the floor in the body frame: under the wheels, or where a link stands on it [m]."""
    known = [w.place_m[2] - w.radius_m for w in wheels if w.radius_m is not None]
    if known:
        return float(np.mean(known))
    for name in _ON_FLOOR:
        if name in places:
            return float(places[name][2, 3])
    return None
