"""Cases of commands that read other tools' files, whole folders, a stream or a browser's requests."""

from __future__ import annotations

import json
import math
import tempfile
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import foreign_logs
import tomllib

from fuzz import mutate

DATA = Path(__file__).resolve().parents[1] / "data"
RUN = foreign_logs.run(21)


@cache
def good_log(form: str) -> dict[str, bytes]:
    """A log as another tool writes it: path below the case's folder → bytes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if form == "wpilog":
            foreign_logs.wpilog(folder / "l.wpilog", RUN)
        elif form == "advantagescope":
            foreign_logs.advantagescope(folder / "l.csv", RUN)
        elif form == "list":
            foreign_logs.advantagescope(folder / "l.csv", RUN, table=False)
        elif form == "roadrunner":
            foreign_logs.roadrunner(folder / "l.json", RUN)
        elif form == "ros":
            _bag(folder / "l")
        else:
            foreign_logs.lerobot(folder / "l", RUN)
            foreign_logs.tracker(folder / "tracker.csv", RUN)
        return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def _bag(folder: Path) -> None:
    """A ROS 2 bag with poses and joint states of the run."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    topics = {"/pose": "geometry_msgs/msg/PoseStamped", "/joint_states": "sensor_msgs/msg/JointState"}
    with Writer(folder, version=9) as writer:
        links = {k: writer.add_connection(k, v, typestore=store) for k, v in topics.items()}
        for t, (x, y, yaw), theta, omega in zip(RUN.t_s, RUN.pose, RUN.theta, RUN.omega, strict=True):
            sec, rest = divmod(round(1e9 * (100.0 + float(t))), 10**9)
            header = kinds["std_msgs/msg/Header"](
                stamp=kinds["builtin_interfaces/msg/Time"](sec=sec, nanosec=rest), frame_id="map"
            )
            pose = kinds["geometry_msgs/msg/Pose"](
                position=kinds["geometry_msgs/msg/Point"](x=float(x), y=float(y), z=0.0),
                orientation=kinds["geometry_msgs/msg/Quaternion"](
                    x=0.0, y=0.0, z=math.sin(0.5 * yaw), w=math.cos(0.5 * yaw)
                ),
            )
            messages: dict[str, Any] = {
                "/pose": kinds[topics["/pose"]](header=header, pose=pose),
                "/joint_states": kinds[topics["/joint_states"]](
                    header=header,
                    name=["fl", "fr", "rl", "rr"],
                    position=theta,
                    velocity=omega,
                    effort=0.0 * theta,
                ),
            }
            for topic, message in messages.items():
                writer.write(links[topic], 10**9 * sec + rest, store.serialize_cdr(message, topics[topic]))


def log_words(random: Random, files: dict[str, bytes]) -> list[str]:
    """Put a log of another tool among the files, changed; the command line that reads it."""
    form = random.choice(("wpilog", "advantagescope", "list", "roadrunner", "ros", "lerobot", "robojackets"))
    if form == "robojackets":
        text = (DATA / "robojackets_excerpt" / "enc_vis_excerpt.txt").read_text(encoding="utf-8")
        text = "\n".join(text.split("\n")[:200]) + "\n"
        files["l.txt"] = mutate.table(random, text, random.choice((0, 1, 3)), " ").encode()
        return ["import", "robojackets", "l.txt"]
    files |= good_log(form)
    for name in random.sample(sorted(good_log(form)), random.choice((0, 1, 1, 1))):
        files[name] = changed(random, name, files[name])
    robot = "l.toml"
    files[robot] = _robot("lekiwi" if form == "lerobot" else "mecanum")
    words = ["import", {"list": "advantagescope"}.get(form, form)]
    words += (
        ["l"] if form in ("ros", "lerobot") else sorted(n for n in files if n.startswith("l.") and n != robot)
    )
    if form == "lerobot" and random.random() < 0.9:
        words += ["--tracker", "tracker.csv", "--time", "stamp", "--x", "px:mm", "--y", "py:mm"]
        words += ["--heading", "yaw:deg", "--tracker-start", random.choice(("100", "0", "1e300", "nan"))]
    if form == "roadrunner" and random.random() < 0.2:
        words += ["--length-unit", random.choice(("in", "m", "furlong"))]
    if form in ("wpilog", "advantagescope", "list") and random.random() < 0.2:
        words += ["--pose", random.choice(("/Vision/Pose", "/Drive/TargetPose", "no", "x:deg"))]
    if form == "ros" and random.random() < 0.3:
        words += ["--pose-rotation", random.choice(("90", "nan", "1e300"))]
    return [*words, "--robot", robot, "--surface", "floor"]


@cache
def _robot(kind: str) -> bytes:
    import slipmargin as sm

    return sm.new_robot("rover", kind).text.encode()


def changed(random: Random, name: str, data: bytes) -> bytes:
    """A file changed as its kind asks for."""
    if random.random() < 0.3:
        return mutate.raw(random, data, random.choice((1, 2, 5)))
    if name.endswith(".json"):
        tree = json.loads(data)
        if name == "l.json":  # long lists of numbers: every place is as likely as a key
            tree = {
                k: v[:12] if isinstance(v, list) and k != "driveEncPositions" else v for k, v in tree.items()
            }
        return json.dumps(mutate.tree(random, tree, random.choice((1, 2)))).encode()
    if name.endswith(".csv"):
        return mutate.table(random, data.decode(), random.choice((1, 2))).encode()
    return mutate.raw(random, data, random.choice((1, 3)))


