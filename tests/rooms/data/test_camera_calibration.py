"""Calibration: what was put into made-up runs comes out within its own interval; the real one is stable."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from real_logs import EXCERPT, WHOLE, logs, needs_whole

from slipmargin.data.calibration import Calibration, calibrate
from slipmargin.data.delay import estimate_delay
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.calibration_file import calibration_text, read_calibration
from slipmargin.io.importers.plug import import_files
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.robot_file import read_recipe

CONTACTS = read_recipe("robotino").build("table").geometry
SCALE, ROTATION, DELAY, TILT, MIDDLE = 0.9, 0.03, 0.04, np.array([-0.03, 0.02]), np.array([1.5, -1.0])


def made_up(
    runs: int = 24, tilt: np.ndarray = TILT, noise: float = 3e-4, seed: int = 1
) -> tuple[Record, ...]:
    """Runs without slip, seen by a camera with known faults."""
    random = np.random.default_rng(seed)
    out = []
    for k in range(runs):
        t = np.cumsum(random.uniform(0.028, 0.034, 450))
        turn, heading = random.normal(0.0, 0.02), random.uniform(0, 2 * np.pi)

        def pose(at: np.ndarray, turn: float = turn, heading: float = heading) -> np.ndarray:
            s = np.maximum(0.0, at - 0.5)
            phi = heading + turn * s
            # true path: body velocity 0.1 m/s along its own x, exactly integrated
            x = 0.1 * np.where(turn == 0, s, (np.sin(phi) - np.sin(heading)) / turn)
            y = 0.1 * np.where(turn == 0, s, -(np.cos(phi) - np.cos(heading)) / turn)
            return np.stack([x, y, phi], axis=1)

        along = np.maximum(0.0, t - 0.5)
        body = np.stack([0.1 * along, 0.0 * along, turn * along], axis=1)
        arm = CONTACTS.position_m
        drive = CONTACTS.drive  # omni wheels: the contact moves along ŝ where θ̇ > 0
        rows = np.column_stack([drive, arm[:, 0] * drive[:, 1] - arm[:, 1] * drive[:, 0]])
        theta = -(body @ rows.T) / CONTACTS.radius_m
        true = pose(t - DELAY)
        c, s = np.cos(ROTATION), np.sin(ROTATION)
        level = SCALE * true[:, :2] @ np.array([[c, s], [-s, c]]) + MIDDLE + random.uniform(-0.6, 0.6, 2)
        off = level - MIDDLE  # levelled = off_seen / (1 + tilt·off_seen)  ⇒  off_seen = off / (1 − tilt·off)
        seen = MIDDLE + off / (1.0 - off @ tilt)[:, None] + random.normal(0.0, noise, (len(t), 2))
        out.append(Record(name=f"r{k}", t_s=t, theta=theta, pose=np.column_stack([seen, true[:, 2]])))
    return tuple(out)


def test_what_was_put_in_comes_out() -> None:
    found = calibrate(made_up(), CONTACTS)
    # scale and rotation are those at the middle of the runs, which is not quite where the tilt was put in
    shift = 1.0 + (found.middle_m - MIDDLE) @ TILT
    assert found.scale / SCALE == pytest.approx(shift, abs=0.003)
    assert found.rotation_rad == pytest.approx(ROTATION, abs=0.003)
    assert found.delay_s == pytest.approx(DELAY, abs=0.006)
    assert np.all(np.abs(found.tilt_per_m - TILT) < np.maximum(4.0 * found.tilt_sd_per_m, 0.0015))
    assert found.spread < 0.002 and found.runs == 24
    flat = calibrate(made_up(), CONTACTS, tilt=False)
    assert flat.spread > found.spread and not flat.tilt_per_m.any()


def test_no_tilt_is_found_where_there_is_none() -> None:
    found = calibrate(made_up(tilt=np.zeros(2), noise=1e-3), CONTACTS)
    assert not found.tilt_per_m.any() and found.scale == pytest.approx(SCALE, abs=0.002)
    assert len(found.lines()) == 4


def test_levelling_undoes_the_tilt() -> None:
    runs = made_up(noise=0.0)
    known = Calibration(scale=SCALE, rotation_rad=ROTATION, delay_s=DELAY, tilt_per_m=TILT, middle_m=MIDDLE)
    again = calibrate(tuple(known.rectified(r) for r in runs), CONTACTS)
    assert np.abs(again.tilt_per_m).max() < 5e-4
    assert again.scale == pytest.approx(SCALE, abs=5e-4)
    plain = Calibration(scale=1.0, rotation_rad=0.0, delay_s=0.0)
    assert plain.rectified(runs[0]) is runs[0]


def test_effects_are_of_the_measurement_kind_and_keep_the_signs() -> None:
    scale, rotation, delay = Calibration(scale=0.9, rotation_rad=0.02, delay_s=0.03).effects()
    assert (scale.scale_x, scale.scale_y, rotation.rotation_rad, delay.delay_s) == (0.9, 0.9, 0.02, 0.03)


def test_the_file_comes_back(tmp_path: Path) -> None:
    found = calibrate(made_up(6), CONTACTS)
    path = tmp_path / "calibration.toml"
    path.write_text(calibration_text(found), encoding="utf-8")
    back = read_calibration(path)
    assert calibration_text(back) == calibration_text(found)
    for wrong, told in (
        (("schema = 1", "schema = 2"), "schema"),
        (("scale = 0", "scale = 9"), "scale"),
        (("runs", "rums"), "rums"),
        (("rotation_rad = ", "rotation_rad = 3"), "rotation_rad"),
        (("delay_s = ", "delay_s = 1"), "delay_s"),
    ):
        path.write_text(calibration_text(found).replace(*wrong, 1), encoding="utf-8")
        with pytest.raises(InputError, match=told) as refusal:
            read_calibration(path)
        assert "calibration.toml" in str(refusal.value)


def test_refuses_what_tells_nothing() -> None:
    still = tuple(
        Record(name="s", t_s=r.t_s, pose=r.pose, theta=0.0 * r.theta)  # type: ignore[operator]
        for r in made_up(2)
    )
    with pytest.raises(InputError, match="no run starts from rest"):
        estimate_delay(still, CONTACTS)
    blind = (Record(name="s", t_s=still[0].t_s, pose=still[0].pose),)
    with pytest.raises(InputError, match="no measured wheel"):
        calibrate(blind, CONTACTS)
    with pytest.raises(InputError, match="has no measured wheel angles"):
        calibrate((*made_up(2), *blind), CONTACTS)
    short = tuple(
        Record(name="s", t_s=r.t_s[:60], pose=r.pose[:60], theta=r.theta[:60])  # type: ignore[index]
        for r in made_up(3)
    )
    with pytest.raises(InputError, match="give two or more runs"):
        calibrate(short, CONTACTS)


def test_what_is_left_over_is_a_share_of_the_distance_driven_out_and_back() -> None:
    """What is left was divided by how far from its start a run ended, which is little here."""
    out = made_up(6)
    there_and_back = []
    for run in out:
        t = np.concatenate([run.t_s, run.t_s[-1] + np.cumsum(np.full(len(run.t_s), 0.031))])
        assert run.theta is not None
        theta, pose = (np.concatenate([rows, rows[::-1]]) for rows in (run.theta, run.pose))
        there_and_back.append(Record(name=run.name, t_s=t, theta=theta, pose=pose))
    assert calibrate(tuple(there_and_back), CONTACTS).spread < 0.01


def test_the_excerpt_of_the_table() -> None:
    records = import_files(RobotinoImporter(), logs(EXCERPT / "table_0.1")).records
    found = calibrate(records, CONTACTS)
    assert found.scale == pytest.approx(0.900, abs=0.006)
    assert found.delay_s == pytest.approx(0.022, abs=0.010)
    assert found.spread < 0.012


@needs_whole
def test_the_whole_table_agrees_with_a_separate_study() -> None:
    # Second road: a separate fit of the 72 table runs (projective map about pixel (800, 600), equal parts of
    # a run instead of two-second pieces): scale falls by 2.46 % per metre in x and rises by 1.72 % in y.
    found = calibrate(import_files(RobotinoImporter(), logs(WHOLE / "table_0.1")).records, CONTACTS)
    assert found.runs == 72 and found.spread < 0.010
    assert found.scale == pytest.approx(0.900, abs=0.004)
    assert np.all(np.abs(found.tilt_per_m - [-0.0246, 0.0172]) < 0.008)
    assert found.delay_s == pytest.approx(0.023, abs=0.004)
