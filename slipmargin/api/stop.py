"""``slipmargin.stop``: stopping distance and time by direction and speed, driven in simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result, head
from slipmargin.api.robots import RobotLike, checked_margin, model_of
from slipmargin.checks import FASTEST_M_S, Array, real
from slipmargin.errors import InputError, MotionStopped
from slipmargin.work import STOPPED_DIRECTIONS, allow

if TYPE_CHECKING:
    from slipmargin.model import Model
    from slipmargin.onboard.braking import Braking
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page

#: Speed [m/s] that is asked for where neither a speed nor the motors' top speed is given.
USUAL_M_S = 1.0
#: Time step of the simulated wheel speeds, and how long a robot is watched after its wheels stand [s].
_STEP_S, _AFTER_S = 0.002, 0.1
#: Stops that differ by less than this are equally long: a symmetric robot has several [m].
_ALIKE_M = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StopResult(Result):
    """Stopping distances (H, S) and times, and what the simulated robot did (NaN where not simulated).

    ``use`` (H, S) is the largest share of a wheel's grip in simulation, ``in_air_s`` (H, S) the longest time
    that a wheel hung in the air there.  ``ended`` says why simulations ended early, one reason for each that
    did; its numbers are NaN.
    """

    model: Model
    margin: float
    heading_rad: Array
    speed_m_s: Array
    distance_m: Array
    time_s: Array
    simulated_m: Array
    use: Array
    in_air_s: Array
    braking: Braking
    warnings: tuple[str, ...]
    ended: tuple[str, ...] = ()

    @property
    def verified(self) -> bool:
        """Whether all were simulated, none used more than the margin leaves, by 0.02, and no wheel lifted."""
        return bool(np.all(np.isfinite(self.use)) and not self.over and not self.lifted)

    @property
    def over(self) -> int:
        """Simulated stops that use more grip than the margin leaves, by 0.02."""
        return int(np.count_nonzero(self.use > 1.0 - self.margin + 0.02))

    @property
    def lifted(self) -> int:
        """Simulated stops in which a wheel lifts."""
        return int(np.count_nonzero(self.in_air_s > 0.0))

    @property
    def limited(self) -> tuple[str, ...]:
        """What limits in each of the H directions at the highest speed."""
        every, both = (
            len(self.model.geometry.names),
            zip(self.braking.cause, self.braking.wheels, strict=True),
        )
        return tuple(
            f"{cause} of {'all wheels' if len(wheels) == every else '+'.join(wheels)}"
            for cause, wheels in both
        )

    @property
    def longest(self) -> int:
        """Row of the longest stop from the highest speed; of several within a nanometre the first."""
        far = self.distance_m[:, -1]
        return int(np.argmax(far >= np.max(far) - _ALIKE_M))

    @property
    def shortest(self) -> int:
        """Row of the shortest stop from the highest speed; of several within a nanometre the first."""
        far = self.distance_m[:, -1]
        return int(np.argmax(far <= np.min(far) + _ALIKE_M))

    @property
    def farthest_m(self) -> float:
        """The longest distance from the highest speed, planned or simulated."""
        return float(np.nanmax([self.distance_m[:, -1], self.simulated_m[:, -1]]))

    def summary(self) -> str:
        """The longest stop from the highest speed."""
        return (
            f"stop of {self.model.robot} on {self.model.surface}: from {self.speed_m_s[-1]:.4g} m/s at most "
            f"{self.farthest_m:.4g} m and {np.max(self.time_s[:, -1]):.4g} s"
        )

    def lines(self) -> list[str]:
        """The longest and the shortest stop from the highest speed, what limits, and the simulation."""
        v = self.speed_m_s[-1]

        def told(name: str, h: int) -> str:
            planned, driven = f"{self.distance_m[h, -1]:.4g}", f"{self.simulated_m[h, -1]:.4g}"
            simulated = f" ({driven} m in simulation)" if driven not in (planned, "nan") else ""
            return (
                f"{name:<9} {planned} m{simulated}, {self.time_s[h, -1]:.4g} s from {v:.4g} m/s "
                f"towards {np.rad2deg(self.heading_rad[h]):.0f}°: limited by {self.limited[h]}"
            )

        out = [told("longest", self.longest), told("shortest", self.shortest)]
        if np.any(np.isfinite(self.use)):
            longer = 100.0 * (self.simulated_m / self.distance_m - 1.0)
            kept = "keeps the margin, but wheels lift" if self.lifted else "keeps the margin"
            verdict = "does NOT keep the margin" if self.over or self.ended else kept
            out.append(
                f"simulated {self.use.size} stops: {verdict}, uses at most {np.nanmax(self.use):.3f} of a "
                f"wheel's grip, {1.0 - self.margin:.3g} allowed; distances differ by "
                f"{np.nanmin(longer):+.1f} to {np.nanmax(longer):+.1f} %"
            )
            if self.lifted:
                out.append(
                    f"in {self.lifted} of them a wheel hangs in the air, for "
                    f"{np.nanmax(self.in_air_s):.3g} s at most; the others carry its share"
                )
        if self.ended:
            out.append(f"{len(self.ended)} of them do not reach their end: {self.ended[0]}")
        return out

    def table_lines(self) -> list[str]:
        """A row a direction, a pair of columns a speed."""
        head = "direction" + "".join(f"{f'{v:.4g} m/s':>22}" for v in self.speed_m_s)
        return [head] + [
            f"{np.rad2deg(phi):8.0f}°"
            + "".join(f"{f'{s:.4g} m, {t:.3g} s':>22}" for s, t in zip(ds, ts, strict=True))
            for phi, ds, ts in zip(self.heading_rad, self.distance_m, self.time_s, strict=True)
        ]

    def plot(self) -> Figure:
        """Stopping distance over the direction of motion, a curve a speed."""
        from slipmargin.plots.onboard import stop_figure

        return stop_figure(self.heading_rad, self.speed_m_s, self.distance_m, self.model.convention)

    def page(self) -> Page:
        """The report: verdict, numbers, picture, table, what to do next."""
        from slipmargin.plots.style import image
        from slipmargin.report.onboard_pages import stop_page

        return stop_page(
            self.model,
            margin=self.margin,
            heading_rad=self.heading_rad,
            speed_m_s=self.speed_m_s,
            distance_m=self.distance_m,
            time_s=self.time_s,
            farthest_m=self.farthest_m,
            limited=self.limited,
            worst=self.longest,
            use=self.use,
            verified=self.verified,
            over=self.over,
            lifted=self.lifted,
            ended=self.ended,
            image=image(self.plot()),
            lines=self.lines(),
            warnings=self.warnings,
        )

    def table_text(self) -> str:
        """A row a direction and speed."""
        from slipmargin.io.table import columns_text

        phi, v = np.meshgrid(self.heading_rad, self.speed_m_s, indexing="ij")
        return columns_text(
            {
                "heading_rad": phi.ravel(),
                "speed_m_s": v.ravel(),
                "distance_m": self.distance_m.ravel(),
                "time_s": self.time_s.ravel(),
                "simulated_distance_m": self.simulated_m.ravel(),
                "simulated_use": self.use.ravel(),
            }
        )

    def to_dict(self) -> dict[str, Any]:
        """Everything as numbers."""
        return {
            **head(self.model.robot, self.model.surface, self.margin),
            "heading_rad": self.heading_rad,
            "speed_m_s": self.speed_m_s,
            "distance_m": self.distance_m,
            "time_s": self.time_s,
            "simulated_distance_m": self.simulated_m,
            "simulated_use": self.use,
            "simulated_in_air_s": self.in_air_s,
            "verified": self.verified,
            **({"simulations_ended_early": list(self.ended)} if self.ended else {}),
            "limiting": ["+".join(w) for w in self.braking.wheels],
            "cause": list(self.braking.cause),
        }


def stop(
    robot: RobotLike,
    surface: str,
    *,
    speeds_m_s: Sequence[float] | Array | None = None,
    margin: float = 0.1,
    step_deg: float = 15.0,
    verify: bool = True,
) -> StopResult:
    """Stopping distance and time on a straight line, by direction and speed, load transfer included.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    speeds_m_s : sequence of S numbers, optional
        Speeds [m/s]; by default a quarter, a half and all of what the motors' top speed allows in every
        direction, or of 1 m/s.
    margin : float
        Safety margin: the share of the grip kept in reserve, 0 to below 1.
    step_deg : float
        Step of the directions, above 0 and up to 90 [deg]; 0° is the body's +x.
    verify : bool
        Drive every stop in simulation, open loop, all wheels on rollers.

    Returns
    -------
    StopResult
        ``distance_m`` and ``time_s``, each (H, S).

    Raises
    ------
    InputError
        For a fault in the robot file or an argument.
    NoSolution
        Where no braking keeps the margin at one of the speeds.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.stop("ohio-kiwi", "paper", speeds_m_s=[0.5], step_deg=45.0)
    <stop of ohio-kiwi on paper: from 0.5 m/s at most 0.08341 m and 0.3277 s>
    """
    from slipmargin.onboard.braking import braking
    from slipmargin.report.motion import ended as why

    model, warnings = model_of(robot, surface, band=True)
    margin = checked_margin(margin)
    step = real("step_deg", step_deg, above=0.0, high=90.0, cure="give a step up to 90 degrees")
    allow("step_deg", 360.0 / step, STOPPED_DIRECTIONS, "directions", "take a longer step")
    heading = np.deg2rad(np.arange(0.0, 360.0 - 1e-9, step))
    speeds = _speeds(model, heading, speeds_m_s)
    found = braking(model, heading, float(speeds[-1]), margin)
    distance, time = (
        np.column_stack([found.at(table, v) for v in speeds]) for table in (found.distance_m, found.time_s)
    )
    simulated, use, in_air = (np.full(distance.shape, np.nan) for _ in range(3))
    ended: list[str] = []
    if verify:
        level = replace(model, grip=replace(model.grip, rigid_fraction=np.zeros(model.count)))
        for h in range(len(heading)):
            for k, v in enumerate(speeds):
                try:
                    simulated[h, k], use[h, k], in_air[h, k] = _driven(level, found, h, float(v))
                except MotionStopped as end:
                    way = f"from {v:.4g} m/s towards {np.rad2deg(heading[h]):.0f}°"
                    ended.append(f"{way}, {why(end)}")
    return StopResult(
        model=model,
        margin=margin,
        heading_rad=heading,
        speed_m_s=speeds,
        distance_m=distance,
        time_s=time,
        simulated_m=simulated,
        use=use,
        in_air_s=in_air,
        braking=found,
        warnings=warnings,
        ended=tuple(ended),
    )


def _speeds(model: Model, heading: Array, asked: Sequence[float] | Array | None) -> Array:
    way = np.column_stack([np.cos(heading), np.sin(heading), np.zeros_like(heading)])
    top = model.drives.max_speed_rad_s
    most = np.inf if top is None else top / np.max(np.abs(model.geometry.wheel_speeds(way)))
    if asked is None:
        return np.array([0.25, 0.5, 1.0]) * (USUAL_M_S if top is None else most)
    speeds = np.sort(np.asarray(asked, dtype=float).ravel())
    if not len(speeds) or not 0.0 < speeds[0] <= speeds[-1] <= FASTEST_M_S:
        raise InputError("speeds_m_s", f"is {list(asked)}", f"give speeds above 0, up to {FASTEST_M_S:g} m/s")
    if speeds[-1] > most * (1.0 + 1e-9):
        raise InputError(
            "speeds_m_s",
            f"reaches {speeds[-1]:g} m/s, the motors allow {most:.4g} m/s in every direction",
            "ask for less, or correct motor.max_speed_rad_s",
        )
    return np.asarray(np.minimum(speeds, most))


def _driven(model: Model, found: Braking, h: int, speed: float) -> tuple[float, float, float]:
    """Distance, largest share and longest time of a wheel in the air of a simulated stop."""
    from slipmargin.sim.signal import linear
    from slipmargin.sim.simulate import simulate

    t, v = found.profile(h, speed, _STEP_S)
    way = np.array([np.cos(found.heading_rad[h]), np.sin(found.heading_rad[h]), 0.0])
    t, v = np.append(t, t[-1] + _AFTER_S), np.append(v, 0.0)
    omega = model.geometry.wheel_speeds(v[:, None] * way)
    run = simulate(
        model,
        linear(t, omega, spin=omega[0]),
        np.linspace(0.0, t[-1], 400),
        start_twist=speed * way,
        rtol=1e-6,
    )
    # a wheel that lifted for less than a step of the integration hung for more than no time
    least = 0.0 if run.lifts_s is None else 1e-9
    in_air = max(least, float(np.max(run.in_air_s)))
    return float(run.pose[-1, :2] @ way[:2]), float(np.max(run.utilisation)), in_air
