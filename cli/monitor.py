"""``slipmargin monitor``: is a wheel slipping, from a stream or a log of wheel speeds."""

from __future__ import annotations

import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, TextIO

import typer

from .options import JsonOpt, PlotOpt, ReportOpt, RobotArg, SeedOpt, SurfaceOpt, check_outputs, deliver
from .render import at_options, read_with_progress, refuse, say, say_at_once


def monitor(
    robot: RobotArg,
    log: Annotated[str, typer.Argument(metavar="LOG.csv|-", help="Log, or - for a stream on stdin.")],
    surface: SurfaceOpt,
    false_alarms: Annotated[
        float,
        typer.Option(
            metavar="P",
            help="Share of the samples without slip that may alarm, on runs like those it trains on.",
        ),
    ] = 0.01,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write a line a sample.")] = None,
    train: Annotated[
        Path | None, typer.Option(metavar="DATASET", help="Train on these runs with poses, not on the model.")
    ] = None,
    torque_per_ampere: Annotated[
        float | None, typer.Option(metavar="K", help="Torque at the wheel per ampere [N m/A], for currents.")
    ] = None,
    seed: SeedOpt = 0,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> None:
    """The probability of slip by a likelihood ratio under the robot's own model: one line in, one line out.

    The first line names the columns: t_s, omega{i}_rad_s and, where logged, omega{i}_cmd_rad_s, gyro_rad_s
    and current{i}_A.  A line out holds the slip probability, the alarm and during one the wheel that
    the model loads most, the corrected body velocity with its covariance.  Three wheels without gyro or
    current can only show a motion that the robot file's grip cannot hold.  From a file, or where an output
    is asked for, the events are printed when it ends, and --out takes the lines.
    """
    import slipmargin as sm

    check_outputs(out=out, json=json, report=report, plot=plot, reads=(robot, log, train))
    live = log == "-" and not (out or plot or json or report)
    with (
        read_with_progress(),
        at_options(
            surface="--surface",
            false_alarm_rate="--false-alarms",
            torque_per_ampere_N_m="--torque-per-ampere",
            seed="--seed",
        ),
    ):
        lines = sm.SlipMonitor.lines(log, _stdin() if log == "-" else None)
        watch = sm.SlipMonitor.of_header(
            robot,
            surface,
            lines,
            false_alarm_rate=false_alarms,
            training=train,
            torque_per_ampere_N_m=torque_per_ampere,
            seed=seed,
        )
        found = None if live else watch.log(lines, log, out)
    if found is not None:
        deliver(found, plot=plot, json=json, report=report, written=[out] if out else [])
        return
    say_at_once(*(f"warning: {line}" for line in watch.warnings))
    for line in watch.stream(lines, source=lines.source):
        if not say(line):
            return  # nobody reads any more


def _stdin() -> TextIO:
    """What is piped in, as UTF-8 in any locale; bytes that are none are refused when they are met."""
    if sys.stdin is None:
        refuse("-", "there is no stdin", "pipe a log in, or name a file")
    if isinstance(sys.stdin, TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8-sig", errors="surrogateescape")
    return sys.stdin
