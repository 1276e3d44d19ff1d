"""A rigid-body engine (MuJoCo) with real rollers, built from any robot's data sheet.

Every wheel is a hinged body on a vertical spring, every roller a body with a hinge of its own around the
wheel's rim: omni or mecanum, as the data sheet's roller angle says.  There is no friction formula here.
The floor's friction is the engine's Coulomb cone with the drive coefficient.  The transverse coefficient is
bearing friction of the roller's hinge: a torque in proportion to the normal force that the engine finds on
that roller and to the arm at which the floor turns it, so that a wheel pulled across its grip shows the data
sheet's coefficient at any wheel angle (+2 % at most where neighbouring mecanum rollers, whose axes differ by
half a degree, share the load).  From the package it takes the data sheet and, to command a motion and to read
slips, the wheel geometry that is under test.

Rollers are ellipsoids whose envelope is the wheel's circle to about a micrometre; they overlap, which stands
for staggered rows: rollers touch the floor only, never each other.  What a data sheet does not say is chosen
in :class:`Build`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from slipmargin.model import nominal_model
from slipmargin.robot import Robot, Wheel

GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class Build:
    """What a data sheet does not say.

    Parameters
    ----------
    rollers : int
        A wheel's rollers.  Not the data sheet's number: with few rollers a mecanum wheel's contact wanders
        across its width and its grip direction nods, which the models of the package leave out.
    roller_radius, sag : float
        Radius of a roller, and how far the suspension gives under the weight, per radius of the wheel.
    damping, inerter : float
        Of the suspension: damping ratio, and a mass (share of what the wheel carries) that resists the
        spring's speed only; it keeps light wheels on stiff contacts numerically tame.
    rotor : float
        Reflected inertia of a motor in multiples of (carried mass) × radius²: a stiff speed servo.
    light : float
        Share of the robot's mass that is in its wheels and rollers.
    soft_s : float
        Time constant of a contact.
    step_s, tick_s : float
        Time step; how often commands and bearings are set.
    slope : (float, float)
        Sine of the floor's tilt along x and y: the body is pulled that way.
    """

    rollers: int = 36
    roller_radius: float = 0.2
    sag: float = 0.01
    damping: float = 0.5
    inerter: float = 0.1
    rotor: float = 10.0
    light: float = 0.02
    soft_s: float = 0.003
    step_s: float = 0.0005
    tick_s: float = 0.001
    slope: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Roller:
    """An ellipsoid (a, b, b) [m] that turns about its long axis, centred ``centre_m`` from the wheel's axle.

    ``slant_rad`` is the angle between its axis and the drive direction where it touches the floor.
    """

    a_m: float
    b_m: float
    centre_m: float
    slant_rad: float

    def reach_m(self, alpha: np.ndarray) -> np.ndarray:
        """How far below the axle the roller reaches when it is α [rad] from the lowest place."""
        return self.centre_m * np.cos(alpha) + self._half_height(alpha)

    def lever_m(self, alpha: np.ndarray) -> np.ndarray:
        """Arm about the roller's axis of a floor force across the grip, α [rad] from the lowest place."""
        axis = self._axis(alpha)
        spread = (self.a_m**2 - self.b_m**2) * axis[..., 2:] * axis
        touch = (self.b_m**2 * np.array([0.0, 0.0, -1.0]) - spread) / self._half_height(alpha)[..., None]
        return np.abs(np.cross(axis, touch) @ [np.sin(self.slant_rad), -np.cos(self.slant_rad), 0.0])

    def _axis(self, alpha: np.ndarray) -> np.ndarray:
        c, s = np.cos(self.slant_rad), np.sin(self.slant_rad)
        return np.stack([c * np.cos(alpha), np.full_like(alpha, s), c * np.sin(alpha)], axis=-1)

    def _half_height(self, alpha: np.ndarray) -> np.ndarray:
        return np.sqrt(self.b_m**2 + (self.a_m**2 - self.b_m**2) * self._axis(alpha)[..., 2] ** 2)


