"""``slipmargin.plan``: the fastest way along a path with a margin against slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import Drawing, RobotLike, checked_margin, contact_of, model_of, read_robot
from slipmargin.checks import Array
from slipmargin.errors import InputError, MotionStopped
from slipmargin.robot.warnings import EVERY_SPREAD

if TYPE_CHECKING:
    from slipmargin.model import Model
    from slipmargin.paths.chance import PlanChance
    from slipmargin.paths.path import Path as Way
    from slipmargin.paths.plan import Plan
    from slipmargin.paths.trajectory import Trajectory
    from slipmargin.paths.verify import Verified
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page

WAYPOINTS = ("x_m", "y_m", "phi_rad")
#: A table whose wheel speeds lead this share of the way off the plan's end without slip is too coarse: creep
#: near the limit leads as far off [1].
FAR = 0.01
#: Turns between two waypoints beyond half a turn by less are half a turn, written with three decimals [1].
_ROUNDED = 1e-4


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanResult(Result):
    """A plan with its table and, where asked for, its simulation on rollers and with rigid sectors."""

    plan: Plan
    trajectory: Trajectory
    simulated: dict[str, Verified]
    warnings: tuple[str, ...]
    plan_chance: PlanChance | None = None  #: None where no number of the robot is uncertain

    @property
    def duration_s(self) -> float:
        """How long the motion takes [s]."""
        return self.plan.duration_s

    def sped_up_to(self, utilisation: float, *, hold_s: float = 0.0) -> Trajectory:
        """The same motion driven faster, until a wheel is asked for ``utilisation`` of its grip [1].

        Parameters
        ----------
        utilisation : float
            Share of a wheel's grip; above 1 the wheel slips.
        hold_s : float
            For how long on end it must be asked [s].

        Raises
        ------
        NoSolution
            If the plan uses more already, or no speed-up by less than 20 does it.
        """
        from slipmargin.paths.sample import at_use

        return at_use(self.plan.model, self.trajectory, utilisation, hold_s=hold_s)

    def simulated_again(self, trajectory: Trajectory) -> Verified:
        """Another trajectory of the same robot, simulated open loop with all wheels on rollers.

        Parameters
        ----------
        trajectory : Trajectory
            For example what :meth:`sped_up_to` returned.
        """
        from slipmargin.paths.verify import on_rollers, verify

        return verify(on_rollers(self.plan.model), trajectory)

    def summary(self) -> str:
        """Duration, length and the highest grip utilisation."""
        from slipmargin.report.paths import covered

        p = self.plan
        return (
            f"plan of {p.model.robot} on {p.model.surface}: {p.duration_s:.4f} s for "
            f"{covered(p)}, at most {p.max_use:.4f} of a wheel's grip"
        )

    def lines(self) -> list[str]:
        """Duration, grip, what limits the pace, and each simulation."""
        from slipmargin.report.paths import plan_lines

        return plan_lines(self.plan, self.simulated, self.plan_chance)

    def plot(self) -> Figure:
        """The path by limiting wheel, the speed under its limit curve, the grip utilisation of each wheel."""
        from slipmargin.plots.paths import plan_figure

        return plan_figure(self.plan, self.trajectory)

    def panels(self) -> dict[str, Figure]:
        """Each panel of :meth:`plot` as a figure of its own, by name: what a page shows."""
        from slipmargin.plots.paths import plan_panels

        return plan_panels(self.plan, self.trajectory)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.motion_pages import plan_page

        return plan_page(
            self.plan, self.trajectory, self.simulated, images(self.panels()), self.lines(), self.warnings
        )

    def table_text(self) -> str:
        """The trajectory in the contract's columns."""
        from slipmargin.io.table import columns_text

        return columns_text(self.trajectory.columns(), digits=12)

    def to_dict(self) -> dict[str, Any]:
        """Everything as numbers."""
        from slipmargin.paths.off_heading import use_off_heading
        from slipmargin.report.paths import limiting

        p, along = self.plan, self.plan.profile()
        return {
            "schema": 1,
            "robot": p.model.robot,
            "surface": p.model.surface,
            "margin": 1.0 - p.request.share,
            "contact": p.request.contact.name.lower(),
            "duration_s": p.duration_s,
            "length_m": float(along.way_m[-1]),
            "max_use": p.max_use,
            "max_use_off_heading": use_off_heading(p),
            **({} if self.plan_chance is None else {"slip_chance": asdict(self.plan_chance)}),
            "grid_points": len(p.x),
            "s_m": along.way_m,
            "speed_m_s": along.speed_m_s,
            "speed_limit_m_s": along.highest_m_s,
            "limiting": limiting(p),
            "trajectory": self.trajectory.columns(),
            "simulated": {
                name: {
                    "slips": v.slips,
                    "lifts_s": v.lifts_s,
                    "in_air_s": v.in_air_s,
                    "max_share": v.peak,
                    "wheel": v.wheel,
                    "max_drive_slip_m_s": float(np.max(v.slip_m_s)),
                    "end_position_m": v.drift_m,
                    "end_heading_rad": v.drift_rad,
                    **({} if (end := v.stopped) is None else {"ended_early": _ended(end)}),
                }
                for name, v in self.simulated.items()
            },
        }


