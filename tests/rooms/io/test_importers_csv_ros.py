"""The same run through other formats gives the same record."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from real_logs import EXCERPT

from slipmargin.errors import InputError
from slipmargin.io import extra
from slipmargin.io.importers.csv_map import CsvImporter, read_map
from slipmargin.io.importers.csv_options import wheel_columns
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.importers.ros2 import RosImporter, pose_of

LOG = EXCERPT / "gray_0.1" / "heading_155.csv"
MAP = """
schema = 1
separator = ";"
[time]
column = "t"
unit = "ms"
[pose]
x = { column = "xpos", unit = "mm", scale = 1.8405 }
y = { column = "ypos", unit = "mm", scale = -1.8372 }
heading = { column = "ang", unit = "deg", offset_rad = 1.5707963267948966 }
[[wheel]]
angle = { column = "m1pos", unit = "ticks", ticks_per_turn = 32000, scale = -1 }
command = { column = "m1setvel", unit = "rad/s", scale = -0.0625 }
[[wheel]]
angle = { column = "m2pos", unit = "ticks", ticks_per_turn = 32000, scale = -1 }
command = { column = "m2setvel", unit = "rad/s", scale = -0.0625 }
[[wheel]]
angle = { column = "m3pos", unit = "ticks", ticks_per_turn = 32000, scale = -1 }
speed = { column = "m3vel", unit = "rpm" }
current = { column = "m3cur", unit = "mA" }
"""


def mapped(tmp_path: Path, text: str = MAP) -> CsvImporter:
    path = tmp_path / "map.toml"
    path.write_text(text, encoding="utf-8")
    return CsvImporter(map=read_map(path))


def test_a_map_reads_what_the_special_importer_reads(tmp_path: Path) -> None:
    mine, special = mapped(tmp_path).read(LOG).record, RobotinoImporter(smooth_s=0.0).read(LOG).record
    np.testing.assert_allclose(mine.t_s, special.t_s - special.t_s[0], rtol=1e-12)
    both = special.seen
    np.testing.assert_allclose(mine.pose[both], special.pose[both], rtol=1e-13)
    assert mine.theta is not None and special.theta is not None and mine.current is not None
    np.testing.assert_allclose(mine.theta, special.theta, rtol=1e-13)
    assert mine.omega is not None and np.isnan(mine.omega[:, :2]).all()
    assert mine.omega_cmd is not None and np.isnan(mine.omega_cmd[:, 2]).all()
    np.testing.assert_allclose(mine.current[:, 2] * 1000.0, special.current[:, 2])  # type: ignore[index]


@pytest.mark.parametrize(
    ("wrong", "right", "said"), [("m1pos", "m2pos", "m2pos"), ("xpos", "ypos", "ypos"), ("m3cur", "t", "t")]
)
def test_one_column_is_not_two_channels(tmp_path: Path, wrong: str, right: str, said: str) -> None:
    """Two wheels of one column were read as wheels that always turn alike."""
    with pytest.raises(InputError) as told:
        mapped(tmp_path, MAP.replace(f'"{wrong}"', f'"{right}"'))
    assert told.value.place == said and told.value.problem == "is the column of two channels"
    assert told.value.source == str(tmp_path / "map.toml")


def test_two_wheels_of_a_command_have_two_columns() -> None:
    with pytest.raises(InputError, match="names fl for two wheels"):
        wheel_columns(["fl:rpm", "fr:rpm", "-fl:rad/s"])


def test_units_by_hand(tmp_path: Path) -> None:
    text = """
