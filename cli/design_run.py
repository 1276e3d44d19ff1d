"""What ``slipmargin design`` computes, between its options and its report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.toml_table import one_of
from slipmargin.io.writes import check_writable, write_together
from slipmargin.study.influence import Influence, influences
from slipmargin.study.machine import Machine
from slipmargin.study.objectives import Kind, objective
from slipmargin.study.optimum import Optimum, optimum
from slipmargin.study.pieces import Workshop, clear, work_folder
from slipmargin.study.reason import Reason, reason
from slipmargin.study.robust import Interval, Robust, parse_interval, robust
from slipmargin.study.study import Question, Study, study
from slipmargin.study.table import study_data, table_text
from slipmargin.study.vary import Vary, parse_vary, product

from .render import progress, refuse

#: Seconds that a design takes by kind (roughly), and from which total on every core is used.
COST_S = {Kind.MOTION: 0.02, Kind.LAPS: 0.5}
MANY_S = 15.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """The command line as it was typed."""

    robot: str
    surface: str
    vary: tuple[str, ...]
    objective: str
    front: str
    uncertain: tuple[str, ...]
    static: bool
    laps: bool
    jobs: int | None
    scheduler: str | None
    out: Path | None
    plot: Path | None
    html: Path | None
    json: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignRun:
    """A study with everything that its report, its page and its files say."""

    study: Study
    why: Reason
    front: tuple[str, ...]
    optimum: Optimum | None
    robust: Robust | None
    intervals: tuple[Interval, ...]
    influences: tuple[Influence, ...]

    def as_json(self) -> dict[str, Any]:
        """Everything, as plain data."""
        s, found, sure = self.study, self.optimum, self.robust
        return {
            **study_data(s),
            "why": {"where": self.why.where, "gives_way": list(self.why.what)},
            "front": {"objectives": list(self.front), "rows": s.front(self.front).nonzero()[0]},
            "optimum": None
            if found is None
            else {
                "design": dict(zip(s.keys, found.values, strict=True)),
                "value": found.value,
                "gain_over_grid": found.gain,
                "self_check": found.check,
                "evaluations": found.evaluations,
            },
            "robust": None
            if sure is None
            else {
                "objective": sure.goal.name,
                "design": dict(zip(s.keys, s.values[sure.best], strict=True)),
                "value": float(sure.value[sure.best]),
                "worst_corner": dict(sure.corner),
                "exact": sure.exact,
                "column": sure.value,
            },
            "influence": [
                {"key": i.key, "value": i.value, "slope": i.slope, "peak": i.peak} for i in self.influences
            ],
        }


def run_design(asked: Asked) -> DesignRun:
    """Everything the command needs, options checked before any work is done, files written at the end.

    Raises
    ------
    InputError
        Placed at the option.
    """
    question, front, intervals = _question(asked)
    check_writable(asked.out, asked.plot, asked.html, asked.json)
    if asked.plot is not None:
        from slipmargin.plots.style import check_format

        check_format(asked.plot)
    folder = work_folder(asked.out)
    count = len(product(question.machine, question.grids)) + 1
    slow = [kind for kind in question.needed() if kind is not Kind.STATIC]
    jobs = (
        asked.jobs
        if asked.jobs is not None
        else (-1 if count * sum(COST_S[kind] for kind in slow) > MANY_S else 1)
    )
    with _placed("--jobs"):
        workshop = Workshop(folder=folder, jobs=jobs, scheduler=asked.scheduler)
    with progress("designs", count if slow else 0) as advance, _placed("--scheduler"):
        found = study(question, workshop=workshop, advance=advance)
    with _placed("--vary"):
        goal, best = question.objective, found.best()
    machine = found.machine(best)
    numeric = any(grid.numeric and len(grid.values) > 1 for grid in question.grids)
    with _placed("--uncertain"):
        sure = robust(found.machines, goal, intervals) if intervals else None
    run = DesignRun(
        study=found,
        why=reason(machine, goal),
        front=front,
        optimum=optimum(found) if numeric else None,
        robust=sure,
        intervals=intervals,
        influences=influences(machine, goal) if goal.kind is not Kind.LAPS else (),
    )
    _write(run, asked)
    clear(folder)
    return run


def _question(asked: Asked) -> tuple[Question, tuple[str, ...], tuple[Interval, ...]]:
    recipe = read_recipe(asked.robot)
    with _placed("--surface"):
        one_of("", asked.surface, [s.name for s in recipe.robot.surfaces])
    machine = Machine(recipe=recipe, surface=asked.surface)
    with _placed("--vary"):
        grids: tuple[Vary, ...] = tuple(parse_vary(text) for text in asked.vary)
        product(machine, grids)
    with _placed("--objective"):
        goal = objective(asked.objective)
    with _placed("--uncertain"):
        intervals = tuple(parse_interval(text) for text in asked.uncertain)
        both = next((i.quantity.key for i in intervals if i.quantity.key in [g.key for g in grids]), None)
        if both is not None:
            raise InputError(both, "is varied as well", "either choose it or leave it uncertain")
    kinds = (Kind.STATIC,) if asked.static else (Kind.STATIC, Kind.MOTION)
    question = Question(
        machine=machine, grids=grids, objective=goal, kinds=(*kinds, Kind.LAPS) if asked.laps else kinds
    )
    with _placed("--front"):
        goals = [objective(name.strip()) for name in asked.front.split(",")]
    there = question.needed()
    front = tuple(g.name for g in goals if g.kind in there)
    if len(front) < 2:
        front = (goal.name, "f_mean" if goal.name != "f_mean" else "f_worst")
    return question, front, intervals


def _write(run: DesignRun, asked: Asked) -> None:
    files: dict[Path | str, str | bytes] = {}
    if asked.html is not None:
        from slipmargin.plots.study_page import study_page

        from .design_report import summary

        files[asked.html] = study_page(run.study, run.front, run.robust, run.influences, summary(run))
    if asked.plot is not None:
        from slipmargin.plots.study import study_figure
        from slipmargin.plots.style import save

        save(study_figure(run.study, run.front, run.robust), asked.plot)
    if asked.out is not None:
        files[asked.out] = table_text(run.study, run.front)
    write_together(files)


class _placed:
    """A fault inside is one of the command line, at this option."""

    def __init__(self, option: str) -> None:
        self.option = option

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, fault: BaseException | None, trace: object) -> None:
        if isinstance(fault, InputError) and not fault.source:
            inner = "" if fault.place == self.option.lstrip("-") else fault.place
            refuse(" ".join(part for part in (self.option, inner) if part), fault.problem, fault.cure)
