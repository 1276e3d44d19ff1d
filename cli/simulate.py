"""``slipmargin simulate``: what the robot really does under wheel speeds that it is told."""

from __future__ import annotations

from .options import JsonOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import progress, say, warn
from .simulate_options import AnglesOpt, CommandsArg, PushOpt, RtolOpt, StepOpt, UntilOpt


def simulate(
    robot: RobotArg,
    commands: CommandsArg,
    surface: SurfaceOpt,
    out: OutOpt = None,
    theta0: AnglesOpt = None,
    step: StepOpt = 0.01,
    until: UntilOpt = None,
    push: PushOpt = None,
    rtol: RtolOpt = 1e-7,
    plot: PlotOpt = None,
    json: JsonOpt = None,
) -> None:
    """Simulate the slipping motion under wheel speeds (t_s, omega{i}_rad_s, held between rows) or a plan.

    A plan is followed open loop from its first pose, its wheel speeds straight lines between rows.
    Lag, delay and droop that the robot file lists act on the commands.  Velocities are in floor axes.
    """
    from .machine import machine
    from .simulate_run import run_simulation

    model, warning = machine(robot, surface)
    with progress("simulate", 2) as advance:
        found = run_simulation(model, commands, theta0, step, until, push, rtol, (out, plot, json))
        advance()
        found.write(out, plot)
        advance()
    if warning:
        warn(warning)
    if not put_json(json, found.as_json()):
        say(*found.lines(), *(f"written: {path}" for path in (out, plot) if path))
