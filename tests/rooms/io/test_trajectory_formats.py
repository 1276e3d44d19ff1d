"""Trajectories that other tools wrote: the same motion in every form, damaged files refused in one line."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from strategies import kiwi

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.io.table import columns_text
from slipmargin.io.trajectory_file import read_trajectory
from slipmargin.model import nominal_model
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.paths.trajectory import Trajectory

SAMPLES = Path(__file__).parents[2] / "data" / "trajectories"
#: φ = θ − π/2: what the writers below add.
QUARTER = 0.5 * math.pi


@pytest.fixture(scope="module")
def planned() -> Trajectory:
    """A plan with a turn through θ = π, at times that are whole milliseconds."""
    way = through(np.array([[0, 0, 1.0], [0.6, 0.4, 1.8], [1.2, 0.0, 2.6]]))
    rows = trajectory(plan(nominal_model(kiwi(), "paper"), way, Request(share=0.9, points=100)), step_s=0.01)
    keep = slice(0, len(rows.t_s) - 1)  # the last step is shorter
    return Trajectory(
        t_s=np.round(rows.t_s[keep], 9),
        pose=rows.pose[keep],
        velocity=rows.velocity[keep],
        acceleration=rows.acceleration[keep],
        omega=rows.omega[keep],
        use=rows.use[keep],
        wheels=rows.wheels,
    )


def wrapped(phi: np.ndarray) -> np.ndarray:
    return np.angle(np.exp(1j * (phi + QUARTER)))


def as_csv(rows: Trajectory, folder: Path) -> Path:
    file = folder / "t.csv"
    file.write_text(columns_text(rows.columns(), digits=17), encoding="utf-8")
    return file


def choreo_samples(rows: Trajectory) -> list[dict[str, Any]]:
    names = ("t", "x", "y", "heading", "vx", "vy", "omega", "ax", "ay", "alpha")
    theta = wrapped(rows.pose[:, 2])
    table = np.column_stack([rows.t_s, rows.pose[:, :2], theta, rows.velocity, rows.acceleration])
    return [dict(zip(names, line, strict=True), fx=[0.0], fy=[0.0]) for line in table.tolist()]


def as_choreo(rows: Trajectory, folder: Path) -> Path:
    file = folder / "any-name.txt"
    samples = choreo_samples(rows)
    file.write_text(
        json.dumps({"name": "a", "version": 1, "trajectory": {"samples": samples}}), encoding="utf-8"
    )
    return file


def as_old_choreo(rows: Trajectory, folder: Path) -> Path:
    new = ("timestamp", "x", "y", "heading", "velocityX", "velocityY", "angularVelocity")
    old = ("t", "x", "y", "heading", "vx", "vy", "omega")
    samples = [{n: s[o] for n, o in zip(new, old, strict=True)} for s in choreo_samples(rows)]
    file = folder / "old.traj"
    file.write_text(json.dumps({"samples": samples}), encoding="utf-8")
    return file


def pathplanner_states(rows: Trajectory) -> list[dict[str, Any]]:
    speed = np.hypot(*rows.velocity[:, :2].T)
    return [
        {
            "time": float(t),
            "pose": {
                "rotation": {"radians": float(np.arctan2(v[1], v[0]))},
                "translation": {"x": float(p[0]), "y": float(p[1])},
            },
            "velocity": float(s),
            "holonomicRotation": float(np.rad2deg(theta)),
            "holonomicAngularVelocity": float(np.rad2deg(v[2])),
            "curvature": 0,
        }
        for t, p, v, s, theta in zip(
            rows.t_s, rows.pose, rows.velocity, speed, wrapped(rows.pose[:, 2]), strict=True
        )
    ]


def as_pathplanner(rows: Trajectory, folder: Path) -> Path:
    file = folder / "a.wpilib.json"
    file.write_text(json.dumps(pathplanner_states(rows)), encoding="utf-8")
    return file


def as_pathplanner_states(rows: Trajectory, folder: Path) -> Path:
    file = folder / "states.json"
    file.write_text(json.dumps({"states": pathplanner_states(rows)}), encoding="utf-8")
    return file


def as_bag(
    rows: Trajectory,
    folder: Path,
    topics: tuple[str, ...] = ("/plan",),
    start_s: int = 1_700_000_000,
    still: bool = False,
    unit: float = 1.0,
    messages: int = 1,
) -> Path:
    """Paths with stamps of this century; the first of several messages holds half the path."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="rosbags is not installed (extra [ros])")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    T = store.types

    def header(ns: int) -> Any:
        stamp = T["builtin_interfaces/msg/Time"](sec=start_s + ns // 10**9, nanosec=ns % 10**9)
        return T["std_msgs/msg/Header"](stamp=stamp, frame_id="map")

    poses = []
    for t, (x, y, phi) in zip(rows.t_s, rows.pose, strict=True):
        half = 0.5 * (phi + QUARTER)
        turn = T["geometry_msgs/msg/Quaternion"](
            x=0.0, y=0.0, z=unit * math.sin(half), w=unit * math.cos(half)
        )
        point = T["geometry_msgs/msg/Point"](x=float(x), y=float(y), z=0.0)
        pose = T["geometry_msgs/msg/Pose"](position=point, orientation=turn)
        at = header(0 if still else round(1e9 * t))
        poses.append(T["geometry_msgs/msg/PoseStamped"](header=at, pose=pose))
    with rosbag2.Writer(folder / "bag", version=9) as writer:
        for topic in topics:
            there = writer.add_connection(topic, "nav_msgs/msg/Path", typestore=store)
            for k in range(messages):
                part = poses if k == messages - 1 else poses[: len(poses) // 2]
                message = T["nav_msgs/msg/Path"](header=header(0), poses=part)
                writer.write(there, 10**9 + k, store.serialize_cdr(message, "nav_msgs/msg/Path"))
    return folder / "bag"


WRITERS: dict[str, tuple[Callable[[Trajectory, Path], Path], str]] = {
    "csv": (as_csv, "CSV"),
    "choreo": (as_choreo, "Choreo"),
    "old choreo": (as_old_choreo, "Choreo"),
    "pathplanner": (as_pathplanner, "PathPlanner"),
    "pathplanner states": (as_pathplanner_states, "PathPlanner"),
    "bag": (as_bag, "nav_msgs/Path"),
}


@pytest.mark.parametrize("form", WRITERS)
def test_the_same_motion_in_every_form(form: str, planned: Trajectory, tmp_path: Path) -> None:
    write, name = WRITERS[form]
    ours = sm.check("ohio-kiwi", "paper", planned, margin=0.1)
    theirs = sm.check("ohio-kiwi", "paper", write(planned, tmp_path), margin=0.1)
    assert theirs.source_format == name and theirs.warnings == ours.warnings
    assert theirs.admissible == ours.admissible
    assert theirs.check.max_use == pytest.approx(ours.check.max_use, abs=1e-6)
    assert theirs.check.worst[3] == ours.check.worst[3]
    assert theirs.check.use == pytest.approx(ours.check.use, abs=1e-6)


@pytest.mark.parametrize("form", [f for f in WRITERS if f != "csv"])
def test_forward_in_the_other_tool_is_our_front(form: str, tmp_path: Path) -> None:
    """A robot that drives along its own forward axis, whatever its heading, moves along our body +Y."""
    t = np.arange(20) * 0.05
    theta = 2.5
    way = 0.2 * t**2
    pose = np.column_stack([way * np.cos(theta), way * np.sin(theta), np.full_like(t, theta - QUARTER)])
    velocity = np.column_stack([0.4 * t * np.cos(theta), 0.4 * t * np.sin(theta), 0 * t])
    zero = np.zeros((20, 3))
    rows = Trajectory(
        t_s=t, pose=pose, velocity=velocity, acceleration=zero, omega=zero, use=zero, wheels=("1", "2", "3")
    )
    if form == "choreo":  # with the truth, not zero
        a = np.tile([0.4 * np.cos(theta), 0.4 * np.sin(theta), 0.0], (20, 1))
        rows = Trajectory(
            t_s=t, pose=pose, velocity=velocity, acceleration=a, omega=zero, use=zero, wheels=("1", "2", "3")
        )
    found = read_trajectory(WRITERS[form][0](rows, tmp_path))
    x, y, phi = found.pose[-1] - [0.0, 0.0, 0.0]
    body = np.array([np.cos(phi) * x + np.sin(phi) * y, -np.sin(phi) * x + np.cos(phi) * y])
    assert body == pytest.approx([0.0, way[-1]], abs=1e-9) and found.notes == ()


@pytest.mark.parametrize("name", ["choreo-2025.traj", "choreo-2024.traj", "pathplanner.wpilib.json"])
def test_the_samples_from_the_published_schemas(name: str) -> None:
    found = read_trajectory(SAMPLES / name)
    assert len(found.t_s) == 9 and found.pose[0] == pytest.approx([1.0, 2.0, 0.0], abs=1e-5)
    assert found.pose[-1] == pytest.approx([1.0 + 0.2 * 0.64, 2.0, 0.0], abs=1e-5)
    result = sm.check("ohio-kiwi", "paper", SAMPLES / name)
    assert result.admissible and result.check.max_use == pytest.approx(0.9045, abs=2e-3)
    repeated = [w for w in result.warnings if "repeats the one before" in w]
    assert len(repeated) == (name == "choreo-2025.traj")


def lower(samples: list[dict[str, Any]], key: str, factor: float) -> None:
    for row in samples:
        row[key] *= factor


@pytest.mark.parametrize(
    ("key", "factor", "told"),
    [
        ("vx", 0.5, "the stated velocity contradicts the samples between t = "),
        ("omega", -1.0, "the stated angular velocity contradicts"),
        ("ax", 3.0, "the stated acceleration contradicts"),
        ("alpha", 57.3, "the stated angular acceleration contradicts"),
    ],
)
def test_what_a_file_states_is_compared_with_its_poses(
    key: str, factor: float, told: str, planned: Trajectory, tmp_path: Path
) -> None:
    samples = choreo_samples(planned)
    lower(samples, key, factor)
    file = tmp_path / "a.traj"
    file.write_text(json.dumps({"trajectory": {"samples": samples}}), encoding="utf-8")
    notes = read_trajectory(file).notes
    assert any(told in note for note in notes) and len(notes) <= 2
    plain = sm.check("ohio-kiwi", "paper", planned)
    assert sm.check("ohio-kiwi", "paper", file).check.max_use == pytest.approx(plain.check.max_use, abs=1e-6)


def test_a_csv_with_velocities_of_the_body_frame_is_told(planned: Trajectory, tmp_path: Path) -> None:
    columns = planned.columns()
    columns["vx_m_s"], columns["vy_m_s"] = columns["vy_m_s"], -columns["vx_m_s"]
    file = tmp_path / "t.csv"
    file.write_text(columns_text(columns, digits=12), encoding="utf-8")
    assert any("stated velocity" in note for note in read_trajectory(file).notes)


def test_a_state_without_the_robots_heading_is_told(planned: Trajectory, tmp_path: Path) -> None:
    states = pathplanner_states(planned)
    for state in states:
        del state["holonomicRotation"], state["holonomicAngularVelocity"]
    file = tmp_path / "t.json"
    file.write_text(json.dumps(states), encoding="utf-8")
    found = read_trajectory(file)
    assert any("direction of travel" in note for note in found.notes)
    course = np.unwrap([s["pose"]["rotation"]["radians"] for s in states]) - QUARTER
    assert found.pose[:, 2] == pytest.approx(course)


def good() -> dict[str, Any]:
    return json.loads((SAMPLES / "choreo-2025.traj").read_text(encoding="utf-8"))  # type: ignore[no-any-return]


def spoilt(change: Callable[[list[Any]], Any]) -> str:
    whole = good()
    change(whole["trajectory"]["samples"])
    return json.dumps(whole)


PLANNER = (SAMPLES / "pathplanner.wpilib.json").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('{"trajectory": {"samples": []}}', "trajectory.samples: holds no sample, generate the trajectory"),
        ('{"trajectory": {}}', "trajectory.samples: is missing"),
        ('{"trajectory": 3}', "trajectory: is 3, not an object"),
        ('{"samples": {"t": 0}}', "samples: is {'t': 0}, not a list"),
        ('{"states": []}', "states: holds no sample"),
        ("[]", "holds no sample"),
        ("[1, 2]", "[0]: is 1, not a sample"),
        ('[{"a": 1}]', "is no trajectory of a known form, give a CSV with t_s,x_m,y_m,phi_rad, a Choreo"),
        ('{"waypoints": []}', "is no trajectory of a known form"),
        ("<xml/>", "is no trajectory of a known form"),
        (
            "time,x,y,theta\n0,0,0,0\n",
            "'phi_rad' are missing, add them (the file has: time, x, y, theta)",
        ),
        (
            "t_s;x_m;y_m;phi_rad\n0;0;0;0\n",
            "the columns are separated by semicolons, separate them",
        ),
        ('{"trajectory": {"samples": [', "1:29: is no JSON"),
        ("[" * 100_000, "is no JSON that can be read"),
        (spoilt(lambda s: s[3].pop("y")), "trajectory.samples[3].y: is missing"),
        (spoilt(lambda s: s[3].update(x=math.nan)), "trajectory.samples[3].x: is nan, give a finite"),
        (spoilt(lambda s: s[3].update(x=math.inf)), "trajectory.samples[3].x: is inf"),
        (spoilt(lambda s: s[3].update(x=10**400)), "trajectory.samples[3].x: is a huge number"),
        (spoilt(lambda s: s[3].update(heading="0")), "samples[3].heading: is '0', not a number"),
        (spoilt(lambda s: s[3].update(t=True)), "samples[3].t: is True, not a number"),
        (spoilt(lambda s: s[3].update(vx=None)), "samples[3].vx: is None, not a number"),
        (spoilt(lambda s: s.__setitem__(3, [0.3])), "samples[3]: is [0.3], not a sample"),
        (spoilt(lambda s: s[3].update(t=0.1)), "samples[3]: is at 0.1 s, not after 0.2 s"),
        (spoilt(lambda s: s[3].update(t=0.2)), "samples[3]: is at 0.2 s, not after 0.2 s"),
        (spoilt(lambda s: s.__delitem__(slice(4, None))), "4 samples are too few"),
        (PLANNER.replace('"x"', '"X"', 1), "[0].pose.translation.x: is missing"),
        (PLANNER.replace('"translation"', '"trans"', 1), "[0].pose.translation: is missing"),
        (PLANNER.replace("90.0", '"N"', 1), "[0].holonomicRotation: is 'N', not a number"),
        ("t_s,x_m\n0,0\n", "the columns 'y_m', 'phi_rad' are missing"),
        ("", "there is no header"),
    ],
)
def test_damaged_files_are_refused_in_one_line_with_the_place(text: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "a.traj"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as fault:
        sm.check("ohio-kiwi", "paper", file)
    assert str(fault.value).startswith(f"{file}: ") and told in str(fault.value)
    assert "\n" not in str(fault.value) and len(str(fault.value)) < 400


def test_bags_that_do_not_fit(planned: Trajectory, tmp_path: Path) -> None:
    folders = [tmp_path / name for name in "abcdef"]
    for folder in folders:
        folder.mkdir()
    two = as_bag(planned, folders[0], topics=("/one", "/two"))
    with pytest.raises(InputError, match=r"2 topics are a nav_msgs/msg/Path, name one with --topic .*/one"):
        read_trajectory(two)
    assert len(read_trajectory(two, "/two").t_s) == len(planned.t_s)
    with pytest.raises(InputError, match="/three: no nav_msgs/msg/Path there"):
        read_trajectory(two, "/three")
    with pytest.raises(InputError, match="all poses carry the same stamp"):
        read_trajectory(as_bag(planned, folders[1], still=True))
    with pytest.raises(InputError, match=r"/plan.poses\[0\]: its orientation is no rotation"):
        read_trajectory(as_bag(planned, folders[2], unit=0.0))
    replanned = read_trajectory(as_bag(planned, folders[3], messages=3))
    assert len(replanned.t_s) == len(planned.t_s) and "holds 3 paths" in replanned.notes[0]
    with pytest.raises(InputError, match="is no trajectory of a known form"):
        read_trajectory(folders[4])
    cut = as_bag(planned, folders[5])
    (store,) = cut.glob("*.db3")
    store.write_bytes(store.read_bytes()[:3000])
    with pytest.raises(InputError, match="is no bag that can be read"):
        read_trajectory(cut)
    with pytest.raises(InputError, match="topic: is for ROS bags"):
        sm.check("ohio-kiwi", "paper", SAMPLES / "choreo-2024.traj", topic="/plan")
    with pytest.raises(InputError, match="topic: is for ROS bags"):
        sm.check("ohio-kiwi", "paper", planned, topic="/plan")


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["samples", "trajectory", "states", "t", "pose", "time", "x"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)
FUZZ = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def read_or_refused(file: Path) -> None:
    try:
        found = read_trajectory(file)
    except InputError as fault:
        assert str(fault).startswith(str(file)) and "\n" not in str(fault)
    else:
        assert np.isfinite(found.t_s).all() and found.pose.shape == (len(found.t_s), 3)


@FUZZ
@given(value=JSON)
def test_any_json_is_read_or_refused(value: Any, tmp_path: Path) -> None:
    file = tmp_path / "f.json"
    file.write_text(json.dumps(value), encoding="utf-8")
    read_or_refused(file)


@FUZZ
@given(
    data=st.data(), name=st.sampled_from(["choreo-2025.traj", "choreo-2024.traj", "pathplanner.wpilib.json"])
)
def test_a_damaged_file_is_read_or_refused(data: st.DataObject, name: str, tmp_path: Path) -> None:
    whole = (SAMPLES / name).read_bytes()
    at = data.draw(st.integers(0, len(whole) - 1))
    cut = data.draw(st.integers(0, 40))
    file = tmp_path / "f.traj"
    file.write_bytes(whole[:at] + data.draw(st.binary(max_size=3)) + whole[at + cut :])
    read_or_refused(file)


@FUZZ
@given(value=JSON, row=st.integers(0, 8), key=st.sampled_from(["t", "x", "heading", "vx", "alpha"]))
def test_any_value_in_a_sample_is_read_or_refused(value: Any, row: int, key: str, tmp_path: Path) -> None:
    file = tmp_path / "f.traj"
    file.write_text(spoilt(lambda samples: samples[row].update({key: value})), encoding="utf-8")
    read_or_refused(file)


def test_a_damaged_bag_is_read_or_refused(planned: Trajectory, tmp_path: Path) -> None:
    """Flipped bytes in the database and in its description; readers fail in many ways of their own."""
    rng = np.random.default_rng(14)
    whole = as_bag(planned, tmp_path)
    refused = 0
    for k in range(60):
        damaged = tmp_path / f"bag{k}"
        shutil.copytree(whole, damaged)
        (store,) = damaged.glob("*.db3")
        file = damaged / "metadata.yaml" if k % 3 == 0 else store
        content = bytearray(file.read_bytes())
        start = content.find(b"map") if file == store and k % 2 else 0  # in the message, or anywhere
        for at in rng.integers(start, min(start + 2000, len(content)), size=12):
            content[at] = rng.integers(256)
        file.write_bytes(content)
        try:
            read_trajectory(damaged)
        except InputError as fault:
            refused += 1
            assert str(fault).startswith(str(damaged)) and "\n" not in str(fault)
    assert refused > 20


@pytest.mark.parametrize("cell", ["", "nan"])
def test_a_pose_that_is_missing_has_one_cure(tmp_path: Path, cell: str) -> None:
    """An empty cell was 'no finite number', and one with nan was to be left empty."""
    rows = "".join(f"{0.1 * k:g},0,{cell if k == 2 else 0},0,{'' if k else 1}\n" for k in range(7))
    file = tmp_path / "drive.csv"
    file.write_text(f"t_s,x_m,y_m,phi_rad,use1\n{rows}", encoding="utf-8")
    with pytest.raises(InputError, match=r"drive\.csv: 4:3: y_m is .*, give a (finite )?number"):
        sm.check("ohio-kiwi", "paper", file)
    file.write_text(file.read_text(encoding="utf-8").replace(f"0.2,0,{cell},", "0.2,0,0,"), encoding="utf-8")
    assert sm.check("ohio-kiwi", "paper", file).check.admissible
