"""``slipmargin.check``: does a trajectory slip, where, and how much slower must it be?"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, checked_margin, contact_of, model_of
from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.paths.trajectory import Trajectory
from slipmargin.robot.mistakes import ABSURD_USE, unlikely_motion

if TYPE_CHECKING:
    from slipmargin.model import Model
    from slipmargin.paths.check import Check
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CheckResult(Result):
    """The grip utilisation of a trajectory, with the poses it was computed from."""

    model: Model
    check: Check
    pose: Array
    warnings: tuple[str, ...]
    source_format: str

    @property
    def admissible(self) -> bool:
        """Whether grip, torque and tipping stay within 1 − margin, and wheels within their top speed."""
        return self.check.admissible

    @property
    def time_scale_needed(self) -> float:
        """The factor by which time must be stretched [1]; infinite where no slowing down helps."""
        return self.check.time_scale_needed

    @property
    def trajectory(self) -> Trajectory:
        """The trajectory with everything that the check added."""
        c = self.check
        return Trajectory(
            t_s=c.t_s,
            pose=self.pose,
            velocity=c.velocity,
            acceleration=c.acceleration,
            omega=c.omega,
            use=c.use,
            wheels=self.model.geometry.names,
        )

    def summary(self) -> str:
        """The verdict."""
        return f"check of {self.model.robot} on {self.model.surface}: {self.lines()[0]}"

    def lines(self) -> list[str]:
        """Verdict, worst point, motors and wheels, and the cure."""
        from slipmargin.report.paths import check_lines

        return check_lines(self.model, self.check)

    def plot(self) -> Figure:
        """The path by the wheel that uses most, and the grip utilisation of every wheel over time."""
        from slipmargin.plots.paths import check_figure

        return check_figure(self.model, self.check, self.trajectory)

    def panels(self) -> dict[str, Figure]:
        """Each panel of :meth:`plot` as a figure of its own, by name: what a page shows."""
        from slipmargin.plots.paths import check_panels

        return check_panels(self.model, self.check, self.trajectory)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.motion_pages import check_page

        return check_page(
            self.model, self.check, self.pose, images(self.panels()), self.lines(), self.warnings
        )

    def table_text(self) -> str:
        """The trajectory in the contract's columns."""
        from slipmargin.io.table import columns_text

        return columns_text(self.trajectory.columns(), digits=12)

    def to_dict(self) -> dict[str, Any]:
        """Verdict, worst point, time scaling, and the grip utilisation of each sample."""
        c = self.check
        t, x, y, k = c.worst
        return {
            "schema": 1,
            "robot": self.model.robot,
            "surface": self.model.surface,
            "margin": 1.0 - c.share,
            "admissible": c.admissible,
            "max_use": c.max_use,
            "time_scale_needed": c.time_scale_needed,
            "worst": {"t_s": t, "x_m": x, "y_m": y, "wheel": self.model.geometry.names[k]},
            "wheels": self.model.geometry.names,
            "t_s": c.t_s,
            "use": c.use,
            "source_format": self.source_format,
            "torque": c.torque,
            "wheel_speed": c.speed,
            "min_load_N": float(np.min(c.load_N)),
            "tipping": c.tipping,
            "max_tipping": float(np.max(c.tipping)),
            **(
                {}
                if (bare := c.unsmoothed) is None
                else {"unsmoothed": {"admissible": bare.admissible, "max_use": bare.max_use}}
            ),
        }


