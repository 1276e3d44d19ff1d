"""The core of the ROS 2 example: REP 103 in and out, timeouts, odometry; and what the node says of itself."""

from __future__ import annotations

import ast
import importlib.util
import math
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from slipmargin_cli.main import status

PACKAGE = Path(__file__).resolve().parents[3] / "examples" / "ros2" / "slipmargin_limiter"


@pytest.fixture(scope="module")
def core() -> ModuleType:
    spec = importlib.util.spec_from_file_location("limiter_core", PACKAGE / "slipmargin_limiter" / "core.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_it_needs_no_ros() -> None:
    tree = ast.parse((PACKAGE / "slipmargin_limiter" / "core.py").read_text(encoding="utf-8"))
    names = {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    names |= {n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    assert not any(name.split(".")[0] in {"rclpy", "geometry_msgs", "nav_msgs"} for name in names)
    ast.parse((PACKAGE / "slipmargin_limiter" / "node.py").read_text(encoding="utf-8"))
    assert "was not run on a robot" in (PACKAGE / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("robot", "surface"), [("mecanum4", "floor"), ("robotino", "gray")])
def test_forward_stays_forward_in_either_convention(core: ModuleType, robot: str, surface: str) -> None:
    """mecanum4 is written in the paper's axes, robotino in those of ROS."""
    node = core.LimiterCore(robot, surface)
    for k in range(300):
        node.command(0.02 * k, core.Twist(0.3, 0.0, 0.0))
        sent, said = node.tick(0.02 * k)
        assert sent.vy == pytest.approx(0.0, abs=1e-12) and sent.vx >= 0.0
    assert sent.vx == pytest.approx(0.3) and said == "reached"


def test_direction_is_kept_and_speed_is_not_jumped(core: ModuleType) -> None:
    node, last = core.LimiterCore("mecanum4", "floor"), 0.0
    for k in range(20):
        node.command(0.02 * k, core.Twist(0.6, 0.3, 0.0))
        sent, _ = node.tick(0.02 * k)
        assert math.atan2(sent.vy, sent.vx) == pytest.approx(math.atan2(0.3, 0.6))
        speed = math.hypot(sent.vx, sent.vy)
        assert 0.0 < speed - last < 0.02 * 9.81
        last = speed


def test_a_robot_without_commands_is_braked_to_rest(core: ModuleType) -> None:
    node = core.LimiterCore("mecanum4", "floor", timeout_s=0.3)
    node.command(0.0, core.Twist(0.3, 0.0, 0.0))
    speeds = [node.tick(0.02 * k)[0].vx for k in range(60)]
    assert max(speeds) == pytest.approx(0.3) and speeds[-1] == 0.0
    assert max(-np.diff(speeds)) < 0.02 * 9.81  # not at once


def test_odometry_far_from_what_was_sent_is_where_it_begins_again(core: ModuleType) -> None:
    node = core.LimiterCore("mecanum4", "floor")
    for k in range(100):
        node.command(0.02 * k, core.Twist(0.8, 0.0, 0.0))
        node.odometry(core.Twist(0.0, 0.0, 0.0))  # somebody holds the robot
        sent, _ = node.tick(0.02 * k)
    assert sent.vx < 0.4
    node.odometry(core.Twist(math.nan, 0.0, 0.0))
    node.command(2.0, core.Twist(math.inf, 0.0, 0.0))
    sent, _ = node.tick(2.0)
    assert math.isfinite(sent.vx)
    assert node.tick(2.0)[1] == "no time passed"


def test_a_slow_robot_that_is_held_is_noticed(core: ModuleType, tmp_path: Path) -> None:
    """Its top speed is below the 0.3 m/s that counted as far: released, it was told full speed at once."""
    file = tmp_path / "slow.toml"
    assert status(["robots", "new", str(file), "--type", "lekiwi"]) == 0
    text = file.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith("max_speed_rad_s"))
    file.write_text(text.replace(line, "max_speed_rad_s = 4.4"), encoding="utf-8")
    held, free = core.LimiterCore(str(file), "floor"), core.LimiterCore(str(file), "floor")
    top = 0.2
    for k in range(150):
        for node, speed in ((held, 0.0), (free, None)):
            node.command(0.02 * k, core.Twist(top, 0.0, 0.0))
            node.odometry(core.Twist(node.tick(0.02 * k)[0].vx if speed is None else speed, 0.0, 0.0))
    sent, said = free.tick(3.0)
    assert sent.vx == pytest.approx(top, rel=0.05) and said == "reached"
    assert held.tick(3.0)[0].vx < 0.75 * top