def roller_of(wheel: Wheel, build: Build) -> Roller:
    """The roller whose envelope comes closest to the wheel's circle."""
    radius, slant = wheel.radius_m, float(np.deg2rad(wheel.roller_angle_deg))
    b = build.roller_radius * radius
    centre, edge = radius - b, np.sin(np.pi / build.rollers) ** 2
    # With s = sin²α it reaches centre √(1 − s) + b √(1 + q s) below the axle.  This q makes that the wheel's
    # radius both at the middle of a roller and where the next one takes over.
    q = (((radius - centre * np.sqrt(1.0 - edge)) / b) ** 2 - 1.0) / edge
    return Roller(
        a_m=b * float(np.sqrt(1.0 + q / np.cos(slant) ** 2)), b_m=b, centre_m=centre, slant_rad=slant
    )


def _text(*values: float) -> str:
    return " ".join(f"{v:.12g}" for v in values)


def wheel_xml(i: int, wheel: Wheel, build: Build, *, mu: float, mass_kg: float, carried_kg: float) -> str:
    """Wheel ``i`` on its suspension, with rollers around the rim; nothing of it touches but rollers."""
    roller, radius, n = roller_of(wheel, build), wheel.radius_m, build.rollers
    slant, turn = np.deg2rad(wheel.roller_angle_deg), np.deg2rad(wheel.drive_direction_deg)
    stiffness = carried_kg * GRAVITY / (build.sag * radius)
    damping = 2.0 * build.damping * np.sqrt(stiffness * carried_kg)
    hub, each = 0.5 * mass_kg, 0.5 * mass_kg / n
    parts = []
    for k in range(n):
        c, s = np.cos(2 * np.pi * k / n), np.sin(2 * np.pi * k / n)
        # Wheel frame: x along the drive direction ŝ, y to its left, z up.  The axle is −y: a positive rate
        # moves the lowest point along +x.  The lowest roller's axle is ŝ turned by the roller angle.
        about = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
        axle, outward = about @ [np.cos(slant), np.sin(slant), 0.0], about @ [0.0, 0.0, -1.0]
        parts.append(
            f'<body pos="{_text(*roller.centre_m * outward)}" xyaxes="{_text(*axle, *outward)}">'
            f'<joint name="roller{i}_{k}" type="hinge" axis="1 0 0"/>'
            f'<inertial pos="0 0 0" mass="{each:.9g}"'
            f' diaginertia="{_text(*np.array([0.5, 0.6, 0.6]) * each * roller.b_m**2)}"/>'
            f'<geom name="roller{i}_{k}" type="ellipsoid" size="{_text(roller.a_m, roller.b_m, roller.b_m)}"'
            f' contype="1" conaffinity="0" condim="3" priority="1" friction="{mu} 0 0"/></body>'
        )
    return (
        f'<body name="wheel{i}" pos="{_text(*wheel.position_m, radius)}" euler="0 0 {turn:.15g}">'
        f'<joint name="suspension{i}" type="slide" axis="0 0 1" stiffness="{stiffness:.9g}"'
        f' damping="{damping:.9g}" springref="{-build.sag * radius:.9g}"'
        f' armature="{build.inerter * carried_kg:.9g}"/>'
        f'<joint name="axle{i}" type="hinge" axis="0 -1 0"'
        f' armature="{build.rotor * carried_kg * radius**2:.9g}"/>'
        f'<inertial pos="0 0 0" mass="{hub:.9g}"'
        f' diaginertia="{_text(*np.array([0.25, 0.5, 0.25]) * hub * radius**2)}"/>{"".join(parts)}</body>'
    )


def axle_servo_xml(i: int, wheel: Wheel, build: Build, carried_kg: float) -> str:
    """A speed servo on the axle of wheel ``i``, as stiff as the time step bears."""
    stiff = 0.5 * build.rotor * carried_kg * wheel.radius_m**2 / build.step_s
    return f'<velocity joint="axle{i}" kv="{stiff:.9g}"/>'


