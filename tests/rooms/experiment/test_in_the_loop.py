"""The loop in short: runs straight ahead leave two names, proposed runs leave one (the whole: benchmarks)."""

from __future__ import annotations

from next_run import CASES, LENGTH_S, Driven, alone, data_set, logged, standard_runs, told

from slipmargin.diagnosis.watch import Watch
from slipmargin.experiment.next_runs import Request, proposed
from slipmargin.experiment.remaining import Question, name_of, remaining


def test_proposed_runs_leave_the_right_name_alone() -> None:
    case = next(c for c in CASES if c.name == "radius")
    before = logged(case, standard_runs(case, range(7)), 5)
    left = remaining(data_set(before), None, 0, Watch(report=lambda stage, share: None))
    assert left.question is Question.WHICH
    assert {"wheel_radius[1]", "wheel_toe[1]"} <= {name_of(f) for f in left.fits}
    asked = Request(runs=3, size_m=(2.0, 1.5), longest_s=LENGTH_S)
    kinds = ("line-y", "turning-line-y", "turning-circle-left", "spin")
    found = proposed(left, asked, Watch(report=lambda stage, share: None), kinds)
    ahead = [
        Driven(
            name=f"run{10 + k}", t_s=r.trajectory.t_s, omega=r.trajectory.omega, start=r.trajectory.pose[0]
        )
        for k, r in enumerate(found.runs)
    ]
    answer = told((*before, *logged(case, ahead, 6)))
    assert alone(answer, ["wheel_radius"]), answer
