"""``slipmargin plan``: the fastest way along a path with a margin against slip."""

from __future__ import annotations

from .options import JsonOpt, MarginOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .plan_options import (
    BlendOpt,
    ClosedOpt,
    MaxSpeedOpt,
    MaxYawRateOpt,
    PointsOpt,
    RobustOpt,
    SpeedOpt,
    TimeStepOpt,
    VerifyOpt,
    WayArg,
)
from .render import say, warn


def plan(
    robot: RobotArg,
    path: WayArg,
    surface: SurfaceOpt,
    margin: MarginOpt = 0.1,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    closed: ClosedOpt = False,
    blend: BlendOpt = None,
    start_speed: SpeedOpt = 0.0,
    end_speed: SpeedOpt = 0.0,
    max_speed: MaxSpeedOpt = None,
    max_yaw_rate: MaxYawRateOpt = None,
    robust: RobustOpt = False,
    points: PointsOpt = 400,
    step: TimeStepOpt = 0.005,
    verify: VerifyOpt = False,
) -> None:
    """The fastest motion along waypoints that keeps every wheel below 1 − margin of its grip.

    The table holds pose, velocity and acceleration in the floor frame, wheel speeds that roll without
    slip and the share of each wheel's grip (0 to 1).
    """
    from .machine import machine
    from .plan_run import ask, report, run_plan, table

    model, warning = machine(robot, surface)
    request = ask(margin, points, (start_speed, end_speed), (max_speed, max_yaw_rate), robust)
    found = run_plan(model, path, request, closed, blend, step, verify, (out, plot, json))
    found.write(out, plot)
    if warning:
        warn(warning)
    if not put_json(json, table(found)):
        say(*report(found), *(f"written: {name}" for name in (out, plot) if name))
