"""The lines of a slip monitor's stream: which columns come in, and what goes out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, final

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.onboard.signals import Channels

#: The columns of a line out.
HEADER = "t_s,slip_probability,alarm,wheel,vx_m_s,vy_m_s,wz_rad_s,cov_xx,cov_xy,cov_xw,cov_yy,cov_yw,cov_ww"


def line(t_s: float, probability: float, alarm: bool, wheel: str, twist: Array, c: Array) -> str:
    """One sample as a line out: covariance c (3, 3) by its upper half."""
    numbers = (*twist, c[0, 0], c[0, 1], c[0, 2], c[1, 1], c[1, 2], c[2, 2])
    told = ",".join(f"{v:.6g}" for v in numbers)
    return f"{t_s:.9g},{probability:.4f},{int(alarm)},{wheel},{told}"


@final
@dataclass(frozen=True, slots=True)
class Columns:
    """Where the columns of a stream stand: time, wheel speeds, commands, gyro, currents.

    ``count`` columns stand in the header, ``unread`` are those that nothing asks for.
    """

    places: tuple[int, ...]
    count: int = 0
    unread: tuple[str, ...] = ()

    @staticmethod
    def of(names: list[str], count: int, channels: Channels) -> Columns:
        """The places of the columns that are needed, in the header ``names``."""
        wheels = range(1, count + 1)
        wanted = ["t_s", *(f"omega{i}_rad_s" for i in wheels)]
        wanted += [f"omega{i}_cmd_rad_s" for i in wheels] if channels.commanded else []
        wanted += ["gyro_rad_s"] if channels.gyro else []
        wanted += [f"current{i}_A" for i in wheels] if channels.current else []
        missing = [name for name in wanted if name not in names]
        if missing:
            raise InputError(
                "line 1", f"lacks the column {missing[0]}", f"name the columns {', '.join(wanted)}"
            )
        twice = [name for name in wanted if names.count(name) > 1]
        if twice:
            raise InputError("line 1", f"has the column {twice[0]} twice", "remove one of them")
        return Columns(
            tuple(names.index(name) for name in wanted),
            len(names),
            tuple(name for name in names if name not in wanted),
        )

    def split(self, values: list[float], n: int, channels: Channels) -> dict[str, Any]:
        """The arguments of :meth:`SlipMonitor.update` without the time."""
        out: dict[str, Any] = {"omega_rad_s": values[1 : 1 + n]}
        at = 1 + n
        if channels.commanded:
            out["commanded_rad_s"], at = values[at : at + n], at + n
        if channels.gyro:
            out["gyro_rad_s"], at = values[at], at + 1
        if channels.current:
            out["current_A"] = values[at : at + n]
        return out


@final
class Lines:
    """Lines of a log whose first one, the header, can be looked at before they are read."""

    def __init__(self, source: str, lines: Iterator[str]) -> None:
        self._lines, self.source = lines, source
        self.first = next(lines, "")
        if not self.first.strip():
            raise InputError("line 1", "is empty", "name the columns: t_s,omega1_rad_s,…", source)

    def __iter__(self) -> Iterator[str]:
        yield self.first
        yield from self._lines
