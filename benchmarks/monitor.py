"""How well the slip monitor tells slip from grip on real logs, and what it costs: for docs/how-to/monitor.md.

    python benchmarks/monitor.py benchmarks/results/monitor.json --data DIR

``DIR`` holds the public logs: ``robojackets/enc_vis_first_part.txt`` (RoboCup SSL robot, four omni wheels),
``robotino/*/heading_*.csv`` (three omni wheels, motor currents) and ``rig/*/trials`` (an engine with real
rollers).  What is not there is left out and named.  Every score is of runs that the monitor was not trained
on; labels come from the pose, which the monitor does not see.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from kept import write_figures

import slipmargin as sm
from slipmargin.onboard.likelihood import LabelledRun, learn

FOLDS = 5
#: The monitor's filters answer late; a label is compared with the answer so much later [s].
LATE_S = 0.06
#: Samples of the one SSL log that count as a run: 0.8 s.  By then false alarms hang together no more
#: (:func:`hanging_together`: 0.5 from one sample to the next, below 0.1 after this many).
BLOCK = 50
#: Margin and speed cap [m/s] of the plans of :func:`control`, and how many of each.
DRIVES = ((0.3, 1.0), (0.1, 1.0), (0.3, None), (0.1, None))
PLANS = 5
SSL = """schema = 1
name = "ssl"
[body]
mass_kg = 2.7
inertia_kg_m2 = 0.01
com_m = [0.0, 0.0]
[loads]
model = "equal"
[friction]
law = "atan"
k_s_per_m = 1000.0
{wheels}
[surface.field]
roller = {{ drive = 0.5, transverse = 0.1 }}
rigid = {{ drive = 0.5, transverse = 0.5 }}
"""
WHEEL = """[[wheel]]
name = "{i}"
position_m = [{x:.9f}, {y:.9f}]
drive_direction_deg = {turn}
radius_m = 0.02786
roller_angle_deg = 0.0
rollers = 15
rigid_fraction = 0.0
"""


@dataclass
class Log:
    """One run: times, wheel speeds, true body twists (NaN where unknown), labels, a group, other channels."""

    t_s: np.ndarray
    omega: np.ndarray
    twist: np.ndarray
    slips: np.ndarray
    group: str
    channels: dict[str, np.ndarray]


def auc(score: np.ndarray, slips: np.ndarray) -> float:
    """Area under the ROC curve: the chance that a slipping sample scores higher than a gripping one."""
    order = np.argsort(np.argsort(score, kind="stable"), kind="stable") + 1.0
    p = int(slips.sum())
    return float((order[slips].sum() - p * (p + 1) / 2.0) / (p * (len(slips) - p)))


def detection(score: np.ndarray, slips: np.ndarray, rate: float) -> float:
    """Share of slipping samples above what a share ``rate`` of the gripping ones exceeds."""
    return float(np.mean(score[slips] > np.quantile(score[~slips], 1.0 - rate)))


def smooth_twist(t: np.ndarray, pose: np.ndarray, half: int, front: float) -> np.ndarray:
    """Body twists (T, 3) from the pose over ``half`` samples on either side; NaN at the ends."""
    rate = np.full(pose.shape, np.nan)
    rate[half:-half] = (pose[2 * half :] - pose[: -2 * half]) / (t[2 * half :] - t[: -2 * half])[:, None]
    c, s = np.cos(pose[:, 2] - front), np.sin(pose[:, 2] - front)
    return np.column_stack([c * rate[:, 0] + s * rate[:, 1], c * rate[:, 1] - s * rate[:, 0], rate[:, 2]])


def over(values: np.ndarray, half: int) -> np.ndarray:
    """Mean over ``half`` samples on either side."""
    kernel = np.ones(2 * half + 1) / (2 * half + 1)
    return np.column_stack([np.convolve(column, kernel, "same") for column in values.T])


def read(text: str) -> Any:
    """A robot file's text as a recipe."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.toml"
        file.write_text(text, encoding="utf-8")
        return sm.read_robot(file)


