"""What ``slipmargin simulate`` computes, and its words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.table import Columns, columns_text, read_columns
from slipmargin.io.writes import check_writable, write_text
from slipmargin.model import Model
from slipmargin.sim.batch import Push
from slipmargin.sim.run import Run
from slipmargin.sim.signal import WheelSignal, held, linear
from slipmargin.sim.simulate import simulate

from .render import refuse

_POSE, _VELOCITY = ("x_m", "y_m", "phi_rad"), ("vx_m_s", "vy_m_s", "wz_rad_s")
_ACCELERATION = ("ax_m_s2", "ay_m_s2", "alpha_rad_s2")
_MOST = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """A run, and where the plan it followed wanted to end (None for bare commands)."""

    model: Model
    run: Run
    planned_end: Array | None

    def write(self, out: Path | None, plot: Path | None) -> None:
        """The CSV and the figure; the figure is drawn before the CSV is written."""
        if plot is not None:
            from slipmargin.plots.motion import run_figure
            from slipmargin.plots.style import save

            save(run_figure(self.run, f"{self.model.robot}, surface “{self.model.surface}”"), plot)
        if out is not None:
            write_text(out, columns_text(self.run.columns(), digits=12))

    def as_json(self) -> dict[str, Any]:
        """The contract's columns and what stands on stdout."""
        return {
            "schema": 1,
            "robot": self.model.robot,
            "surface": self.model.surface,
            "end_pose": self.run.pose[-1],
            "planned_end_pose": self.planned_end,
            "friction_work_J": self._work(),
            "peak_drive_slip_m_s": np.abs(self.run.slip[..., 0]).max(axis=0),
            "least_load_N": self.run.load.min(axis=0),
            **self.run.columns(),
        }

    def _work(self) -> float:
        power, t = self.run.friction_power_W, self.run.t_s
        return float(np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(t)))

    def lines(self) -> list[str]:
        """Lines for stdout."""
        run = self.run
        x, y, phi = run.pose[-1]
        slip = np.abs(run.slip[..., 0])
        when, wheel = np.unravel_index(int(np.argmax(slip)), slip.shape)
        lines = [
            f"ends at x {x:.4f} m, y {y:.4f} m, φ {phi:.4f} rad after {run.duration_s:.3g} s "
            f"({self.model.robot} on {self.model.surface})",
            f"largest drive slip {slip[when, wheel]:.4g} m/s, "
            f"wheel {run.wheels[wheel]} at {run.t_s[when]:.3g} s; "
            f"sliding takes {-self._work():.3g} J",
        ]
        if self.planned_end is not None:
            miss = run.pose[-1] - self.planned_end
            lines.append(
                f"misses the planned end by {1e3 * math.hypot(*miss[:2]):.2f} mm and {miss[2]:.4f} rad"
            )
        return lines


def run_simulation(
    model: Model,
    file: Path,
    theta0: str | None,
    step: float,
    until: float | None,
    push: str | None,
    rtol: float,
    outputs: tuple[Path | str | None, ...],
) -> Simulation:
    """Read, check, simulate; outputs are checked before any work is done.

    Raises
    ------
    InputError
        Placed at the option or in the file of commands.
    MotionStopped
        If the robot tips or the motion overflows.
    """
    check_writable(*outputs)
    if outputs[1] is not None:
        from slipmargin.plots.style import check_format

        check_format(outputs[1])
    if not 1e-13 <= rtol <= 0.1:
        refuse("--rtol", f"is {rtol:g}", "give a relative error between 1e-13 and 0.1")
    angles = np.zeros(model.count) if theta0 is None else _numbers("--theta0", theta0, model.count)
    wrench = None if push is None else _numbers("--push", push, 3)
    try:
        signal, start, twist, goal = _read(model, file, angles, until)
    except InputError as fault:
        raise fault.in_file(fault.source or str(file)) from None
    first, last = float(signal.knots_s[0]), float(signal.knots_s[-1])
    if not 0.0 < step < math.inf or (last - first) / step > _MOST:
        refuse("--step", f"is {step:g} s over {last - first:g} s", f"give 1 to {_MOST} rows")
    rows = max(round((last - first) / step), 1)
    times = (
        np.linspace(first, last, rows + 1)
        if abs(rows * step - (last - first)) < 1e-9
        else np.append(np.arange(first, last, step), last)
    )
    outside = None if wrench is None else Push(t_s=np.array([first, last]), wrench=np.stack([wrench, wrench]))
    run = simulate(
        model, signal, times, commanded=True, start_pose=start, start_twist=twist, push=outside, rtol=rtol
    )
    return Simulation(model=model, run=run, planned_end=goal)


def _read(
    model: Model, file: Path, angles: Array, until: float | None
) -> tuple[WheelSignal, Array | None, Array | None, Array | None]:
    speeds = [f"omega{i + 1}_rad_s" for i in range(model.count)]
    plan = (*_POSE, *_VELOCITY, *_ACCELERATION, *(f"use{i + 1}" for i in range(model.count)))
    table = read_columns(file, required=("t_s", *speeds), known=plan, empty=None, least=1)
    _filled(table, ("t_s", *speeds))
    t, omega = table["t_s"], table.stack(speeds)
    _allowed(model, table, omega, speeds)
    if until is not None and not t[-1] < until < math.inf:
        refuse("--until", f"is {until:g} s", f"give a time after the last row, {t[-1]:g} s")
    if any(name in table.names for name in _POSE):
        for name in _POSE:
            if name not in table.names:
                raise InputError(
                    name, "this column is missing", "a planned trajectory needs x_m, y_m and phi_rad"
                )
        _filled(table, _POSE)
        pose = table.stack(_POSE)
        twist = None
        if all(name in table.names for name in _VELOCITY):
            _filled(table, _VELOCITY)
            twist = table.stack(_VELOCITY)[0]
        if until is not None:
            refuse("--until", "is for bare commands", "leave it out, a plan ends where it ends")
        return linear(t, omega, theta0=angles, spin=omega[0]), pose[0], twist, pose[-1]
    if len(t) == 1 and until is None:
        raise InputError("t_s", "there is one row and no end", "give a second row, or --until")
    return held(t, omega, end_s=until, theta0=angles), None, None, None


def _filled(table: Columns, names: tuple[str, ...]) -> None:
    for name in names:
        gaps = np.flatnonzero(~np.isfinite(table[name]))
        if len(gaps):
            line = table.lines[gaps[0]]
            raise InputError(
                f"{line}:{table.names.index(name) + 1}", f"{name} is empty or not finite", "give a number"
            )


def _allowed(model: Model, table: Columns, omega: Array, speeds: list[str]) -> None:
    most = model.drives.max_speed_rad_s
    if most is None:
        return
    over = np.argwhere(np.abs(omega) > most * (1.0 + 1e-9))
    if len(over):
        row, i = over[0]
        raise InputError(
            f"{table.lines[row]}:{table.names.index(speeds[i]) + 1}",
            f"{speeds[i]} is {omega[row, i]:g}, the motor reaches {most:g} rad/s",
            "command less, or correct motor.max_speed_rad_s",
        )


def _numbers(option: str, text: str, count: int) -> Array:
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(math.isfinite(v) for v in values):
        refuse(option, f"is {text!r}", f"give {count} numbers with commas between")
    return np.array(values)