schema = 1
[time]
column = "t"
unit = "us"
[pose]
x = { column = "x", unit = "cm" }
y = { column = "y", unit = "in" }
heading = { column = "h", unit = "turn" }
[[wheel]]
speed = { column = "w", unit = "rpm" }
"""
    (tmp_path / "run.csv").write_text(
        "t,x,y,h,w\n0,0,0,0.9,0\n2000000,100,100,1.1,60\n3000000,,1,1,1\n", encoding="utf-8"
    )
    reading = mapped(tmp_path, text).read(tmp_path / "run.csv")
    record = reading.record
    np.testing.assert_allclose(record.t_s, [0, 2, 3])
    np.testing.assert_allclose(record.pose[1], [1.0, 2.54, 2.2 * math.pi])
    assert reading.lost_frames == 1 and np.isnan(record.pose[2]).all()
    assert record.omega is not None and record.omega[1, 0] == pytest.approx(2 * math.pi)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("schema = 1", "schema = 3"), "schema: is 3, this program reads schema = 1"),
        (('"ms"', '"weeks"'), "time.unit: has the unit 'weeks'"),
        (('separator = ";"', 'separator = "x"'), "separator"),
        (("ticks_per_turn = 32000", "ticks_per_turn = 0"), "wheel[1].angle.ticks_per_turn"),
        (("scale = 1.8405", "scale = 0"), "pose.x.scale: is 0"),
        (("[pose]", "[pose]\nz = 1"), "pose.z: is not a known key"),
        (('column = "t"', 'columm = "t"'), "time.column: is missing"),
        (("[[wheel]]\nangle", "[[wheel]]\n[[wheel]]\nangle"), "wheel[1]: has no channel"),
        (("schema = 1", "schema = 1\nwheels = 3"), "wheels: is not a known key"),
    ],
)
def test_a_map_is_read_strictly(tmp_path: Path, change: tuple[str, str], told: str) -> None:
    with pytest.raises(InputError) as refusal:
        mapped(tmp_path, MAP.replace(*change, 1))
    assert told in str(refusal.value) and "map.toml" in str(refusal.value)


def test_a_map_without_wheels_and_logs_that_do_not_fit(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no wheel is mapped"):
        mapped(tmp_path, MAP[: MAP.index("[[wheel]]")])
    importer = mapped(tmp_path, MAP)
    log = tmp_path / "log.csv"
    log.write_text(LOG.read_text(encoding="utf-8").replace("m3cur", "m3amp"), encoding="utf-8")
    with pytest.raises(InputError, match="'m3cur' is missing"):
        importer.read(log)
    lines = LOG.read_text(encoding="utf-8").split("\n")
    log.write_text("\n".join(lines[:4]), encoding="utf-8")
    with pytest.raises(InputError, match="only one row"):
        importer.read(log)
    blind = [";".join([*line.split(";")[:19], "", *line.split(";")[20:]]) for line in lines[3:9]]
    log.write_text("\n".join([*lines[:3], *blind]), encoding="utf-8")
    with pytest.raises(InputError, match="no row holds a whole pose"):
        importer.read(log)


def bag(folder: Path, stamps: list[float], joint: bool = True, velocity: bool = False) -> Path:
    """A ROS 2 bag: the pose turns by 0.1 rad a sample and drives along x, the joints follow."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="rosbags is not installed (extra [ros])")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    T = store.types
    with rosbag2.Writer(folder, version=9) as writer:
        pose = writer.add_connection("/pose", "geometry_msgs/msg/PoseStamped", typestore=store)
        wheels = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for k, t in enumerate(stamps):
            stamp = T["builtin_interfaces/msg/Time"](sec=int(t), nanosec=round((t % 1) * 1e9))
            header = T["std_msgs/msg/Header"](stamp=stamp, frame_id="m")
            yaw = 3.0 + 0.1 * k
            message = T["geometry_msgs/msg/PoseStamped"](
                header=header,
                pose=T["geometry_msgs/msg/Pose"](
                    position=T["geometry_msgs/msg/Point"](x=0.01 * k, y=0.0, z=0.0),
                    orientation=T["geometry_msgs/msg/Quaternion"](
                        x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2)
                    ),
                ),
            )
            at = int(1e9 * (100 + k))
            writer.write(pose, at, store.serialize_cdr(message, "geometry_msgs/msg/PoseStamped"))
            if joint:
                state = T["sensor_msgs/msg/JointState"](
                    header=header,
                    name=["b", "a", "c"],
                    position=np.array([2.0, 1.0, 3.0]) * k,
                    velocity=np.array([2.0, 1.0, 3.0]) if velocity else np.zeros(0),
                    effort=np.zeros(0),
                )
                writer.write(wheels, at, store.serialize_cdr(state, "sensor_msgs/msg/JointState"))
    return folder


