"""Limits, loads and plans against a rigid-body engine with real rollers (MuJoCo; tests/engines/rollers.py).

    python benchmarks/rollers.py [--part 1/2] [--json FILE]     needs the extra [mujoco]; about ten minutes

For three robots (three omni wheels, four omni wheels, four mecanum wheels; centre of mass off centre and
raised) in twelve directions: wheel speeds for a constant acceleration at shares of the limit that
``slipmargin.limits.bounds.directions`` states; mean loads while accelerating, level and on a slope of 4°; and
three plans each at 0.9 of the grip, played open loop.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path as File
from typing import Any

import numpy as np
from kept import Keeper

sys.path.insert(0, str(File(__file__).resolve().parent.parent / "tests"))

from engines.rollers import GRAVITY, Build, Engine, Log, MovingOff

from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.bounds import directions
from slipmargin.model import Model, nominal_model
from slipmargin.paths.path import Path, corners, through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.robot import GripShape, LoadRule, Robot

#: A wheel slips if it slides this far per distance driven.  The engine's own creep (soft contacts, rollers
#: that take over from each other) stays below 0.9 % at 0.95 of the limit.
GROSS = 0.015
#: Shares of the limit that are tried.
SHARES = (0.95, 0.98, 1.0, 1.02, 1.05)
#: Directions of motion [rad]: every 30°, off the directions in which a wheel does not slide sideways.
HEADINGS = np.deg2rad(np.arange(7.0, 367.0, 30.0))
#: The end of a motion off, in which creep is measured [s].
LATE_S = 0.2
#: Loads are means over this time [s].
MEAN_S = 0.1
SLOPE_DEG = 4.0


@dataclass(frozen=True, kw_only=True)
class Case:
    """A robot on a surface, both as the engine and as the package see it."""

    robot: Robot
    surface: str

    @property
    def model(self) -> Model:
        """The package's model."""
        return nominal_model(self.robot, self.surface)


def case(name: str, surface: str, com_m: tuple[float, float], height_m: float) -> Case:
    """A built-in robot with its centre of mass moved, free rollers (disc-strip) and load transfer."""
    robot = read_recipe(name).robot
    return Case(
        robot=replace(
            robot,
            body=replace(robot.body, com_m=np.array(com_m), com_height_m=height_m),
            load_rule=LoadRule.QUASI_STATIC,
            friction=replace(robot.friction, grip=GripShape.DISC_STRIP),
        ),
        surface=surface,
    )


def cases() -> dict[str, Case]:
    """The three robots."""
    return {
        "kiwi, 3 omni": case("ohio-kiwi-symmetric", "paper", (0.004, -0.006), 0.04),
        "4 omni": case("omni4", "floor", (0.02, -0.03), 0.08),
        "4 mecanum": case("mecanum4", "floor", (0.02, 0.03), 0.10),
    }


def limits(machine: Case, heading_rad: np.ndarray, shape: GripShape = GripShape.DISC_STRIP) -> np.ndarray:
    """Our limit of speeding up at full drag [m/s²], motors left out."""
    model = machine.model
    model = replace(model, grip=replace(model.grip, shape=shape))
    return directions(model, heading_rad, motor=False).starting_m_s2


def moved_off(machine: Case, heading_rad: float, acceleration_m_s2: float) -> np.ndarray:
    """Late creep of each wheel (N,) in the engine, per distance driven."""
    motion = MovingOff(heading_rad=heading_rad, acceleration_m_s2=acceleration_m_s2)
    log = motion.drive(Engine(machine.robot, machine.surface))
    return log.part(motion.end_s - LATE_S, motion.end_s).creep()


