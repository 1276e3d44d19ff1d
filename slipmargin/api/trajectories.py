"""``slipmargin.export_trajectory``: a planned, checked or simulated motion in another tool's file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipmargin.api.check import CheckResult
from slipmargin.api.plan import PlanResult
from slipmargin.api.simulate import SimulationResult
from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.model import Model

BAG = "ros-path"
TOOLS = ("choreo", "pathplanner", "roadrunner", BAG)


def export_trajectory(
    found: PlanResult | CheckResult | SimulationResult, tool: str, file: Path | str
) -> None:
    """Write a motion as another tool's trajectory file, which that tool (and ``check``) reads.

    Parameters
    ----------
    found : PlanResult, CheckResult or SimulationResult
        The motion.
    tool : str
        ``choreo`` (a ``.traj``), ``pathplanner`` (its generated JSON), ``roadrunner`` (a log of its
        quickstart,
        in inches) or ``ros-path`` (a ROS 2 bag with a nav_msgs/Path, which needs ``slipmargin[ros]``).
    file : str or Path
        The file, or the bag's new folder.

    Raises
    ------
    InputError
        For an unknown tool, or where the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import slipmargin as sm
    >>> found = sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [1, 0, 0]], points=50)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "drive.traj")
    ...     sm.export_trajectory(found, "choreo", file)
    ...     sm.check("ohio-kiwi", "paper", file, margin=0.05)
    <check of ohio-kiwi on paper: admissible: uses at most 0.9000 of a wheel's grip, 0.95 allowed>
    """
    from slipmargin.io.trajectory_write import write_path_bag
    from slipmargin.io.writes import write_text

    file = Path(file)
    if tool == BAG:
        model, t_s, pose, _, _ = _motion(found)
        write_path_bag(file, t_s, pose, model.convention)
        return
    write_text(file, trajectory_text(found, tool, file.name))


def trajectory_text(found: PlanResult | CheckResult | SimulationResult, tool: str, file_name: str) -> str:
    """The text of the file that :func:`export_trajectory` writes, for tools that read text.

    Parameters
    ----------
    found : PlanResult, CheckResult or SimulationResult
        The motion.
    tool : str
        ``choreo``, ``pathplanner`` or ``roadrunner``.
    file_name : str
        Name of the file; a trajectory is called like it.

    Raises
    ------
    InputError
        For an unknown tool, or ``ros-path``, which is a folder.

    Examples
    --------
    >>> import slipmargin as sm
    >>> found = sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [1, 0, 0]], points=50)
    >>> sm.trajectory_text(found, "choreo", "drive.traj").splitlines()[1]
    ' "name": "drive",'
    """
    from slipmargin.io.trajectory_write import trajectory_text as text_of

    if tool not in TOOLS:
        raise InputError("tool", f"is {tool!r}", f"use one of: {', '.join(TOOLS)}")
    if tool == BAG:
        raise InputError("tool", f"is {tool!r}, a folder", "write it with export_trajectory")
    model, t_s, pose, velocity, acceleration = _motion(found)
    name = file_name.split(".")[0]
    return text_of(tool, name, t_s, pose, velocity, acceleration, model.convention)


def _motion(
    found: PlanResult | CheckResult | SimulationResult,
) -> tuple[Model, Array, Array, Array, Array]:
    """Model, time (T,), pose, velocity and acceleration (T, 3) in floor axes."""
    if isinstance(found, SimulationResult):
        run = found.run
        change = np.gradient(run.velocity, run.t_s, axis=0) if len(run.t_s) > 1 else 0.0 * run.velocity
        return found.model, run.t_s, run.pose, run.velocity, np.asarray(change)
    rows = found.trajectory
    model = found.plan.model if isinstance(found, PlanResult) else found.model
    return model, rows.t_s, rows.pose, rows.velocity, rows.acceleration
