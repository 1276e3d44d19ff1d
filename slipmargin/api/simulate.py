"""``slipmargin.simulate``: what the robot really does under wheel speeds that it is told."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, model_of
from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.paths.trajectory import Trajectory
from slipmargin.robot.mistakes import ABSURD_USE

if TYPE_CHECKING:
    from slipmargin.io.table import Columns
    from slipmargin.model import Model
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page
    from slipmargin.sim.run import Run
    from slipmargin.sim.signal import WheelSignal

_POSE, _VELOCITY = ("x_m", "y_m", "phi_rad"), ("vx_m_s", "vy_m_s", "wz_rad_s")
_ACCELERATION = ("ax_m_s2", "ay_m_s2", "alpha_rad_s2")
_MOST = 1_000_000
_AT_REST = (
    f"the plan's wheels turn at its first row and it has no {', '.join(_VELOCITY)}: the robot starts at rest"
)
#: Instants that the largest slip and the energy are taken from: so far apart [s], and no more than so many.
_FINE_S, _FINE_ROWS = 1e-3, 20_000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SimulationResult(Result):
    """A run, and where the plan it followed wanted to end (None for bare commands).

    ``run`` has the rows that were asked for; ``fine`` is the same motion at instants close enough that the
    largest slip, the least load and the energy do not depend on these rows.
    """

    model: Model
    run: Run
    fine: Run
    planned_end: Array | None
    warnings: tuple[str, ...]

    @property
    def peak_slip_m_s(self) -> float:
        """Largest drive slip of any wheel [m/s]."""
        return float(np.max(np.abs(self.fine.slip[..., 0])))

    def summary(self) -> str:
        """Where it ends and how much it slips."""
        x, y, phi = (round(float(v), 4) + 0.0 for v in self.run.pose[-1])  # no minus zero
        return (
            f"simulation of {self.model.robot} on {self.model.surface}: ends at x {x:.4f} m, y {y:.4f} m, "
            f"φ {phi:.4f} rad, drive slip up to {self.peak_slip_m_s:.4g} m/s"
        )

    def lines(self) -> list[str]:
        """End pose, largest slip, and how far it misses the plan."""
        from slipmargin.report.motion import run_lines

        return run_lines(self.fine, self.model, self._work(), self.planned_end)

    def plot(self) -> Figure:
        """Path, slip and forces over time."""
        from slipmargin.plots.motion import run_figure

        return run_figure(self.fine, f"{self.model.robot}, surface “{self.model.surface}”")

    def panels(self) -> dict[str, Figure]:
        """Each panel of :meth:`plot` as a figure of its own, by name: what a page shows."""
        from slipmargin.plots.motion import run_panels

        return run_panels(self.fine)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.motion_pages import simulate_page

        return simulate_page(
            self.fine,
            self.model,
            self._work(),
            self.planned_end,
            images(self.panels()),
            self.lines(),
            self.warnings,
        )

    def table_text(self) -> str:
        """The run in the contract's columns."""
        from slipmargin.io.table import columns_text

        return columns_text(self.run.columns(), digits=12)

    def to_dict(self) -> dict[str, Any]:
        """The contract's columns, the end pose, friction work, peak slip and least load."""
        return {
            "schema": 1,
            "robot": self.model.robot,
            "surface": self.model.surface,
            "end_pose": self.run.pose[-1],
            "planned_end_pose": self.planned_end,
            "friction_work_J": self._work(),
            "peak_drive_slip_m_s": np.abs(self.fine.slip[..., 0]).max(axis=0),
            "least_load_N": self.fine.load.min(axis=0),
            "lifts_s": self.run.lifts_s,
            "in_air_s": self.run.in_air_s,
            **self.run.columns(),
        }

    def _work(self) -> float:
        from slipmargin.physics.kinematics import integrated

        return float(integrated(self.fine.t_s, self.fine.friction_power_W)[-1])


