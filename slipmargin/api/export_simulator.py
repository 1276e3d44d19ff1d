"""``slipmargin.export_simulator``: a robot with its friction as a simulator's model file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, read_robot, warnings_of
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.report.simulator_parts import SimRobot, SimWheel

FORMATS = ("sdf", "mjcf", "urdf")


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SimulatorModel(Result):
    """A simulator's model of a robot, and what it could not take along."""

    format: str
    robot: SimRobot
    text: str
    of_file: tuple[str, ...] = ()  #: what the robot file says and a model's text does not use

    @property
    def warnings(self) -> tuple[str, ...]:
        """What limits depend on and the model does not hold."""
        lost = (f"not in the {self.format} model: {line}" for line in self.robot.left_out)
        return (*lost, *self.of_file)

    def summary(self) -> str:
        """Format, robot and surface."""
        return f"{self.format} model of {self.robot.name} on {self.robot.surface}"

    def lines(self) -> list[str]:
        """The friction of every wheel."""

        def across(w: SimWheel) -> str:
            if self.format == "mjcf":
                return f"{w.mu2:.4g} across by the rollers' hinges"
            return f"mu2 {w.mu2:.4g}, slip {w.slip1:.3g} and {w.slip2:.3g} m/(N s)"

        rows = [
            f"wheel {w.name}: mu {w.mu:.4g} along ({w.grip[0]:.3f}, {w.grip[1]:.3f}), {across(w)}"
            for w in self.robot.wheels
        ]
        return [self.summary(), *rows]

    def to_dict(self) -> dict[str, Any]:
        """The friction of every wheel as data; axes are x forward, y left."""
        return {
            "schema": 1,
            "format": self.format,
            "robot": self.robot.name,
            "surface": self.robot.surface,
            "wheels": [
                {
                    "name": w.name,
                    "fdir1": list(w.grip),
                    "mu": w.mu,
                    "mu2": w.mu2,
                    "slip1_m_per_N_s": w.slip1,
                    "slip2_m_per_N_s": w.slip2,
                    "load_N": w.load_N,
                }
                for w in self.robot.wheels
            ],
            "left_out": list(self.robot.left_out),
        }


def export_simulator(robot: RobotLike, format: str, surface: str | None = None) -> SimulatorModel:
    """A robot as a model file whose friction gives a simulator this robot's limits.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    format : str
        ``sdf`` or ``urdf`` for Gazebo (``mu``, ``mu2``, ``fdir1`` and slip compliances of every wheel) or
        ``mjcf`` for MuJoCo (wheels with rollers).
    surface : str, optional
        A surface of the robot file; by default its first.

    Returns
    -------
    SimulatorModel
        ``text``, and in ``robot`` the numbers in it.

    Raises
    ------
    InputError
        For another format, or a fault in the robot file.

    Examples
    --------
    >>> import slipmargin as sm
    >>> print(sm.export_simulator("mecanum4", "sdf").lines()[1])
    wheel front-right: mu 0.4 along (-0.707, -0.707), mu2 0.05, slip 0.000133 and 0.00107 m/(N s)
    """
    from slipmargin.report.gazebo_model import sdf_text, urdf_text
    from slipmargin.report.mujoco_model import mjcf_text
    from slipmargin.report.simulator_parts import sim_robot

    texts = {"sdf": sdf_text, "mjcf": mjcf_text, "urdf": urdf_text}
    if format not in texts:
        raise InputError("format", f"is {format!r}", f"use one of: {', '.join(FORMATS)}")
    recipe = read_robot(robot)
    floor = recipe.robot.surfaces[0].name if surface is None else recipe.robot.surface(surface).name
    found = sim_robot(recipe, floor)
    said = warnings_of(recipe, floor)
    return SimulatorModel(format=format, robot=found, text=texts[format](found), of_file=said)
