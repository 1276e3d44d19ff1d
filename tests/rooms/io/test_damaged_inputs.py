"""Each of 25 damaged inputs of every reader is refused in one line that says where and what to do, exit 2."""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import foreign_logs as logs
import numpy as np
import pytest
from real_logs import EXCERPT
from slipmargin_cli.main import status

import slipmargin as sm

RUN = logs.run(21)
#: A damaged input: what is in its place.  None: nothing; a dictionary: a folder of these files.
Damage = bytes | None | dict[str, bytes]
LEAST = 25
URDF = Path(__file__).parents[2] / "data" / "urdf" / "mecanum.urdf.xacro"


def of_any_reader() -> dict[str, Damage]:
    """What no reader can read."""
    random = np.random.default_rng(1)
    return {
        "nothing there": None,
        "empty": b"",
        "blank lines": b"\n\n \n",
        "zeros": bytes(200),
        "noise": bytes(random.integers(0, 256, 400, dtype=np.uint8)),
        "a web page": b"<!DOCTYPE html><html><body>404: not found</body></html>\n",
        "a letter": b"Dear reader,\nplease find the log attached.\n",
        "an object": b"{}",
        "a list": b"[]",
        "null": b"null",
        "a number": b"42\n",
        "no end of brackets": b"[" * 3000,
        "a picture": b"\x89PNG\r\n\x1a\n" + bytes(60),
        "an empty folder": {},
        "a folder of something": {"readme.txt": b"hello"},
    }


def packed(whole: bytes) -> dict[str, Damage]:
    """A good file in a wrapping that no reader opens."""
    return {"packed": gzip.compress(whole), "twice as wide": whole.decode("latin-1").encode("utf-16")}


def cut(whole: bytes, *places: int) -> dict[str, Damage]:
    """A good file cut short."""
    return {f"cut at {place}": whole[:place] for place in places}


def swapped(whole: bytes, **changes: tuple[str, str]) -> dict[str, Damage]:
    """A good text with one word replaced everywhere, once for each change; the word must be there."""
    text, out = whole.decode(), {}
    for name, (old, new) in changes.items():
        found = re.sub(old, new, text)
        assert found != text, (name, old)
        out[name] = found.encode()
    return out


def without_rows(whole: bytes, head: int) -> dict[str, Damage]:
    """A table with its head alone, and with one row."""
    lines = whole.split(b"\n")
    return {"no row": b"\n".join(lines[:head]) + b"\n", "one row": b"\n".join(lines[: head + 1]) + b"\n"}


def csv_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A CSV with a pose and four wheels."""
    rows = [
        ",".join(f"{v:.9g}" for v in (t, *pose, *wheels))
        for t, pose, wheels in zip(RUN.t_s, RUN.pose, RUN.theta, strict=True)
    ]
    whole = ("stamp,px,py,yaw,fl,fr,rl,rr\n" + "\n".join(rows) + "\n").encode()
    words = ["--time", "stamp", "--x", "px", "--y", "py", "--heading", "yaw"]
    words += [w for name in ("fl", "fr", "rl", "rr") for w in ("--wheel", f"{name}:rad")]
    number = r"(?m)^-?[\d.e+-]+,"
    special = (
        without_rows(whole, 1)
        | cut(whole, 3, 20, 28)
        | swapped(
            whole,
            no_time=("stamp", "clock"),
            no_x=("px", "qx"),
            no_heading=("yaw", "psi"),
            no_wheel=(",rr", ",wheel4"),
            words_for_time=(number, "soon,"),
            time_stands=(number, "1.0,"),
            no_pose=(r"(?m)^([\d.e+-]+),[^p\n]+?,[^p\n]+?,[^p\n]+?,", r"\1,,,,"),
        )
    )
    return ["import", "csv", "{}", *words], whole, special


def robotino_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A log of the Robotino's makers."""
    whole = (EXCERPT / "gray_0.1" / "heading_155.csv").read_bytes()
    lines = whole.split(b"\n")
    special = without_rows(whole, 3) | cut(whole, 3, 40, len(b"\n".join(lines[:3])) - 4)
    special |= swapped(
        whole,
        no_time=(r"(?m)^t;", "clock;"),
        no_wheel=("m2pos", "m9pos"),
        no_pose=("xpos", "apos"),
        no_heading=(r"\bang\b", "angle"),
        another_unit=(r"(?m)^ms;", "weeks;"),
        words_for_time=(r"(?m)^[\d.]+;", "soon;"),
        time_stands=(r"(?m)^[\d.]+;", "7;"),
    )
    return ["import", "robotino", "{}"], whole, special


