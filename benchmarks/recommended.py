"""Recommended accelerations, safe sets and exported files of drawn robots, driven as motions.

    python benchmarks/recommended.py [COUNT] [--seed 1] [--json FILE] [--part 1/2]     a line a robot
    python benchmarks/recommended.py table FILE… [--out SUMMARY]                        what kept rows come to

Every robot has draws of its own: robot 17 is the same however many are asked for.  A motion of constant
acceleration passes ``check`` with the margin if no wheel's grip, no motor's torque and no wheel's load goes
above 1 − margin + ALLOWED.  Boxes, circles, speeds and coefficients are those of the exported files, read
back from their text in the units they state.  Grip is checked where drag is full, torque at the exported
speeds.  At 1.08 of the unscaled limit the simulator, which knows nothing of limits, must see the named wheel
slip or lift: with a steep friction law, as creep that nobody corrects turns the robot, and with its heading
the limit.  Before it only wheels may slip whose own limit is passed too.  Where grip ends first and a wheel
lifts soon after, it is driven half way between the two, and must slip.  An ellipse has no grip left beside
full drag: nothing is recommended for it, and speeding up must slip.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from drawn_robots import drawn_robot
from kept import Keeper, collected

from slipmargin.io.writes import write_text
from slipmargin.limits.bounds import Directions, ahead_of, directions
from slipmargin.limits.bounds_summary import Bounds, bounds
from slipmargin.limits.motion_rows import CAUSES, GRIP, SPENT, TIPS
from slipmargin.model import Model
from slipmargin.model.parts import Drives
from slipmargin.paths.check import check
from slipmargin.paths.trajectory import Trajectory
from slipmargin.paths.verify import GROSS, on_rollers, verify
from slipmargin.report.exports import export_text
from slipmargin.robot import GripShape
from slipmargin.sim.batch import Ending

MARGIN, ALLOWED, BEYOND = 0.1, 0.0015, 1.08
#: A speed at which the drag of every wheel that slides at all is full [m/s], and how long a motion lasts [s].
FLAT_OUT, BRIEF = 1e4, 1e-3
#: Limits that lie within this share of each other end at once: either name is right [1].  Half way between a
#: slip and a tip 1.5 % apart the creep at 3 m/s already made robot 328 tip.
AT_ONCE = 0.02
#: Speed across its rollers, as a share of the robot's, below which a wheel's drag is not full yet [1].
SLIDES = 0.01
#: Regularisation slope of the runs beyond the limit [s/m]; limits do not depend on it.
STEEP = 5e4
#: The same on an ellipse: at STEEP and 3 m/s rollers that turn easily lack 10⁻⁴ of their full drag, which
#: leaves √(2 · 10⁻⁴) of the grip to drive, and speeding up a little did not slip.
STEEPEST = 5e6
INCH_M = 0.0254
#: Drawn ends of the safe sets a robot, and directions driven beyond the limit.
ENDS, DIRECTIONS = 60, 3


def used(model: Model, velocity: np.ndarray, acceleration: np.ndarray) -> dict[str, float]:
    """What ``check`` says of a brief motion (3,), (3,): shares of grip, tipping, torque and top speed."""
    t = BRIEF * np.linspace(-0.5, 0.5, 7)
    pose = np.outer(t, velocity) + 0.5 * np.outer(t**2, acceleration)
    found = check(model, t, pose, share=1.0)
    middle = len(t) // 2  # before and after it the robot is slower and faster than what was asked about
    return {
        "grip": float(np.max(found.use[middle])),
        "tipping": float(np.max(found.tipping[middle])),
        "torque": float(np.max(found.torque[middle])),
        "speed": float(np.max(found.speed[middle])),
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """What the exported files of a robot say [m, s, rad]; axes (3,) are those of the robot file.

    ``fast``, ``slow``: Nav2's velocity smoother; ``even``: its MPPI controller; ``circle`` and ``yaw``: the
    larger of Road Runner's and PathPlanner's; ``coefficient``: the larger of PathPlanner's and Choreo's;
    speeds forward, sideways, any way and turning (the largest of Nav2's, Road Runner's and PathPlanner's),
    infinite where the file has none.

    ``rolling``: Road Runner's maxWheelVel, how fast a wheel rolls along its drive direction [m/s].  ``held``:
    PathPlanner's maxDriveSpeed, what the motors reach against drag with all of their torque.  ``module`` and
    ``push``: Choreo's vmax times the radius, how fast a swerve module moves over the floor, and tmax over the
    radius, how hard it pushes [N].
    """

    fast: np.ndarray
    slow: np.ndarray
    even: np.ndarray
    circle: float
    yaw: float
    coefficient: float
    speeds: tuple[float, float, float, float]
    rolling: float
    held: float
    module: float
    push: float

    @classmethod
    def of(cls, found: Bounds) -> Files:
        """Read back from the text that would be in the files."""
        nav2 = fields(r"^ *(\w+): (\[.*?\]|\S+)", export_text("nav2", found))
        java = fields(r"^public double (\w+) = (.*);$", export_text("roadrunner", found))
        planner = json.loads(export_text("pathplanner", found))
        config = json.loads(export_text("choreo", found))["config"]

        def axes(values: list[float]) -> np.ndarray:
            forward, left, turn = np.abs(values)
            return np.abs([*found.model.convention.from_right_forward(left, forward), turn])

        return cls(
            fast=axes(nav2["max_accel"]),
            slow=axes(nav2["max_decel"]),
            even=axes([nav2[name] for name in ("ax_max", "ay_max", "az_max")]),
            circle=max(java["maxProfileAccel"] * INCH_M, planner["defaultMaxAccel"]),
            yaw=max(java["maxAngAccel"], math.radians(planner["defaultMaxAngAccel"])),
            coefficient=max(planner["wheelCOF"], config["cof"]["val"]),
            speeds=(
                nav2.get("vx_max", math.inf),
                nav2.get("vy_max", math.inf),
                planner.get("defaultMaxVel", math.inf),
                max(
                    nav2.get("wz_max", math.inf),
                    java.get("maxAngVel", math.inf),
                    math.radians(planner.get("defaultMaxAngVel", math.inf)),
                ),
            ),
            rolling=java.get("maxWheelVel", math.inf * INCH_M) * INCH_M,
            held=planner.get("maxDriveSpeed", math.inf),
            module=value(config, "vmax") * config["radius"]["val"],
            push=value(config, "tmax") / config["radius"]["val"],
        )


def value(config: dict[str, Any], name: str) -> float:
    """A number of a .chor file; infinite where it has none."""
    return float(config[name]["val"]) if name in config else math.inf


def fields(pattern: str, text: str) -> dict[str, Any]:
    """The numbers and lists of numbers that a text gives to names."""
    found = re.findall(pattern, text, flags=re.MULTILINE)
    return {name: json.loads(value) for name, value in found if value[0] in "[-0123456789"}


def ends(
    rng: np.random.Generator, found: Bounds, files: Files, ahead: np.ndarray
) -> Iterator[tuple[str, np.ndarray]]:
    """A drawn end of each safe set, for a motion along ``ahead`` (3,)."""
    assert found.inside is not None
    way = rng.choice((-1.0, 1.0), 3)
    yield "box", way * np.where(way > 0.0, files.fast, files.slow) * np.where(ahead < 0.0, -1.0, 1.0)
    yield "even box", way * files.even
    angle = rng.uniform(-np.pi, np.pi)
    yield "circle", np.array([*files.circle * np.array([np.cos(angle), np.sin(angle)]), way[2] * files.yaw])
    turn = rng.normal(size=3)
    yield "ellipsoid", found.inside.ellipsoid @ (turn / np.linalg.norm(turn))
    yield "modules", modules_end(found.model, files.coefficient, rng.normal(size=3))


def modules_end(model: Model, coefficient: float, way: np.ndarray) -> np.ndarray:
    """What modules in the wheels' places do when all push as hard as they can along a wrench ``way`` (3,)."""
    body = model.inertia
    arm = model.geometry.position_m - body.com_m
    size = np.sqrt(body.inertia_kg_m2 / body.mass_kg)
    push = way[:2] + way[2] / size * np.column_stack([-arm[:, 1], arm[:, 0]])
    force = coefficient * body.weight_N / model.count * push / np.linalg.norm(push, axis=1, keepdims=True)
    spin = np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]) / body.inertia_kg_m2
    at_com = force.sum(axis=0) / body.mass_kg
    return np.array([*(at_com + spin * np.array([body.com_m[1], -body.com_m[0]])), spin])


