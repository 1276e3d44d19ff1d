"""The whole command on a small data set from the simulator: the load centre is not where the file says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.robot_text import write_recipe
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear

NOISE = np.array([5e-4, 5e-4, 2e-3])
SHIFT = (0.010, -0.007)


def record(folder: Path, count: int = 4) -> None:
    """Write ``count`` runs of 1.5 s at 40 Hz with wheel speeds and angles."""
    robot = kiwi(rigid_fraction=0.0)
    truth = Recipe(robot=robot, effects=(WheelLoads(shift_x_m=SHIFT[0], shift_y_m=SHIFT[1]),)).build("paper")
    (folder / "trials").mkdir(parents=True)
    (folder / "robot.toml").write_text(write_recipe(Recipe(robot=robot)), encoding="utf-8")
    (folder / "dataset.toml").write_text(
        'schema = 1\nrobot = "robot.toml"\nsurface = "paper"\nwheel_signal = "measured"\n'
        "[sigma]\nx_m = 0.0005\ny_m = 0.0005\nphi_rad = 0.002\n",
        encoding="utf-8",
    )
    random = np.random.default_rng(11)
    clock = np.linspace(0.0, 1.5, 61)
    for k in range(count):
        knots = np.linspace(0.0, 1.5, 7)
        speeds = random.uniform(-9.0, 9.0, (7, 3))
        speeds[0] = 0.0
        ran = Batch([linear(knots, speeds)], [clock]).run(pack(truth), np.zeros(3), tell=True)
        pose = ran.pose[0] + NOISE * random.standard_normal((61, 3))
        omega = np.stack([np.interp(clock, knots, s) for s in speeds.T], axis=1)
        assert ran.theta is not None
        rows = np.column_stack([clock, pose, omega, ran.theta[0]])
        head = [
            "t_s",
            "x_m",
            "y_m",
            "phi_rad",
            *(f"omega{i}_rad_s" for i in (1, 2, 3)),
            *(f"theta{i}_rad" for i in (1, 2, 3)),
        ]
        text = "\n".join([",".join(head), *(",".join(f"{v:.7g}" for v in row) for row in rows)]) + "\n"
        (folder / "trials" / f"run{k}.csv").write_text(text, encoding="utf-8")


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    record(folder / "set")
    assert status(["diagnose", str(folder / "set"), "--out", str(folder / "out"), "--seed", "1"]) == 0
    return folder / "out"


def test_it_finds_the_effect_and_its_size(out: Path) -> None:
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert report["verdict"] == "effect-found"
    (effect,) = report["effects"]
    assert effect["name"] == "wheel_loads" and effect["traced_to"] == "wheel_load"
    for key, true in zip(("shift_x_m", "shift_y_m"), SHIFT, strict=True):
        found = effect["parameters"][key]
        assert found["low"] <= found["value"] <= found["high"]
        assert found["value"] == pytest.approx(true, abs=1e-3)
    assert report["after"]["chi"] < 1.2 < report["before"]["chi"]


def test_the_loop_is_closed(out: Path) -> None:
    """The corrected file builds the machine that made the data, limits included."""
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    corrected = read_recipe(out / "corrected.toml")
    assert [e.name for e in corrected.effects] == ["wheel_loads"]
    truth = WheelLoads(shift_x_m=SHIFT[0], shift_y_m=SHIFT[1])
    true = Recipe(robot=corrected.robot, effects=(truth,)).build("paper")
    np.testing.assert_allclose(corrected.build("paper").loads.rest_N, true.loads.rest_N, rtol=0.03)
    assert report["limits"]["after"]["f_max_min_N"] != report["limits"]["before"]["f_max_min_N"]
    assert "The model lacks wheel_loads" in (out / "report.html").read_text(encoding="utf-8")