def load_errors(machine: Case, motion: MovingOff, slope: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Mean loads while accelerating less those of the package (W, N), per m g / N, window by window.

    On a slope the package is told of the pull along the floor (at the height of the centre of mass) and of
    the weight that is missing across it.  Empty where the wheels slip, so that the robot turns as well.
    """
    engine = Engine(machine.robot, machine.surface, Build(slope=slope))
    log, body, loads = motion.drive(engine), machine.robot.body, machine.model.loads
    pull = body.mass_kg * GRAVITY * np.array(slope)
    lift = body.mass_kg * GRAVITY * (1.0 - np.sqrt(1.0 - np.sum(np.square(slope))))
    errors: list[np.ndarray] = []
    if log.part(motion.steady_s, motion.end_s).creep().max() > GROSS:
        return np.zeros((0, len(machine.robot.wheels)))
    for start in np.arange(motion.steady_s + 0.1, motion.end_s - MEAN_S, MEAN_S):
        part = log.part(start, start + MEAN_S)
        acceleration = _acceleration(part)
        ours = loads.at(acceleration, body.com_height_m * pull, lift)
        errors.append(
            (part.load_N.mean(axis=0) - ours) / (body.mass_kg * GRAVITY / len(machine.robot.wheels))
        )
    return np.array(errors)


def _acceleration(log: Log) -> np.ndarray:
    """Mean acceleration (2,) of a window by its slope [m/s²]: the heading is held."""
    return np.polyfit(log.t_s, log.twist[:, :2], 1)[0]


def paths() -> dict[str, Path]:
    """A diagonal, a slalom, and a turn while translating."""
    s = np.linspace(0.0, 1.0, 7)
    return {
        "diagonal": corners(np.array([[0.0, 0.0, 0.0], [0.5, 0.7, 0.0]])),
        "slalom": through(np.column_stack([s, 0.08 * np.sin(2.0 * np.pi * s), 0.0 * s])),
        "turn while translating": corners(np.array([[0.0, 0.0, 0.0], [0.8, 0.2, 1.2]])),
    }


def played(machine: Case, way: Path, share: float = 0.9) -> dict[str, float]:
    """A plan's wheel speeds, open loop, in the engine: creep per distance, and how far off it ends."""
    rows = trajectory(plan(machine.model, way, Request(share=share)))
    engine = Engine(machine.robot, machine.surface)

    def speeds(t: float) -> np.ndarray:
        return np.array([np.interp(t, rows.t_s, column, right=0.0) for column in rows.omega.T])

    log = engine.run(speeds, rows.duration_s)
    far = np.sum(np.hypot(*log.twist[:, :2].T)) * engine.build.tick_s
    slipped = np.sum(np.abs(log.slip_m_s), axis=0) * engine.build.tick_s
    off = log.pose[-1] - rows.pose[-1]
    return {
        "duration_s": rows.duration_s,
        "distance_m": float(far),
        "planned_use": float(rows.use.max()),
        "creep_percent": float(100.0 * slipped.max() / far),
        "fastest_slip_mm_s": float(1e3 * np.abs(log.slip_m_s).max()),
        "end_off_mm": float(1e3 * np.hypot(*off[:2])),
        "end_off_deg": float(np.degrees(abs(off[2]))),
    }


def starting_row(machine: Case, heading_rad: float) -> dict[str, Any]:
    """Our limit in a direction, and what the engine says at shares of it."""
    limit = float(limits(machine, np.array([heading_rad]))[0])
    creep = {f"{share:g}": float(moved_off(machine, heading_rad, share * limit).max()) for share in SHARES}
    slips = {share: value > GROSS for share, value in creep.items()}
    return {
        "heading_deg": round(float(np.degrees(heading_rad)), 6),
        "limit_m_s2": limit,
        "limit_of_the_box_m_s2": float(limits(machine, np.array([heading_rad]), GripShape.BOX)[0]),
        "creep_percent": {share: 100.0 * value for share, value in creep.items()},
        "slips": slips,
        "first_share_that_slips": next((float(share) for share in slips if slips[share]), None),
    }


def loads_row(machine: Case) -> dict[str, Any]:
    """Largest error of a 100 ms mean of any wheel's load, in every direction in which no wheel slips."""
    row: dict[str, Any] = {}
    for name, share, slope_deg in (("level", 0.7, 0.0), ("slope", 0.4, SLOPE_DEG)):
        errors = [
            load_errors(
                machine,
                MovingOff(heading_rad=heading, acceleration_m_s2=share * limit),
                (float(np.sin(np.radians(slope_deg))), 0.0),
            )
            for heading, limit in zip(HEADINGS, limits(machine, HEADINGS), strict=True)
        ]
        seen = 100.0 * np.concatenate(errors)
        row[name] = {
            "slope_deg": slope_deg,
            "share_of_limit": share,
            "headings": sum(len(rows) > 0 for rows in errors),
            "worst_percent": float(np.abs(seen).max()),
            "rms_percent": float(np.sqrt(np.mean(seen**2))),
        }
    return row


def summary(rows: Sequence[dict[str, Any]]) -> dict[str, float]:
    """The worst of everything."""
    starts = [row["creep_percent"] for row in rows if "slips" in row]
    loads = [row[floor] for row in rows if "level" in row for floor in ("level", "slope")]
    plans = [row for row in rows if "end_off_mm" in row]
    return {
        "directions": len(starts),
        "largest_creep_percent_at_0.95": max(creep["0.95"] for creep in starts),
        "least_creep_percent_at_1.05": min(creep["1.05"] for creep in starts),
        "worst_load_percent": max(seen["worst_percent"] for seen in loads),
        "plans": len(plans),
        "largest_creep_percent_of_a_plan": max(row["creep_percent"] for row in plans),
        "largest_end_off_mm": max(row["end_off_mm"] for row in plans),
        "largest_end_off_deg": max(row["end_off_deg"] for row in plans),
    }


def main(words: Sequence[str]) -> None:
    """Do the jobs of this part, print every row, and the worst of all."""
    keeper, _ = Keeper.of(words, __doc__)
    jobs = []
    for name, machine in cases().items():
        jobs += [
            (f"{name}: start {np.degrees(h):.0f} deg", lambda m=machine, h=h: starting_row(m, float(h)))
            for h in HEADINGS
        ]
        jobs.append((f"{name}: loads", lambda m=machine: loads_row(m)))
        jobs += [(f"{name}: plan {way}", lambda m=machine, p=p: played(m, p)) for way, p in paths().items()]
    rows = keeper.run(jobs)
    for row in rows:
        print(row)
    if keeper.parts == 1:
        print(summary(rows))


if __name__ == "__main__":
    main(sys.argv[1:])
