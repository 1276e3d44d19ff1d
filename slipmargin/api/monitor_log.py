"""What a slip monitor says: of one sample, and of a whole log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result, head
from slipmargin.checks import Array

if TYPE_CHECKING:
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SlipEstimate:
    """What a monitor says of one sample.

    ``slip_probability`` counts slipping and gripping as equally likely beforehand; ``wheel`` is the wheel
    that its model loads most (empty where it does not alarm); ``twist`` (3,) is the corrected body velocity
    with its ``covariance`` (3, 3) [m/s, m/s, rad/s].
    """

    t_s: float
    slip_probability: float
    log_ratio: float
    alarm: bool
    wheel: str
    twist: Array
    covariance: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlipEvent:
    """Alarms that follow one another: from when to when [s], the first one's wheel, highest probability."""

    start_s: float
    end_s: float
    wheel: str
    probability: float


#: Points of the curve of a log, at most twice as many while it is read.
POINTS = 2000


@final
class Tally:
    """What many estimates come to, without keeping them: their number, the alarms, events and a curve."""

    def __init__(self) -> None:
        self.samples, self.alarms = 0, 0
        self.events: list[SlipEvent] = []
        self._alarmed, self._every = False, 1
        self._t: list[float] = []
        self._p: list[float] = []

    def append(self, one: SlipEstimate) -> None:
        """Count one estimate more."""
        p = one.slip_probability
        if one.alarm:
            start, wheel, before = one.t_s, one.wheel, 0.0
            if self._alarmed:
                last = self.events.pop()
                start, wheel, before = last.start_s, last.wheel, last.probability
            self.events.append(
                SlipEvent(start_s=start, end_s=one.t_s, wheel=wheel, probability=max(before, p))
            )
        if self.samples % self._every:
            self._p[-1] = max(self._p[-1], p)
        else:
            self._t.append(one.t_s)
            self._p.append(p)
        self.samples += 1
        self.alarms += one.alarm
        self._alarmed = one.alarm
        if len(self._p) == 2 * POINTS and self.samples % self._every == 0:
            pairs = zip(self._p[::2], self._p[1::2], strict=True)
            self._t, self._p, self._every = self._t[::2], [max(pair) for pair in pairs], 2 * self._every

    def curve(self) -> tuple[Array, Array]:
        """Times [s] and the highest probability from each to the next, (K,)."""
        return np.array(self._t), np.array(self._p)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MonitoredLog(Result):
    """A log that a monitor has read: its samples, alarms and events, alarms that follow one another.

    ``t_s`` and ``probability`` (K,) are the highest slip probability over parts of the log; ``quiet`` says
    that the training runs were too few for the rate, so that nothing could alarm.
    """

    robot: str
    surface: str
    source: str
    false_alarm_rate: float
    quiet: bool
    samples: int
    alarms: int
    events: tuple[SlipEvent, ...]
    t_s: Array
    probability: Array
    warnings: tuple[str, ...]

    @property
    def alarm_share(self) -> float:
        """Share of the samples that alarm."""
        return self.alarms / max(self.samples, 1)

    def summary(self) -> str:
        """How many samples, alarms and events."""
        return (
            f"{self.source}: {self.samples} samples, alarm in {100.0 * self.alarm_share:.2f} % of "
            f"them, {len(self.events)} events" + (", no alarm possible" if self.quiet else "")
        )

    def lines(self) -> list[str]:
        """The summary, then a line an event."""
        return [
            self.summary(),
            *(
                f"slip {e.start_s:.3f} … {e.end_s:.3f} s, most loaded wheel {e.wheel}, "
                f"probability {e.probability:.3f}"
                for e in self.events
            ),
        ]

    def plot(self) -> Figure:
        """Slip probability over time, the events shaded."""
        from slipmargin.plots.onboard import monitor_figure

        return monitor_figure(self.t_s, self.probability, [(e.start_s, e.end_s) for e in self.events])

    def page(self) -> Page:
        """The report: verdict, numbers, picture, events, what to do next."""
        from slipmargin.plots.style import image
        from slipmargin.report.onboard_pages import monitor_page

        return monitor_page(
            robot=self.robot,
            surface=self.surface,
            source=self.source,
            false_alarm_rate=self.false_alarm_rate,
            count=self.samples,
            alarms=self.alarm_share,
            events=[(e.start_s, e.end_s, e.wheel, e.probability) for e in self.events],
            highest=float(np.max(self.probability, initial=0.0)),
            quiet=self.quiet,
            image=image(self.plot()),
            lines=self.lines(),
            warnings=self.warnings,
        )

    def to_dict(self) -> dict[str, Any]:
        """Rate, samples and events."""
        return {
            **head(self.robot, self.surface),
            "source": self.source,
            "false_alarm_rate": self.false_alarm_rate,
            "quiet": self.quiet,
            "samples": self.samples,
            "alarm_share": self.alarm_share,
            "events": [
                {"start_s": e.start_s, "end_s": e.end_s, "wheel": e.wheel, "probability": e.probability}
                for e in self.events
            ],
        }
