"""The report pages of ``stop`` and ``monitor``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.model import Model
from slipmargin.report.page import Fact, Image, Page, Picture, Table
from slipmargin.report.result_page import result_page
from slipmargin.report.text import towards

#: Events that a page lists before it says how many more there are.
MOST_EVENTS = 50
#: Above this slip is more probable than grip, both being equally likely beforehand [1].
LIKELY = 0.5


def stop_page(
    model: Model,
    *,
    margin: float,
    heading_rad: Array,
    speed_m_s: Array,
    distance_m: Array,
    time_s: Array,
    limited: Sequence[str],
    farthest_m: float,
    worst: int,
    use: Array,
    verified: bool,
    over: int,
    lifted: int,
    ended: Sequence[str],
    image: Image,
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """How long a stop is in every direction, and what to give the safety system."""
    way = [towards(float(a)) for a in model.convention.from_front(heading_rad)]
    speed, simulated = speed_m_s[-1], bool(np.all(np.isfinite(use)))
    lead = (
        f"{model.robot} on {model.surface} stops from {speed:.3g} m/s within {farthest_m:.3g} m in every "
        f"direction, with {100.0 * margin:g} % of the grip in reserve."
    )
    if ended:
        lead += f" In simulation {len(ended)} stops do not reach their end: do not rely on these distances."
    elif over:
        lead += " In simulation a stop used more grip than that: do not rely on these distances."
    elif lifted:
        lead += (
            f" In simulation a wheel lifts in {lifted} of {use.size} stops: do not rely on these distances."
        )
    used = f"{np.max(use):.3f} of a wheel's grip" if simulated else "not simulated"
    if ended:
        used = f"{len(ended)} of {use.size} end early"
    rows = [
        (f"{at:.0f}°, {way[h]}", *(f"{s:.4g} m, {t:.3g} s" for s, t in zip(ds, ts, strict=True)), limited[h])
        for h, (at, ds, ts) in enumerate(zip(np.rad2deg(heading_rad), distance_m, time_s, strict=True))
    ]
    return result_page(
        title=f"Stopping distance of {model.robot} on {model.surface}",
        lead=lead,
        good=verified,
        facts=(
            Fact(label="Longest stop", value=f"{farthest_m:.4g} m", note=way[worst]),
            Fact(label="It takes", value=f"{time_s[worst, -1]:.3g} s", note=f"from {speed:.3g} m/s"),
            Fact(label="Limited by", value=limited[worst], note="at the highest speed"),
            Fact(label="In simulation", value=used, note=f"{1.0 - margin:.3g} allowed"),
        ),
        pictures=(
            Picture(
                name="stops",
                image=image,
                alt="Polar curves of the stopping distance by direction of motion, one for each speed",
                caption="Stopping distance by direction of motion, forwards up.",
            ),
        ),
        tables=(
            Table(
                caption="Distance and time by direction of motion, counter-clockwise from the robot's +x",
                head=("direction", *(f"from {v:.4g} m/s" for v in speed_m_s), "limited by"),
                rows=tuple(rows),
            ),
        ),
        next_steps=(
            f"Give a safety scanner {farthest_m:.3g} m and the way driven while the robot reacts.",
            "Let the robot brake like this: `slipmargin export c` writes the limiter that keeps the margin.",
            "Measure one stop and compare: friction decides, and it differs from floor to floor.",
        ),
        lines=lines,
        warnings=warnings,
    )


def monitor_page(
    *,
    robot: str,
    surface: str,
    source: str,
    false_alarm_rate: float,
    count: int,
    alarms: float,
    events: Sequence[tuple[float, float, str, float]],
    highest: float,
    quiet: bool,
    image: Image,
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """Where a log slips: events are (start [s], end [s], wheel, highest probability).

    ``highest`` is the highest slip probability of the whole log.
    """
    often = "once" if len(events) == 1 else f"{len(events)} times"
    if quiet:
        lead = f"{source}: no alarm can be given, the training runs are too few for the rate that was asked."
    elif events:
        share = f"alarm in {100.0 * alarms:.3g} % of the samples"
        lead = f"{source}: {robot} slips {often} on {surface}, {share}."
    elif highest > LIKELY:
        lead = (
            f"{source}: no alarm, although the slip probability reaches {highest:.2g}. While {robot} grips, "
            f"that happens too often for {100.0 * false_alarm_rate:g} % false alarms."
        )
    else:
        lead = f"{source}: no sign of slip."
    wheels = sorted({wheel for _, _, wheel, _ in events})
    rows = [(f"{a:.3f} … {b:.3f}", wheel, f"{p:.3f}") for a, b, wheel, p in events[:MOST_EVENTS]]
    more = f" (the first {MOST_EVENTS} of {len(events)})" if len(events) > MOST_EVENTS else ""
    return result_page(
        title=f"Slip of {robot} on {surface}",
        lead=lead,
        good=not events and not quiet and highest <= LIKELY,
        facts=(
            Fact(label="Events", value=str(len(events))),
            Fact(label="Samples with alarm", value=f"{100.0 * alarms:.2f} %", note=f"of {count}"),
            Fact(
                label="False alarms set",
                value=f"{100.0 * false_alarm_rate:g} %",
                note="of the samples that grip",
            ),
            Fact(label="Most loaded then", value=", ".join(wheels) or "none", note="by the robot's model"),
        ),
        pictures=(
            Picture(
                name="slip",
                image=image,
                alt="Slip probability over time with the events shaded",
                caption="Slip probability over time; where it alarms the background is shaded.",
            ),
        ),
        tables=(Table(caption=f"Events{more}", head=("time [s]", "wheel", "probability"), rows=tuple(rows)),)
        if rows
        else (),
        next_steps=(
            "Find out why: `slipmargin diagnose` on runs with poses names what the model lacks.",
            "Prevent it: `slipmargin export c` writes a limiter that keeps commands within the grip.",
            "The wheel is the one that the model loads most, not a measurement.",
        ),
        lines=lines,
        warnings=warnings,
    )