def check(
    robot: RobotLike,
    surface: str,
    trajectory: Trajectory | Array | Path | str,
    *,
    margin: float = 0.0,
    smooth_s: float = 0.0,
    robust: bool = False,
    topic: str | None = None,
) -> CheckResult:
    """The share of each wheel's grip that a trajectory asks for, and how much slower it must be.

    Admissible means that no wheel uses more than 1 − margin of its grip, loses more than that of its load
    (at 1
    it lifts off), and no motor gives more than that of its torque.  The cure is one factor: stretch time by
    it.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    trajectory : Trajectory, array (T, 4), or a file
        A planned trajectory; rows of t [s], x [m], y [m], φ [rad]; or a file: a CSV with at least the
        columns ``t_s,x_m,y_m,phi_rad``, a Choreo ``.traj``, a PathPlanner trajectory JSON, a log of Road
        Runner's quickstart (in inches), or a ROS bag with a nav_msgs/Path.  Those four give the heading θ
        of the robot's front; it becomes φ = θ − π/2
        for a robot file in the paper's convention and φ = θ in that of ROS.  Velocities and accelerations
        that a file states are compared with its poses, which are what is checked; a contradiction is a
        warning.
    margin : float
        Safety margin: 1 − grip utilisation, 0 to below 1.
    smooth_s : float
        Window over which derivatives of measured poses are taken, up to a tenth of the motion [s].  Where it
        changes the verdict, ``check.unsmoothed`` holds the check without it.
    robust : bool
        True: whichever wheels stand on rigid sectors.  False: all wheels on rollers.
    topic : str, optional
        Topic of the nav_msgs/Path, where a ROS bag has more than one.

    Returns
    -------
    CheckResult
        ``admissible``, ``time_scale_needed`` and, in ``check``, ``use`` (T, N).

    Raises
    ------
    InputError
        For a fault in the robot file, the trajectory or an argument.

    Examples
    --------
    >>> import slipmargin as sm
    >>> import numpy as np
    >>> t = np.linspace(0.0, 2.0, 41)
    >>> still = np.zeros_like(t)
    >>> rows = np.column_stack([t, 0.2 * t**2, still, still])  # 0.4 m/s² to the right
    >>> sm.check("ohio-kiwi", "paper", rows)
    <check of ohio-kiwi on paper: admissible: uses at most 0.9045 of a wheel's grip, 1 allowed>

    The same drive as Choreo writes it, the robot's front along the field's +y:

    >>> import json, pathlib, tempfile
    >>> states = [{"t": a, "x": b, "y": 0.0, "heading": np.pi / 2} for a, b, _, _ in rows]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "drive.traj")
    ...     _ = file.write_text(json.dumps({"trajectory": {"samples": states}}))
    ...     sm.check("ohio-kiwi", "paper", file)
    <check of ohio-kiwi on paper: admissible: uses at most 0.9045 of a wheel's grip, 1 allowed>
    """
    from slipmargin.paths.check import check as path_check, widened
    from slipmargin.report.motion import unsteady

    model, warnings = model_of(robot, surface, band=True)
    share = 1.0 - checked_margin(margin)
    source, form = "", "array"
    if topic is not None and not isinstance(trajectory, Path | str):
        raise InputError("topic", "is for ROS bags, and the trajectory is none", "leave it out")
    if isinstance(trajectory, Trajectory):
        t_s, pose, form = trajectory.t_s, trajectory.pose, "Trajectory"
    elif isinstance(trajectory, Path | str):
        from slipmargin.io.trajectory_file import read_trajectory

        source = str(trajectory)
        samples = read_trajectory(Path(trajectory), topic, model.convention)
        t_s, pose, form = samples.t_s, samples.pose, samples.form
        warnings = (*warnings, *samples.notes)
    else:
        rows = np.asarray(trajectory, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 4:
            raise InputError(
                "trajectory", f"has the shape {rows.shape}", "give rows of t [s], x [m], y [m], φ [rad]"
            )
        t_s, pose = rows[:, 0], rows[:, 1:]
    contact, idle = contact_of(model, robust)
    warnings = (*warnings, *idle)
    try:
        found = path_check(model, t_s, pose, share=share, smooth_s=smooth_s, contact=contact)
    except InputError as fault:
        raise fault.in_file(source) if source and fault.place != "smooth_s" else fault from None
    if not found.max_use <= ABSURD_USE:
        raise InputError(
            "t_s",
            f"asks for {found.max_use:.3g} times a wheel's grip somewhere, which is no robot's motion",
            "give seconds, metres and radians, and at most one pose for each time",
            source,
        )
    if smooth_s > 0.0 and not widened(found.t_s, smooth_s):
        least = f"smooth_s {smooth_s:g} has no effect: no window is wider than without it; give a longer one"
        warnings = (*warnings, least)
    warnings = (*warnings, *unlikely_motion(found.velocity, model.reach_m))
    warnings = (*warnings, *unsteady(model, found.states(pose), contact))
    return CheckResult(model=model, check=found, pose=pose, warnings=warnings, source_format=form)
