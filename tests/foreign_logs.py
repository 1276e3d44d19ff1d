"""One run of a mecanum robot (and of a LeKiwi) in the files of other tools, written without this package."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slipmargin.checks import Array

#: The run's robot: forwards positive, wheels fl, fr, rl, rr.
RADIUS_M = 0.052
CORNERS = ("front_left", "front_right", "rear_left", "rear_right")


@dataclass(frozen=True)
class Run:
    """Times (T,), the front's pose (T, 3) in REP 103, wheel angles and speeds (T, 4), forwards positive."""

    t_s: Array
    pose: Array
    theta: Array
    omega: Array


def run(rows: int = 41, still: int = 0) -> Run:
    """A smooth run; ``still`` rows in the middle repeat the one before them."""
    t = np.linspace(0.0, 2.0, rows)
    moved = np.where(np.arange(rows) < rows // 2, t, np.maximum(t - 0.05 * still, t[rows // 2 - 1]))
    pose = np.column_stack([0.3 * np.sin(moved), 0.1 * moved**2, 3.0 + 0.4 * moved])
    theta = np.outer(moved, [5.0, 6.0, 7.0, 8.0])
    omega = np.gradient(theta, t, axis=0)
    return Run(t_s=t, pose=pose, theta=theta, omega=omega)


def wrapped(yaw: Array) -> Array:
    """Angles as tools write them, within ±π."""
    return np.asarray(np.arctan2(np.sin(yaw), np.cos(yaw)))


def wpilog(
    file: Path, held: Run, *, changes: bool = True, wheels: str = "positions", swerve: bool = False
) -> Path:
    """A data log by WPILib's own writer; an entry is written only where it changed, as AdvantageKit does."""
    from wpiutil import DataLogWriter

    log = DataLogWriter(str(file))
    kinds = {"positions": "Positions", "speeds": "Speeds"}
    pose = log.start("/Vision/Pose", "struct:Pose2d", "", 0)
    goal = log.start("/Drive/TargetPose", "struct:Pose2d", "", 0)
    name = (
        "struct:SwerveModuleState[]" if swerve else f"struct:MecanumDriveWheel{kinds.get(wheels, 'Speeds')}"
    )
    four = log.start("/Drive/Wheels", name, "", 0) if wheels != "numbers" else 0
    each = [log.start(f"/Drive/{c}", "double", "", 0) for c in CORNERS] if wheels == "numbers" else []
    text = log.start("/Mode", "string", "", 0)
    log.appendString(text, "auto", 1)
    values = held.theta if wheels == "positions" else held.omega
    before: dict[int, bytes] = {}

    def put(entry: int, numbers: Array, at: int) -> None:
        raw = struct.pack(f"<{len(numbers)}d", *numbers)
        if not changes or before.get(entry) != raw:
            log.appendRaw(entry, raw, at)
        before[entry] = raw

    heading = wrapped(held.pose[:, 2])
    for k, t in enumerate(held.t_s):
        at = 5_000_000 + round(1e6 * float(t))
        put(pose, np.array([*held.pose[k, :2], heading[k]]), at)
        put(goal, np.array([0.0, 0.0, 1e-3 * k]), at)
        if wheels == "numbers":
            for entry, value in zip(each, values[k], strict=True):
                put(entry, np.array([value * 30.0 / np.pi]), at)  # rpm
        else:
            put(four, values[k] * RADIUS_M, at)
    log.flush()
    log.stop()
    return file


def advantagescope(file: Path, held: Run, *, table: bool = True, swerve: bool = False) -> Path:
    """An export as AdvantageScope writes it: structures' fields apart, a table filled with the last value."""
    heading = wrapped(held.pose[:, 2])
    columns: dict[str, list[str]] = {"/DriverStation/Enabled": ["true"] * len(heading)}
    for name, values in zip(
        ("/Vision/Pose/rotation/value", "/Vision/Pose/translation/x", "/Vision/Pose/translation/y"),
        (heading, held.pose[:, 0], held.pose[:, 1]),
        strict=True,
    ):
        columns[name] = [repr(float(v)) for v in values]
    for i, corner in enumerate(CORNERS):
        name = f"/Drive/Modules/{i}/speed" if swerve else f"/Drive/WheelSpeeds/{corner}"
        columns[name] = [repr(float(v)) for v in held.omega[:, i] * RADIUS_M]
        if swerve:
            columns[f"/Drive/Modules/{i}/angle/value"] = ["0.1"] * len(heading)
    stamps = [repr(7.0 + float(t)) for t in held.t_s]
    if table:
        lines = [",".join(["Timestamp", *columns])]
        lines += [",".join([t, *cells]) for t, *cells in zip(stamps, *columns.values(), strict=True)]
    else:
        lines = ["Timestamp,Key,Value"]
        for k, t in enumerate(stamps):
            lines += [f"{t},{n},{c[k]}" for n, c in columns.items() if k == 0 or c[k] != c[k - 1]]
    file.write_text("\n".join(lines), encoding="utf-8")
    return file


def roadrunner(file: Path, held: Run) -> Path:
    """A log as the quickstart's LogFiles writes it: inches, ticks, motors lf, lr, rr, rf."""
    inch, ticks, gear = 0.0254, 537.7, 0.5
    order = [0, 2, 3, 1]
    counts = held.theta * ticks / gear / (2.0 * np.pi)
    rates = held.omega * ticks / gear / (2.0 * np.pi)
    table = {
        "version": "quickstart1 v2",
        "opModeName": "org.firstinspires.ftc.teamcode.Auto",
        "nsStart": 10**12,
        "ticksPerRev": ticks,
        "gearRatio": gear,
        "wheelRadius": RADIUS_M / inch,
        "nsTimes": [10**12 + round(1e9 * float(t)) for t in held.t_s],
        "targetXs": (held.pose[:, 0] / inch).tolist(),
        "targetYs": (held.pose[:, 1] / inch).tolist(),
        "targetHeadings": held.pose[:, 2].tolist(),
        "xs": (held.pose[:, 0] / inch).tolist(),
        "ys": (held.pose[:, 1] / inch).tolist(),
        "headings": wrapped(held.pose[:, 2]).tolist(),
        "voltages": [12.5] * len(held.t_s),
        "driveEncPositions": counts[:, order].T.tolist(),
        "driveEncVels": rates[:, order].T.tolist(),
        "trackingEncPositions": [[0] * len(held.t_s)],
        "trackingEncVels": [[0] * len(held.t_s)],
    }
    file.write_text(json.dumps(table, indent=2), encoding="utf-8")
    return file


LEKIWI_STATE = (
    "arm_shoulder_pan.pos",
    "arm_gripper.pos",
    "x.vel",
    "y.vel",
    "theta.vel",
)


def lerobot(folder: Path, held: Run, *, episodes: int = 1, names: tuple[str, ...] = LEKIWI_STATE) -> Path:
    """A data set as LeRobot writes it, of a LeKiwi whose wheels left, back, right turn as the first three."""
    import pyarrow as pa
    from pyarrow import parquet

    way = np.radians(np.array([240.0, 0.0, 120.0]) - 90.0)
    matrix = np.column_stack([np.cos(way), np.sin(way), np.full(3, 0.125)])
    body = np.linalg.solve(matrix, 0.05 * held.omega[:, :3].T).T
    state = np.column_stack([np.zeros((len(body), 2)), body[:, :2], np.degrees(body[:, 2])])
    (folder / "meta").mkdir(parents=True)
    (folder / "data" / "chunk-000").mkdir(parents=True)
    features = {"observation.state": {"dtype": "float32", "shape": [len(names)], "names": list(names)}}
    (folder / "meta" / "info.json").write_text(
        json.dumps({"codebase_version": "v2.1", "robot_type": "lekiwi", "fps": 20, "features": features}),
        encoding="utf-8",
    )
    for k in range(episodes):
        columns = {
            "observation.state": pa.array(state.tolist(), pa.list_(pa.float64())),
            "timestamp": pa.array(held.t_s, pa.float64()),
            "frame_index": pa.array(range(len(held.t_s)), pa.int64()),
            "episode_index": pa.array([k] * len(held.t_s), pa.int64()),
        }
        parquet.write_table(pa.table(columns), folder / "data" / "chunk-000" / f"episode_{k:06d}.parquet")
    return folder


def tracker(file: Path, held: Run) -> Path:
    """A tracker's CSV: seconds on its own clock, millimetres, degrees."""
    rows = ["stamp,px,py,yaw"]
    rows += [
        f"{t + 100.0:.9f},{1e3 * x:.9f},{1e3 * y:.9f},{np.degrees(yaw):.9f}"
        for t, (x, y, yaw) in zip(held.t_s, held.pose, strict=True)
    ]
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return file