def robojackets_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A recording of an SSL robot."""
    file = Path(__file__).parents[2] / "data" / "robojackets_excerpt" / "enc_vis_excerpt.txt"
    whole = file.read_bytes()
    special = without_rows(whole, 1) | cut(whole, 3, 40, 100)
    special |= swapped(
        whole,
        no_robot=("bot_id", "robot"),
        no_heading=(r"\bang\b", "angle"),
        no_wheel=("enc3", "odo3"),
        other_separator=(" ", ";"),
        words_for_ticks=(r"(?m) -?\d+$", " many"),
        ticks_without_end=(r"(?m) -?\d+$", " inf"),
        a_wheel_less=(r"(?m) \S+$", ""),
    )
    special["another robot later"] = whole + b"7" + whole.split(b"\n")[2][1:] + b"\n"
    return ["import", "robojackets", "{}"], whole, special


def wpilog_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A data log of WPILib."""
    whole = logs.wpilog(folder / "good.wpilog", RUN).read_bytes()
    swerve = logs.wpilog(folder / "swerve.wpilog", RUN, swerve=True).read_bytes()
    special: dict[str, Damage] = {"swerve": swerve, "only the head": whole[:12]}
    special |= cut(whole, 3, 8, 20, 60, 100, 150, 200)
    special |= {
        "another version": whole[:6] + b"\x00\x00" + whole[8:],
        "a longer head": whole[:8] + b"\xff\xff\xff\x7f" + whole[12:],
        "no pose": whole.replace(b"struct:Pose2d", b"struct:Pose9d"),
        "no wheels": whole.replace(b"WheelPositions", b"WheelPositionz"),
        "only a goal": whole.replace(b"/Vision/Pose", b"/Vision/Goal"),
        "a pose of four numbers": whole.replace(b"struct:Pose2d", b"struct:Pose3d"),
    }
    return ["import", "wpilog", "{}"], whole, special


def advantagescope_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A table that AdvantageScope exported."""
    whole = logs.advantagescope(folder / "good.csv", RUN).read_bytes()
    special: dict[str, Damage] = {
        "swerve": logs.advantagescope(folder / "swerve.csv", RUN, swerve=True).read_bytes()
    }
    number = r"(?m)^[\d.]+,"
    special |= without_rows(whole, 1) | cut(whole, 3, 30)
    special |= swapped(
        whole,
        no_time=("Timestamp", "Time"),
        no_x=("Pose/translation/x", "Pose/translation/z"),
        no_heading=("rotation/value", "rotation/angle"),
        no_wheel=("rear_right", "rear_middle"),
        which_wheels=("WheelSpeeds", "Wheels"),
        only_a_goal=("Vision/Pose", "Vision/Target"),
        words_for_time=(number, "soon,"),
        time_stands=(number, "1.0,"),
        cells_missing=(r"(?m)^([\d.]+),true", r"\1"),
        semicolons=(",", ";"),
    )
    return ["import", "advantagescope", "{}"], whole, special


def road_runner_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A log of Road Runner's quickstart."""
    file = logs.roadrunner(folder / "good.json", RUN)
    special: dict[str, Damage] = {}
    table = json.loads(file.read_text(encoding="utf-8"))

    def put(name: str, **changes: object) -> None:
        special[name] = json.dumps({k: v for k, v in {**table, **changes}.items() if v is not ...}).encode()

    put("no times", nsTimes=...)
    put("one time", nsTimes=table["nsTimes"][:1])
    put("times with a point", nsTimes=[t / 7 for t in table["nsTimes"]])
    put("times stand", nsTimes=[5] * len(RUN.t_s))
    put("words for times", nsTimes=["soon"] * len(RUN.t_s))
    put("no pose", xs=...)
    put("a shorter pose", ys=table["ys"][:-1])
    put("words in the pose", ys=[*table["ys"][:-1], "far"])
    put("not a number", headings=[*table["headings"][:-1], float("nan")])
    put("no encoders", driveEncPositions=[], driveEncVels=[])
    put("three motors", driveEncPositions=table["driveEncPositions"][:3])
    put("a shorter motor", driveEncPositions=[[1.0], *table["driveEncPositions"][1:]])
    put("no ticks", ticksPerRev=0)
    put("no gear", gearRatio=...)
    put("a word for the gear", gearRatio="19.2:1")
    return ["import", "roadrunner", "{}"], file.read_bytes(), special | cut(file.read_bytes(), 9, 900)


