"""Constructed next runs for the tests of whatever shows them: no diagnosis and no simulation behind them."""

from __future__ import annotations

import numpy as np

from slipmargin.diagnosis.result import Verdict
from slipmargin.experiment.motions import Space
from slipmargin.experiment.remaining import Question
from slipmargin.experiment.result import Narrowing, NextRuns, ProposedRun, Separation
from slipmargin.paths.trajectory import Trajectory


def run(name: str = "run-1", wheels: int = 3) -> ProposedRun:
    """A metre along x and back, with wheel speeds that mean nothing."""
    t = np.linspace(0.0, 4.0, 81)
    x, v = 0.5 - 0.5 * np.cos(0.5 * np.pi * t), 0.25 * np.pi * np.sin(0.5 * np.pi * t)
    zero = np.zeros_like(t)
    return ProposedRun(
        name=name,
        words="straight along the floor's x and back, heading 0°, slowly",
        legs=(np.array([[0.0, 0.2, 0.0], [1.0, 0.2, 0.0]]), np.array([[1.0, 0.2, 0.0], [0.0, 0.2, 0.0]])),
        repeats=1,
        trajectory=Trajectory(
            t_s=t,
            pose=np.column_stack([x, zero + 0.2, zero]),
            velocity=np.column_stack([v, zero, zero]),
            acceleration=np.zeros((len(t), 3)),
            omega=np.tile(v[:, None], (1, wheels)),
            use=np.full((len(t), wheels), 0.4),
            wheels=tuple(str(i + 1) for i in range(wheels)),
        ),
        predicted=(np.column_stack([x, zero + 0.21, zero]), np.column_stack([x, zero + 0.19, zero])),
    )


def separation(**change: object) -> Separation:
    """Two models that differ by two noises today and by fourteen with the run."""
    values: dict[str, object] = {
        "right": "wheel_radius[1]",
        "rival": "wheel_toe[1]",
        "today": 4.0,
        "expected": 196.0,
        "simulated": True,
        "by_run": (190.0,),
        "apart_mm": 12.0,
        "apart_deg": 0.5,
    }
    return Separation(**(values | change))  # type: ignore[arg-type]


def next_runs(question: Question | None = Question.WHICH, **change: object) -> NextRuns:
    """Next runs that answer this question."""
    both = question is Question.WHICH
    values: dict[str, object] = {
        "data_set": "drawn",
        "robot": "kiwi",
        "surface": "paper",
        "verdict": Verdict.NO_MISSING_EFFECT if question is Question.ANYTHING else Verdict.EFFECT_FOUND,
        "question": question,
        "explanations": ("wheel_radius[1]", "wheel_toe[1]") if both else ("floor_tilt",),
        "runs": (run(),),
        "separations": (separation(), separation(right="wheel_toe[1]", rival="wheel_radius[1]", today=-4.0))
        if both
        else (),
        "narrowings": (
            Narrowing(parameter="floor_tilt.tilt_x_rad", unit="rad", today=0.02, expected=0.004),
            Narrowing(parameter="floor_tilt.tilt_y_rad", unit="rad", today=0.01, expected=0.004),
        ),
        "compared": 49,
        "space": Space(middle_m=(0.5, 0.2), size_m=(3.0, 2.0)),
        "reach_m": 0.12,
        "share": 0.9,
        "misfit": 1.0,
        "noise": np.array([5e-4, 6e-4, 2e-3]),
        "front_rad": 0.5 * np.pi,
    }
    return NextRuns(**(values | change))  # type: ignore[arg-type]