def importer(**more: object) -> RosImporter:
    return RosImporter(
        **{
            "pose_topic": "/pose",
            "joint_topic": "/joint_states",  # type: ignore[arg-type]
            "joints": ("a", "-b", "c"),
        }
        | more
    )


def test_a_bag(tmp_path: Path) -> None:
    reading = importer().read(bag(tmp_path / "run", [5.0, 5.1, 5.25, 5.2, 5.3], velocity=True))
    record = reading.record
    np.testing.assert_allclose(record.t_s, [0.0, 0.1, 0.2, 0.3], atol=1e-8)  # one stamp came too late
    assert reading.rows == 5 and [d.count for d in reading.dropped] == [1]
    np.testing.assert_allclose(np.diff(record.pose[:, 2]), [0.1, 0.2, 0.1], atol=1e-12)  # unwrapped through π
    assert record.theta is not None and record.omega is not None
    np.testing.assert_allclose(record.theta[1], [1.0, -2.0, 3.0])  # in the robot's order, b turned
    np.testing.assert_allclose(record.omega[2], [1.0, -2.0, 3.0])


def test_bags_that_do_not_fit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    good = bag(tmp_path / "run", [1.0, 2.0])
    for wrong, told in (
        ({"pose_topic": "/odom"}, "/odom: is not a topic of the bag, use one of: /joint_s"),
        ({"joints": ("a", "b", "d")}, "'d' is not a joint, use some of: a, b, c"),
        ({"pose_topic": "/joint_states"}, "holds"),
    ):
        with pytest.raises(InputError, match=told):
            importer(**wrong).read(good)
    with pytest.raises(InputError, match="there is no such bag"):
        importer().read(tmp_path / "none")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="is no bag"):
        importer().read(tmp_path / "empty")
    with pytest.raises(InputError, match="holds no message"):
        importer().read(bag(tmp_path / "still", [1.0, 2.0], joint=False))
    with pytest.raises(InputError, match="1 poses"):
        importer().read(bag(tmp_path / "short", [1.0]))
    monkeypatch.setattr(extra, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'slipmargin\[ros\]'"):
        importer().read(good)


def test_a_damaged_bag_is_refused(tmp_path: Path) -> None:
    good = bag(tmp_path / "run", [1.0, 2.0])
    (store,) = good.glob("*.db3")
    store.write_bytes(store.read_bytes()[:3000])
    with pytest.raises(InputError, match="is no bag that can be read"):
        importer().read(good)


def test_clock_times_begin_at_zero(tmp_path: Path) -> None:
    """Seconds since 1970 with nine digits were all the same time once they were written."""
    lines = LOG.read_text(encoding="utf-8").splitlines()
    late = [row.split(";", 1) for row in lines[3:] if row]
    rows = [f"{1.7e12 + float(ms):.3f};{rest}" for ms, rest in late]
    path = tmp_path / "late.csv"
    path.write_text("\n".join([*lines[:3], *rows]) + "\n", encoding="utf-8")
    found, plain = (mapped(tmp_path).read(p).record for p in (path, LOG))
    assert found.t_s[0] == 0.0
    np.testing.assert_allclose(found.t_s, plain.t_s - plain.t_s[0], atol=1e-3)


@pytest.mark.parametrize("q", [(1e200, 0.0, 1e200, 1e200), (2.0, 0.0, 0.0, 0.0), (math.nan, 0.0, 0.0, 0.0)])
def test_a_quaternion_that_is_no_rotation_is_a_missing_pose(q: tuple[float, ...]) -> None:
    """Its square overflowed, which ended the import in an internal error."""

    def message(w: float, x: float, y: float, z: float) -> SimpleNamespace:
        place = SimpleNamespace(x=1.0, y=2.0, z=0.0)
        return SimpleNamespace(
            pose=SimpleNamespace(position=place, orientation=SimpleNamespace(w=w, x=x, y=y, z=z))
        )

    assert pose_of(message(*q))[:2] == (1.0, 2.0) and math.isnan(pose_of(message(*q))[2])
    assert pose_of(message(0.0, 0.0, 0.0, 0.0))[2] == 0.0
    assert pose_of(message(math.cos(0.2), 0.0, 0.0, math.sin(0.2)))[2] == pytest.approx(0.4)
