"""What ``slipmargin diagnose`` computes, writes and says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .render import refuse
from .stages import stages

if TYPE_CHECKING:
    from slipmargin.data.data_set import DataSet
    from slipmargin.diagnose.diagnosis import Diagnosis
    from slipmargin.diagnose.limits_change import LimitsChange


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """A diagnosis, its limits before and after, the report and the files to write."""

    diagnosis: Diagnosis
    change: LimitsChange
    report: dict[str, Any]
    files: dict[str, str | bytes]

    @property
    def written(self) -> list[str]:
        """Files, the page to read first."""
        return sorted(self.files, key=lambda name: (name != "report.html", name.endswith(".png"), name))


def engine(data_set: DataSet, seed: int, progress: Callable[[str, float], None]) -> Diagnosis:
    """The diagnosis itself."""
    from slipmargin.diagnose.loop import diagnose

    return diagnose(data_set, seed=seed, progress=progress)


def check_sense(data_set: DataSet, source: str) -> None:
    """Refuse data whose fault is not the robot's: wrong units, swapped wheels, a mirrored frame."""
    from slipmargin.errors import InputError
    from slipmargin.io.data_checks import check_data_set

    for fault in check_data_set(data_set):
        raise InputError(fault.place, fault.problem, f"likely cause: {fault.cause}", source)


def run_diagnose(dataset: Path, out: Path, seed: int, json: str | None) -> Found:
    """Read, diagnose, draw: everything that can fail, before any file is written."""
    from slipmargin.diagnose.limits_change import limits_change
    from slipmargin.io.data_set import read_data_set
    from slipmargin.io.folder import check_folder
    from slipmargin.io.report_json import report
    from slipmargin.io.writes import check_writable

    if seed < 0:
        refuse("--seed", f"is {seed}", "give a whole number from 0")
    check_folder(out)
    check_writable(json)
    with stages() as progress:
        data_set = read_data_set(dataset)
        check_sense(data_set, str(dataset))
        diagnosis = engine(data_set, seed, progress)
        progress("limits before and after", 0.2)
        change = limits_change(diagnosis.recipe, diagnosis.corrected, diagnosis.surface, data_set.pulls)
        progress("drawing", 0.5)
        table = report(diagnosis, change)
        files = _files(diagnosis, change, table)
    return Found(diagnosis=diagnosis, change=change, report=table, files=files)


def _files(diagnosis: Diagnosis, change: LimitsChange, table: dict[str, Any]) -> dict[str, str | bytes]:
    from slipmargin.io.json_text import json_text
    from slipmargin.io.robot_text import write_recipe
    from slipmargin.plots.diagnosis_page import page
    from slipmargin.plots.diagnosis_words import verdict_sentence
    from slipmargin.plots.page import html, pictures

    built = page(diagnosis, change)
    comment = (
        f"{diagnosis.recipe.robot.name}, corrected by slipmargin diagnose from the data set "
        f"{diagnosis.data_set}.\n{verdict_sentence(diagnosis)}"
    )
    return {
        "report.json": json_text(table),
        "report.html": html(built),
        "corrected.toml": write_recipe(diagnosis.corrected, comment),
        **pictures(built),
    }


def results(found: Found, out: Path) -> None:
    """Write the folder."""
    from slipmargin.io.folder import write_folder

    write_folder(out, found.files)


def summary(found: Found) -> list[str]:
    """Lines for stdout: verdict, effects, error and limits before and after."""
    from slipmargin.diagnose.separate import separating_trial
    from slipmargin.plots import diagnosis_words as words

    d, change = found.diagnosis, found.change
    lines = [f"{d.verdict.value}: {words.verdict_sentence(d)}"]
    for f in d.findings:
        values = ", ".join(words.interval(e) for e in f.parameters[:4])
        more = f", and {len(f.parameters) - 4} more" if len(f.parameters) > 4 else ""
        lines.append(
            f"found    {f.name} (traced to {f.traced_to.value}; {words.chance(f.p_value)} among "
            f"{f.candidates_tried} suspects): {values}{more}"
        )
        lines += [
            f"         not told apart from {name}: {separating_trial(f.name, f.traced_to, name)}"
            for name in f.confused_with
        ]
    lines.append(
        f"error    {words.error(d.before)}"
        + (f" → {words.error(d.after)}" if d.findings else "")
        + " on held-out runs"
    )
    b, a = change.before, change.after
    if change.moved:
        lines.append(
            f"limits   weakest pull {words.arrow(b.f_max_min_N, a.f_max_min_N, 'N')}, mean "
            f"{words.arrow(b.f_max_mean_N, a.f_max_mean_N, 'N')}"
        )
        high = words.arrow(float(b.f_high_N.max()), float(a.f_high_N.max()), "N")
        start = words.arrow(float(b.start_worst_m_s2.min()), float(a.start_worst_m_s2.min()), "m/s²")
        lines.append(f"         whatever the wheels stand on: strongest pull {high}, least start {start}")
    else:
        lines.append(f"limits   unchanged: weakest pull {b.f_max_min_N:.3g} N, mean {b.f_max_mean_N:.3g} N")
    if change.moved and change.pulls is not None:
        lines.append(f"pulls    {words.pulls_sentence(change.pulls)}")
    lines += [f"note     {remark}" for remark in d.remarks]
    return lines
