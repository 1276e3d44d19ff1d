"""Simulators' models of a robot have its friction: MuJoCo is run, Gazebo's is compared with Gazebo's own."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conventions import robot_in_ros
from slipmargin_cli.main import status
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.errors import InputError
from slipmargin.limits.bounds import directions
from slipmargin.report.mujoco_model import ROLLERS, roller_axes
from slipmargin.report.simulator_parts import LIGHT
from slipmargin.robot import GripShape, LoadRule, Robot

OWN = Path(__file__).parents[2] / "data" / "simulators" / "gazebo-mecanum-wheel.sdf"
EXPRESSED = "{http://gazebosim.org/schema}expressed_in"


def rover(name: str) -> Robot:
    """A built-in robot as the engine sees it: loads by statics and acceleration, free rollers."""
    robot = sm.read_robot(name).robot
    return replace(
        robot,
        body=replace(robot.body, com_height_m=0.04),
        load_rule=LoadRule.QUASI_STATIC,
        friction=replace(robot.friction, grip=GripShape.DISC_STRIP),
    )


class Exported:
    """The exported model in MuJoCo, commanded by wheel speeds; it settles when it is made."""

    TICK_S = 0.001

    def __init__(self, robot: Robot, surface: str) -> None:
        import mujoco

        found = sm.export_simulator(robot, "mjcf", surface)
        self.step = mujoco.mj_step
        self.world = mujoco.MjModel.from_xml_string(found.text)
        self.data = mujoco.MjData(self.world)
        self.geometry = sm.read_robot(robot_in_ros(robot)).build(surface).geometry
        names = [f"{w.name}_wheel_joint" for w in robot.wheels]
        self.axle = [self.world.joint(name).dofadr[0] for name in names]
        self.run(lambda t: np.zeros(len(names)), 0.2)
        self.data.time = 0.0

    def run(self, speeds: Callable[[float], np.ndarray], duration_s: float):
        """What the engine did, as the log of the engine with rollers of the tests."""
        from engines.rollers import Log

        data, g, rows = self.data, self.geometry, []
        hubs, along = g.hub_rows(), g.radius_m * np.sum(g.drive * g.grip, axis=1)
        start, steps = data.time, round(self.TICK_S / self.world.opt.timestep)
        for k in range(round(duration_s / self.TICK_S)):
            data.ctrl[:] = speeds(start + (k + 0.5) * self.TICK_S)
            self.step(self.world, data, steps)
            heading = 2.0 * np.arctan2(data.qpos[6], data.qpos[3])
            c, s = np.cos(heading), np.sin(heading)
            vx, vy = data.qvel[:2]
            twist = np.array([c * vx + s * vy, c * vy - s * vx, data.qvel[5]])
            slip = np.sum((hubs @ twist) * g.grip, axis=1) + along * data.qvel[self.axle]
            rows.append((data.time, [data.qpos[0], data.qpos[1], heading], twist, slip, slip * 0.0))
        t, pose, twists, slips, loads = (np.array(column) for column in zip(*rows, strict=True))
        return Log(t_s=t, pose=pose, twist=twists, slip_m_s=slips, load_N=loads)


@pytest.mark.parametrize(
    ("name", "surface"), [("ohio-kiwi-symmetric", "paper"), ("omni4", "floor"), ("mecanum4", "floor")]
)
def test_wheels_in_mujoco_roll_below_the_starting_limit_and_slip_above_it(name: str, surface: str) -> None:
    pytest.importorskip("mujoco", reason="the optional extra [mujoco] is not installed")
    from engines.rollers import MovingOff

    robot = rover(name)
    heading = np.deg2rad(37.0)
    model = robot_in_ros(robot)
    limit = float(
        directions(sm.read_robot(model).build(surface), np.array([heading]), motor=False).starting_m_s2[0]
    )
    creep = {}
    for share in (0.93, 1.07):
        motion = MovingOff(heading_rad=heading, acceleration_m_s2=share * limit)
        log = motion.drive(Exported(robot, surface))
        creep[share] = float(log.part(motion.end_s - 0.2, motion.end_s).creep().max())
    # 1.5 % of the way is where the study of this engine (benchmarks/rollers.py) calls it slip.
    assert creep[0.93] < 0.015 < creep[1.07], creep


@pytest.mark.parametrize("slant", [0.0, np.pi / 4.0])
def test_wheels_are_round(slant: float) -> None:
    radius, half = 0.05, np.pi / ROLLERS
    a, b = roller_axes(radius, slant)
    alpha = np.linspace(-half, half, 51)
    below = (radius - b) * np.cos(alpha)
    below += np.sqrt(b**2 + (a**2 - b**2) * np.cos(slant) ** 2 * np.sin(alpha) ** 2)
    assert np.ptp(below) < 1e-3 * radius and below[0] == pytest.approx(radius, abs=1e-12)


def test_the_mass_and_its_place_are_the_robot_s() -> None:
    mujoco = pytest.importorskip("mujoco", reason="the optional extra [mujoco] is not installed")
    robot = replace(rover("mecanum4"), body=replace(rover("mecanum4").body, com_m=np.array([0.02, 0.03])))
    world = mujoco.MjModel.from_xml_string(sm.export_simulator(robot, "mjcf").text)
    data = mujoco.MjData(world)
    mujoco.mj_forward(world, data)
    assert world.body_mass.sum() == pytest.approx(robot.body.mass_kg)
    np.testing.assert_allclose(data.subtree_com[0], [0.03, -0.02, 0.04], atol=1e-9)


def elements(model: ElementTree.Element) -> set[str]:
    """Where which elements stand, below a link or a joint."""
    found = set()

    def walk(element: ElementTree.Element, place: str) -> None:
        for child in element:
            found.add(f"{place}/{child.tag}")
            walk(child, f"{place}/{child.tag}")

    for part in model:
        if not part.get("name", "").startswith("base"):
            walk(part, part.tag)
    return found


def test_sdf_has_gazebo_s_own_elements_and_our_numbers() -> None:
    robot = kiwi()
    found = sm.export_simulator(robot, "sdf", "paper")
    root = ElementTree.fromstring(found.text)
    ours, theirs = root.find("model"), ElementTree.parse(OWN).getroot().find("model")
    assert ours is not None and theirs is not None
    extra = elements(ours) - elements(theirs)
    own = {f"link/collision/surface/friction/ode/{name}" for name in ("slip1", "slip2")}
    drawn = {"link/visual", *(f"link/visual/geometry{rest}" for rest in ("", "/sphere", "/sphere/radius"))}
    assert not elements(theirs) - elements(ours)
    assert extra <= own | drawn | {
        "link/inertial/pose",
        "joint/axis/limit/effort",
        "joint/axis/limit/velocity",
    }
    model = sm.read_robot(robot_in_ros(robot)).build("paper")
    for i, wheel in enumerate(robot.wheels):
        ode = ours.find(f"link[@name='{wheel.name}_wheel']/collision/surface/friction/ode")
        assert ode is not None
        mu, mu2, slip1, slip2 = (float(ode.findtext(k) or "nan") for k in ("mu", "mu2", "slip1", "slip2"))
        assert [mu, mu2] == pytest.approx(model.grip.roller[i])
        # The law's slope at rest: friction of a slow slip v is μ N (2/π) k v.
        slow = 1e-9
        force = mu * model.loads.rest_N[i] * 2.0 / np.pi * np.arctan(model.grip.k_s_per_m * slow)
        assert slip1 == pytest.approx(slow / force, rel=1e-6) and slip2 == pytest.approx(slip1 * mu / mu2)
        fdir = ode.find("fdir1")
        assert fdir is not None and fdir.get(EXPRESSED) == "base_link"
        way = np.array([float(v) for v in (fdir.text or "").split()])
        assert abs(way[:2] @ model.geometry.grip[i]) == pytest.approx(1.0, abs=1e-8) and way[2] == 0.0


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_urdf_read_back_has_the_same_limits(robot: Robot, tmp_path: Path) -> None:
    pytest.importorskip("yourdfpy", reason="yourdfpy is not installed (extra [urdf])")
    file = tmp_path / "robot.urdf"
    file.write_text(sm.export_simulator(robot, "urdf", "paper").text, encoding="utf-8")
    there = robot_in_ros(robot)
    read = sm.robot_from_urdf(file).recipe.robot
    assert read.body.mass_kg == pytest.approx(robot.body.mass_kg, rel=1e-5)
    np.testing.assert_allclose(read.body.com_m, there.body.com_m, atol=1e-5)
    assert read.body.inertia_kg_m2 == pytest.approx(robot.body.inertia_kg_m2, rel=0.01)
    # Friction and how the weight is shared are not in a URDF.
    again = replace(there, wheels=read.wheels)
    ours, theirs = (sm.sweep(r, "paper", step_deg=15.0) for r in (again, there))
    np.testing.assert_allclose(ours.f_max_N, theirs.f_max_N, rtol=1e-4)


def test_both_conventions_and_effects_are_exported_alike() -> None:
    for format in ("sdf", "urdf", "mjcf"):
        one, two = (
            sm.export_simulator(r, format, "paper").text for r in (four_wheels(), robot_in_ros(four_wheels()))
        )
        assert numbers_of(one) == pytest.approx(numbers_of(two), abs=1e-8)
    recipe = sm.read_robot("ohio-kiwi")
    slick = recipe.with_effects(FrictionCoefficients(drive_factor=0.5, transverse_factor=1.0))
    whole, half = (sm.export_simulator(r, "sdf").robot.wheels[0].mu for r in (recipe, slick))
    assert half == pytest.approx(0.5 * whole)
    assert any("rigid material" in line for line in sm.export_simulator(recipe, "sdf").warnings)
    assert 0.0 < LIGHT < 0.1


def numbers_of(text: str) -> list[float]:
    """Every number that stands alone in a file."""
    out = []
    for word in text.replace('"', " ").replace("<", " ").replace(">", " ").split():
        try:
            out.append(float(word))
        except ValueError:
            continue
    return out


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, report = tmp_path / "rover.sdf", tmp_path / "rover.json"
    words = ["export", "sdf", "mecanum4", "--surface", "floor", "--out", str(file), "--json", str(report)]
    assert status(words) == 0
    assert f"written: {file}" in capsys.readouterr().out
    assert (
        file.read_text(encoding="utf-8").startswith("<?xml")
        and len(json.loads(report.read_text(encoding="utf-8"))["wheels"]) == 4
    )
    assert status(["export", "obj", "mecanum4", "--out", str(tmp_path / "x")]) == 2
    assert "No such command 'obj', see slipmargin export --help" in capsys.readouterr().err
    with pytest.raises(InputError, match="format: is 'obj', use one of: sdf, mjcf, urdf"):
        sm.export_simulator("mecanum4", "obj")
    with pytest.raises(InputError, match="moon"):
        sm.export_simulator("mecanum4", "sdf", "moon")