def lerobot_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A data set of LeRobot in a folder."""
    good = logs.lerobot(folder / "good", RUN)
    several = logs.lerobot(folder / "several", RUN, episodes=3)
    other = logs.lerobot(folder / "other", RUN, names=("a.pos", "b.pos", "x.vel", "y.vel", "spin.vel"))

    def files(root: Path) -> dict[str, bytes]:
        return {str(f.relative_to(root)): f.read_bytes() for f in root.rglob("*") if f.is_file()}

    info, data = "meta/info.json", "data/chunk-000/episode_000000.parquet"
    whole = files(good)
    special: dict[str, Damage] = {"three episodes": files(several), "another robot": files(other)}
    for name, text in {
        "no JSON": b"{",
        "a list as info": b"[]",
        "no features": b"{}",
        "features are a word": b'{"features": "x"}',
        "no state": b'{"features": {"action": {}}}',
        "names are numbers": b'{"features": {"observation.state": {"names": [1, 2]}}}',
        "fewer names": b'{"features": {"observation.state": {"names": ["x.vel", "y.vel", "theta.vel"]}}}',
    }.items():
        special[name] = whole | {info: text}
    special["no info"] = {data: whole[data]}
    special["no data"] = {info: whole[info]}
    for place in (0, 4, 100, len(whole[data]) // 2, len(whole[data]) - 5):
        special[f"cut at {place}"] = whole | {data: whole[data][:place]}
    special["zeros in it"] = whole | {data: bytes(len(whole[data]))}
    special["text as data"] = whole | {data: b"t,x,y\n1,2,3\n"}
    track = logs.tracker(folder / "tracker.csv", RUN)
    words = ["--tracker", str(track), "--tracker-start", "100", "--time", "stamp", "--x", "px:mm"]
    return ["import", "lerobot", "{}", *words, "--y", "py:mm", "--heading", "yaw:deg"], b"", special


def files_of(folder: Path) -> dict[str, bytes]:
    """What a bag holds."""
    return {f.name: f.read_bytes() for f in folder.iterdir()}


def damaged_bag(good: Path, what: str, change: tuple[bytes, bytes]) -> dict[str, Damage]:
    """A ROS 2 bag without a part, with a part cut or emptied, and with a word of its metadata changed."""
    whole, meta = files_of(good), "metadata.yaml"
    (store,) = (name for name in whole if name.endswith(".db3"))
    special: dict[str, Damage] = {"no metadata": {store: whole[store]}, "no store": {meta: whole[meta]}}
    for place in (0, 16, 100, 3000, 6000):
        special[f"store cut at {place}"] = whole | {store: whole[store][:place]}
    texts = {"empty": b"", "a list": b"[]", "no YAML": b"{{{", what: whole[meta].replace(*change)}
    for name, text in texts.items():
        special[f"metadata: {name}"] = whole | {meta: text}
    special["store of zeros"] = whole | {store: bytes(len(whole[store]))}
    return special


def ros_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A ROS 2 bag."""
    from rooms.io.test_importers_csv_ros import bag

    good = bag(folder / "good", [5.0, 5.1, 5.2, 5.3], velocity=True)
    special = damaged_bag(good, "another version", (b"version: 9", b"version: 99"))
    special["no wheels"] = files_of(bag(folder / "still", [5.0, 5.1], joint=False))
    special["one pose"] = files_of(bag(folder / "short", [5.0]))
    words = [w for joint in ("a", "b", "c", "d") for w in ("--joint", joint)]
    return ["import", "ros", "{}", *words], b"", special


