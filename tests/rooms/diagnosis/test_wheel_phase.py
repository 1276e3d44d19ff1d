"""Wheel phases that were not logged: found where they matter, never from what they are to predict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry import wheel_angles
from slipmargin.data.record import Record
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.held_out import phases_matter, predicted
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.searched import searched
from slipmargin.diagnosis.wheel_phase import first_part, matters_to
from slipmargin.effects import Trace
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.io.robot_file import read_recipe

SMALL = {"count": 6, "duration_s": 2.5, "rate_hz": 100.0}


def without_angles(data: DataSet) -> DataSet:
    return replace(data, trials=tuple(replace(t, theta=None) for t in data.trials))


def test_rigid_material_is_found_without_logged_angles() -> None:
    truth = RigidSector(rigid_fraction=0.10, rigid_coefficient=0.47)
    plant = Plant(name="rigid", traces=(Trace.WHEEL_ANGLE,), effects=(truth,))
    found = diagnose(without_angles(planted(smooth_kiwi(), plant, seed=4, **SMALL)), seed=2)
    assert found.findings[0].name == "rigid_sector"
    values = {p.name: p.value for p in found.findings[0].parameters}
    assert values["rigid_fraction"] == pytest.approx(0.10, abs=0.02)
    assert found.after.chi < 0.6 * found.before.chi
    assert any(said.startswith("No log holds the wheel angles.") for said in found.remarks)


def test_free_angles_are_no_reason_to_see_rigid_material() -> None:
    data = without_angles(planted(smooth_kiwi(), None, seed=5, **SMALL))
    found = diagnose(data, seed=1)
    assert found.verdict is Verdict.NO_MISSING_EFFECT
    assert found.before.chi == pytest.approx(1.0, abs=0.08)
    assert np.isfinite(found.before.rmse_position_m)


def spoilt(data: DataSet, run: int, after_s: float) -> DataSet:
    """The same with what was measured of one run after a time replaced by something else altogether."""
    trial = data.trials[run]
    pose, late = trial.pose.copy(), trial.t_s > after_s
    random = np.random.default_rng(2)
    pose[late] += np.array([0.2, -0.1, 0.5]) + 0.02 * np.cumsum(random.normal(size=(late.sum(), 3)), axis=0)
    trials = [replace(t, pose=pose) if i == run else t for i, t in enumerate(data.trials)]
    return replace(data, trials=tuple(trials))


def test_what_a_held_out_run_did_later_reaches_neither_parameters_nor_its_phases(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    few, room = ("rigid_sector", "floor_tilt"), "slipmargin.diagnosis.searched."  # a short search
    monkeypatch.setattr(
        room + "general_candidates",
        lambda *a: [c for c in general_candidates(*a) if c.trace is Trace.CONSTANT_FORCE],
    )
    monkeypatch.setattr(
        room + "named_candidates", lambda *a, **k: [c for c in named_candidates(*a, **k) if c.name in few]
    )
    truth = RigidSector(rigid_fraction=0.12, rigid_coefficient=0.47)
    plant = Plant(name="rigid", traces=(Trace.WHEEL_ANGLE,), effects=(truth,))
    small = {"count": 6, "duration_s": 1.2, "rate_hz": 50.0}
    plain = replace(without_angles(planted(smooth_kiwi(), plant, seed=3, **small)), sigma=None)
    one = searched(plain, 1)
    run = int(one.held[0])
    end = first_part(plain.trials[run]).t_s[-1]
    assert 0.1 < end < 1.0
    other = searched(spoilt(plain, run, end), 1, held_runs=one.held)
    assert one.state.structure[0].name == "rigid_sector"
    assert [c.label for c in other.state.structure] == [c.label for c in one.state.structure]
    np.testing.assert_array_equal(other.state.fit.x, one.state.fit.x)
    np.testing.assert_array_equal(other.problem.sigma, one.problem.sigma)
    phases = []
    for data, found in ((plain, one), (spoilt(plain, run, end), other)):
        records = [data.trials[found.runs[i]] for i in found.held]
        judged = predicted(
            found.problem, found.held, records, [found.state.fit.effects] * len(found.held), phased=True
        )
        assert phases_matter(found.problem, found.state.fit.effects)
        assert judged.phased
        first = int(found.held[0])  # where the run was cut, its phase is that of the part's start
        angles = wheel_angles(records[0].t_s, None, records[0].omega)
        assert angles is not None
        at = records[0].t_s == found.problem.trials[first].t_s[0]
        phases.append(judged.problem.wheel_phases[first] - angles[at][0])
    np.testing.assert_allclose(phases[1], phases[0], rtol=0.0, atol=1e-12)
    assert np.any(phases[0] != 0.0)
    unseen = one.problem.wheel_phases[one.held]
    np.testing.assert_array_equal(unseen, np.zeros_like(unseen))  # the search gave them none


def test_only_the_rest_of_a_run_is_scored() -> None:
    t = np.linspace(0.0, 3.0, 31)
    omega = np.outer(np.where(t < 1.0, 0.0, 2.0), [1.0, -1.0, 0.5])
    run = Record(name="stands first", t_s=t, pose=np.zeros((31, 3)), omega=omega)
    part = first_part(run)
    assert part.t_s[-1] == pytest.approx(2.0, abs=0.1)  # half of the way from 1 s to 3 s
    assert part.omega is not None and len(part.omega) == len(part.t_s) == len(part.pose)


def test_models_without_rigid_sectors_need_no_phases() -> None:
    smooth = smooth_kiwi()
    assert not matters_to(smooth.build("paper"))
    assert matters_to(read_recipe("ohio-kiwi").build("paper"))
    assert matters_to(
        smooth.with_effects(RigidSector(rigid_fraction=0.1, rigid_coefficient=0.5)).build("paper")
    )