def world_xml(build: Build, bodies: str, servos: str) -> str:
    """The floor, the gravity, and how exactly contacts and bearings hold."""
    x, y = build.slope
    gravity = GRAVITY * np.array([x, y, -np.sqrt(1.0 - x * x - y * y)])
    return f"""<mujoco><compiler angle="radian"/>
<option timestep="{build.step_s}" cone="elliptic" impratio="100" integrator="implicitfast"
 gravity="{_text(*gravity)}" iterations="50" tolerance="1e-10"/>
<default><geom mass="0" solref="{build.soft_s} 1" solimp="0.9 0.9 0.001"/>
<joint solreffriction="{2 * build.step_s} 1" solimpfriction="0.9999 0.9999 0.001"/></default>
<worldbody><geom name="floor" type="plane" size="9 9 1" contype="0" conaffinity="1" condim="3"/>
{bodies}</worldbody><actuator>{servos}</actuator></mujoco>"""


class Rollers:
    """A scene with N wheels whose rollers bear as much as their bearings' coefficient says."""

    def __init__(self, xml: str, wheels: tuple[Wheel, ...], build: Build, transverse: float) -> None:
        self.build, self.wheels = build, wheels
        self.world = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.world)
        names = [[f"roller{i}_{k}" for k in range(build.rollers)] for i in range(len(wheels))]
        self._dof = np.array([[self.world.joint(name).dofadr[0] for name in row] for row in names])
        self._geom = np.array([[self.world.geom(name).id for name in row] for row in names])
        self.axle_dof = np.array([self.world.joint(f"axle{i}").dofadr[0] for i in range(len(wheels))])
        self._axle_q = np.array([self.world.joint(f"axle{i}").qposadr[0] for i in range(len(wheels))])
        self._place = 2.0 * np.pi * np.arange(build.rollers) / build.rollers
        self._transverse = transverse
        self._alpha = np.linspace(0.0, 4.0 * np.pi / build.rollers, 30)
        self._levers = [roller_of(wheel, build).lever_m(self._alpha) for wheel in wheels]
        self.pressed = self.roller_loads()

    def roller_loads(self) -> np.ndarray:
        """Normal force of the floor on every roller now (N, rollers) [N]."""
        contact = self.data.contact
        on = contact.efc_address >= 0
        geom = np.max(contact.geom[on], axis=1)  # the floor is geom 0
        force = np.bincount(geom, self.data.efc_force[contact.efc_address[on]], minlength=self.world.ngeom)
        return force[self._geom]

    def bearing_torque(self) -> np.ndarray:
        """Friction of every roller's bearing (N, rollers) [N m]: at the floor it is μ_T times the load."""
        alpha = self.data.qpos[self._axle_q][:, None] + self._place
        away = np.abs(np.mod(alpha + np.pi, 2.0 * np.pi) - np.pi)
        lever = [np.interp(a, self._alpha, values) for a, values in zip(away, self._levers, strict=True)]
        return self._transverse * self.pressed * np.array(lever)

    def advance(self, command: np.ndarray) -> np.ndarray:
        """One tick; normal force on every wheel (N,) [N]."""
        self.world.dof_frictionloss[self._dof] = self.bearing_torque()
        self.data.ctrl[:] = command
        mujoco.mj_step(self.world, self.data, round(self.build.tick_s / self.build.step_s))
        now = self.roller_loads()
        self.pressed = 0.5 * (self.pressed + now)
        return now.sum(axis=1)