def plan(
    robot: RobotLike,
    surface: str,
    waypoints: Sequence[Sequence[float]] | Array | Path | str,
    *,
    margin: float = 0.1,
    closed: bool = False,
    blend_m: float | None = None,
    start_speed_m_s: float = 0.0,
    end_speed_m_s: float = 0.0,
    max_speed_m_s: float | None = None,
    max_yaw_rate_rad_s: float | None = None,
    robust: bool = False,
    points: int = 400,
    step_s: float = 0.005,
    verify: bool = False,
    chance: float | None = None,
    seed: int = 0,
) -> PlanResult:
    """The fastest motion along waypoints that keeps every wheel below 1 − margin of its grip.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    waypoints : array (K, 3), or a file
        Poses x [m], y [m], φ [rad] in the floor frame, or a CSV with columns ``x_m,y_m,phi_rad``.
    margin : float
        Safety margin: 1 − grip utilisation, 0 to below 1.
    closed : bool
        Close the path smoothly.
    blend_m : float, optional
        Straight lines with corners rounded from so many metres before each waypoint [m]; without it the
        path is a spline.
    start_speed_m_s, end_speed_m_s : float
        Speed over the floor at the ends of the path [m/s], of the wheels where the robot turns on the spot.
    max_speed_m_s, max_yaw_rate_rad_s : float, optional
        Caps [m/s, rad/s].
    robust : bool
        True: safe whichever wheels stand on rigid sectors.  False: all wheels on rollers.
    points : int
        Grid points along the path.
    step_s : float
        Time step of the table, at most a fifth of the motion [s].
    verify : bool
        Also simulate the planned wheel speeds, open loop.
    chance : float, optional
        Chance of slip for which a margin is wanted, 0.001 to 0.5.  It needs a number with a spread
        (``"0.26 ± 0.02"`` in the robot file); the plan itself keeps ``margin``.
    seed : int
        Seed of the drawn numbers, from 0.

    Returns
    -------
    PlanResult
        ``trajectory`` holds ``t_s`` (T,), ``pose``, ``velocity`` and ``acceleration`` (T, 3) in the floor
        frame, ``omega`` and ``use`` (T, N).

    Raises
    ------
    InputError
        For a fault in the robot file, the waypoints or an argument.
    NoSolution
        If there is no admissible motion.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [1, 0, 0]], margin=0.1, points=50)
    <plan of ohio-kiwi on paper: 2.5312 s for 1 m, at most 0.9000 of a wheel's grip>
    """
    from slipmargin.paths.along import Caps
    from slipmargin.paths.plan import Request, plan as path_plan
    from slipmargin.paths.sample import trajectory
    from slipmargin.paths.verify import on_rollers, verify as simulated
    from slipmargin.report.motion import unsteady
    from slipmargin.report.paths import not_proved

    recipe = read_robot(robot)
    model, warnings = model_of(recipe, surface, spread=EVERY_SPREAD, band=True)
    drawing, unseeded = Drawing.of(recipe, surface, chance, seed)
    for name, cap in (("max_speed_m_s", max_speed_m_s), ("max_yaw_rate_rad_s", max_yaw_rate_rad_s)):
        if cap is not None and not 0.0 < cap < np.inf:
            raise InputError(name, f"is {cap:g}", "give a positive number, or leave it out")
    if closed and blend_m is not None:
        raise InputError(
            "blend_m",
            "is given for a closed path",
            "close the path with a spline, or repeat the first waypoint",
        )
    contact, idle = contact_of(model, robust)
    warnings = (*warnings, *unseeded, *idle)
    request = Request(
        share=1.0 - checked_margin(margin),
        points=points,
        start_m_s=start_speed_m_s,
        end_m_s=end_speed_m_s,
        caps=Caps(speed_m_s=max_speed_m_s or np.inf, yaw_rate_rad_s=max_yaw_rate_rad_s or np.inf),
        contact=contact,
    )
    source = str(waypoints) if isinstance(waypoints, Path | str) else ""
    try:
        places = _places(waypoints)
        way = _way(model, places, closed, blend_m)
        found = path_plan(model, way, request)
    except InputError as fault:
        raise fault if fault.source or not source else fault.in_file(source) from None
    if blend_m is not None and len(places) < 3:
        raise InputError("blend_m", "has no effect: two waypoints have no corner", "leave it out")
    rows = trajectory(found, step_s=step_s)
    proofs = {}
    if verify:
        proofs["on rollers"] = simulated(on_rollers(model), rows)
        if np.any(model.grip.rigid_fraction > 0.0):
            proofs["with its rigid sectors"] = simulated(model, rows)
    likely = None
    if drawing is not None:
        from slipmargin.paths.chance import plan_chance

        try:
            likely = plan_chance(
                model, way, request, rows, drawing.drawn(model), chance=chance, seed=seed, step_s=step_s
            )
        except InputError as fault:
            if chance is not None:
                raise
            warnings = (*warnings, str(fault))
    warnings = (
        *warnings,
        *unsteady(model, found.states(), request.contact),
        *_long_turns(places),
        *_coarse(found, rows, step_s),
        *_below(found),
        *(f"simulated {name}: {not_proved(run.stopped)}" for name, run in proofs.items() if run.stopped),
    )
    return PlanResult(plan=found, trajectory=rows, simulated=proofs, warnings=warnings, plan_chance=likely)


