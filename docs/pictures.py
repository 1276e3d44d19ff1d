"""Draw the pictures of the README and the site into docs/pictures.

    python docs/pictures.py [limits] [diagnosis] [next-run]       all of them, or those that are named

``diagnosis`` makes ten runs of a robot with rigid rims, diagnoses them and takes about half a minute;
``next-run`` asks which runs would tell a wheel's radius from its toe, and takes as long.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import slipmargin as sm
from slipmargin.plots.machine import draw_machine
from slipmargin.plots.polar import forwards_up, polar_axes
from slipmargin.plots.style import BLUE, GREY, INK, RED, SKY, save, styled

FOLDER = Path(__file__).resolve().parent / "pictures"


@styled
def limits_picture(robot: str = "mecanum4", surface: str = "carpet"):
    """How hard a robot may accelerate by direction, with numbers, beside a drawing of the robot."""
    from matplotlib.figure import Figure

    found = sm.bounds(robot, surface).bounds
    turned = found.model.convention.from_front
    heading = np.append(found.safe.heading_rad, found.safe.heading_rad[0] + 2.0 * np.pi)
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.25))
    machine = figure.add_subplot(grid[0])
    draw_machine(machine, found.model)
    machine.set_axis_off()
    machine.set_aspect("equal")
    machine.set_title("A robot …")
    axes = polar_axes(figure, grid[1])
    edge = np.append(found.full.starting_m_s2, found.full.starting_m_s2[0])
    safe = np.append(found.safe.starting_m_s2, found.safe.starting_m_s2[0])
    axes.fill(turned(heading), safe, color=SKY, alpha=0.45, lw=0, label="safe: 10 % of the grip in reserve")
    axes.plot(turned(heading), edge, color=BLUE, label="a wheel begins to slip")
    for degrees in (90.0, 45.0, 0.0):
        apart = np.abs(np.angle(np.exp(1j * (found.safe.heading_rad - np.deg2rad(degrees)))))
        near = apart < np.deg2rad(3.0)  # not the tip of a needle
        safe_there = float(np.min(found.safe.starting_m_s2[near]))
        axes.annotate(
            f"{safe_there:.1f}",
            (float(turned(np.deg2rad(degrees))), 0.78 * safe_there),  # inside the area that it is the edge of
            ha="center",
            va="center",
            color=INK,
            fontsize=13,
            fontweight="bold",
        )
    forwards_up(axes)
    axes.set_rlabel_position(112.0)
    axes.tick_params(axis="y", labelsize=8, labelcolor=GREY)
    axes.set_title("… and how hard it can accelerate [m/s²]", pad=16)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=1)
    return figure


@styled
def diagnosis_picture():
    """A run that no fit has seen, predicted without and with the effect that ``diagnose`` found."""
    from matplotlib.figure import Figure

    sys.path.insert(0, str(FOLDER.parents[1] / "benchmarks"))
    from planting import Plant, planted, smooth_kiwi

    from slipmargin.effects import Trace
    from slipmargin.effects.rigid_sector import RigidSector

    plant = Plant(name="rims", traces=(Trace.WHEEL_ANGLE,), effects=(RigidSector(rigid_fraction=0.1),))
    found = sm.diagnose(planted(smooth_kiwi(), plant, seed=11, count=8, duration_s=3.0)).diagnosis
    run = max(
        (t for t in found.trials if t.held_out),
        key=lambda t: np.max(np.hypot(*(t.measured - t.before).T[:2])),
    )
    figure = Figure(figsize=(9.0, 3.3), layout="constrained")
    for axes, predicted, colour, title in zip(
        figure.subplots(1, 2, sharex=True, sharey=True),
        (run.before, run.after),
        (RED, BLUE),
        ("Model without the effect", f"With what was found: {found.findings[0].effect.name}"),
        strict=True,
    ):
        off_m = np.sqrt(np.mean(np.sum((run.measured - predicted)[:, :2] ** 2, axis=1)))
        axes.plot(
            1e3 * run.measured[::8, 0],
            1e3 * run.measured[::8, 1],
            "o",
            ms=3,
            color=INK,
            alpha=0.5,
            label="measured",
        )
        axes.plot(1e3 * predicted[:, 0], 1e3 * predicted[:, 1], color=colour, label="predicted")
        axes.set(
            title=f"{title}\n{1e3 * off_m:.2g} mm off (r.m.s.)",
            xlabel="x [mm]",
            aspect="equal",
        )
        axes.legend(loc="best")
    figure.axes[0].set_ylabel("y [mm]")
    return figure


def next_run_picture():
    """The runs that would tell a wheel's radius from its toe after ten runs straight ahead."""
    sys.path.insert(0, str(FOLDER.parents[1] / "benchmarks"))
    from next_run import CASES, data_set, logged, standard_runs

    case = next(c for c in CASES if c.name == "radius")
    runs = logged(case, standard_runs(case, range(10)), seed=1)
    return sm.next_run(data_set(runs), space_m=(3.0, 2.0)).plot()


def main(names: list[str]) -> None:
    """Draw what is asked for."""
    FOLDER.mkdir(exist_ok=True)
    if not names or "limits" in names:
        save(limits_picture(), FOLDER / "limits.png")
    if not names or "diagnosis" in names:
        save(diagnosis_picture(), FOLDER / "diagnosis.png")
    if not names or "next-run" in names:
        save(next_run_picture(), FOLDER / "next-run.png")


if __name__ == "__main__":
    main(sys.argv[1:])
