"""What a slip monitor says: of one sample, and of a whole log."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import Result, head
from slipmargin.checks import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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


def slip_events(estimates: Iterable[SlipEstimate]) -> tuple[SlipEvent, ...]:
    """The events of a row of estimates."""
    groups: list[list[SlipEstimate]] = []
    before = False
    for one in estimates:
        if one.alarm:
            if not before:
                groups.append([])
            groups[-1].append(one)
        before = one.alarm
    return tuple(
        SlipEvent(
            start_s=group[0].t_s,
            end_s=group[-1].t_s,
            wheel=group[0].wheel,
            probability=max(one.slip_probability for one in group),
        )
        for group in groups
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MonitoredLog(Result):
    """A log that a monitor has read: its estimates, its events, and a line for every sample.

    ``quiet`` says that the training runs were too few for the rate, so that nothing could alarm.
    """

    robot: str
    surface: str
    source: str
    false_alarm_rate: float
    quiet: bool
    estimates: tuple[SlipEstimate, ...]
    text: str
    warnings: tuple[str, ...]

    @property
    def events(self) -> tuple[SlipEvent, ...]:
        """Alarms that follow one another as one event."""
        return slip_events(self.estimates)

    @property
    def alarm_share(self) -> float:
        """Share of the samples that alarm."""
        return sum(one.alarm for one in self.estimates) / max(len(self.estimates), 1)

    def summary(self) -> str:
        """How many samples, alarms and events."""
        return (
            f"{self.source}: {len(self.estimates)} samples, alarm in {100.0 * self.alarm_share:.2f} % of "
            f"them, {len(self.events)} events"
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

    def table_text(self) -> str:
        """A line a sample, as the stream gives them."""
        return self.text

    def plot(self) -> Figure:
        """Slip probability over time, the events shaded."""
        from slipmargin.plots.onboard import monitor_figure

        return monitor_figure(
            np.array([one.t_s for one in self.estimates]),
            np.array([one.slip_probability for one in self.estimates]),
            [(e.start_s, e.end_s) for e in self.events],
        )

    def page(self) -> Page:
        """The report: verdict, numbers, picture, events, what to do next."""
        from slipmargin.plots.style import image
        from slipmargin.report.onboard_pages import monitor_page

        return monitor_page(
            robot=self.robot,
            surface=self.surface,
            source=self.source,
            false_alarm_rate=self.false_alarm_rate,
            count=len(self.estimates),
            alarms=self.alarm_share,
            events=[(e.start_s, e.end_s, e.wheel, e.probability) for e in self.events],
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
            "samples": len(self.estimates),
            "alarm_share": self.alarm_share,
            "events": [
                {"start_s": e.start_s, "end_s": e.end_s, "wheel": e.wheel, "probability": e.probability}
                for e in self.events
            ],
        }
