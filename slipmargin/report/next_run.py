"""Which runs to drive next, and why: in sentences, as a page and as plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.separate import separating_trial, trace_of
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.experiment.remaining import Question
from slipmargin.experiment.result import Narrowing, NextRuns, ProposedRun, Separation
from slipmargin.report import diagnosis_words as words
from slipmargin.report.page import Fact, Image, Page, Picture, Table
from slipmargin.report.pulls import next_sentence
from slipmargin.report.result_page import result_page
from slipmargin.report.text import two_digits

#: Below this χ² two explanations are still level after the runs: five noises.
CLEAR = 25.0
#: A run that never gets faster than this turns on the spot [m/s].
CREEPS_M_S = 0.01
#: Intervals that are told in lines.
_TOLD = 3


def pairs(found: NextRuns) -> list[Separation]:
    """Each pair of explanations once, in the direction in which it is told apart worse; the worst first."""
    worst: dict[frozenset[str], Separation] = {}
    for one in found.separations:
        key = frozenset((one.right, one.rival))
        if key not in worst or one.expected < worst[key].expected:
            worst[key] = one
    return sorted(worst.values(), key=lambda s: s.expected)


def noises(chi_square: float) -> str:
    """``14 noises (chi-square 190)``."""
    size = max(0.0, chi_square)
    return f"{math.sqrt(size):.3g} noises (chi-square {size:.3g})"


def answer(found: NextRuns) -> str:
    """What is open and what the runs will do about it, in one or two sentences."""
    if found.question is None:
        if not found.pulls:
            return "These are pulls alone, and none of those compared would tell more."
        return "These are pulls alone: pull the robot in the orientations below next."
    count = f"{len(found.runs)} run{'s' if len(found.runs) != 1 else ''}"
    if found.question is Question.ANYTHING:
        first = "The model misses something, and nothing that was tried explains it."
        if found.verdict is not Verdict.UNEXPLAINED:
            first = "Nothing is missing as far as the runs show."
        return f"{first} The {count} below show best what these runs could have missed."
    if found.question is Question.HOW_MUCH:
        return (
            f"One explanation is left: {found.explanations[0]}. The {count} below narrow its widest "
            f"interval most: {narrowed(found.narrowings[0])}."
        )
    hardest = pairs(found)[0]
    said = (
        f"The runs leave {words.listed(list(found.explanations))}. With the {count} below the pair that is "
        f"hardest to tell apart will differ by {noises(hardest.expected)}; today by {noises(hardest.today)}."
    )
    if hardest.expected < CLEAR:
        said += " That is too little: no motion that was compared tells them apart."
    return said


def narrowed(one: Narrowing) -> str:
    """``floor_tilt.tilt_x_rad from ±0.02 to ±0.004 rad``."""
    unit = "" if one.unit in ("", "1") else f" {one.unit}"
    return f"{one.parameter} from ±{two_digits(one.today)} to ±{two_digits(one.expected)}{unit}"


def _run_line(run: ProposedRun) -> str:
    rows = run.trajectory
    return (
        f"{run.words} ({rows.duration_s:.3g} s, up to {_fastest(run)}, at most "
        f"{np.max(rows.use):.2f} of a wheel's grip)"
    )


def _fastest(run: ProposedRun) -> str:
    """Its greatest speed, or how fast it turns where it stays on the spot."""
    right, forward, turn = np.abs(run.trajectory.velocity).T
    ahead = float(np.max(np.hypot(right, forward)))
    return f"{two_digits(ahead)} m/s" if ahead > CREEPS_M_S else f"{two_digits(float(np.max(turn)))} rad/s"


def _pair_line(one: Separation) -> str:
    apart = f"up to {two_digits(one.apart_mm)} mm and {two_digits(one.apart_deg)}° apart in the new runs"
    how = "after a new fit" if one.simulated else "by linear steps"
    return (
        f"{one.right} and {one.rival} will differ by {noises(one.expected)} {how}, {apart}; today by "
        f"{noises(one.today)}"
    )


def lines(found: NextRuns) -> list[str]:
    """What the command prints."""
    said = [f"{found.verdict.value}: {answer(found)}"]
    if found.question is None:
        return [*said, *(f"next     {next_sentence(p)}" for p in found.pulls)]
    said += [f"{run.name}    {_run_line(run)}" for run in found.runs]
    said += [f"expected {_pair_line(one)}" for one in pairs(found)]
    label = "hidden  " if found.question is Question.ANYTHING else "interval"
    said += [f"{label} {narrowed(one)}" for one in found.narrowings[:_TOLD]]
    if found.space is not None:
        x, y = found.space.middle_m
        a, b = found.space.size_m
        said.append(
            f"space    {a:.3g} m along x, {b:.3g} m along y, about ({x:.3g}, {y:.3g}) m; the robot with its "
            f"wheels takes {2.0 * found.reach_m:.3g} m of it"
        )
    said.append(
        f"compared {found.compared} motions at several paces, {100.0 * found.share:.3g} % of the grip"
    )
    if found.misfit > SETTINGS.noise_chi:
        said.append(
            f"note     the best explanation leaves {found.misfit:.3g} times the noise: differences are "
            "counted in that"
        )
    said += [f"note     {one}" for one in _other_ways(found)]
    said.append(f"next     drive them, add the logs to {found.data_set}, and diagnose again")
    return said


def _other_ways(found: NextRuns) -> list[str]:
    """What else would separate a pair that no motion within the limits does."""
    said = []
    for one in pairs(found):
        trace = trace_of(one.right)
        if one.expected < CLEAR and trace is not None:
            other = separating_trial(one.right, trace, one.rival)
            said.append(f"no motion compared tells {one.right} from {one.rival}: {other}")
    return said


def report(found: NextRuns) -> dict[str, Any]:
    """Everything as plain data."""
    space = found.space
    return {
        "schema": 1,
        "data_set": found.data_set,
        "robot": found.robot,
        "surface": found.surface,
        "verdict": found.verdict.value,
        "question": None if found.question is None else found.question.value,
        "explanations": list(found.explanations),
        "answer": answer(found),
        "space": None if space is None else {"middle_m": space.middle_m, "size_m": space.size_m},
        "robot_radius_m": found.reach_m,
        "margin": 1.0 - found.share,
        "misfit": found.misfit,
        "noise": dict(zip(("x_m", "y_m", "phi_rad"), found.noise.tolist(), strict=True)),
        "motions_compared": found.compared,
        "runs": [
            {
                "name": run.name,
                "motion": run.words,
                "duration_s": run.trajectory.duration_s,
                "max_use": float(np.max(run.trajectory.use)),
                "repeats": run.repeats,
                "legs": [leg.tolist() for leg in run.legs],
                "trajectory": run.trajectory.columns(),
            }
            for run in found.runs
        ],
        "separations": [asdict(s) for s in found.separations],
        "intervals": [asdict(n) for n in found.narrowings],
        "pulls": [asdict(p) for p in found.pulls],
    }


def page(found: NextRuns, images: Mapping[str, Image], warnings: Sequence[str] = ()) -> Page:
    """The page: what is open, the runs on the floor, what each explanation predicts, what to do."""
    told = pairs(found)
    facts = [Fact(label="Runs proposed", value=str(len(found.runs)), note=f"of {found.compared} compared")]
    if told:
        facts += [
            Fact(
                label="Apart today",
                value=f"{math.sqrt(max(0.0, told[0].today)):.3g} noises",
                note="worst pair",
            ),
            Fact(
                label="Apart with the runs",
                value=f"{math.sqrt(max(0.0, told[0].expected)):.3g} noises",
                note="expected, worst pair",
            ),
        ]
    facts += [
        Fact(
            label=n.parameter,
            value=f"±{two_digits(n.today)} → ±{two_digits(n.expected)}",
            note="95 %, as far as noise decides",
        )
        for n in found.narrowings[:1]
    ]
    tables = [
        Table(
            caption="The runs, in the order in which they were chosen",
            head=("run", "what to drive", "duration", "fastest", "grip used"),
            rows=tuple(
                (
                    run.name,
                    run.words,
                    f"{run.trajectory.duration_s:.3g} s",
                    _fastest(run),
                    f"{100.0 * float(np.max(run.trajectory.use)):.0f} %",
                )
                for run in found.runs
            ),
            numbers=False,
        ),
        Table(
            caption="How far the explanations are apart",
            head=("if this is right", "and this is fitted", "today", "with the runs"),
            rows=tuple((s.right, s.rival, noises(s.today), noises(s.expected)) for s in found.separations),
            numbers=False,
        ),
        Table(
            caption="Half of each 95 % interval, as far as noise decides",
            head=("parameter", "today", "with the runs", "unit"),
            rows=tuple(
                (n.parameter, f"±{two_digits(n.today)}", f"±{two_digits(n.expected)}", n.unit)
                for n in found.narrowings
            ),
        ),
    ]
    steps = [
        "Put the robot at the start that the picture shows, and drive each run once; log it as the others.",
        f"Add the logs to {found.data_set} and run `slipmargin diagnose` again.",
        *_other_ways(found),
    ]
    if found.question is None:
        steps = [f"Pull next: {next_sentence(p)}." for p in found.pulls] or ["Nothing more to pull."]
    return result_page(
        title=f"What to drive next: {found.robot} on {found.surface}, data set {found.data_set}",
        lead=answer(found),
        good=told[0].expected >= CLEAR if told else found.verdict is not Verdict.UNEXPLAINED,
        facts=facts,
        pictures=tuple(
            Picture(
                name="floor",
                image=image,
                alt="The space from above with each proposed run's path and where the robot starts",
                caption="The proposed runs on the floor.",
            )
            for image in images.values()
        ),
        tables=[t for t in tables if t.rows],
        next_steps=steps,
        lines=lines(found),
        warnings=warnings,
    )
