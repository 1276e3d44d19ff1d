"""``slipmargin.explore``: a robot's limits on a local page, with sliders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.robots import RobotLike, model_of, read_robot
from slipmargin.errors import InputError
from slipmargin.robot.warnings import EVERY_SPREAD

if TYPE_CHECKING:
    from slipmargin.limits.bounds_summary import Bounds, SafeSets
    from slipmargin.live.server import Server
    from slipmargin.live.settings import Settings, Slider
    from slipmargin.study.robot_on_surface import RobotOnSurface


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Explorer:
    """A robot on a surface whose numbers may be moved; the local page asks it for everything."""

    design: RobotOnSurface
    name: str  #: how the commands that the page shows call the robot
    report: str | None  #: the text of a report that the page shows
    warnings: tuple[str, ...]
    #: The newest settings and their safe sets: another tool's file for the same robot costs nothing.
    kept: dict[tuple[tuple[str, float], ...], SafeSets] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<explorer of {self.design.robot.name} on {self.design.surface}>"

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """The sliders that mean something for this robot."""
        from slipmargin.live.settings import sliders

        return sliders(self.design)

    def picture(self, **values: float) -> dict[str, Any]:
        """What the page draws with sliders at ``values``: limits by direction, pure forces, loads, tipping.

        Raises
        ------
        InputError
            For an unknown slider or a robot that is impossible so.
        """
        from slipmargin.live.picture import picture

        return picture(self._settings(values))

    def pulls(self, measured: Path | None = None, **values: float) -> dict[str, Any]:
        """F_emax all round with sliders at ``values``, and measured pulls from a CSV beside it."""
        from slipmargin.live.picture import pulls

        return pulls(self._settings(values), measured)

    def export(self, tool: str, **values: float) -> dict[str, str]:
        """The limits for another tool, the robot file and the command that writes the same.

        Returns
        -------
        dict
            ``text`` the exported file, ``robot`` the robot file with the sliders' values, ``command`` the
            command that makes the one from the other.

        Raises
        ------
        InputError
            For an unknown slider or tool.
        NoSolution
            If no acceleration is safe in every direction.
        """
        import shlex  # names in a file are data, also in a shell

        from slipmargin.io.robot_text import write_recipe
        from slipmargin.limits.bounds_inside import YAW_SHARE
        from slipmargin.live.settings import MARGIN
        from slipmargin.report.exports import export_text, sets_text

        if tool not in _ENDING:
            raise InputError("export", f"is {tool!r}", f"use one of: {', '.join(_ENDING)}")
        now = self._settings(values)
        yaw = None if now.yaw_share == YAW_SHARE else self._sets(values, now).reserved_rad_s2
        whole = tool == "json"
        text = (
            export_text(tool, self._bounds(now, yaw)) if whole else sets_text(tool, self._sets(values, now))
        )
        robot = f"{now.design.robot.name}.toml" if now.changed else self.name
        words = ["slipmargin", "bounds", robot, "--surface", now.design.surface]
        words += ["--margin", repr(now.margin)] if now.margin != MARGIN else []
        words += ["--yaw", repr(yaw)] if yaw is not None else []
        return {
            "text": text,
            "robot": write_recipe(now.design.recipe),
            "command": shlex.join([*words, "--export", tool, f"limits.{_ENDING[tool]}"]),
        }

    def _sets(self, values: Mapping[str, float], now: Settings) -> SafeSets:
        """What planning tools are told with sliders at ``values``, which make the robot ``now``."""
        from slipmargin.limits.bounds_summary import safe_sets

        key = tuple(sorted(values.items()))
        found = self.kept.get(key)
        if found is None:
            model, _ = model_of(now.design.recipe, now.design.surface, spread=EVERY_SPREAD, band=True)
            found = safe_sets(model, margin=now.margin, yaw_share=now.yaw_share, ellipsoid=False)
            self.kept.clear()  # another request may do the same at once
            self.kept[key] = found
        return found

    def _bounds(self, now: Settings, yaw_rad_s2: float | None) -> Bounds:
        """All that the command would compute."""
        from slipmargin.api.bounds import bounds

        return bounds(now.design.recipe, now.design.surface, margin=now.margin, yaw_rad_s2=yaw_rad_s2).bounds

    def serve(self, port: int = 0) -> Server:
        """A server for the page at 127.0.0.1; a free port where none is given.

        Call ``serve_forever()`` of what is returned; ``address`` is what a browser opens.

        Raises
        ------
        InputError
            Where the port is taken.
        """
        from slipmargin.live.server import Server

        answers = {
            "robot": lambda query, file: self._about(),
            "limits": lambda query, file: self.picture(**_numbers(query)),
            "pulls": lambda query, file: self.pulls(file, **_numbers(query)),
            "export": lambda query, file: self.export(
                query.get("tool", ""), **_numbers({k: v for k, v in query.items() if k != "tool"})
            ),
            "report": lambda query, file: {"html": self.report},
        }
        try:
            return Server(answers, port)
        except (OSError, OverflowError) as fault:
            reason = getattr(fault, "strerror", None) or "is out of range"
            raise InputError("port", f"{port}: {reason}", "leave it out for a free one") from None

    def _settings(self, values: Mapping[str, float]) -> Settings:
        from slipmargin.live.settings import settings

        return settings(self.design, values)

    def _about(self) -> dict[str, Any]:
        from slipmargin.report.exports import TOOLS

        return {
            "robot": self.design.robot.name,
            "surface": self.design.surface,
            "sliders": [asdict(s) for s in self.sliders],
            "tools": [{"name": tool, "ending": _ENDING[tool]} for tool in TOOLS],
            "warnings": list(self.warnings),
            "report": self.report is not None,
        }


#: How an exported file's name ends.
_ENDING = {"nav2": "yaml", "roadrunner": "txt", "pathplanner": "json", "choreo": "json", "json": "json"}


def _numbers(query: Mapping[str, str]) -> dict[str, float]:
    found = {}
    for key, word in query.items():
        try:
            found[key] = float(word)
        except ValueError:
            raise InputError(key, f"is {word!r}, not a number", "give a number") from None
    return found


def explore(robot: RobotLike, surface: str | None = None, *, report: Path | str | None = None) -> Explorer:
    """A robot whose numbers may be moved while its limits follow, for the page of ``slipmargin explore``.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str, optional
        A surface of the robot file; its first where it is left out.
    report : str or Path, optional
        A ``report.html`` that the page shows.

    Returns
    -------
    Explorer
        ``sliders``, ``picture()``, ``pulls()``, ``export()`` and ``serve()``.

    Raises
    ------
    InputError
        For a fault in the robot file or an argument.

    Examples
    --------
    >>> import slipmargin as sm
    >>> page = sm.explore("ohio-kiwi", "paper")
    >>> [slider.key for slider in page.sliders][:2]
    ['mu', 'com_height_m']
    >>> page.picture(mu=0.3)["weakest"]["wheels"]
    ['rear']
    """
    from slipmargin.io.assets import report_text
    from slipmargin.study.robot_on_surface import RobotOnSurface

    recipe = read_robot(robot)
    floor = recipe.robot.surfaces[0].name if surface is None else surface
    _, warnings = model_of(recipe, floor, band=True)
    return Explorer(
        design=RobotOnSurface(recipe=recipe, surface=floor),
        name=str(robot) if isinstance(robot, str | Path) else f"{recipe.robot.name}.toml",
        report=None if report is None else report_text(str(report)),
        warnings=warnings,
    )