def ssl_robot() -> Any:
    """The SSL robot by its README; mass known, friction and inertia assumed."""
    wheels = ""
    for i, angle in enumerate((150.0, 219.0, 321.0, 30.0), 1):
        a = np.deg2rad(angle)
        wheels += WHEEL.format(
            i=i, x=0.07986 * np.cos(a), y=0.07986 * np.sin(a), turn=angle + 90.0 - 360.0 * (angle > 90)
        )
    return read(SSL.format(wheels=wheels))


def ssl_log(file: Path, delay: int) -> Log:
    """The SSL log; slip: the camera's velocity is 0.15 m/s off the scaled wheels'."""
    table = np.loadtxt(file, skiprows=1)
    t = np.arange(len(table)) / 60.0
    omega = table[:, 4:8] / 6144.0 * 2.0 * np.pi * 60.0
    pose = np.column_stack([table[:, 1:3] * 1e-3, np.unwrap(table[:, 3])])
    twist = np.roll(smooth_twist(t, pose, 4, 0.5 * np.pi), -delay, axis=0)
    wheels = over(
        np.linalg.lstsq(sm.Limiter(ssl_robot(), "field").table.rolling, omega.T, rcond=None)[0].T, 4
    )
    on = np.all(np.isfinite(twist), axis=1)
    on[:20] = on[-20:] = False
    scale = np.sum((wheels * twist)[on], axis=0) / np.sum(wheels[on] ** 2, axis=0)
    apart = np.hypot(*(twist - scale * wheels)[:, :2].T)
    twist[~on] = np.nan
    gyro = np.gradient(over(pose[:, 2:], 1)[:, 0], t)
    return Log(t, omega, twist, apart > 0.15, "ssl", {"gyro_rad_s": gyro})


def robotino_logs(folder: Path) -> list[Log]:
    """Runs of the Robotino; slip: the body goes less than 0.8 of what the wheels say."""
    out = []
    for file in sorted(folder.glob("*/heading_*.csv")):
        rows = [line.rstrip("; \r").split(";") for line in file.read_text(encoding="utf-8").splitlines()[3:]]
        table = np.array([row[:22] for row in rows if len(row) >= 22], dtype=float)
        table = table[np.concatenate([[True], np.diff(table[:, 0]) > 0.0])]
        t = 1e-3 * table[:, 0]
        grid = np.arange(t[0], t[-1], 0.03)
        turns = np.unwrap(np.deg2rad(table[:, 21]))
        pose = np.column_stack([1.8405e-3 * table[:, 19], -1.8372e-3 * table[:, 20], turns])
        pose = np.column_stack([np.interp(grid, t, column) for column in pose.T])
        angle = np.column_stack([np.interp(grid, t, column) for column in table[:, 7:10].T])
        omega = -np.gradient(over(angle, 2), grid, axis=0) / 2000.0 / 16.0 * 2.0 * np.pi
        current = np.column_stack([np.interp(grid, t, column) for column in table[:, 13:16].T])
        twist = smooth_twist(grid, pose, 8, -0.5 * np.pi)
        wheels = over(np.linalg.lstsq(ROBOTINO.table.rolling, omega.T, rcond=None)[0].T, 8)
        speed = np.hypot(*wheels[:, :2].T)
        share = np.sum((wheels * twist)[:, :2], axis=1) / np.maximum(speed, 1e-9) ** 2
        twist[speed < 0.05] = np.nan
        out.append(Log(grid, omega, twist, share < 0.8, file.parent.name, {"current_A": current}))
    return out


