"""``slipmargin.measure``: friction coefficients from pulls with a scale."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, model_of, read_robot
from slipmargin.checks import Array, from_zero
from slipmargin.errors import InputError
from slipmargin.physics.constants import GRAVITY_M_S2

if TYPE_CHECKING:
    from slipmargin.study.measure import Measured


WAYS = ("drive", "transverse")
#: Coefficients apart by 9.81 within this factor look like kilograms taken for newtons [1].
_ABOUT = 1.5


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MeasureResult(Result):
    """Drive and transverse coefficients of each type of wheel, each with an interval."""

    measured: Measured
    surface: str
    warnings: tuple[str, ...]

    def summary(self) -> str:
        """The coefficients of the first type of wheel."""
        m = self.measured
        return (
            f"measured {m.types[0]}: drive {m.value[0, 0]:.3f} ({m.low[0, 0]:.3f} to {m.high[0, 0]:.3f}), "
            f"transverse {m.value[0, 1]:.3f} ({m.low[0, 1]:.3f} to {m.high[0, 1]:.3f})"
        )

    def lines(self) -> list[str]:
        """Coefficients with their intervals, how well they fit, and the line for the robot file."""
        m, lines = self.measured, []
        for t, name in enumerate(m.types):
            for j, way in enumerate(WAYS):
                lines.append(
                    f"{name:<11} {way:<10} {m.value[t, j]:.4f}, 95 % between {m.low[t, j]:.4f} and "
                    f"{m.high[t, j]:.4f}"
                )
        rms = float(np.sqrt(np.mean(m.residual_N**2)))
        lines.append(
            f"residual    {rms:.3g} N root mean square over {len(m.residual_N)} pulls"
            + (f", {m.left_out} with a wheel on rigid material left out" if m.left_out else "")
        )
        if len(m.types) > 1:
            return [*lines, "file        a surface has one pair for all wheels: take the lower coefficients"]
        spans = ", ".join(f"{w} = [{m.low[0, j]:.4f}, {m.high[0, j]:.4f}]" for j, w in enumerate(WAYS))
        return [*lines, "", f"[surface.{self.surface}]", f"roller = {{ {spans} }}"]

    def to_dict(self) -> dict[str, Any]:
        """Everything as numbers."""
        m = self.measured
        return {
            "schema": 1,
            "surface": self.surface,
            "types": [
                {
                    "wheels": name,
                    **{
                        way: {"value": m.value[t, j], "low": m.low[t, j], "high": m.high[t, j]}
                        for j, way in enumerate(WAYS)
                    },
                }
                for t, name in enumerate(m.types)
            ],
            "residual_N": m.residual_N,
            "left_out": m.left_out,
            "draws": m.draws,
            "seed": m.seed,
        }


def measure(pulls: Path | str, robot: RobotLike, surface: str, *, seed: int = 0) -> MeasureResult:
    """Friction coefficients of each type of wheel, from pulls at several orientations of the robot.

    A least-squares fit of the pull limit (all wheels on rollers) to the measured forces, with intervals by
    bootstrap over the pulls (B. Efron, The Annals of Statistics 7(1), 1979).

    Parameters
    ----------
    pulls : str or Path
        A CSV of pulls (``phi_rad,force_N`` and, where known, ``theta{i}_rad``), one row a pull: the force at
        which the robot began to slide [N] and its orientation under a pull along the floor's +x [rad], or
        along ``direction_rad``, at ``point_x_m,point_y_m`` and ``height_m`` where these are given.
    robot : str, Path, Recipe or Robot
        Its mass, geometry, loads and grip are taken as they are; its coefficients on rollers are not used.
    surface : str
        The surface of the robot file that the pulls were made on (its effects count).
    seed : int
        Seed of the bootstrap, from 0.

    Returns
    -------
    MeasureResult
        ``measured.value``, ``low`` and ``high`` (T, 2): drive and transverse of each type of wheel [1].

    Raises
    ------
    InputError
        For a fault in a file, or pulls that do not decide the coefficients.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.measure("pulls.csv", "ohio-kiwi", "paper")  # doctest: +SKIP
    """
    from slipmargin.io.trial_file import read_pulls
    from slipmargin.study.measure import measure as fit

    from_zero("seed", seed)
    recipe = read_robot(robot)
    model, warnings = model_of(recipe, surface)
    read = read_pulls(Path(pulls), model.count)
    if read.theta_rad is None and np.any(model.grip.rigid_fraction > 0.0):
        warnings = (
            *warnings,
            "pulls: no wheel angles are given, so every wheel is taken to stand on a roller",
        )
    angles = np.array([w.roller_angle_deg for w in recipe.robot.wheels])
    try:
        found = fit(model, angles, read, seed=seed)
    except InputError as fault:
        raise fault.in_file(str(pulls)) from None
    return MeasureResult(
        measured=found, surface=surface, warnings=(*warnings, *_kilograms(model.grip.roller, found.value))
    )


def _kilograms(stated: Array, found: Array) -> tuple[str, ...]:
    """What to say where pulls look as if they had been read off a scale in kilograms."""
    factor = float(np.mean(stated) / np.mean(found))
    if not GRAVITY_M_S2 / _ABOUT < factor < GRAVITY_M_S2 * _ABOUT:
        return ()
    return (
        f"pulls: the robot file's coefficients are {factor:.3g} times these: were the forces read in "
        "kilograms? force_N is in newtons, 9.81 of them to a kilogram",
    )
