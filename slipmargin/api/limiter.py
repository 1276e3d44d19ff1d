"""``slipmargin.Limiter``: cuts commands back to what the wheels can do without slipping, direction kept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result, head
from slipmargin.api.robots import RobotLike, checked_margin, model_of, read_robot
from slipmargin.checks import Array
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from slipmargin.onboard.table import LimitTable

#: What the codes of a limited command mean, by number.
CODES = (
    "reached",
    "cut back, direction kept",
    "braking: no step towards what was wanted keeps the margin",
    "braking as well as it can: nothing keeps the margin",
    "an input is no finite number, or no time passed",
)
_Numbers = Sequence[float] | Array


@final
class Limiter(Result):
    """Cuts accelerations and velocity commands back to the margin without turning their direction.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    margin : float
        Safety margin: the share of the grip kept in reserve, 0 to below 1.

    Raises
    ------
    InputError
        For a fault in the robot file or an argument.

    Notes
    -----
    All wheels are taken to stand on rollers.  What depends on something that a robot does not know while it
    drives (its place, the time) counts with its worst value.  :meth:`c_header` is the same limiter in C.

    Examples
    --------
    >>> import slipmargin as sm
    >>> limiter = sm.Limiter("ohio-kiwi", "paper", margin=0.1)
    >>> twist, code = limiter.limit_twist(now=[0.0, 0.0, 0.0], wanted=[1.0, 0.0, 0.0], dt_s=0.02)
    >>> twist.round(4).tolist(), sm.Limiter.meaning(code)
    ([0.008, 0.0, 0.0], 'cut back, direction kept')
    """

    __slots__ = ("_command", "_hash", "_margin", "table", "warnings")

    table: LimitTable
    warnings: tuple[str, ...]

    def __init__(self, robot: RobotLike, surface: str, *, margin: float = 0.1) -> None:
        import shlex
        from hashlib import sha256

        from slipmargin.io.robot_text import write_recipe
        from slipmargin.onboard.table import limit_table, steady_warnings

        recipe = read_robot(robot)
        model, warnings = model_of(recipe, surface, band=True)
        self._margin = checked_margin(margin)
        name = str(robot) if isinstance(robot, str | Path) else "ROBOT"
        words = ["slipmargin", "export", "c", name, "--surface", surface, "--margin", str(self._margin)]
        self._command = shlex.join(words)
        self._hash = sha256(write_recipe(recipe).encode()).hexdigest()
        self.table = limit_table(model, self._margin)
        self.warnings = (*warnings, *steady_warnings(model, self._margin))

    def limit_twist(
        self, now: _Numbers, wanted: _Numbers, dt_s: float | Array, heading_rad: float | Array = 0.0
    ) -> tuple[Array, Any]:
        """The next velocity command, on the straight line from the last one to the wanted one.

        Parameters
        ----------
        now, wanted : (3,) or (M, 3)
            Body twists of the origin [m/s, m/s, rad/s].
        dt_s : float or (M,)
            Time until the next command [s].
        heading_rad : float or (M,)
            Yaw on the floor [rad]; only a slope needs it.

        Returns
        -------
        (3,) or (M, 3) twist, and its code (:meth:`meaning`), an int or (M,).
        """
        from slipmargin.onboard.limiter import limit_twist

        one, now, wanted = _states("wanted", now, wanted)
        twist, code = limit_twist(
            self.table,
            now,
            wanted,
            _each("dt_s", dt_s, len(now)),
            _each("heading_rad", heading_rad, len(now)),
        )
        return (twist[0], int(code[0])) if one else (twist, code)

    def limit_acceleration(
        self, now: _Numbers, wanted: _Numbers, heading_rad: float | Array = 0.0
    ) -> tuple[Array, Any]:
        """A wanted body acceleration cut back to the margin at a twist.

        Parameters
        ----------
        now, wanted : (3,) or (M, 3)
            Body twist [m/s, m/s, rad/s]; acceleration of the origin in body axes [m/s², m/s², rad/s²].

        Returns
        -------
        (3,) or (M, 3) acceleration, and its code (:meth:`meaning`), an int or (M,).
        """
        from slipmargin.onboard.limiter import cleaned, limit_acceleration

        one, now, wanted = _states("wanted", now, wanted)
        t, code = limit_acceleration(self.table, now, wanted, _each("heading_rad", heading_rad, len(now)))
        out = t[:, None] * cleaned(wanted)[0]
        return (out[0], int(code[0])) if one else (out, code)

    def margin(
        self, now: _Numbers, acceleration: _Numbers, heading_rad: float | Array = 0.0
    ) -> tuple[Any, Any]:
        """Share of its grip that the most loaded wheel uses, and that wheel's name.

        Parameters
        ----------
        now, acceleration : (3,) or (M, 3)
            Body twist and acceleration of the origin in body axes.

        Returns
        -------
        float or (M,) share, above 1 where the robot must slip; str or list of str.
        """
        from slipmargin.onboard.limiter import utilisation

        one, now, acceleration = _states("acceleration", now, acceleration)
        use = utilisation(self.table, now, acceleration, _each("heading_rad", heading_rad, len(now)))
        share, wheel = use.max(axis=1), [self.table.names[k] for k in use.argmax(axis=1)]
        return (float(share[0]), wheel[0]) if one else (share, wheel)

    @staticmethod
    def meaning(code: int) -> str:
        """What a code says."""
        return CODES[code]

    def c_header(self, source: str | None = None) -> str:
        """The limiter as one C99 and C++17 header.

        Parameters
        ----------
        source : str, optional
            What made it, for the header's first lines; by default the command that makes the same header, in
            which a robot without a file is ROBOT.
        """
        from slipmargin import __version__
        from slipmargin.onboard.c_header import c_header

        made = self._command if source is None else source
        return c_header(self.table, version=__version__, robot_hash=self._hash, source=made)

    def summary(self) -> str:
        """Robot, surface and margin."""
        t = self.table
        return f"limiter of {t.robot} on {t.surface}: {t.count} wheels, margin {self._margin:g}"

    def lines(self) -> list[str]:
        """What the limiter knows, and what a call costs."""
        from slipmargin.onboard.c_header import operations, row_count

        t = self.table
        known = ["grip of every wheel"]
        known += ["load transfer"] if t.transfers else []
        known += ["motor torque"] if t.stall_torque_N_m is not None else []
        known += ["top speed"] if t.top_speed_rad_s is not None else []
        known += ["slope of the floor"] if t.turned else []
        cost = ", ".join(f"{name} {count}" for name, count in operations(t).items())
        return [
            self.summary(),
            f"keeps: {', '.join(known)} ({row_count(t)} rows)",
            f"operations at most: {cost}",
        ]

    def to_dict(self) -> dict[str, Any]:
        """Robot, margin, hash and operation counts."""
        from slipmargin.onboard.c_header import operations, row_count

        return {
            **head(self.table.robot, self.table.surface, self._margin),
            "robot_sha256": self._hash,
            "rows": row_count(self.table),
            "operations": operations(self.table),
        }


def _states(place: str, now: _Numbers, other: _Numbers) -> tuple[bool, Array, NDArray[np.float64]]:
    """Whether it is one state, and both as (M, 3)."""
    first, second = np.asarray(now, dtype=float), np.asarray(other, dtype=float)
    for name, values in (("now", first), (place, second)):
        if values.ndim not in (1, 2) or values.shape[-1] != 3:
            raise InputError(name, f"has the shape {values.shape}", "give three numbers, or rows of three")
    if first.shape != second.shape:
        raise InputError(place, f"has the shape {second.shape}, now {first.shape}", "give as many of both")
    return first.ndim == 1, np.atleast_2d(first), np.atleast_2d(second)


def _each(place: str, value: float | Array, count: int) -> Array:
    given = np.asarray(value, dtype=float)
    if given.shape not in ((), (count,)):
        raise InputError(place, f"has the shape {given.shape}", "give one number, or one a state")
    return np.array(np.broadcast_to(given, (count,)))


def export_c(robot: RobotLike, surface: str, path: Path | str, *, margin: float = 0.1) -> Limiter:
    """Write the C header of a robot's limiter.

    Parameters
    ----------
    robot, surface, margin
        As for :class:`Limiter`.
    path : str or Path
        The header; it is written whole or not at all.

    Returns
    -------
    Limiter
        The same limiter in Python.

    Raises
    ------
    InputError
        For a fault in the robot file or an argument, or where the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import slipmargin as sm
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     limiter = sm.export_c("ohio-kiwi", "paper", pathlib.Path(folder, "limit.h"))
    >>> limiter
    <limiter of ohio-kiwi on paper: 3 wheels, margin 0.1>
    """
    limiter = Limiter(robot, surface, margin=margin)
    limiter.write_files(texts={path: limiter.c_header()})
    return limiter