@dataclass(frozen=True, kw_only=True)
class Log:
    """What the engine did, once a tick (T): pose of the origin, its twist in the body frame, slips, loads.

    ``slip_m_s`` (T, N) is u·ĝ: along the grip, against no-slip rolling; ``load_N`` (T, N) normal forces.
    """

    t_s: np.ndarray
    pose: np.ndarray
    twist: np.ndarray
    slip_m_s: np.ndarray
    load_N: np.ndarray

    def part(self, start_s: float, end_s: float) -> Log:
        """The ticks within a window."""
        on = (self.t_s > start_s + 1e-9) & (self.t_s < end_s + 1e-9)
        return Log(
            t_s=self.t_s[on],
            pose=self.pose[on],
            twist=self.twist[on],
            slip_m_s=self.slip_m_s[on],
            load_N=self.load_N[on],
        )

    def creep(self) -> np.ndarray:
        """Slipped distance of each wheel (N,) per distance that the wheel's centre went."""
        return np.abs(np.mean(self.slip_m_s, axis=0)) / np.mean(np.hypot(*self.twist[:, :2].T))


class Engine(Rollers):
    """A robot on its rollers: it settles when it is made, then follows commanded wheel speeds.

    Mass, centre of mass (with its height) and yaw inertia of the whole are the data sheet's.
    """

    def __init__(self, robot: Robot, surface: str, build: Build | None = None) -> None:
        build, body, n = build or Build(), robot.body, len(robot.wheels)
        coefficients, carried = robot.surface(surface).roller, body.mass_kg / n
        each, rest = build.light * body.mass_kg / n, (1.0 - build.light) * body.mass_kg
        place = np.array([[*w.position_m, w.radius_m] for w in robot.wheels])
        centre = (body.mass_kg * np.array([*body.com_m, body.com_height_m]) - each * place.sum(axis=0)) / rest
        arms = np.sum((place[:, :2] - body.com_m) ** 2, axis=1)
        in_wheels = each * np.sum(
            arms + 0.3 * place[:, 2] ** 2
        )  # a wheel about its own upright axis: 0.3 m ρ²
        yaw = body.inertia_kg_m2 - in_wheels - rest * np.sum((centre[:2] - body.com_m) ** 2)
        if yaw <= 0.0:
            raise ValueError("the wheels have more yaw inertia than the whole robot: make them lighter")
        wheels = [
            wheel_xml(i, w, build, mu=coefficients.drive, mass_kg=each, carried_kg=carried)
            for i, w in enumerate(robot.wheels)
        ]
        servos = [axle_servo_xml(i, w, build, carried) for i, w in enumerate(robot.wheels)]
        bodies = (
            f'<body name="robot"><freejoint/><inertial pos="{_text(*centre)}" mass="{rest:.12g}"'
            f' diaginertia="{_text(0.6 * yaw, 0.6 * yaw, yaw)}"/>{"".join(wheels)}</body>'
        )
        super().__init__(
            world_xml(build, bodies, "".join(servos)), robot.wheels, build, coefficients.transverse
        )
        self.geometry = nominal_model(robot, surface).geometry
        self.run(lambda t: np.zeros(n), 0.2)
        self.data.qpos[:2] = 0.0
        self.data.time = 0.0

    def run(self, speeds: Callable[[float], np.ndarray], duration_s: float) -> Log:
        """Follow wheel speeds ``speeds(t)`` (N,) [rad/s] for a time from now on."""
        data, g, tick = self.data, self.geometry, self.build.tick_s
        hubs, along = g.hub_rows(), g.radius_m * np.sum(g.drive * g.grip, axis=1)
        rows: list[tuple[float, list[float], np.ndarray, np.ndarray, np.ndarray]] = []
        start = data.time
        for k in range(round(duration_s / tick)):
            load = self.advance(speeds(start + (k + 0.5) * tick))
            heading = 2.0 * np.arctan2(data.qpos[6], data.qpos[3])
            c, s = np.cos(heading), np.sin(heading)
            vx, vy = data.qvel[:2]
            twist = np.array([c * vx + s * vy, c * vy - s * vx, data.qvel[5]])
            slip = np.sum((hubs @ twist) * g.grip, axis=1) + along * data.qvel[self.axle_dof]
            rows.append((data.time, [data.qpos[0], data.qpos[1], heading], twist, slip, load))
        t, pose, twists, slips, loads = (np.array(column) for column in zip(*rows, strict=True))
        return Log(t_s=t, pose=pose, twist=twists, slip_m_s=slips, load_N=loads)