def rig_logs(folder: Path, robot: Any) -> list[Log]:
    """Trials of the rig; slip: the body is off the wheels' velocity by a fifth of it and 20 mm/s."""
    out = []
    rolling = sm.Limiter(robot, "floor").table.rolling
    for file in sorted(folder.glob("*/trials/*.csv")):
        table = np.genfromtxt(file, delimiter=",", skip_header=1)
        t, omega = table[:, 0], table[:, 4:7]
        twist = smooth_twist(t, table[:, 1:4], 4, 0.0)
        wheels = over(np.linalg.lstsq(rolling, omega.T, rcond=None)[0].T, 4)
        size = np.array([1.0, 1.0, 0.09])
        apart = np.linalg.norm((twist - wheels) * size, axis=1)
        slips = apart > 0.02 + 0.2 * np.linalg.norm(wheels * size, axis=1)
        channels = {"commanded": table[:, 10:13], "gyro_rad_s": np.gradient(over(table[:, 3:4], 2)[:, 0], t)}
        out.append(Log(t, omega, twist, slips, file.parents[1].name, channels))
    return out


ROBOTINO = sm.Limiter("robotino", "gray")


def numbers(monitor: sm.SlipMonitor, log: Log, names: Sequence[str]) -> LabelledRun:
    """A log as a training run, its labels those of :data:`LATE_S` before."""
    late = max(1, round(LATE_S / float(np.median(np.diff(log.t_s)))))
    twist, slips = np.roll(log.twist, late, axis=0), np.roll(log.slips, late)
    twist[:late] = np.nan
    given = {name: log.channels[name] for name in names}
    return monitor.labelled(log.t_s, log.omega, twist, slips, **given)


def judged(
    monitor: sm.SlipMonitor, logs: list[Log], names: Sequence[str], baseline: str | None
) -> dict[str, Any]:
    """Scores of every fold's runs by a ratio learnt from the others.

    One log alone is cut into blocks, and a fold is a fifth of it in one piece.
    """
    runs = [numbers(monitor, log, names) for log in logs]
    names_of = [log.group for log in logs]
    of_fold = np.arange(len(runs)) % FOLDS
    if len(logs) == 1:
        runs = runs[0].blocks(BLOCK)
        names_of = names_of * len(runs)
        of_fold = np.arange(len(runs)) * FOLDS // len(runs)
    scores, slips, plain, groups, above = [], [], [], [], {0.05: [], 0.01: []}
    column = None if baseline is None else monitor._signals.names.index(baseline)
    for fold in range(FOLDS):
        ratio = learn([run for run, of in zip(runs, of_fold, strict=True) if of != fold])
        for group, run in ((names_of[k], runs[k]) for k in np.flatnonzero(of_fold == fold)):
            value = ratio.value(run.numbers)
            scores.append(value)
            slips.append(run.slips)
            groups += [group] * len(value)
            for rate, found in above.items():
                found.append(value > ratio.threshold(rate))
            if column is not None:
                plain.append(run.numbers[:, column])
    score, slip, group = np.concatenate(scores), np.concatenate(slips), np.array(groups)
    alarm = {rate: np.concatenate(found) for rate, found in above.items()}
    out: dict[str, Any] = {
        "runs": len(runs),
        "samples": len(score),
        "slipping": float(slip.mean()),
        "auc": auc(score, slip),
        "detected at 5 %": detection(score, slip, 0.05),
        "detected at 1 %": detection(score, slip, 0.01),
        "training runs": int(np.sum(of_fold != FOLDS - 1)),
        "training runs with grip": len(ratio.gripping),
        "runs needed for 5 %, for 1 %": [ratio.runs_needed(rate) for rate in above],
        "detected, set 5 %": float(alarm[0.05][slip].mean()),
        "false alarms, set 5 %": float(alarm[0.05][~slip].mean()),
        "detected, set 1 %": float(alarm[0.01][slip].mean()),
        "false alarms, set 1 %": float(alarm[0.01][~slip].mean()),
    }
    if len(logs) == 1:
        out["false alarms hang together, after 1, a block"] = hanging_together(score, slip)
    if plain:
        base = np.concatenate(plain)
        out["baseline"] = {
            "what": baseline,
            "auc": auc(base, slip),
            "detected at 5 %": detection(base, slip, 0.05),
            "detected at 1 %": detection(base, slip, 0.01),
        }
    if len(set(groups)) > 1:
        out["alarms by group, set 5 %"] = {
            g: float(alarm[0.05][group == g].mean()) for g in sorted(set(groups))
        }
        out["slipping by group"] = {g: float(slip[group == g].mean()) for g in sorted(set(groups))}
    return out


