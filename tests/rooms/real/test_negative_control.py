"""A negative control: real wheels, a robot that moves as its file says, a camera as noisy as the real one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from real.sets import RealSet, robojackets

from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis.conditions import ready
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.sense import measure
from slipmargin.sim.pack import pack

EXCERPT = Path(__file__).resolve().parents[2] / "data" / "robojackets_excerpt" / "enc_vis_excerpt.txt"


@pytest.fixture(scope="module")
def data() -> RealSet:
    return robojackets(EXCERPT)[0]


def obedient(data: RealSet) -> DataSet:
    """The recording's wheels with the poses of a robot that moves as its file says."""
    real = ready(replace(data.fitted, trials=(*data.fitted.trials, *data.judged))).data_set
    problem = problem_of(real)
    model = problem.model(())
    poses = problem.batch.run(pack(model), problem.starts, start_twist=problem.twists).pose
    random = np.random.default_rng(0)
    trials = []
    for record, pose in zip(real.trials, poses, strict=True):
        seen = measure(model.measurement, [record.t_s], pose[None, : len(record.t_s)])[0]
        moved = seen + problem.sigma * random.normal(size=record.pose.shape)
        trials.append(replace(record, pose=np.where(np.isfinite(record.pose), moved, np.nan)))
    return replace(real, trials=tuple(trials), sigma=None, lasting=None)


def test_a_robot_that_obeys_lacks_nothing(data: RealSet) -> None:
    found = diagnose(obedient(data))
    assert found.verdict is Verdict.NO_MISSING_EFFECT and not found.findings