@dataclass(frozen=True, kw_only=True)
class MovingOff:
    """A crawl at full drag, then a constant acceleration along a body direction, the heading held.

    ``acceleration_m_s2`` comes on within ``rise_s`` and is held for ``hold_s``; the crawl is reached gently.
    """

    heading_rad: float
    acceleration_m_s2: float
    crawl_m_s: float = 0.03
    rise_s: float = 0.1
    hold_s: float = 0.7

    @property
    def _gentle(self) -> float:
        return min(0.3 * abs(self.acceleration_m_s2), 0.3)

    @property
    def start_s(self) -> float:
        """When the crawl ends."""
        return self.crawl_m_s / self._gentle + 0.1

    @property
    def steady_s(self) -> float:
        """When the acceleration is all there."""
        return self.start_s + self.rise_s

    @property
    def end_s(self) -> float:
        """When the motion ends."""
        return self.steady_s + self.hold_s

    @property
    def direction(self) -> np.ndarray:
        """The unit body twist."""
        return np.array([np.cos(self.heading_rad), np.sin(self.heading_rad), 0.0])

    def speed(self, t: float) -> float:
        """Commanded speed at a time [m/s]."""
        if t < self.start_s:
            return min(self._gentle * t, self.crawl_m_s)
        after = t - self.start_s
        rising = min(after, self.rise_s)
        whole = 0.5 * rising**2 / self.rise_s + max(after - self.rise_s, 0.0)
        return self.crawl_m_s + self.acceleration_m_s2 * whole

    def drive(self, engine: Engine) -> Log:
        """The whole motion in an engine."""
        per_speed = engine.geometry.wheel_speeds(self.direction)
        return engine.run(lambda t: per_speed * self.speed(t), self.end_s)


class Trolley(Rollers):
    """One wheel, locked at an angle, under a weight that is pulled over the floor without turning."""

    def __init__(
        self, robot: Robot, surface: str, wheel: int, *, angle_rad: float = 0.0, build: Build | None = None
    ) -> None:
        build, carried = build or Build(rotor=1e4), robot.body.mass_kg / len(robot.wheels)
        alone, coefficients = robot.wheels[wheel], robot.surface(surface).roller
        x, y = alone.position_m
        inside = wheel_xml(
            0, alone, build, mu=coefficients.drive, mass_kg=build.light * carried, carried_kg=carried
        )
        stiff = 0.5 * carried / build.step_s
        bodies = (
            '<body name="trolley"><joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide"'
            ' axis="0 1 0"/><joint name="z" type="slide" axis="0 0 1"/>'
            f'<inertial pos="{x} {y} 0" mass="{(1.0 - build.light) * carried:.12g}"'
            f' diaginertia="1 1 1"/>{inside}</body>'
        )
        pullers = "".join(f'<velocity joint="{axis}" kv="{stiff:.9g}"/>' for axis in "xy")
        super().__init__(
            world_xml(build, bodies, pullers + axle_servo_xml(0, alone, build, carried)),
            (alone,),
            build,
            coefficients.transverse,
        )
        self.weight_N = carried * GRAVITY
        self.data.joint("axle0").qpos[0] = angle_rad

    def pull(self, direction: np.ndarray, speed_m_s: float = 0.02) -> np.ndarray:
        """Mean force (2,) that a steady pull takes, as a share of the weight."""
        for _ in range(100):
            self.advance(np.zeros(3))
        forces = []
        for _ in range(300):
            self.advance(np.array([*direction * speed_m_s, 0.0]))
            forces.append(self.data.actuator_force[:2].copy())
        return np.mean(forces[100:], axis=0) / self.weight_N
