"""Drawn runs: what the wheels are asked for, as tables for the simulator and as columns for the log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from judged.simulator import GRAVITY, Array, Machine, step_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Tables:
    """Wheel motion for the simulator: (S, 3, N) at the beginning, middle and end of each step."""

    theta: Array
    omega: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class RunPlan:
    """One run before anything happened."""

    start: Array  # (3,) pose
    rows_s: Array  # (R,) times of the log's rows
    sub: int  # poses kept per row
    every: int  # steps per kept pose
    h: float
    theta0: Array  # (N,)
    command: Array  # (R, N) speed asked for at each row; held to the next where the log is of commands
    tables: Tables  # of wheels that do as they are asked
    log_theta: Array  # (R, N)
    log_omega: Array  # (R, N)

    @property
    def fine_s(self) -> Array:
        """Times of the kept poses."""
        return np.arange((len(self.rows_s) - 1) * self.sub + 1) * (self.every * self.h)


def _no_slip(machine: Machine) -> Array:
    """(N, 3): wheel speed per body twist of the origin without slip along the grip."""
    p, g = machine.position, machine.grip
    rows = np.column_stack([g, p[:, 0] * g[:, 1] - p[:, 1] * g[:, 0]])
    return np.asarray(-rows / (machine.radius * np.sum(machine.drive * g, axis=1))[:, None])


def _twist(rng: np.random.Generator, machine: Machine, duration: float, hard: float) -> CubicSpline:
    """Body twist over time: rest, drawn motion, rest.  ``hard`` is the peak acceleration over μ_W g."""
    knots = np.arange(0.1, duration - 0.2, rng.uniform(0.35, 0.6))
    knots = np.append(knots, [duration - 0.15, duration])
    values = np.zeros((len(knots), 3))
    inner = slice(1, len(knots) - 2)
    count = len(values[inner])
    reach = float(np.mean(np.hypot(*machine.position.T)))
    style = int(rng.integers(5))
    if style == 0:  # straight there and back in a drawn direction
        beta, swing = rng.uniform(0, 2 * np.pi), rng.normal(size=count)
        values[inner, 0], values[inner, 1] = np.cos(beta) * swing, np.sin(beta) * swing
    elif style == 1:  # turning on the spot, a little drift
        values[inner, 2] = rng.normal(size=count) / reach
        values[inner, :2] = 0.2 * rng.normal(size=(count, 2))
    elif style == 2:  # a curve at speed
        beta = rng.uniform(0, 2 * np.pi)
        values[inner] = np.array([np.cos(beta), np.sin(beta), rng.uniform(-1.5, 1.5)]) * rng.uniform(
            0.6, 1.0, size=(count, 1)
        )
    else:
        values[inner] = rng.normal(size=(count, 3)) * np.array([1.0, 1.0, rng.uniform(0.2, 0.7) / reach])
    t = np.concatenate([[0.0], knots])
    spline = CubicSpline(t, np.vstack([np.zeros(3), values]), bc_type="clamped")
    fine = np.linspace(0.0, duration, 400)
    a = spline(fine, 1)
    peak = float(np.max(np.hypot(a[:, 0], a[:, 1]) + 0.6 * reach * np.abs(a[:, 2])))
    asked = hard * float(np.mean(machine.mu_drive)) * GRAVITY
    return CubicSpline(t, np.vstack([np.zeros(3), values]) * (asked / peak), bc_type="clamped")


def held_tables(command: Array, steps: int, h: float, theta0: Array) -> Tables:
    """Wheels that do exactly the command of each row until the next; ``steps`` of ``h`` per row."""
    omega = np.repeat(command[:-1], steps, axis=0)
    begin = theta0 + np.vstack([np.zeros(len(theta0)), np.cumsum(omega * h, axis=0)[:-1]])
    return Tables(
        theta=np.stack([begin, begin + 0.5 * h * omega, begin + h * omega], axis=1),
        omega=np.ascontiguousarray(np.stack([omega] * 3, axis=1)),
    )


def lagging_tables(command: Array, steps: int, h: float, theta0: Array, lag: float, delay: float) -> Tables:
    """Wheels that follow lag·ω̇ = command(t − delay) − ω, from rest."""
    count = len(command) - 1
    half = np.arange(2 * steps * count + 1) * (0.5 * h)
    row = np.floor((half[:-1] + 0.25 * h - delay) / (steps * h)).astype(int)
    asked = np.where((row >= 0)[:, None], command[np.clip(row, 0, count - 1)], 0.0)
    keep = np.exp(-0.5 * h / lag)
    omega = _filtered(asked, keep)
    theta = theta0 + np.vstack(
        [np.zeros(len(theta0)), np.cumsum(0.5 * (omega[1:] + omega[:-1]) * 0.5 * h, axis=0)]
    )
    return Tables(theta=_thirds(theta), omega=_thirds(omega))


@njit(cache=True)
def _filtered(asked: Array, keep: float) -> Array:
    out = np.zeros((asked.shape[0] + 1, asked.shape[1]))
    for j in range(asked.shape[0]):
        for i in range(asked.shape[1]):
            out[j + 1, i] = asked[j, i] + (out[j, i] - asked[j, i]) * keep
    return out


@njit(cache=True)
def _play(theta: Array, gap: float) -> Array:
    out = theta.copy()
    for i in range(theta.shape[1]):
        out[0, i] = theta[0, i]
        for j in range(1, theta.shape[0]):
            low, high = theta[j, i] - 0.5 * gap, theta[j, i] + 0.5 * gap
            out[j, i] = min(max(out[j - 1, i], low), high)
    return out


def play_tables(tables: Tables, h: float, gap: float) -> Tables:
    """Wheels behind gears with backlash: they move only where the motor has taken up the gap [rad]."""
    half = np.vstack([tables.theta[:, :2].reshape(-1, tables.theta.shape[2]), tables.theta[-1:, 2]])
    theta = _play(half, gap)
    omega = np.gradient(theta, 0.5 * h, axis=0)
    return Tables(theta=_thirds(theta), omega=_thirds(omega))


def _thirds(half: Array) -> Array:
    return np.ascontiguousarray(np.stack([half[:-1:2], half[1::2], half[2::2]], axis=1))


def draw_run(
    rng: np.random.Generator, machine: Machine, rate: int, *, spread: bool, commanded: bool, hardest: float
) -> RunPlan:
    """A run of 2 to 4 s; ``spread`` puts its start anywhere in half a metre and at any heading."""
    rows = int(rate * rng.uniform(2.0, 4.0)) + 1
    duration = (rows - 1) / rate
    sub = max(1, int(np.ceil(600 / rate)))
    every = int(np.ceil(1.0 / (rate * sub) / step_of(machine)))
    h = 1.0 / (rate * sub * every)
    twist = _twist(rng, machine, duration, hardest * rng.uniform(0.45, 1.0))
    rolls = _no_slip(machine)
    theta0 = rng.uniform(0.0, 2.0 * np.pi, size=len(rolls))
    start = rng.uniform(-0.01, 0.01, size=3)
    if spread:
        start = np.array([*rng.uniform(-0.5, 0.5, size=2), rng.uniform(-np.pi, np.pi)])
    t = np.arange(rows) / rate
    speed, way = twist, twist.antiderivative()
    command = speed(t) @ rolls.T
    if commanded:
        command = np.round(command, 6)
        tables = held_tables(command, sub * every, h, theta0)
    else:
        half = np.arange(2 * (rows - 1) * sub * every + 1) * (0.5 * h)
        tables = Tables(theta=_thirds(theta0 + way(half) @ rolls.T), omega=_thirds(speed(half) @ rolls.T))
    return RunPlan(
        start=start,
        rows_s=t,
        sub=sub,
        every=every,
        h=h,
        theta0=theta0,
        command=command,
        tables=tables,
        log_theta=theta0 + way(t) @ rolls.T,
        log_omega=speed(t) @ rolls.T,
    )
