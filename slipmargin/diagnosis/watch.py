"""Progress that is reported, and the time at which a search stops with the best answer so far."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

from slipmargin.checks import real
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.errors import InputError
from slipmargin.physics.compiled import compiling_s

Progress = Callable[[str, float], None]


def no_progress(stage: str, share: float) -> None:
    """Progress that is not shown."""


def clock_s() -> float:
    """Time by which a search is limited [s]: it stands while code is compiled, once after installation."""
    return time.monotonic() - compiling_s()


@final
class OutOfTime(Exception):
    """A step of a search was left because its time is over; what earlier steps found stands."""


def cut_short(budget_s: float | None) -> tuple[str, ...]:
    """What a report says of a search that its budget ended."""
    return (
        f"The time budget of {budget_s:g} s ended the search: this is the best answer until then; candidates "
        "that were not reached, and further effects, were not tried.",
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Watch:
    """Reports progress; ``until_s`` is when time runs out on :func:`clock_s`, None: never."""

    report: Callable[[str, float], None]
    until_s: float | None = None
    prefix: str = ""

    @staticmethod
    def of(report: Callable[[str, float], None], budget_s: float | None) -> Watch:
        """A watch that starts now.

        Raises
        ------
        InputError
            If the budget is not a positive number of seconds.
        """
        if budget_s is None:
            return Watch(report=report)
        cure = "give the seconds that the search may take, above 0"
        if real("budget_s", budget_s, cure=cure) <= 0.0:
            raise InputError("budget_s", f"is {budget_s:g}", cure)
        return Watch(report=report, until_s=clock_s() + budget_s)

    def __call__(self, stage: str, share: float) -> None:
        self.report(self.prefix + stage, share)

    @property
    def expired(self) -> bool:
        """Whether the time is over."""
        return self.until_s is not None and clock_s() >= self.until_s

    @property
    def overdue(self) -> bool:
        """Whether the time has been over for so long that even a first list is cut."""
        return self.until_s is not None and clock_s() >= self.until_s + SETTINGS.list_s

    def check(self) -> None:
        """Leave the step of a search that is being made.

        Raises
        ------
        OutOfTime
            If the time is over.
        """
        if self.expired:
            raise OutOfTime

    def part(self, share: float) -> Watch:
        """The same watch for a share (0 to 1) of the time that is left."""
        if self.until_s is None:
            return self
        now = clock_s()
        return replace(self, until_s=now + share * max(0.0, self.until_s - now))

    def staged(self, stage: str) -> Watch:
        """The same watch with texts that begin with the stage."""
        return replace(self, prefix=f"{self.prefix}{stage}: ")