def simulate(
    robot: RobotLike,
    surface: str,
    commands: Trajectory | Array | Path | str,
    *,
    linear: bool = False,
    wheel_angles_rad: Sequence[float] | Array | None = None,
    step_s: float = 0.01,
    until_s: float | None = None,
    push: Sequence[float] | Array | None = None,
    relative_error: float = 1e-7,
) -> SimulationResult:
    """The slipping motion under wheel speeds, or under a planned trajectory that is followed open loop.

    Friction follows the robot's friction law (eq. 11 of the paper unless its file names another).  Lag,
    delay and droop that the robot file lists act on the commands.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    commands : array (T, 1 + N), Trajectory, or a file
        Rows of t [s] and a wheel speed [rad/s] for each wheel, held until the next row; a planned
        trajectory (its wheel speeds are straight lines between rows, and the robot starts at its first pose
        and velocity); or a CSV of either.
    linear : bool
        Wheel speeds of an array are straight lines between rows instead of held.
    wheel_angles_rad : (N,), optional
        Wheel angles at the start [rad]; 0 where not given.
    step_s : float
        Time between rows of the result [s].
    until_s : float, optional
        Hold the last row until this time [s]; for bare commands.
    push : (3,), optional
        Constant force and moment on the centre of mass in floor axes [N, N, N m].
    relative_error : float
        Relative error allowed a step, 1e-13 to 0.1.

    Returns
    -------
    SimulationResult
        ``run`` holds ``t_s`` (M,), ``pose`` (M, 3), ``slip`` and ``force`` (M, N, 2) and more; velocities
        are in floor axes.

    Raises
    ------
    InputError
        For a fault in the robot file, the commands or an argument.
    MotionStopped
        If the robot tips or the motion overflows.  It tips where no three wheels carry it; while three do, a
        wheel may hang in the air: ``run.in_air_s`` says for how long each does, ``run.lifts_s`` from when on.

    Examples
    --------
    >>> import slipmargin as sm
    >>> forwards = [[0.0, -2.0, 2.0, 0.0], [1.0, -2.0, 2.0, 0.0]]  # t [s], three wheel speeds [rad/s]
    >>> found = sm.simulate("ohio-kiwi", "paper", forwards, step_s=0.1)
    >>> found.run.pose.shape
    (11, 3)
    """
    from slipmargin.sim.batch import Push
    from slipmargin.sim.simulate import simulate as run_simulation

    model, warnings = model_of(robot, surface)
    if not 1e-13 <= relative_error <= 0.1:
        raise InputError(
            "relative_error", f"is {relative_error:g}", "give a relative error between 1e-13 and 0.1"
        )
    angles = _numbers("wheel_angles_rad", wheel_angles_rad, model.count)
    wrench = _numbers("push", push, 3)
    reach = float(np.max(np.hypot(*model.geometry.position_m.T)))
    most = ABSURD_USE * model.inertia.weight_N * np.array([1.0, 1.0, reach])
    if np.any(np.abs(wrench) > most):
        raise InputError(
            "push",
            f"is {', '.join(f'{v:g}' for v in wrench)}; {ABSURD_USE:g} times the weight is {most[0]:.3g} N",
            "give newtons and newton metres",
        )
    signal, start, twist, goal = _commands(model, commands, angles, until_s, linear)
    if goal is not None and twist is None and np.any(signal.spin_rad_s):
        warnings = (*warnings, _AT_REST)
    first, last = float(signal.knots_s[0]), float(signal.knots_s[-1])
    if not 0.0 < step_s < math.inf or (last - first) / step_s > _MOST:
        raise InputError("step_s", f"is {step_s:g} s over {last - first:g} s", f"give 1 to {_MOST} rows")
    rows = max(round((last - first) / step_s), 1)
    times = (
        np.linspace(first, last, rows + 1)
        if abs(rows * step_s - (last - first)) < 1e-9
        else np.append(np.arange(first, last, step_s), last)
    )
    outside = None if push is None else Push(t_s=np.array([first, last]), wrench=np.stack([wrench, wrench]))
    close = max(_FINE_S, (last - first) / _FINE_ROWS)
    fine = np.linspace(first, last, max(2, math.ceil((last - first) / close) + 1))
    every = np.union1d(times, fine)
    run = run_simulation(
        model,
        signal,
        every,
        commanded=True,
        start_pose=start,
        start_twist=twist,
        push=outside,
        rtol=relative_error,
    )
    return SimulationResult(
        model=model,
        run=run.take(np.searchsorted(every, times)),
        fine=run.take(np.searchsorted(every, fine)),
        planned_end=goal,
        warnings=warnings,
    )