def drawn(seed: int, k: int) -> dict[str, Any]:
    """Robot ``k``: the largest shares of everything recommended, and what happens beyond the limit."""
    refused: list[str] = []
    rng = np.random.default_rng([seed, k])
    while True:
        model = drawn_robot(rng)
        found = bounds(model, margin=MARGIN, step_deg=15.0)
        if found.inside is not None and found.recommended_m_s2 > 0.0:
            break
        if model.grip.shape is GripShape.ELLIPSE:
            return spent(rng, model, found, refused)
        refused.append(found.why_not or "nothing recommended")
    bare = replace(model, drives=Drives(max_speed_rad_s=None, stall_torque_N_m=None))
    worst = dict.fromkeys(("recommended", "box", "even box", "circle", "ellipsoid", "modules"), 0.0)
    torque, speed = dict.fromkeys([*worst, "turning"], 0.0), 0.0
    halt = 0.5 * found.top_m_s
    for h, heading in enumerate(found.full.heading_rad + rng.uniform(0.01, 0.02)):
        ahead = ahead_of(np.array([heading]))[0]
        wanted = found.recommended_m_s2 * ahead
        grip = used(bare, FLAT_OUT * ahead, wanted)
        worst["recommended"] = max(worst["recommended"], grip["grip"], grip["tipping"])
        if np.isfinite(halt[h]):
            slow = float(np.interp(heading, found.full.heading_rad, halt, period=2.0 * np.pi))
            torque["recommended"] = max(
                torque["recommended"], used(model, 0.99 * slow * ahead, wanted)["torque"]
            )
    files = Files.of(found)
    forward, side, any_way, turn = files.speeds
    for _ in range(ENDS // 5):
        heading = rng.uniform(-np.pi, np.pi)
        ahead = ahead_of(np.array([heading]))[0]
        for name, end in ends(rng, found, files, ahead):
            grip = used(bare, FLAT_OUT * ahead, end)
            worst[name] = max(worst[name], grip["grip"], grip["tipping"])
            if name == "ellipsoid" or not np.isfinite(any_way):
                continue
            for fast, v in (
                (any_way, ahead),
                (forward, np.array([0.0, 1.0, 0.0])),
                (side, np.array([1.0, 0.0, 0.0])),
            ):
                if name != "box" or v is ahead:
                    there = used(model, fast * v, end)
                    torque[name], speed = max(torque[name], there["torque"]), max(speed, there["speed"])
    if np.isfinite(turn):
        for way in (1.0, -1.0):
            there = used(model, np.array([0.0, 0.0, turn]), np.array([0.0, 0.0, way * files.yaw]))
            torque["turning"] = max(torque["turning"], there["torque"])
            worst["turning"] = max(worst.get("turning", 0.0), there["grip"], there["tipping"])
            speed = max(speed, there["speed"])
    tools, fastest = planned(rng, model, files)
    torque |= tools
    return {
        **told(model, refused),
        "recommended_m_s2": found.recommended_m_s2,
        "used": worst,
        "torque": torque if model.drives.stall_torque_N_m is not None else {},
        "top_speed": max(speed, fastest),
        "beyond": beyond(rng, bare),
    }


def planned(rng: np.random.Generator, model: Model, files: Files) -> tuple[dict[str, float], float]:
    """Shares of the motors' torque, and of their top speed, at the fastest that each tool plans.

    Road Runner: a wheel rolls at maxWheelVel while the robot turns no faster than maxAngVel.  Choreo: a
    module moves at vmax, and all push as hard as friction and tmax allow.  PathPlanner's maxDriveSpeed is
    what the motors hold with all of their torque: its share is counted in that which the margin leaves.
    """
    torque, speed = {"wheel speed": 0.0, "drive speed": 0.0, "modules' speed": 0.0}, 0.0

    def driven(name: str, velocity: np.ndarray, end: np.ndarray, part: float = 1.0) -> None:
        # What turning takes for the mass off the middle, the files leave to whoever turns while driving.
        nonlocal speed
        inward = velocity[2] ** 2 * np.append(model.inertia.com_m, 0.0)
        there = used(model, velocity, end + inward)
        torque[name], speed = max(torque[name], part * there["torque"]), max(speed, there["speed"])

    coefficient = min(files.coefficient, files.push * model.count / model.inertia.weight_N)
    for _ in range(ENDS // 5 if np.isfinite(files.module) else 0):
        ahead, turn = (
            ahead_of(rng.uniform(-np.pi, np.pi, 1))[0],
            np.array([0.0, 0.0, rng.choice((-1.0, 1.0))]),
        )
        angle = rng.uniform(-np.pi, np.pi)
        circle = files.circle * np.array([np.cos(angle), np.sin(angle), 0.0]) + files.yaw * turn
        straight, spin = model.geometry.wheel_speeds(np.stack([ahead, turn])) * model.geometry.radius_m
        yaw = rng.uniform(0.0, 1.0) * min(files.speeds[3], files.rolling / np.max(np.abs(spin)))
        fast = np.min((files.rolling - np.sign(straight) * yaw * spin) / np.abs(straight))
        driven("wheel speed", files.rolling / np.max(np.abs(straight)) * ahead, circle)
        driven("wheel speed", fast * ahead + yaw * turn, circle)
        driven("drive speed", files.held * ahead, np.zeros(3), 1.0 - MARGIN)
        place, rate = model.geometry.position_m, rng.normal()
        moves = np.hypot(ahead[0] - rate * place[:, 1], ahead[1] + rate * place[:, 0])
        end = modules_end(model, coefficient, rng.normal(size=3))
        driven("modules' speed", files.module * ahead, end)
        driven("modules' speed", files.module / np.max(moves) * (ahead + rate * np.abs(turn)), end)
    return torque, speed


def told(model: Model, refused: list[str]) -> dict[str, Any]:
    """What every row says of its robot."""
    return {
        "robot": model.robot,
        "grip": model.grip.shape.value,
        "loads": model.loads.rule,
        "motors": model.drives.max_speed_rad_s is not None,
        "refused": refused,
    }


def spent(rng: np.random.Generator, model: Model, found: Bounds, refused: list[str]) -> dict[str, Any]:
    """The row of an ellipse: wheels that slide sideways have no grip left to drive, and nothing is promised.

    Speeding up at a twentieth of μ g must slip, in directions of which ``bounds`` says so.
    """
    bare = replace(model, drives=Drives(max_speed_rad_s=None, stall_torque_N_m=None))
    full, runs = directions(bare, rng.uniform(-np.pi, np.pi, 8 * DIRECTIONS), motor=False), []
    across = np.abs(ahead_of(full.heading_rad) @ model.geometry.lateral_rows().T)
    sure = np.isinf(full.steady_use) & np.all(across > SLIDES, axis=1)
    for h in np.flatnonzero(sure)[:DIRECTIONS]:
        heading = float(full.heading_rad[h])
        run = driven_beyond(on_rollers(bare), heading, 0.05 * found.isotropic_m_s2, STEEPEST)
        named = list(full.starting.wheels[h])
        run["as_named"] = bool(set(run["slips"][:1]) & set(named)) or run["tips"]
        runs.append({"heading_rad": heading, "cause": SPENT, "named": named, "beyond": BEYOND, **run})
    return {
        **told(model, refused),
        "recommended_m_s2": max(found.recommended_m_s2, 0.0),
        "used": {"nothing recommended": 0.0},
        "torque": {},
        "top_speed": 0.0,
        "beyond": runs,
    }


def beyond(rng: np.random.Generator, model: Model) -> list[dict[str, Any]]:
    """What the simulator does at 1.08 of the unscaled limit, in some directions.

    Drawn directions: where a wheel does not slide sideways at all, drag counts as none in the limit, but the
    wheel's sideways creep helps.
    """
    full, out = directions(model, rng.uniform(-np.pi, np.pi, 8 * DIRECTIONS), motor=False), []
    for h, (a, cause) in enumerate(zip(full.starting_m_s2, full.starting.cause, strict=True)):
        if a < 0.05 or cause == SPENT or not np.isfinite(full.steady_use[h]):
            continue
        named, lifts = full.starting.wheels[h], ending(full, h, TIPS) / a
        at_once, tips = np.min(lifts) < 1.0 + AT_ONCE, cause == CAUSES[TIPS]
        by = BEYOND if at_once else min(BEYOND, 0.5 * (1.0 + float(np.min(lifts))))
        heading = float(full.heading_rad[h])
        ends_at = dict(zip(model.geometry.names, ending(full, h, GRIP) / a, strict=True))
        for share in (by, *halfway(ends_at, by)):
            run = driven_beyond(on_rollers(model), heading, share * float(a))
            as_named = named_slips(run["slips"], named, ends_at, share) and not tips
            run |= {"beyond": share, "as_named": as_named or bool(run["tips"] and at_once)}
            if run["as_named"]:
                break
        out.append({"heading_rad": heading, "cause": cause, "named": list(named), **run})
        if len(out) == DIRECTIONS:
            break
    return out


def ending(full: Directions, h: int, cause: int) -> np.ndarray:
    """Accelerations (N,) [m/s²] at which each wheel's grip, or load, ends in direction ``h``, or infinity."""
    rows = full.starting.rows
    slope = rows.A[h] @ ahead_of(full.heading_rad[h : h + 1])[0]
    ends_at = np.where(slope > 0.0, rows.b[h] / np.where(slope > 0.0, slope, 1.0), np.inf)
    about = (rows.cause == cause)[:, None] & rows.wheels
    return np.asarray(np.min(np.where(about, ends_at[:, None], np.inf), axis=0))


def halfway(ends_at: dict[str, float], by: float) -> list[float]:
    """How far beyond the limit no other wheel is: half way to the next one's, where ``by`` lies beyond it.

    A wheel that slips takes from the others what they carried: the named one may then hold.
    """
    others = [end for end in ends_at.values() if 1.0 + AT_ONCE <= end < by]
    return [0.5 * (1.0 + float(min(others)))] if others else []


def named_slips(slipped: list[str], named: Sequence[str], ends_at: dict[str, float], by: float) -> bool:
    """Whether a wheel that was named slips, and none before it but those beyond their own limit too.

    ``ends_at`` are the wheels' limits and ``by`` what was driven, in units of the limit.
    """
    for wheel in slipped:
        if wheel in named or ends_at[wheel] < 1.0 + AT_ONCE:
            return True
        if not ends_at[wheel] < by:
            return False
    return False


def driven_beyond(model: Model, heading: float, a: float, slope: float = STEEP) -> dict[str, Any]:
    """One direction, from a speed at which drag is full, until a wheel has had the time to slip."""
    ahead, v = ahead_of(np.array([heading]))[0], 3.0
    model = replace(model, grip=replace(model.grip, k_s_per_m=slope))
    t = np.linspace(0.0, 0.5, 200)
    velocity = (v + a * t)[:, None] * ahead
    planned = Trajectory(
        t_s=t,
        pose=(v * t + 0.5 * a * t**2)[:, None] * ahead,
        velocity=velocity,
        acceleration=np.broadcast_to(a * ahead, velocity.shape),
        omega=model.geometry.wheel_speeds(velocity),
        use=np.zeros((len(t), model.count)),
        wheels=model.geometry.names,
    )
    run = verify(model, planned)
    tips = run.ending is Ending.TIPS or run.lifts_s is not None
    over = run.share > GROSS
    begins = np.argmax(over, axis=0)
    order = np.lexsort(
        (-run.share[begins, np.arange(model.count)], begins)
    )  # of two at once the one that uses more
    slipped = [run.wheels[i] for i in order if np.any(over[:, i])]
    return {
        "ending": run.ending.name,
        "slips": slipped,
        "holds": not tips and not slipped,
        "tips": tips,
    }


def shown(seed: int, k: int) -> dict[str, Any]:
    """A robot's row, printed."""
    row = drawn(seed, k)
    most = max(row["used"], key=lambda name: row["used"][name])
    motor = max(row["torque"].values(), default=0.0)
    words = ", ".join(
        "as named" if b["as_named"] else "holds" if b["holds"] else "other" for b in row["beyond"]
    )
    print(
        f"{k:4d}  {row['robot']:16s} {row['grip']:10s} uses {row['used'][most]:.4f} ({most})  "
        f"torque {motor:.4f}  at {BEYOND}: {words}",
        flush=True,
    )
    return row


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What the rows come to."""
    allowed = 1.0 - MARGIN + ALLOWED
    kinds = sorted({name for r in rows for name in r["used"]} - {"nothing recommended"})
    runs = [b for r in rows for b in r["beyond"]]
    return {
        "robots": len(rows),
        "by_grip": {g.value: sum(r["grip"] == g.value for r in rows) for g in GripShape},
        "nothing_recommended": sum("nothing recommended" in r["used"] for r in rows),
        "with_motors": sum(r["motors"] for r in rows),
        "drawn_again": sum(len(r["refused"]) for r in rows),
        "margin": MARGIN,
        "largest_share": {name: max(r["used"].get(name, 0.0) for r in rows) for name in kinds},
        "largest_torque": max((v for r in rows for v in r["torque"].values()), default=0.0),
        "robots_above": sum(max([*r["used"].values(), *r["torque"].values()]) > allowed for r in rows),
        "driven_beyond": len(runs),
        "slips_or_tips": sum(not b["holds"] for b in runs),
        "as_named": sum(b["as_named"] for b in runs),
    }


def main(words: list[str]) -> None:
    """Drive, or sum up what was driven."""
    keeper, words = Keeper.of(words, __doc__)
    out = words[words.index("--out") + 1] if "--out" in words else ""
    if words[:1] == ["table"]:
        found = summary(collected([w for w in words[1:] if w not in ("--out", out)]))
    else:
        seed = int(words[words.index("--seed") + 1]) if "--seed" in words else 1
        count = int(words[0]) if words[:1] and words[0].isdigit() else 500
        found = summary(keeper.run([(f"robot {k}", partial(shown, seed, k)) for k in range(count)]))
    text = json.dumps(found, indent=1) + "\n"
    if out:
        write_text(Path(out), text)
    print(text, end="")


if __name__ == "__main__":
    main(sys.argv[1:])