def hanging_together(score: np.ndarray, slips: np.ndarray) -> list[float]:
    """Correlation of being above the 5 % mark between samples that grip, 1 and :data:`BLOCK` apart."""
    above = np.where(slips, 0.0, (score > np.quantile(score[~slips], 0.95)) - 0.05)
    out = []
    for lag in (1, BLOCK):
        both = ~slips[:-lag] & ~slips[lag:]
        out.append(
            float(np.sum((above[:-lag] * above[lag:])[both]) / both.sum() / np.mean(above[~slips] ** 2))
        )
    return out


def control(rate: float) -> dict[str, dict[str, float]]:
    """Share of alarms of a monitor that only its own model has trained, on plans: motion without slip.

    A plan uses all of the grip that its margin leaves, most of the time.
    """
    out: dict[str, dict[str, float]] = {}
    for name, surface in (("ohio-kiwi", "paper"), ("mecanum4", "floor"), ("omni4", "floor")):
        recipe = sm.read_robot(name, rigid_sectors=False)
        rng = np.random.default_rng(0)
        ahead = np.array([1.0, 0.3, 0.2])
        ways = [np.cumsum(ahead + rng.uniform(-1.0, 1.0, (4, 3)), axis=0) for _ in range(PLANS)]
        for gyro in (True, False):
            monitor = sm.SlipMonitor(recipe, surface, false_alarm_rate=rate, gyro=gyro)
            row = out[f"{name}, {'gyro' if gyro else 'wheels only'}"] = {}
            for margin, most in DRIVES:
                alarms, count = 0, 0
                for way in ways:
                    plan = sm.plan(recipe, surface, way, margin=margin, max_speed_m_s=most, step_s=0.01)
                    rows = plan.trajectory
                    noise = 0.01 * float(np.sqrt(np.mean(rows.omega**2)))
                    monitor.restart()
                    for t, speeds, velocity in zip(rows.t_s, rows.omega, rows.velocity, strict=True):
                        yaw = float(velocity[2]) + 0.02 * rng.normal()
                        noisy = speeds + noise * rng.normal(size=len(speeds))
                        found = monitor.update(float(t), noisy, gyro_rad_s=yaw if gyro else None)
                        alarms, count = alarms + found.alarm, count + 1
                row[_drive(margin, most)] = alarms / count
    return out


def _drive(margin: float, most: float | None) -> str:
    return f"margin {margin:g}" + ("" if most is None else f", up to {most:g} m/s")


def cost() -> dict[str, float]:
    """Time a line of a 1 kHz stream takes, as a share of a core, and how memory grows."""
    monitor = sm.SlipMonitor(
        "mecanum4", "floor", gyro=True, current=True, commanded=True, torque_per_ampere_N_m=0.5
    )
    header = ["t_s", *(f"omega{i}_rad_s" for i in range(1, 5)), *(f"omega{i}_cmd_rad_s" for i in range(1, 5))]
    header += ["gyro_rad_s", *(f"current{i}_A" for i in range(1, 5))]
    rng = np.random.default_rng(0)
    cells = [",".join(f"{v:.4f}" for v in row) for row in rng.normal(size=(1000, 13))]

    def lines(count: int) -> Any:
        yield ",".join(header)
        for k in range(count):
            yield f"{k * 1e-3:.3f},{cells[k % 1000]}"

    start = time.process_time()
    for _ in monitor.stream(lines(20_000)):
        pass
    busy = (time.process_time() - start) / 20.0
    monitor.restart()
    tracemalloc.start()
    marks = []
    for k, _ in enumerate(monitor.stream(lines(60_000))):
        if k in (5_000, 60_000):
            marks.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    return {"share of a core at 1 kHz": busy, "bytes gained in 55 000 lines": float(marks[1] - marks[0])}


