"""A real robot with its weight moved: beside runs without payload, no wheel grows and the loads are found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from real.sets import robotino
from real_logs import WHOLE, needs_whole

from slipmargin.data.campaign import apart
from slipmargin.data.odometry import body_path
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.evidence import intervals
from slipmargin.diagnosis.fit import fit
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.state import later_share

LABELS = (
    "slip_ratio_friction with its own constants across in floor gray",
    "wheel_loads in loading each",
    "trailing_load in floor gray",
)
START = (5.0, 1.8, 2.7, -0.02, 0.0, -0.012, 0.0, 0.004)


@needs_whole
def test_a_payload_is_a_payload_and_no_larger_wheel() -> None:
    data = next(s for s in robotino(WHOLE) if s.name == "robotino-load")
    parts = apart(data.fitted)
    some = {id(t) for part in parts for t in part.trials[:: 3 if part.surface == "table" else 1]}
    kept = [i for i, t in enumerate(data.fitted.trials) if id(t) in some]
    fitted = replace(
        data.fitted,
        trials=tuple(data.fitted.trials[i] for i in kept),
        member_of=tuple(data.fitted.member_of[i] for i in kept),
    )
    problem = problem_of(fitted)
    camera = tuple(e.name for e in fitted.recipe.effects)
    known = {c.label: c for c in in_groups(named_candidates(("1", "2", "3"), False, camera), fitted.members)}
    structure = tuple(known[label] for label in LABELS)
    rows = np.arange(len(problem.trials), dtype=np.int64)  # on the table a larger wheel would show
    view = problem.in_pieces(2.0)
    made = fit(view, structure, np.array(START), rows)
    keys = [k for c in made.structure for k in c.keys]
    found = dict(zip(keys, made.x, strict=True))
    spread = intervals(made)
    at = keys.index("shift_x_m (loading payload)")
    assert spread.low[at] < -0.006 and spread.high[at] > -0.018
    assert found["shift_x_m (loading as stated)"] < found["shift_x_m (loading payload)"] - 0.004
    wheels = [known[f"wheel_radius[{w}]"] for w in "12"]
    grown = fit(view, (*structure, *wheels), np.array([*made.x, 1.0, 1.0]), rows, iterations=2)
    share = 1.0 - np.sqrt(grown.cost / made.cost)
    assert share < later_share(len(rows)), "a wheel that no search takes up"
    judged = replace(fitted, trials=data.judged, members=(), member_of=(), recipe=data.recipe)
    errors = _errors(problem_of(replace(judged, sigma=problem.sigma)), made.effects)
    assert errors[0] < 0.02 and errors[1] < 3.5


def _errors(problem: Problem, effects: tuple[object, ...]) -> tuple[float, float]:
    """Displacement over way [1] and heading [deg], root mean squares over the payload's runs."""
    from slipmargin.effects.confined import acting

    own = acting(effects, 1)  # type: ignore[arg-type]
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    way, turn = [], []
    for trial, pose in zip(problem.trials, problem.predict([own], [everyone])[0], strict=True):
        went = body_path(trial.pose)[-1]
        gap = body_path(pose[: len(trial.t_s)])[-1] - went
        way.append(np.hypot(*gap[:2]) / np.hypot(*went[:2]))
        turn.append(gap[2])
    return float(np.sqrt(np.mean(np.square(way)))), float(np.rad2deg(np.sqrt(np.mean(np.square(turn)))))
