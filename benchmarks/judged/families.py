"""The families of undeclared effects: what is planted, how large it may be, and what is true of it.

A family draws its directions and places once (:class:`Draw`) and then applies itself at a size between 0
(nothing) and 1 (as large as is plausible).  README.md describes every family in words.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from judged.motions import RunPlan, Tables, lagging_tables, play_tables
from judged.robots import Wishes
from judged.simulator import GRAVITY, Array, Machine, Physics, sharing, transfer

#: (times of the fine poses, fine poses, times of the rows) → poses at the rows, as the camera reports them.
Camera = Callable[[Array, Array, Array], Array]


def at_rows(fine_s: Array, fine: Array, rows_s: Array) -> Array:
    """A camera without fault."""
    return np.asarray(CubicSpline(fine_s, fine)(np.clip(rows_s, fine_s[0], fine_s[-1])))


@dataclass(frozen=True, slots=True, kw_only=True)
class Planted:
    """The robot, physics, drives and camera of a set at one size of its effect."""

    machine: Machine
    physics: Physics = field(default_factory=Physics)
    tables: Callable[[RunPlan], Tables] | None = None
    camera: Camera = at_rows
    parameters: dict[str, float] = field(default_factory=dict)
    wheels: tuple[int, ...] = ()  #: counted from 1; empty: all, or the whole robot


Apply = Callable[[float], Planted]


@dataclass(frozen=True, slots=True, kw_only=True)
class Draw:
    """What a family may draw from."""

    rng: np.random.Generator
    machine: Machine
    runs: list[RunPlan]

    def a_wheel(self) -> int:
        return int(self.rng.integers(len(self.machine.radius)))

    def sign(self) -> float:
        return float(self.rng.choice([-1.0, 1.0]))

    def angle(self) -> float:
        return float(self.rng.uniform(0.0, 2.0 * np.pi))

    def visited(self) -> Array:
        """A floor place (2,) that some run meets, by its commands without slip."""
        run = self.runs[int(self.rng.integers(len(self.runs)))]
        track = no_slip_track(self.machine, run)
        middle = track[int(self.rng.uniform(0.2, 0.9) * len(track))]
        wheel = self.machine.position[self.a_wheel()]
        c, s = np.cos(middle[2]), np.sin(middle[2])
        return np.asarray(middle[:2] + np.array([c * wheel[0] - s * wheel[1], s * wheel[0] + c * wheel[1]]))


def no_slip_track(machine: Machine, run: RunPlan) -> Array:
    """(R, 3) pose if no wheel slipped; rough, for placing things on the floor."""
    p, g = machine.position, machine.grip
    rows = np.column_stack([g, p[:, 0] * g[:, 1] - p[:, 1] * g[:, 0]])
    rim = -run.command * machine.radius * np.sum(machine.drive * g, axis=1)
    twist = rim @ np.linalg.pinv(rows).T
    step = np.diff(run.rows_s, prepend=0.0)
    phi = run.start[2] + np.cumsum(twist[:, 2] * step)
    c, s = np.cos(phi), np.sin(phi)
    x = run.start[0] + np.cumsum((c * twist[:, 0] - s * twist[:, 1]) * step)
    y = run.start[1] + np.cumsum((s * twist[:, 0] + c * twist[:, 1]) * step)
    return np.column_stack([x, y, phi])


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """A kind of undeclared physics.

    Parameters
    ----------
    name : str
        What it is called here.
    catalogue : str or None
        The catalogue's name where the catalogue holds it exactly.
    variable : str
        What it depends on, in the words of ``report.json``'s ``traced_to``.
    also : tuple of str
        Variables that are as right.
    draws : function
        Draws places and directions, returns what applies the effect at a size from 0 to 1.
    held_back : bool
        True: never drawn for development.
    covered : bool
        True: exact and continuous in its parameters, so that intervals can be judged.
    """

    name: str
    catalogue: str | None
    variable: str
    draws: Callable[[Draw], Apply]
    also: tuple[str, ...] = ()
    held_back: bool = False
    covered: bool = False
    commanded: bool = False
    spread: bool = False
    theta: bool = False
    hardest: float = 1.0
    wishes: Wishes = field(default_factory=Wishes)


def _put(a: Array, i: int, value: float) -> Array:
    out = np.array(a)
    out[i] = value
    return out


# --- effects that the catalogue holds ----------------------------------------------------------------------


def _friction(d: Draw) -> Apply:
    drive, across = d.rng.uniform(-1, 1), d.rng.uniform(-1, 1)

    def apply(s: float) -> Planted:
        a, b = float(np.exp(0.7 * s * drive)), float(np.exp(1.0 * s * across))
        m = d.machine
        m = m._replace(mu_drive=m.mu_drive * a, mu_transverse=m.mu_transverse * b)
        return Planted(machine=m, parameters={"drive_factor": a, "transverse_factor": b})

    return apply


def _rigid(d: Draw) -> Apply:
    def apply(s: float) -> Planted:
        c = 0.3 * s
        m = d.machine._replace(rigid_fraction=np.full_like(d.machine.radius, c))
        return Planted(machine=m, parameters={"rigid_fraction": c})

    return apply


def _loads(d: Draw) -> Apply:
    to, payload = d.angle(), float(d.rng.random() < 0.5)
    reach = 0.35 * float(np.mean(np.hypot(*d.machine.position.T)))

    def apply(s: float) -> Planted:
        m, shift = d.machine, s * reach * np.array([np.cos(to), np.sin(to)])
        rest = m.rest + m.mass * GRAVITY * sharing(m.position)[:, 1:] @ shift
        m = m._replace(rest=rest, com=m.com + payload * shift)
        return Planted(
            machine=m,
            parameters={"shift_x_m": float(shift[0]), "shift_y_m": float(shift[1]), "com_share": payload},
        )

    return apply


def _transfer(d: Draw) -> Apply:
    reach = float(np.mean(np.hypot(*d.machine.position.T)))

    def apply(s: float) -> Planted:
        h = 1.2 * s * reach
        m = d.machine._replace(per_acceleration=transfer(d.machine, h))
        return Planted(machine=m, parameters={"com_height_m": h})

    return apply


def _stribeck(d: Draw) -> Apply:
    speed = float(np.exp(d.rng.uniform(np.log(0.01), np.log(0.06))))

    def apply(s: float) -> Planted:
        ratio = 1.0 - 0.6 * s
        return Planted(
            machine=d.machine,
            physics=Physics(stribeck=ratio, stribeck_speed=speed),
            parameters={"dynamic_ratio": ratio, "stribeck_speed_m_s": speed},
        )

    return apply


def _coupled(shape: int) -> Callable[[Draw], Apply]:
    def draws(d: Draw) -> Apply:
        return lambda s: Planted(
            machine=d.machine._replace(shape=shape, coupling=s), parameters={"strength": float(s)}
        )

    return draws


def _rolling(d: Draw) -> Apply:
    mix = d.rng.choice([0.0, 1.0, float(d.rng.random())])

    def apply(s: float) -> Planted:
        mu = float(np.mean(d.machine.mu_drive))
        c = float(0.25 * s * mu * mix)
        b = float(0.6 * s * mu * (1 - mix) * d.machine.mass * GRAVITY)
        return Planted(
            machine=d.machine,
            physics=Physics(roll_coulomb=c, roll_viscous=b),
            parameters={"coefficient": c, "viscous_N_s_per_m": b},
        )

    return apply


def _tilt(d: Draw) -> Apply:
    to = d.angle()

    def apply(s: float) -> Planted:
        x, y = 0.06 * s * np.cos(to), 0.06 * s * np.sin(to)
        return Planted(
            machine=d.machine,
            physics=Physics(tilt_x=float(x), tilt_y=float(y)),
            parameters={"tilt_x_rad": float(x), "tilt_y_rad": float(y)},
        )

    return apply


def _nap(d: Draw) -> Apply:
    to = d.angle()

    def apply(s: float) -> Planted:
        x, y = float(0.5 * s * np.cos(to)), float(0.5 * s * np.sin(to))
        return Planted(
            machine=d.machine, physics=Physics(nap_x=x, nap_y=y), parameters={"nap_x": x, "nap_y": y}
        )

    return apply


def _tether(slack: bool) -> Callable[[Draw], Apply]:
    def draws(d: Draw) -> Apply:
        to, far = d.angle(), d.rng.uniform(0.4, 1.2)
        x, y = float(far * np.cos(to)), float(far * np.sin(to))
        loose = float(d.rng.uniform(0.5, 0.9) * far) if slack else 0.0

        def apply(s: float) -> Planted:
            weight = d.machine.mass * GRAVITY * float(np.mean(d.machine.mu_drive))
            k = float(0.4 * s * weight * (3.0 if slack else 1.0))
            told = {"stiffness_N_per_m": k, "anchor_x_m": x, "anchor_y_m": y}
            return Planted(
                machine=d.machine,
                physics=Physics(tether_k=k, tether_x=x, tether_y=y, tether_slack=loose),
                parameters=told | ({"slack_m": loose} if slack else {}),
            )

        return apply

    return draws


def _radius(d: Draw) -> Apply:
    i, sign = d.a_wheel(), d.sign()

    def apply(s: float) -> Planted:
        factor = 1.0 + 0.12 * s * sign
        m = d.machine
        m = m._replace(radius=_put(m.radius, i, m.radius[i] * factor))
        return Planted(machine=m, parameters={"radius_factor": factor}, wheels=(i + 1,))

    return apply


def _toe(d: Draw) -> Apply:
    i, sign = d.a_wheel(), d.sign()

    def apply(s: float) -> Planted:
        toe = 0.2 * s * sign
        c, n = np.cos(toe), np.sin(toe)
        turn = np.array([[c, -n], [n, c]])
        m = d.machine
        new = {}
        for name in ("drive", "grip", "free"):
            new[name] = np.array(getattr(m, name))
            new[name][i] = turn @ new[name][i]
        return Planted(machine=m._replace(**new), parameters={"toe_rad": toe}, wheels=(i + 1,))

    return apply


def _lag(d: Draw) -> Apply:
    delay = float(d.rng.choice([0.0, d.rng.uniform(0.01, 0.05)]))

    def apply(s: float) -> Planted:
        lag = 0.15 * s
        late = delay * min(1.0, 4.0 * s)

        def tables(run: RunPlan) -> Tables:
            return lagging_tables(run.command, run.sub * run.every, run.h, run.theta0, lag, late)

        return Planted(
            machine=d.machine, tables=tables if s > 0.0 else None, parameters={"lag_s": lag, "delay_s": late}
        )

    return apply


def _droop(d: Draw) -> Apply:
    def apply(s: float) -> Planted:
        m = d.machine
        torque = float(np.mean(m.mu_drive * m.rest * m.radius))
        droop = float(0.25 * s / float(np.mean(m.radius)) / torque)
        return Planted(machine=m, physics=Physics(droop=droop), parameters={"droop_rad_s_per_N_m": droop})

    return apply


def _scale(d: Draw) -> Apply:
    a, b = d.rng.uniform(-1, 1, size=2)

    def apply(s: float) -> Planted:
        x, y = 1.0 + 0.15 * s * a, 1.0 + 0.15 * s * b
        return Planted(
            machine=d.machine,
            camera=lambda t, p, r: at_rows(t, p, r) * np.array([x, y, 1.0]),
            parameters={"scale_x": float(x), "scale_y": float(y)},
        )

    return apply


def _rotation(d: Draw) -> Apply:
    sign = d.sign()

    def apply(s: float) -> Planted:
        a = 0.3 * s * sign
        c, n = np.cos(a), np.sin(a)
        turn = np.array([[c, n, 0.0], [-n, c, 0.0], [0.0, 0.0, 1.0]])
        return Planted(
            machine=d.machine,
            camera=lambda t, p, r: at_rows(t, p, r) @ turn,
            parameters={"rotation_rad": float(a)},
        )

    return apply


def _delay(d: Draw) -> Apply:
    def apply(s: float) -> Planted:
        late = 0.15 * s
        return Planted(
            machine=d.machine,
            camera=lambda t, p, r: at_rows(t, p, r - late),
            parameters={"delay_s": late},
        )

    return apply


def _marker(d: Draw) -> Apply:
    to = d.angle()

    def apply(s: float) -> Planted:
        x, y = 0.12 * s * np.cos(to), 0.12 * s * np.sin(to)

        def camera(t: Array, p: Array, r: Array) -> Array:
            out = at_rows(t, p, r)
            c, n = np.cos(out[:, 2]), np.sin(out[:, 2])
            return np.column_stack([out[:, 0] + c * x - n * y, out[:, 1] + n * x + c * y, out[:, 2]])

        return Planted(
            machine=d.machine,
            camera=camera,
            parameters={"marker_x_m": float(x), "marker_y_m": float(y)},
        )

    return apply


def _gain(d: Draw) -> Apply:
    sign = d.sign()

    def apply(s: float) -> Planted:
        g = 1.0 + 0.2 * s * sign
        return Planted(
            machine=d.machine,
            camera=lambda t, p, r: (at_rows(t, p, r) - p[0]) * np.array([1.0, 1.0, g]) + p[0],
            parameters={"gain": g},
        )

    return apply


# --- inventions: the catalogue holds none of these ---------------------------------------------------------


def _patch(d: Draw) -> Apply:
    place, radius = d.visited(), float(d.rng.uniform(0.1, 0.3))
    more = bool(d.rng.random() < 0.25)

    def apply(s: float) -> Planted:
        change = float(0.8 * s if more else -0.75 * s)
        told = {"x_m": float(place[0]), "y_m": float(place[1]), "radius_m": radius, "relative_change": change}
        physics = Physics(patch_x=told["x_m"], patch_y=told["y_m"], patch_radius=radius, patch_change=change)
        return Planted(machine=d.machine, physics=physics, parameters=told)

    return apply


def _seam(d: Draw) -> Apply:
    place, across, width = d.visited(), d.angle(), float(d.rng.uniform(0.015, 0.04))

    def apply(s: float) -> Planted:
        at = float(place[0] * np.cos(across) + place[1] * np.sin(across))
        height = float(0.5 * s * width)
        return Planted(
            machine=d.machine,
            physics=Physics(seam_height=height, seam_width=width, seam_at=at, across=across),
            parameters={"height_m": height, "half_width_m": width, "at_m": at, "direction_rad": across},
        )

    return apply


def _ramp(d: Draw) -> Apply:
    place, across, length = d.visited(), d.angle(), float(d.rng.uniform(0.15, 0.5))
    where = float(d.rng.uniform(0.2, 0.8))

    def apply(s: float) -> Planted:
        at = float(place[0] * np.cos(across) + place[1] * np.sin(across)) - where * length
        slope = 0.1 * s
        return Planted(
            machine=d.machine,
            physics=Physics(ramp_slope=slope, ramp_from=at, ramp_to=at + length, across=across),
            parameters={"slope_rad": slope, "from_m": at, "to_m": at + length, "direction_rad": across},
        )

    return apply


def _fade(d: Draw) -> Apply:
    tau, sign = float(d.rng.uniform(0.5, 2.5)), float(d.rng.choice([1.0, 1.0, -0.7]))

    def apply(s: float) -> Planted:
        loss = 0.8 * s * sign
        return Planted(
            machine=d.machine,
            physics=Physics(fade=loss, fade_time=tau),
            parameters={"loss": loss, "time_s": tau},
        )

    return apply


def _push(d: Draw) -> Apply:
    at, width, to = float(d.rng.uniform(0.4, 1.4)), float(d.rng.uniform(0.03, 0.2)), d.angle()
    spin = float(d.rng.uniform(-0.1, 0.1))

    def apply(s: float) -> Planted:
        size = 3.0 * s * d.machine.mass * GRAVITY * float(np.mean(d.machine.mu_drive)) * 0.1 / width
        x, y = float(size * np.cos(to)), float(size * np.sin(to))
        moment = float(spin * size * np.mean(np.hypot(*d.machine.position.T)) * 5.0)
        return Planted(
            machine=d.machine,
            physics=Physics(push_at=at, push_width=width, push_x=x, push_y=y, push_moment=moment),
            parameters={"at_s": at, "width_s": width, "force_x_N": x, "force_y_N": y, "moment_N_m": moment},
        )

    return apply


def _round(d: Draw) -> Apply:
    i, phase = d.a_wheel(), d.angle()

    def apply(s: float) -> Planted:
        a = 0.15 * s
        return Planted(
            machine=d.machine,
            physics=Physics(round_wheel=float(i), out_of_round=a, round_phase=phase),
            parameters={"relative_amplitude": a, "phase_rad": phase},
            wheels=(i + 1,),
        )

    return apply


def _bent(d: Draw) -> Apply:
    i, phase = d.a_wheel(), d.angle()

    def apply(s: float) -> Planted:
        a = 0.25 * s
        return Planted(
            machine=d.machine,
            physics=Physics(bent_wheel=float(i), bent=a, bent_phase=phase),
            parameters={"toe_amplitude_rad": a, "phase_rad": phase},
            wheels=(i + 1,),
        )

    return apply


def _fourfold(d: Draw) -> Apply:
    at = float(d.rng.uniform(0.0, np.pi / 2))

    def apply(s: float) -> Planted:
        a = 0.6 * s
        return Planted(
            machine=d.machine,
            physics=Physics(fourfold=a, fourfold_at=at),
            parameters={"relative_amplitude": a, "direction_rad": at},
        )

    return apply


def _backlash(d: Draw) -> Apply:
    def apply(s: float) -> Planted:
        gap = 0.5 * s
        return Planted(
            machine=d.machine,
            tables=lambda run: play_tables(run.tables, run.h, gap),
            parameters={"gap_rad": gap},
        )

    return apply


def _sag(d: Draw) -> Apply:
    tau = float(d.rng.uniform(0.02, 0.15))

    def apply(s: float) -> Planted:
        m = d.machine
        torque = float(np.sum(m.mu_drive * m.rest * m.radius))
        sag = 0.6 * s / torque
        return Planted(
            machine=m,
            physics=Physics(sag=sag, sag_time=tau),
            parameters={"relative_per_N_m": sag, "time_s": tau},
        )

    return apply


def _flex(d: Draw) -> Apply:
    rate, damping = float(2 * np.pi * d.rng.uniform(2.0, 6.0)), float(d.rng.uniform(0.05, 0.3))
    reach = float(np.mean(np.hypot(*d.machine.position.T)))

    def apply(s: float) -> Planted:
        h = 1.0 * s * reach
        return Planted(
            machine=d.machine._replace(per_acceleration=transfer(d.machine, h)),
            physics=Physics(flex_rate=rate, flex_damping=damping),
            parameters={"com_height_m": h, "rate_rad_s": rate, "damping": damping},
        )

    return apply


def _stuck(d: Draw) -> Apply:
    i, at = d.a_wheel(), d.angle()
    pitch = float(2 * np.pi / d.machine.rollers[i])

    def apply(s: float) -> Planted:
        m = d.machine
        factor = 1.0 + s * (1.2 * float(m.mu_drive[i] / m.mu_transverse[i]) - 1.0)
        return Planted(
            machine=m,
            physics=Physics(stick_wheel=float(i), stick_from=at, stick_width=pitch, stick_factor=factor),
            parameters={"transverse_factor": factor, "from_rad": at, "width_rad": pitch},
            wheels=(i + 1,),
        )

    return apply


def _polish(d: Draw) -> Apply:
    length, sign = float(d.rng.uniform(0.05, 0.5)), float(d.rng.choice([1.0, 1.0, -0.7]))

    def apply(s: float) -> Planted:
        loss = 0.8 * s * sign
        return Planted(
            machine=d.machine,
            physics=Physics(polish=loss, polish_length=length),
            parameters={"loss": loss, "length_m": length},
        )

    return apply


def _castor(d: Draw) -> Apply:
    to, far = d.angle(), float(d.rng.uniform(0.3, 1.0) * np.mean(np.hypot(*d.machine.position.T)))
    x, y = float(far * np.cos(to)), float(far * np.sin(to))

    def apply(s: float) -> Planted:
        size = float(0.3 * s * d.machine.mass * GRAVITY * np.mean(d.machine.mu_drive))
        return Planted(
            machine=d.machine,
            physics=Physics(castor=size, castor_x=x, castor_y=y),
            parameters={"force_N": size, "x_m": x, "y_m": y},
        )

    return apply


def _twisted(d: Draw) -> Apply:
    sign = d.sign()

    def apply(s: float) -> Planted:
        m = d.machine
        reach = float(np.mean(np.hypot(*m.position.T)))
        moment = 0.4 * s * sign * m.mass * GRAVITY * float(np.mean(m.mu_drive)) * reach
        return Planted(
            machine=m, physics=Physics(twist_moment=moment), parameters={"moment_N_m": float(moment)}
        )

    return apply


def _lens(d: Draw) -> Apply:
    centre, sign = d.rng.uniform(-0.3, 0.3, size=2), d.sign()

    def apply(s: float) -> Planted:
        kappa = 0.6 * s * sign

        def camera(t: Array, p: Array, r: Array) -> Array:
            out = at_rows(t, p, r)
            off = out[:, :2] - centre
            out[:, :2] += kappa * np.sum(off**2, axis=1, keepdims=True) * off
            return out

        told = {"per_m2": float(kappa), "centre_x_m": float(centre[0]), "centre_y_m": float(centre[1])}
        return Planted(machine=d.machine, camera=camera, parameters=told)

    return apply


_PLAIN = Wishes(plain_loads=True)
_PLAIN_BOX = Wishes(plain_loads=True, box=True)
_BOX = Wishes(box=True)
_DRIVES = Wishes(no_motor=True, no_rigid=True)


def _known(name: str, variable: str, draws: Callable[[Draw], Apply], **more: Any) -> Family:
    more = {"covered": True} | more
    return Family(name=name, catalogue=name, variable=variable, draws=draws, **more)


CATALOGUE_FAMILIES = (
    _known("friction_coefficients", "coefficient", _friction),
    _known("rigid_sector", "wheel_angle", _rigid, theta=True, wishes=Wishes(no_rigid=True)),
    _known("wheel_loads", "wheel_load", _loads, wishes=_PLAIN),
    _known("load_transfer", "acceleration", _transfer, wishes=_PLAIN),
    _known("stribeck", "slip_speed", _stribeck, hardest=1.5, wishes=_BOX),
    _known("roller_coupling", "slip_coupling", _coupled(1), hardest=1.3, covered=False, wishes=_BOX),
    _known("elliptic_grip", "slip_coupling", _coupled(2), hardest=1.3, covered=False, wishes=_BOX),
    _known("rolling_resistance", "velocity", _rolling),
    _known("floor_tilt", "constant_force", _tilt, spread=True),
    _known("floor_nap", "heading", _nap, spread=True, wishes=_BOX),
    _known("tether", "position", _tether(False), spread=True, wishes=_PLAIN),
    _known("wheel_radius", "wheel", _radius),
    _known("wheel_toe", "wheel", _toe),
    _known("motor_lag", "actuation", _lag, commanded=True, wishes=_DRIVES),
    _known("speed_droop", "actuation", _droop, commanded=True, wishes=_DRIVES),
    _known("camera_scale", "measurement", _scale, spread=True),
    _known("camera_rotation", "measurement", _rotation),
    _known("camera_delay", "measurement", _delay),
    _known("marker_offset", "measurement", _marker),
    _known("heading_gain", "measurement", _gain),
)


def _new(name: str, variable: str, draws: Callable[[Draw], Apply], **more: Any) -> Family:
    return Family(name=name, catalogue=None, variable=variable, draws=draws, **more)


INVENTIONS = (
    _new("slick_patch", "position", _patch, spread=True),
    _new("floor_seam", "position", _seam, spread=True, held_back=True),
    _new("floor_ramp", "position", _ramp, spread=True),
    _new("fading_friction", "time", _fade),
    _new("push_event", "time", _push),
    _new("out_of_round_wheel", "wheel_angle", _round, theta=True),
    _new("bent_axle", "wheel_angle", _bent, theta=True),
    _new("fourfold_floor", "heading", _fourfold, spread=True, wishes=_BOX),
    _new("backlash", "actuation", _backlash, wishes=_DRIVES),
    _new("battery_sag", "actuation", _sag, commanded=True, held_back=True, wishes=_DRIVES),
    _new("chassis_flex", "acceleration", _flex, held_back=True, wishes=_PLAIN),
    _new("sticking_roller", "wheel_angle", _stuck, theta=True, held_back=True, wishes=_BOX),
    _new("dust_polish", "time", _polish, also=("slip_speed",), held_back=True),
    _new("dragging_castor", "velocity", _castor),
    _new("twisted_cable", "constant_force", _twisted),
    _new("slack_tether", "position", _tether(True), spread=True, held_back=True, wishes=_PLAIN),
    _new("lens_distortion", "measurement", _lens, also=("position",), spread=True, held_back=True),
)
FAMILIES = CATALOGUE_FAMILIES + INVENTIONS
#: Inventions that the catalogue has an equation of by now.
SINCE = (
    "backlash",
    "bent_axle",
    "dragging_castor",
    "floor_ramp",
    "floor_seam",
    "fourfold_floor",
    "lens_distortion",
    "out_of_round_wheel",
    "push_event",
    "slick_patch",
    "sticking_roller",
)
