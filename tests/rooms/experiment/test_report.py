"""What is said of next runs: lines, page, JSON, files, picture; pulls alone."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnoses import diagnosis, wheel_loads
from json_schemas import faults
from proposals import next_runs, separation

import slipmargin as sm
from slipmargin.api.next_run import NextRunResult
from slipmargin.diagnosis.pull_next import NextPull
from slipmargin.diagnosis.result import Verdict
from slipmargin.errors import InputError
from slipmargin.experiment.remaining import Question
from slipmargin.report.diagnosis_evidence import next_steps
from slipmargin.report.diagnosis_words import next_run_command


def result(question: Question | None = Question.WHICH, **change: object) -> NextRunResult:
    return NextRunResult(next_runs=next_runs(question, **change))


def test_lines_say_what_will_be_told_apart() -> None:
    lines = result().lines()
    assert lines[0].startswith("effect-found: The runs leave wheel_radius[1] and wheel_toe[1].")
    assert "will differ by 14 noises (chi-square 196); today by 2 noises (chi-square 4)" in " ".join(lines)
    assert any(line.startswith("run-1    straight along the floor's x and back") for line in lines)
    assert sum(line.startswith("expected") for line in lines) == 1  # each pair once, by its worse direction


def test_what_no_motion_separates_is_said_with_another_way() -> None:
    level = separation(expected=3.0)
    lines = result(separations=(level,)).lines()
    assert "That is too little" in lines[0]
    assert any("no motion compared tells wheel_radius[1] from wheel_toe[1]: " in line for line in lines)
    assert result(separations=(level,)).page().lead_kind == "attention"


def test_one_explanation_has_its_interval_narrowed_and_none_what_could_hide() -> None:
    lines = result(Question.HOW_MUCH).lines()
    assert "floor_tilt.tilt_x_rad from ±0.02 to ±0.004 rad" in lines[0]
    assert any(line.startswith("interval floor_tilt.tilt_x_rad") for line in lines)
    hidden = result(Question.ANYTHING).lines()
    assert hidden[0].startswith("no-missing-effect: Nothing is missing as far as the runs show.")
    assert any(line.startswith("hidden   floor_tilt.tilt_x_rad from") for line in hidden)


def test_pulls_alone_say_which_orientation_to_pull_next() -> None:
    pull = NextPull(phi_rad=0.5, direction_rad=0.0, separates=("stribeck", "floor_tilt"), apart_N=0.4)
    found = result(None, runs=(), space=None, narrowings=(), pulls=(pull,))
    assert "pulled along" in found._repr_html_()  # a notebook shows what there is
    assert found.lines()[1] == (
        "next     robot at φ = 29°, pulled along 0° of the floor: stribeck and floor_tilt differ there by "
        "0.4 N"
    )
    assert faults("next-run", found.to_json()) == [] and found.files() == {}
    assert "pulled along" in found.page_text()
    with pytest.raises(InputError, match="no runs to draw"):
        found.plot()


@pytest.mark.parametrize("question", list(Question))
def test_json_keeps_its_schema_and_the_page_holds_the_answer(question: Question) -> None:
    found = result(question)
    assert faults("next-run", found.to_json()) == []
    told = json.loads(found.to_json())
    assert told["runs"][0]["trajectory"]["t_s"][-1] == 4.0 and told["question"] == question.value
    assert "What to do next" in found.page_text() and "<svg" in found.page_text()
    assert found.summary() in repr(found)


def test_files_are_what_plan_writes_and_reads(tmp_path: Path) -> None:
    names = result().write_folder(tmp_path / "next")
    assert names == ["run-1.csv", "run-1-path-1.csv", "run-1-path-2.csv"]
    rows = list(csv.DictReader(io.StringIO((tmp_path / "next" / "run-1.csv").read_text(encoding="utf-8"))))
    assert list(rows[0])[:4] == ["t_s", "x_m", "y_m", "phi_rad"] and "omega3_rad_s" in rows[0]
    planned = sm.plan("ohio-kiwi-symmetric", "paper", tmp_path / "next" / "run-1-path-1.csv", points=40)
    assert planned.plan.path.length == pytest.approx(1.0)
    driven = sm.simulate("ohio-kiwi-symmetric", "paper", tmp_path / "next" / "run-1.csv")
    assert driven.run.t_s[-1] == 4.0


@pytest.mark.parametrize(
    ("verdict", "rivals", "asked"),
    [
        (Verdict.EFFECT_FOUND, (), True),  # a lead is left over
        (Verdict.EFFECT_FOUND, ("floor_nap",), True),
        (Verdict.UNEXPLAINED, (), True),
        (Verdict.NO_MISSING_EFFECT, (), False),
    ],
)
def test_a_diagnosis_names_the_command_where_something_is_open(
    verdict: Verdict, rivals: tuple[str, ...], asked: bool
) -> None:
    findings = (wheel_loads(confused_with=rivals),) if verdict is Verdict.EFFECT_FOUND else ()
    shown = str(next_steps(diagnosis(verdict, findings)))
    assert ("Drive this next: `slipmargin next-run drawn`" in shown) is asked


def test_of_a_campaign_the_command_names_the_data_set_that_fits_worst() -> None:
    """next-run takes no campaign, and the report named one: "slipmargin next-run two floors"."""
    found = diagnosis(Verdict.UNEXPLAINED)
    near, far = (replace(found.trials[0], data_set=f"runs/{part}") for part in ("table", "gray floor"))
    far = replace(far, after=far.after + 1.0)
    assert next_run_command(replace(found, trials=(near, far))) == "slipmargin next-run 'runs/gray floor'"


def test_a_run_on_the_spot_says_how_fast_it_turns() -> None:
    """It said "up to 0 m/s"."""
    (run, *_) = result().next_runs.runs
    rows = run.trajectory
    spin = replace(rows, velocity=np.column_stack([*(0.0 * rows.velocity.T[:2]), 0.0 * rows.t_s - 2.5]))
    found = result(runs=(replace(run, trajectory=spin, predicted=(spin.pose, spin.pose)),))
    assert any("up to 2.5 rad/s, at most" in line for line in found.lines())
    text = found.page_text().replace("\N{NO-BREAK SPACE}", " ")
    assert "2.5 rad/s" in text
    alone = result(runs=(replace(run, predicted=(rows.pose,)),))
    for of, count in ((found, 2), (alone, 1)):
        (legend,) = of.plot().legends
        assert sum("is right" in line.get_text() for line in legend.get_texts()) == count