def urdf_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A plain URDF of three wheels."""
    wheels = "".join(
        f'<link name="{n}"><collision><origin rpy="1.5708 0 0"/><geometry>'
        f'<cylinder radius="0.05" length="0.02"/></geometry></collision></link>'
        f'<joint name="{n}_wheel_joint" type="continuous"><parent link="base_link"/>'
        f'<child link="{n}"/><origin xyz="{x} {y} 0.05"/><axis xyz="0 1 0"/></joint>'
        for n, x, y in (("fl", 0.1, 0.1), ("fr", 0.1, -0.1), ("rl", -0.1, 0.1), ("rr", -0.1, -0.1))
    )
    base = (
        '<link name="base_link"><inertial><mass value="10"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
    )
    base += 'iyz="0"/></inertial></link>'
    whole = f'<?xml version="1.0"?><robot name="rover">{base}{wheels}</robot>'.encode()
    special = cut(whole, 10, 30, 100, 400, len(whole) - 9) | swapped(
        whole,
        no_wheel_joint=('type="continuous"', 'type="fixed"'),
        no_parent=('<parent link="base_link"/>', '<parent link="nobody"/>'),
        no_child=('<child link="fl"/>', '<child link="nobody"/>'),
        words_for_places=('xyz="0.1 0.1 0.05"', 'xyz="here"'),
        upright_axles=('xyz="0 1 0"', 'xyz="0 0 1"'),
        no_axle=('xyz="0 1 0"', 'xyz="0 0 0"'),
        a_word_for_the_mass=('value="10"', 'value="heavy"'),
        no_radius=('radius="0.05"', 'radius="thick"'),
        not_a_robot=("robot", "machine"),
    )
    return ["robots", "from-urdf", "{}"], whole, special


def trajectory(name: str, folder: Path) -> bytes:
    """A good trajectory file, as plan exports it."""
    found = sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [0.4, 0.1, 0.3]], points=40, step_s=0.05)
    file = folder / f"good-{name}"
    if name == "csv":
        found.write_files(table=file)
    else:
        sm.export_trajectory(found, name, file)
    return b"" if file.is_dir() else file.read_bytes()


CHECK = ["check", "ohio-kiwi", "{}", "--surface", "paper"]


def own_csv_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """Our own CSV."""
    whole = trajectory("csv", folder)
    row = r"(?m)^([-\d.e]+),"
    special = without_rows(whole, 1) | cut(whole, 2, 9, 14)
    special |= swapped(
        whole,
        no_time=("t_s", "time"),
        no_x=("x_m", "px_m"),
        no_heading=("phi_rad", "phi_deg"),
        words_for_time=(row, "soon,"),
        no_times=(row, ","),
        time_stands=(row, "1.0,"),
        time_goes_back=(row, r"-\1,"),
        a_number_too_large=(row, r"1e400,"),
        semicolons=(",", ";"),
    )
    return CHECK, whole, special


def samples_files(
    name: str, folder: Path, change: Callable[[object], list[dict[str, object]]], keys: dict[str, str]
) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A JSON of samples, each fault put into the third of them; ``keys`` names time, x and heading."""
    whole = trajectory(name, folder)
    special: dict[str, Damage] = {} | cut(whole, 1, 30, len(whole) // 2, len(whole) - 3)
    for what, value in {
        "a word": "far",
        "nothing": None,
        "true": True,
        "not a number": float("nan"),
        "infinite": float("inf"),
        "a list": [1.0],
    }.items():
        for key in (keys["time"], keys["heading"]):
            table = json.loads(whole)
            change(table)[2][key] = value
            special[f"{key} is {what}"] = json.dumps(table).encode()
    table = json.loads(whole)
    del change(table)[3][keys["time"]]
    special["a time is missing"] = json.dumps(table).encode()
    table = json.loads(whole)
    change(table)[3] = [1.0]  # type: ignore[call-overload]
    special["a sample is a list"] = json.dumps(table).encode()
    table = json.loads(whole)
    del change(table)[:]
    special["no sample"] = json.dumps(table).encode()
    table = json.loads(whole)
    del change(table)[2:]
    special["two samples"] = json.dumps(table).encode()
    return CHECK, whole, special


def choreo_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """Choreo's .traj."""
    keys = {"time": "t", "heading": "heading"}
    return samples_files("choreo", folder, lambda t: t["trajectory"]["samples"], keys)  # type: ignore[index]


def pathplanner_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """PathPlanner's trajectory."""
    keys = {"time": "time", "heading": "holonomicRotation"}
    return samples_files("pathplanner", folder, lambda t: t, keys)  # type: ignore[arg-type,return-value]


def road_runner_trajectory_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A log of Road Runner as a trajectory."""
    whole = trajectory("roadrunner", folder)
    table = json.loads(whole)
    special: dict[str, Damage] = {} | cut(whole, 1, 30, len(whole) // 2, len(whole) - 3)
    count = len(table["nsTimes"])
    for what, changes in {
        "no times": {"nsTimes": []},
        "times are a word": {"nsTimes": "soon"},
        "times with a point": {"nsTimes": [0.5 * t for t in table["nsTimes"]]},
        "times stand": {"nsTimes": [7] * count},
        "times go back": {"nsTimes": table["nsTimes"][::-1]},
        "a time is missing": {"nsTimes": table["nsTimes"][:-1]},
        "no x": {"targetXs": "x", "xs": []},
        "no pose": {"targetXs": [], "xs": []},
        "a shorter y": {"targetYs": table["targetYs"][1:]},
        "a word in y": {"targetYs": ["far", *table["targetYs"][1:]]},
        "not a number": {"targetHeadings": [float("nan"), *table["targetHeadings"][1:]]},
        "two samples": {k: table[k][:2] for k in ("nsTimes", "targetXs", "targetYs", "targetHeadings")},
    }.items():
        special[what] = json.dumps(table | changes).encode()
    return CHECK, whole, special


def path_bag_files(folder: Path) -> tuple[list[str], bytes, dict[str, Damage]]:
    """A ROS bag with a nav_msgs/Path."""
    trajectory("ros-path", folder)
    change = (b"nav_msgs/msg/Path", b"std_msgs/msg/String")
    return CHECK, b"", damaged_bag(folder / "good-ros-path", "another type", change)


READERS: dict[str, Callable[[Path], tuple[list[str], bytes, dict[str, Damage]]]] = {
    "csv": csv_files,
    "robotino": robotino_files,
    "robojackets": robojackets_files,
    "wpilog": wpilog_files,
    "advantagescope": advantagescope_files,
    "roadrunner": road_runner_files,
    "lerobot": lerobot_files,
    "ros": ros_files,
    "urdf": urdf_files,
    "trajectory csv": own_csv_files,
    "trajectory choreo": choreo_files,
    "trajectory pathplanner": pathplanner_files,
    "trajectory roadrunner": road_runner_trajectory_files,
    "trajectory bag": path_bag_files,
}
PACKAGES = {
    "wpilog": "wpiutil",
    "lerobot": "pyarrow",
    "ros": "rosbags",
    "urdf": "yourdfpy",
    "trajectory bag": "rosbags",
}


def lay(place: Path, damage: Damage) -> None:
    """Put a damaged input into its place."""
    if isinstance(damage, dict):
        place.mkdir(parents=True)
        for name, content in damage.items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            (place / name).write_bytes(content)
    elif damage is not None:
        place.write_bytes(damage)


def cases(name: str, folder: Path) -> Iterator[tuple[str, Path, list[str]]]:
    """Every damaged input of a reader, in a place of its own, and the command that reads it."""
    words, whole, special = READERS[name](folder)
    damages = of_any_reader() | (packed(whole) if whole else {}) | special
    assert len(damages) >= LEAST, (name, len(damages))
    for k, (what, damage) in enumerate(damages.items()):
        place = folder / f"damage{k}"
        lay(place, damage)
        yield what, place, [str(place) if word == "{}" else word for word in words]


def robot_of(name: str, folder: Path) -> list[str]:
    """The options that every import has."""
    if name == "urdf" or name.startswith("trajectory"):
        return []
    if name in ("robotino", "robojackets"):
        return ["--robot", {"robotino": "robotino", "robojackets": "robojackets-2018"}[name]]
    file = folder / "robot.toml"
    file.write_text(
        sm.new_robot("robot", "lekiwi" if name == "lerobot" else "mecanum").text, encoding="utf-8"
    )
    return ["--robot", str(file)]


@pytest.mark.parametrize("name", READERS)
def test_damage_is_refused_in_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip(PACKAGES.get(name, "json"), reason=f"the extra of {name} is not installed")
    robot, out = robot_of(name, tmp_path), tmp_path / "out.txt"
    faults = []
    for what, place, words in cases(name, tmp_path):
        capsys.readouterr()
        code = status([*words, *robot, "--out", str(out)])
        told = capsys.readouterr().err
        line = told.startswith("error: ") and told.count("\n") == 1 and ", " in told
        if code != 2 or not line or place.name not in told or out.exists():
            faults.append(f"{what}: exit {code}: {told.strip()[:300]}")
    assert not faults, "\n".join(faults)