# --- campaigns and pulls --------------------------------------------------------------------------------


def _short(text: str, rows: int) -> str:
    return "\n".join(text.split("\n")[: rows + 3]) + "\n"


def campaign(random: Random) -> tuple[list[str], dict[str, bytes]]:
    """Two data sets of one robot and the file that joins them."""
    files: dict[str, bytes] = {}
    folder = DATA / "rig" / "a-null"
    for name in ("d", "e"):
        for file in ("robot.toml", "dataset.toml"):
            files[f"{name}/{file}"] = (folder / file).read_bytes()
        for trial in sorted((folder / "trials").glob("*.csv"))[: random.choice((1, 2, 3))]:
            text = _short(trial.read_text(encoding="utf-8"), 30)
            changes = int(random.random() < 0.1)
            files[f"{name}/trials/{trial.name}"] = mutate.table(random, text, changes).encode()
    rows: list[dict[str, Any]] = [{"path": "d"}, {"path": "e", "floor": "other", "instrument": "camera 2"}]
    if random.random() < 0.5:
        rows[1]["loading"] = "payload"
    table = {"schema": 1, "name": "c", "loading": {"payload": {"mass_kg": 12.7}}, "data_set": rows}
    files["campaign.toml"] = mutate.toml(mutate.tree(random, table, random.choice((0, 0, 1, 1, 2)))).encode()
    where = random.choice(("campaign.toml", ".", "campaign.toml"))
    return ["diagnose", where, "--out", "o", "--budget", random.choice(("0.2", "1"))], files


def pulls(random: Random) -> tuple[list[str], dict[str, bytes]]:
    """A data set of pulls alone."""
    folder = DATA / "rig" / "b-natural-loads"
    spoilt = random.choice(("robot", "head", "pulls", "pulls", ""))
    robot = mutate.tree(
        random, tomllib.loads((folder / "robot.toml").read_text(encoding="utf-8")), int(spoilt == "robot")
    )
    head = tomllib.loads((DATA / "rig" / "a-null" / "dataset.toml").read_text(encoding="utf-8"))
    changes = random.choice((1, 1, 2)) if spoilt == "pulls" else 0
    text = mutate.table(random, (folder / "pulls.csv").read_text(encoding="utf-8"), changes)
    files = {
        "d/robot.toml": mutate.toml(robot).encode(),
        "d/dataset.toml": mutate.toml(mutate.tree(random, head, int(spoilt == "head"))).encode(),
        "d/pulls.csv": text.encode(),
    }
    return ["diagnose", "d", "--out", "o", "--budget", "1"], files


# --- a browser's requests -------------------------------------------------------------------------------


def requests(random: Random, files: dict[str, bytes]) -> None:
    """Put what a browser, or something else, sends to the local page among the files: ``request-1`` …"""
    keys = ("mu", "com_height_m", "com_x_m", "com_y_m", "delta_deg", "front_angle_deg", "margin", "yaw_share")
    for k in range(random.choice((1, 3, 6))):
        query = "&".join(
            f"{random.choice((*keys, 'colour', 'tool', ''))}={_value(random)}"
            for _ in range(random.choice((0, 1, 2)))
        )
        path = random.choice(
            ("/api/robot", "/api/limits", "/api/limits", "/api/pulls", "/api/export", "/api/report")
        )
        path = random.choice((path, path, path, path, "/", "/page.js", "/../etc/passwd", "/api/", "//x", "*"))
        if path == "/api/export":
            query += "&tool=" + random.choice(("nav2", "choreo", "json", "pathplanner", "roadrunner", "x"))
        method, body = "GET", b""
        if random.random() < 0.25:
            method, path = random.choice(
                (("POST", "/api/pulls"), ("POST", path), ("PUT", path), ("HEAD", path))
            )
            text = "phi_rad,force_N\n0,5\n0.5,5.1\n1,4.9\n"
            body = mutate.table(random, text, random.choice((0, 1, 2))).encode()
        lines = [f"{method} {path}{'?' + query if query else ''} HTTP/1.1"]
        lines += [random.choice(("Host: HOST", "Host: HOST", "Host: HOST", "Host: evil.example", "X: y"))]
        lines += ["Origin: http://HOST"] if random.random() < 0.2 else []
        lines += ["Origin: null"] if random.random() < 0.05 else []
        if body:
            length = random.choice((len(body),) * 6 + (0, -1, 10**12, "x"))
            lines += [f"Content-Length: {length}"]
        lines += ["Connection: close", "", ""]
        data = "\r\n".join(lines).encode("utf-8", "replace") + body
        files[f"request-{k}"] = mutate.raw(random, data, 1) if random.random() < 0.1 else data


def _value(random: Random) -> str:
    one = random.choice((*mutate.NUMBERS, 0.1, 0.3, 0.5, "much", "1e", "%00", "<b>", "0x10", "1_0"))
    return str(one)[:60].replace(" ", "+")
