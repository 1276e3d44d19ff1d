"""A record: what cameras and encoders saw of one run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index, measurable, read_only, shaped
from slipmargin.data.settings import SETTINGS
from slipmargin.errors import InputError

#: The signals of the wheels that a record may hold: field name → meaning.
WHEEL_SIGNALS = {
    "omega": "measured wheel speed [rad/s]",
    "theta": "measured wheel angle [rad]",
    "omega_cmd": "commanded wheel speed [rad/s]",
    "current": "motor current [A]",
}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """One measured run: sampled pose and what is known of the wheels, missing samples as NaN.

    Parameters
    ----------
    name : str
        What the run is called (its file's name without the ending).
    t_s : array (T,)
        Time stamps [s], strictly increasing, at least two; sampling may be irregular.
    pose : array (T, 3)
        x [m], y [m], φ [rad] of the body frame's origin in the floor frame; φ unwrapped.
    omega, theta, omega_cmd, current : array (T, N) or None
        Wheel speed [rad/s], angle [rad], commanded speed [rad/s], motor current [A].  A wheel that
        has no such channel is a column of NaN; ``None`` where no wheel has.
    commands_held : bool
        Whether each commanded speed holds until the next row; else commands run straight from row to row.
    began_s : float, optional
        When the run began [s] that this is cut from; by default it begins with it.
    """

    name: str
    t_s: Array
    pose: Array
    omega: Array | None = None
    theta: Array | None = None
    omega_cmd: Array | None = None
    current: Array | None = None
    commands_held: bool = False
    began_s: float | None = None

    def __post_init__(self) -> None:
        time = _signal("t_s", self.t_s, (None,))  # of any size: it may count from 1970
        if len(time) < 2:
            raise InputError("t_s", f"{len(time)} samples are no motion", "give two rows or more")
        if not np.all(np.isfinite(time)):
            raise InputError("t_s", "holds a time that is missing", "every row needs its time [s]")
        step = np.diff(time)
        if np.min(step) <= 0.0:
            row = int(np.argmax(step <= 0.0)) + 1
            raise InputError(
                "t_s",
                f"sample {row + 1} is at {time[row]:g} s, after {time[row - 1]:g} s",
                "time must increase from row to row",
            )
        if self.began_s is not None and not self.began_s <= time[0]:
            raise InputError(
                "began_s", f"is {self.began_s:g} s, after the first sample", "give when it began"
            )
        put = object.__setattr__
        put(self, "t_s", time)
        put(self, "pose", measurable("pose", _signal("pose", self.pose, (len(time), 3))))
        count: int | None = None
        for field in WHEEL_SIGNALS:
            value = getattr(self, field)
            if value is None:
                continue
            signal = measurable(field, _signal(field, value, (len(time), count)))
            count = signal.shape[1]
            put(self, field, signal)
        if not self.seen.any():
            raise InputError("pose", "no sample holds a whole pose", "give x, y and φ together")

    @property
    def seen(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """(T,) true where the whole pose was measured."""
        return np.asarray(np.isfinite(self.pose).all(axis=1))

    @property
    def poses(self) -> int:
        """Number of samples in which the pose, or a part of it, was measured."""
        return int(np.isfinite(self.pose).any(axis=1).sum())

    @property
    def wheels(self) -> int:
        """Number of wheels N with a channel; 0 where only the pose is known."""
        for field in WHEEL_SIGNALS:
            value: Array | None = getattr(self, field)
            if value is not None:
                return int(value.shape[1])
        return 0

    def first(self, rows: int = SETTINGS.first_rows) -> Record:
        """The run up to so many rows after its first whole pose; itself where it is no longer."""
        stop = int(np.argmax(self.seen)) + rows
        if stop >= len(self.t_s):
            return self
        return self.part(slice(stop))

    def part(self, rows: slice | NDArray[np.bool_] | Index) -> Record:
        """These rows of the run, which began when it did."""
        cut: dict[str, Any] = {
            name: None if (value := getattr(self, name)) is None else value[rows] for name in WHEEL_SIGNALS
        }
        return replace(self, t_s=self.t_s[rows], pose=self.pose[rows], began_s=self.start_s, **cut)

    def restamped(self, t_s: Array) -> Record:
        """The same samples at other times (T,) [s]; when the run began moves in proportion."""
        if self.began_s is None:
            return replace(self, t_s=t_s)
        rate = float(t_s[-1] - t_s[0]) / self.duration_s
        return replace(self, t_s=t_s, began_s=float(t_s[0]) - rate * float(self.t_s[0] - self.began_s))

    @property
    def start_s(self) -> float:
        """When the run began [s], which this may be cut from."""
        return float(self.t_s[0]) if self.began_s is None else self.began_s

    @property
    def since_s(self) -> Array:
        """Times (T,) since the run began [s]."""
        return np.asarray(self.t_s - self.start_s)

    @property
    def duration_s(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.t_s[-1] - self.t_s[0])


def _signal(place: str, value: object, shape: tuple[int | None, ...]) -> Array:
    """A read-only copy in which NaN stands for a missing sample; infinity is refused."""
    array = shaped(place, value, shape)
    if np.isinf(array).any():
        raise InputError(place, "holds an infinite value", "leave a missing sample empty")
    return read_only(array)