_Course = tuple["WheelSignal", "Array | None", "Array | None", "Array | None"]


def _commands(
    model: Model,
    commands: Trajectory | Array | Path | str,
    angles: Array,
    until_s: float | None,
    straight: bool,
) -> _Course:
    """Signal, start pose, start velocity and planned end."""
    from slipmargin.sim.signal import held, linear

    if isinstance(commands, Path | str):
        if straight:
            raise InputError("linear", "is for arrays", "leave it out, the file's columns say which it is")
        try:
            return _read(model, Path(commands), angles, until_s)
        except InputError as fault:
            if fault.place == "until_s":  # an argument, not the file
                raise
            raise fault.in_file(fault.source or str(commands)) from None
    if isinstance(commands, Trajectory):
        if until_s is not None:
            raise InputError("until_s", "is for bare commands", "leave it out, a plan ends where it ends")
        omega = commands.omega
        signal = linear(commands.t_s, omega, theta0=angles, spin=omega[0])
        return signal, commands.pose[0], commands.velocity[0], commands.pose[-1]
    rows = np.asarray(commands, dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 1 + model.count:
        raise InputError(
            "commands",
            f"have the shape {rows.shape}",
            f"give rows of t [s] and {model.count} wheel speeds [rad/s]",
        )
    if straight:
        if until_s is not None:
            raise InputError("until_s", "is for speeds that are held", "leave it out, or add a row")
        return linear(rows[:, 0], rows[:, 1:], theta0=angles), None, None, None
    return held(rows[:, 0], rows[:, 1:], end_s=until_s, theta0=angles), None, None, None


def _read(model: Model, file: Path, angles: Array, until_s: float | None) -> _Course:
    from slipmargin.io.table import read_columns
    from slipmargin.sim.signal import held, linear

    speeds = [f"omega{i + 1}_rad_s" for i in range(model.count)]
    plan = (*_POSE, *_VELOCITY, *_ACCELERATION, *(f"use{i + 1}" for i in range(model.count)))
    table = read_columns(file, required=("t_s", *speeds), known=plan, empty=None, least=1)
    _filled(table, ("t_s", *speeds))
    t, omega = table["t_s"], table.stack(speeds)
    _allowed(model, table, omega, speeds)
    if until_s is not None and not t[-1] < until_s < math.inf:
        raise InputError("until_s", f"is {until_s:g} s", f"give a time after the last row, {t[-1]:g} s")
    for group, needed_by in ((_POSE, plan), (_VELOCITY, _VELOCITY)):
        there = [name for name in needed_by if name in table.names]
        if there:
            for name in group:
                if name not in table.names:
                    cure = f"give {', '.join(group)} together"
                    raise InputError(name, f"this column is missing, and {there[0]} needs it", cure)
            _filled(table, group)
    if _POSE[0] in table.names:
        pose = table.stack(_POSE)
        twist = table.stack(_VELOCITY)[0] if _VELOCITY[0] in table.names else None
        if until_s is not None:
            raise InputError("until_s", "is for bare commands", "leave it out, a plan ends where it ends")
        return linear(t, omega, theta0=angles, spin=omega[0]), pose[0], twist, pose[-1]
    if len(t) == 1 and until_s is None:
        raise InputError("t_s", "there is one row and no end", "give a second row, or --until")
    return held(t, omega, end_s=until_s, theta0=angles), None, None, None


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


def _numbers(name: str, values: Sequence[float] | Array | None, count: int) -> Array:
    if values is None:
        return np.zeros(count)
    found = np.asarray(values, dtype=float)
    if found.shape != (count,) or not np.all(np.isfinite(found)):
        raise InputError(name, f"is {', '.join(f'{v:g}' for v in found.ravel())}", f"give {count} numbers")
    return found