def table(sets: dict[str, Any]) -> list[str]:
    """The rows of docs/how-to/monitor.md."""
    out = []
    for name, row in sets.items():
        quiet = row["runs needed for 5 %, for 1 %"]
        kept = [
            f"{row[f'false alarms, set {rate} %']:.3f}, {row[f'detected, set {rate} %']:.2f}"
            if row["training runs with grip"] >= needed
            else "quiet"
            for rate, needed in zip((5, 1), quiet, strict=True)
        ]
        base = row.get("baseline")
        plain = f"{base['auc']:.3f}, {base['detected at 5 %']:.2f}" if base else "none: three wheels"
        out.append(
            f"| {name} | {row['auc']:.3f} | {row['detected at 5 %']:.2f} | {row['detected at 1 %']:.2f} | "
            f"{kept[0]} | {kept[1]} | {row['training runs with grip']} of {quiet[0]}, {quiet[1]} | {plain} |"
        )
    return out


def control_table(found: dict[str, dict[str, float]]) -> list[str]:
    """The rows of docs/how-to/monitor.md on motion without slip."""
    cells = {name: [f"{row[_drive(*drive)]:.3f}" for drive in DRIVES] for name, row in found.items()}
    return [f"| {name} | {' | '.join(row)} |" for name, row in cells.items()]


def main(words: list[str]) -> None:
    """Measure everything there is data for and write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--data", type=Path, required=True)
    given = parser.parse_args(words)
    found: dict[str, Any] = {"sets": {}, "not there": []}
    ssl, robotino, rig = (given.data / name for name in ("robojackets", "robotino", "rig"))
    null = "null-space residual"
    if (ssl / "enc_vis_first_part.txt").is_file():
        robot = ssl_robot()
        for delay in (2, 4, 6, 8):
            logs = [ssl_log(ssl / "enc_vis_first_part.txt", delay)]
            found["sets"][f"SSL, wheels only, delay {delay}"] = judged(
                sm.SlipMonitor(robot, "field"), logs, (), null
            )
        logs = [ssl_log(ssl / "enc_vis_first_part.txt", 6)]
        watch = sm.SlipMonitor(robot, "field", gyro=True)
        found["sets"]["SSL, camera's yaw rate as a gyro, delay 6"] = judged(
            watch, logs, ("gyro_rad_s",), null
        )
    else:
        found["not there"].append("robojackets")
    if robotino.is_dir():
        logs = robotino_logs(robotino)
        watch = sm.SlipMonitor("robotino", "gray", current=True, torque_per_ampere_N_m=0.82)
        found["sets"]["Robotino, currents"] = judged(watch, logs, ("current_A",), None)
        found["sets"]["Robotino, wheels only"] = judged(sm.SlipMonitor("robotino", "gray"), logs, (), None)
    else:
        found["not there"].append("robotino")
    if rig.is_dir():
        robot = sm.read_robot(rig / "a-null" / "robot.toml")
        logs = rig_logs(rig, robot)
        watch = sm.SlipMonitor(robot, "floor", commanded=True)
        found["sets"]["rig, wheels and commands"] = judged(watch, logs, ("commanded",), None)
        watch = sm.SlipMonitor(robot, "floor", commanded=True, gyro=True)
        found["sets"]["rig, camera's yaw rate as a gyro"] = judged(
            watch, logs, ("commanded", "gyro_rad_s"), None
        )
    else:
        found["not there"].append("rig")
    found["no-slip control, alarms, set 1 %"] = control(0.01)
    found["cost"] = cost()
    write_figures(given.out, found)
    print("\n".join(table(found["sets"])))
    print("\n".join(control_table(found["no-slip control, alarms, set 1 %"])))
    print(found["cost"], found["not there"])


if __name__ == "__main__":
    main(sys.argv[1:])
