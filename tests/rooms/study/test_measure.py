"""Friction coefficients from pulls: what was planted comes back, within intervals that hold it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.data.pulls import Pulls
from slipmargin.errors import InputError
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.robot import GripShape, Robot
from slipmargin.study.measure import measure, wheel_types

PHI = np.deg2rad(np.repeat(np.arange(0.0, 360.0, 30.0), 3))


def pulled(model: Model, drive: float, transverse: float, noise: float, seed: int) -> Pulls:
    roller = np.tile([drive, transverse], (model.count, 1))
    force = limit(replace(model, grip=replace(model.grip, roller=roller)), PHI, Pull())
    return Pulls(
        phi_rad=PHI, force_N=force * (1.0 + noise * np.random.default_rng(seed).normal(size=len(PHI)))
    )


@pytest.mark.parametrize(
    ("robot", "shape"),
    [
        (kiwi(15.0), GripShape.BOX),
        (kiwi(15.0), GripShape.DISC_STRIP),
        (four_wheels(), GripShape.DISC_STRIP),
    ],
    ids=["kiwi-box", "kiwi-disc", "mecanum-disc"],
)
def test_exact_pulls_give_the_coefficients_back(robot: Robot, shape: GripShape) -> None:
    model = nominal_model(replace(robot, friction=replace(robot.friction, grip=shape)), "paper")
    angles = np.array([w.roller_angle_deg for w in robot.wheels])
    found = measure(model, angles, pulled(model, 0.42, 0.11, 0.0, 0), seed=0)
    np.testing.assert_allclose(found.value, [[0.42, 0.11]], rtol=1e-4)
    np.testing.assert_allclose(found.high - found.low, 0.0, atol=1e-3)


def test_pulls_count_with_their_direction_point_and_height(tmp_path: Path) -> None:
    model = sm.read_robot("ohio-kiwi").build("paper")
    roller = np.tile([0.42, 0.11], (3, 1))
    pull = Pull(direction_rad=np.pi / 2, point_m=np.array([0.1, 0.0]), height_m=0.03)
    force = limit(replace(model, grip=replace(model.grip, roller=roller)), PHI, pull)
    rows = [f"{p:.9f},{f:.9f},{np.pi / 2:.9f},0.1,0,0.03" for p, f in zip(PHI, force, strict=True)]
    file = tmp_path / "pulls.csv"
    header = "phi_rad,force_N,direction_rad,point_x_m,point_y_m,height_m"
    file.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    np.testing.assert_allclose(
        sm.measure(file, "ohio-kiwi", "paper").measured.value, [[0.42, 0.11]], rtol=1e-3
    )


def test_intervals_hold_the_truth_about_as_often_as_they_say() -> None:
    model = nominal_model(kiwi(15.0), "paper")
    held = np.zeros(2)
    for seed in range(20):
        found = measure(model, np.zeros(3), pulled(model, 0.3, 0.08, 0.05, seed), seed=seed)
        held += ((found.low <= [0.3, 0.08]) & (found.high >= [0.3, 0.08]))[0]
    assert np.all(held >= 15)  # 95 % of 20 is 19; a bootstrap of 36 pulls is a little short


def test_pulls_that_do_not_decide_are_refused() -> None:
    model = nominal_model(kiwi(15.0), "paper")
    with pytest.raises(InputError, match="2 with all wheels on rollers are too few for 2 coefficients"):
        measure(model, np.zeros(3), Pulls(phi_rad=np.zeros(2), force_N=np.ones(2)))
    along = Pulls(phi_rad=np.zeros(9), force_N=5.0 * np.ones(9))  # one direction, two coefficients
    with pytest.raises(InputError, match="do not decide drive of omni and transverse of omni"):
        measure(model, np.zeros(3), along)
    # Four locked mecanum wheels of the box hold (μ_W + μ_T) in every direction: the two cannot be told apart.
    mecanum = nominal_model(four_wheels(), "paper")
    with pytest.raises(InputError, match="only together do they act"):
        measure(mecanum, np.full(4, 45.0), pulled(mecanum, 0.42, 0.11, 0.02, 0))


def test_pulls_on_rigid_material_are_left_out() -> None:
    model = nominal_model(kiwi(15.0), "paper")
    exact = pulled(model, 0.3, 0.08, 0.0, 0)
    theta = np.zeros((len(PHI), 3))
    theta[::3, 1] = 0.99 * 2.0 * np.pi / 8.0  # the end of a sector: rigid material
    force = np.where(theta[:, 1] > 0.0, 3.0, 1.0) * exact.force_N
    found = measure(model, np.zeros(3), Pulls(phi_rad=PHI, force_N=force, theta_rad=theta))
    assert found.left_out == len(PHI) // 3
    np.testing.assert_allclose(found.value, [[0.3, 0.08]], rtol=1e-4)


def test_wheels_are_told_apart_by_their_roller_angle() -> None:
    names, kind = wheel_types(np.array([45.0, -45.0, 0.0]))
    assert names == ("omni", "mecanum 45°") and kind.tolist() == [1, 1, 0]


def test_the_front_door_reads_the_file_that_sweep_reads(tmp_path: Path) -> None:
    model, file = nominal_model(kiwi(15.0), "paper"), tmp_path / "pulls.csv"
    pulls = pulled(model, 0.26, 0.09, 0.02, 1)
    rows = [f"{p!r},{f!r}" for p, f in zip(pulls.phi_rad.tolist(), pulls.force_N.tolist(), strict=True)]
    file.write_text("phi_rad,force_N\n" + "\n".join(rows) + "\n", encoding="utf-8")
    found = sm.measure(file, kiwi(15.0), "paper", seed=3)
    assert found.measured.value[0] == pytest.approx([0.26, 0.09], rel=0.15)
    assert found.lines()[-2] == "[surface.paper]" and found.lines()[-1].startswith("roller = { drive = [0.2")
    assert found.lines() == sm.measure(file, kiwi(15.0), "paper", seed=3).lines()
    beside = sm.sweep(kiwi(15.0), "paper", to_deg=330.0, step_deg=30.0, measured=file)
    assert beside.pulls is not None and int(beside.pulls.count.sum()) == len(PHI)
    with pytest.raises(InputError, match=r"pulls\.csv"):
        file.write_text("phi_rad,force_N\n0.0,1.0\n", encoding="utf-8")
        sm.measure(file, kiwi(15.0), "paper")


def test_a_scale_that_reads_kilograms_is_spoken_of(tmp_path: Path) -> None:
    """The likeliest mistake with a luggage scale; its coefficients were printed without a word."""
    model = nominal_model(kiwi(15.0), "paper")
    force = limit(model, PHI, Pull())
    for unit, told in ((1.0, False), (9.81, True)):
        rows = [f"{a:.6f},{f / unit:.6f}" for a, f in zip(PHI, force, strict=True)]
        (tmp_path / "p.csv").write_text("\n".join(["phi_rad,force_N", *rows]) + "\n", encoding="utf-8")
        found = sm.measure(tmp_path / "p.csv", kiwi(15.0), "paper")
        assert any("kilograms" in w for w in found.warnings) == told