def _below(found: Plan) -> tuple[str, ...]:
    """That a profile was found below a lower speed only, so that a faster one may be there."""
    if found.below_m_s is None:
        return ()
    return (
        f"a profile was found below a lower speed only, {found.below_m_s:.3g} m/s along the path; there "
        "may be a faster one: try another number of points",
    )


def _ended(stopped: MotionStopped) -> dict[str, Any]:
    """When, why and what to change, of a simulation that did not reach its end."""
    return {"t_s": stopped.time_s, "why": stopped.why, "cure": stopped.cure}


def _places(waypoints: Sequence[Sequence[float]] | Array | Path | str) -> Array:
    """The waypoints (W, 3), of a file or as given."""
    if isinstance(waypoints, Path | str):
        from slipmargin.io.table import read_columns

        places = read_columns(Path(waypoints), required=WAYPOINTS, known=(), least=1).stack(WAYPOINTS)
    else:
        places = np.asarray(waypoints, dtype=float)
        if places.ndim != 2 or places.shape[1] != 3:
            raise InputError(
                "waypoints", f"have the shape {places.shape}", "give rows of x [m], y [m], φ [rad]"
            )
    return places


def _long_turns(places: Array) -> tuple[str, ...]:
    """That a robot turns the long way round between two waypoints, or round and round as by degrees."""
    turn = np.diff(places[:, 2])
    turns = np.abs(turn) / (2.0 * np.pi)
    if not len(turns) or np.max(turns) <= 0.5 + _ROUNDED:
        return ()
    at = int(np.argmax(turns))
    if turns[at] > 1.0:
        return (
            f"waypoints {at + 1} and {at + 2}: the robot turns {turns[at]:.3g} times between them; headings "
            "are in radians",
        )
    short, said = np.unwrap(places[:, 2]), []
    for k in np.flatnonzero(turns > 0.5 + _ROUNDED).tolist():
        later = ""
        if k + 2 < len(places):
            later = f", and add {short[k + 1] - short[k] - turn[k]:.5g} to those after it"
        said.append(
            f"waypoints {k + 1} and {k + 2}: the robot turns {np.rad2deg(turn[k]):.4g}° between them; for "
            f"the short way write phi_rad = {short[k + 1]:.5g} for waypoint {k + 2}{later}"
        )
    return tuple(said)


def _coarse(found: Plan, rows: Trajectory, step_s: float) -> tuple[str, ...]:
    """That the steps of a table are too long to lead to the plan's end."""
    from slipmargin.paths.pieces import distance
    from slipmargin.paths.sample import rolled

    end, goal = rolled(rows), rows.pose[-1]
    if distance(end, goal, found.model.reach_m) <= FAR * found.path.length:
        return ()
    return (
        f"step: the table's wheel speeds, a row every {step_s:g} s, lead "
        f"{1e3 * np.hypot(*(end - goal)[:2]):.3g} mm and {np.rad2deg(abs(end[2] - goal[2])):.3g}° off the "
        "plan's end without any slip; take a shorter step",
    )


def _way(model: Model, places: Array, closed: bool, blend_m: float | None) -> Way:
    """The path through the waypoints."""
    from slipmargin.paths.path import corners, through

    if blend_m is None:
        return through(places, arm=model.reach_m, closed=closed)
    return corners(places, arm=model.reach_m, blend_m=blend_m)
