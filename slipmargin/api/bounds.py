"""``slipmargin.bounds``: accelerations and cornering speeds that do not slip."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.api.robots import Drawing, RobotLike, checked_margin, contact_of, model_of, read_robot
from slipmargin.errors import InputError
from slipmargin.robot.warnings import EVERY_SPREAD

if TYPE_CHECKING:
    from slipmargin.limits.bounds_summary import Bounds
    from slipmargin.limits.uncertainty import SlipChance
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BoundsResult(Result):
    """Motion limits by direction: ``bounds.full`` with all of the grip, ``bounds.safe`` with the margin."""

    bounds: Bounds
    warnings: tuple[str, ...]
    slip_chance: SlipChance | None = None  #: None where no number of the robot is uncertain

    @property
    def recommended_m_s2(self) -> float:
        """Acceleration that is safe in every direction of motion with the margin [m/s²]."""
        return self.bounds.recommended_m_s2

    def summary(self) -> str:
        """Recommended acceleration and weakest direction."""
        b = self.bounds
        limit = f"{b.traction_m_s2:.4g} m/s² at the limit"
        if b.traction_m_s2 <= 0.0:
            limit = "it must slip at constant speed in some"
        return (
            f"bounds of {b.model.robot} on {b.model.surface}: recommended "
            f"{b.recommended_m_s2:.4g} m/s² in any direction, {limit}"
        )

    def lines(self) -> list[str]:
        """The answer; the first four lines are traction, motor, isotropic and recommended."""
        from slipmargin.report.bounds import answer

        return answer(self.bounds, self.slip_chance)

    def table_lines(self) -> list[str]:
        """Limits by direction and cornering speeds by curvature."""
        from slipmargin.report.bounds import tables

        return tables(self.bounds)

    def plot(self) -> Figure:
        """Polar plots of the limits, and cornering speed over curvature."""
        from slipmargin.plots.bounds import bounds_figure

        return bounds_figure(self.bounds)

    def panels(self) -> dict[str, Figure]:
        """Each panel of :meth:`plot` as a figure of its own, by name: what a page shows."""
        from slipmargin.plots.bounds import bounds_panels

        return bounds_panels(self.bounds)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.limits_pages import bounds_page

        return bounds_page(self.bounds, images(self.panels()), self.lines(), self.warnings)

    def to_dict(self) -> dict[str, Any]:
        """Everything as numbers."""
        from slipmargin.report.exports import bounds_table

        return bounds_table(self.bounds, self.slip_chance)

    def table_text(self) -> str:
        """A row a direction."""
        from slipmargin.io.table import columns_text

        full, safe, even = self.bounds.full, self.bounds.safe, self.bounds.even
        return columns_text(
            {
                "heading_rad": full.heading_rad,
                "starting_m_s2": full.starting_m_s2,
                "turning_m_s2": full.turning_m_s2,
                "braking_m_s2": full.braking_m_s2,
                "safe_starting_m_s2": safe.starting_m_s2,
                "safe_turning_m_s2": safe.turning_m_s2,
                "safe_braking_m_s2": safe.braking_m_s2,
                "steady_use": full.steady_use,
                "steady_use_rigid": self.bounds.rigid_use,
                "limiting": ["+".join(w) for w in full.starting.wheels],
                "cause": list(full.starting.cause),
                **({} if even is None else {"even_floor_starting_m_s2": even.starting_m_s2}),
            }
        )

    def export_text(self, tool: str) -> str:
        """The limits under another tool's own names: nav2, roadrunner, pathplanner, choreo or json.

        Raises
        ------
        InputError
            If the tool is not known.
        NoSolution
            If no acceleration is safe in every direction.
        """
        from slipmargin.report.exports import export_text

        return export_text(tool, self.bounds, self.slip_chance)


def bounds(
    robot: RobotLike,
    surface: str,
    *,
    margin: float = 0.1,
    step_deg: float = 1.0,
    robust: bool = False,
    export: str | None = None,
    yaw_rad_s2: float | None = None,
    chance: float | None = None,
    seed: int = 0,
) -> BoundsResult:
    """Acceleration limits in motion by direction: speeding up, turning, braking, cornering, spinning.

    In motion the rollers turn and their friction is drag (docs/theory.md), so the pull limit divided by the
    mass is not an acceleration limit.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    margin : float
        Safety margin: the share of the grip kept in reserve, 0 to below 1.
    step_deg : float
        Step of the directions, above 0 and up to 90 [deg]; 0° is the body's +x.
    robust : bool
        True: safe whichever wheels stand on rigid sectors.  False: all wheels on rollers.
    export : str, optional
        A tool for which the limits will be exported; it is checked before any work is done.
    yaw_rad_s2 : float, optional
        Yaw acceleration that the safe box and circle (and so every export) keep in reserve [rad/s²]; by
        default a tenth of what spinning on the spot allows, enough to correct the heading on a straight line.

    chance : float, optional
        Chance of slip for which an acceleration is wanted, 0.001 to 0.5; 0.01 where it is not given.  It
        needs a number with a spread (``"0.26 ± 0.02"`` in the robot file).
    seed : int
        Seed of the drawn numbers, from 0.

    Returns
    -------
    BoundsResult
        ``bounds.full`` and ``bounds.safe`` hold ``heading_rad``, ``starting_m_s2``, ``turning_m_s2`` and
        ``braking_m_s2``, each of shape (H,).

    Raises
    ------
    InputError
        For a fault in the robot file or an argument.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.bounds("ohio-kiwi", "paper", step_deg=15.0)
    <bounds of ohio-kiwi on paper: recommended 0.3947 m/s² in any direction, 0.5017 m/s² at the limit>
    """
    from slipmargin.limits.bounds_summary import bounds as limit_bounds
    from slipmargin.report.bounds import slower_at_speed
    from slipmargin.report.motion import unsteady

    recipe = read_robot(robot)
    model, warnings = model_of(recipe, surface, spread=EVERY_SPREAD, band=True)
    drawing, unseeded = Drawing.of(recipe, surface, chance, seed)
    if not (math.isfinite(step_deg) and 0.0 < step_deg <= 90.0):
        raise InputError("step_deg", f"is {step_deg:g}", "give a step up to 90 degrees")
    if export is not None:
        from slipmargin.report.exports import TOOLS

        if export not in TOOLS:
            raise InputError("export", f"is {export!r}", f"use one of: {', '.join(TOOLS)}")
    if yaw_rad_s2 is not None and not (math.isfinite(yaw_rad_s2) and yaw_rad_s2 >= 0.0):
        raise InputError("yaw_rad_s2", f"is {yaw_rad_s2:g}", "give a yaw acceleration [rad/s²], 0 for none")
    contact, idle = contact_of(model, robust)
    warnings = (*warnings, *unseeded, *idle)
    found = limit_bounds(
        model,
        margin=checked_margin(margin),
        step_deg=step_deg,
        contact=contact,
        yaw_rad_s2=yaw_rad_s2,
    )
    likely = None
    if drawing is not None:
        from slipmargin.limits.uncertainty_motion import lowest_starts

        likely, more = drawing.counted(
            model, lambda drawn: lowest_starts(model, drawn, contact), found.recommended_m_s2
        )
        warnings = (*warnings, *more)
    warnings = (
        *warnings,
        *slower_at_speed(found),
        *unsteady(model, found.extremes(), contact, looked_at="starts and stops at the limit"),
    )
    return BoundsResult(bounds=found, warnings=warnings, slip_chance=likely)
