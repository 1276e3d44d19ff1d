"""``slipmargin.design``: which robot to build, every limit over varied dimensions."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, read_robot, warnings_of
from slipmargin.errors import InputError, SlipmarginError

if TYPE_CHECKING:
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page
    from slipmargin.study.influence import Influence
    from slipmargin.study.optimum import Optimum
    from slipmargin.study.reason import Reason
    from slipmargin.study.robust import Interval, Robust
    from slipmargin.study.study import DesignProblem, Study
    from slipmargin.study.vary import Vary

#: Objectives of the Pareto front where none are asked for.
_FRONT = "f_worst,start_worst_m_s2"

#: Seconds that a design takes by kind (roughly; static: one that no zonotope describes), and from which
#: total on every core is used.
COST_S = {"static": 1.0, "motion": 0.02, "laps": 0.5}
MANY_S = 15.0


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DesignResult(Result):
    """Every limit of every design, the best design and why, and what the best depends on."""

    study: Study
    why: Reason
    front: tuple[str, ...]  #: objectives of the Pareto front
    optimum: Optimum | None  #: the best between the grid's points
    robust: Robust | None  #: the best in the worst case of what is uncertain
    influences: tuple[Influence, ...]
    work_folder: Path | None
    dropped: tuple[str, ...] = ()  #: what was asked for and is not computed

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the robot file says, or was asked for, and a study of designs does not use."""
        base = self.study.problem.base
        return (*warnings_of(base.recipe, base.surface, band=True), *self.dropped)

    @property
    def best(self) -> dict[str, Any]:
        """The best design: quantity → value."""
        return dict(zip(self.study.keys, self.study.values[self.study.best()], strict=True))

    def summary(self) -> str:
        """The best design and its objective with its unit."""
        from slipmargin.report.design import best_sentence

        design = self.study.problem.base
        return f"design of {design.robot.name} on {design.surface}: best {best_sentence(self.study)}"

    def labelled(self) -> list[tuple[str, str]]:
        """The answer as labelled sentences."""
        from slipmargin.report.design import summary

        return summary(self.study, self.why, self.front, self.optimum, self.robust, self.influences)

    def lines(self) -> list[str]:
        """The answer, then the best design for each objective."""
        from slipmargin.report.design import best_by_objective
        from slipmargin.report.text import columns

        lines = [f"{label:<11} {text}" for label, text in self.labelled()]
        return [*lines, "", *columns(*best_by_objective(self.study))]

    def table_lines(self) -> list[str]:
        """A row a design, as many as a terminal shows."""
        from slipmargin.report.design import designs

        return designs(self.study, self.front)

    def plot(self) -> Figure:
        """Limits over the study, pulls all round for a few designs, and the Pareto front."""
        from slipmargin.plots.study import study_figure

        return study_figure(self.study, self.front, self.robust)

    def table_text(self) -> str:
        """A row a design."""
        from slipmargin.study.table import table_text

        return table_text(self.study, self.front)

    def page(self) -> Page:
        """The page that sums up."""
        from slipmargin.plots.study import study_panels
        from slipmargin.plots.style import images
        from slipmargin.report.design_page import design_page

        drawn = images(study_panels(self.study, self.front, self.robust))
        return design_page(self.study, self.front, self.robust, self.influences, self.labelled(), drawn)

    def forget_work(self) -> None:
        """Remove the pieces kept for a run that is interrupted; call it once the result is written."""
        from slipmargin.study.pieces import clear

        clear(self.work_folder)

    def to_dict(self) -> dict[str, Any]:
        """Everything, as plain data."""
        from slipmargin.study.table import study_data

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


def known_quantities() -> dict[str, str]:
    """The quantities that :func:`slipmargin.design` may vary, each with its meaning and unit.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.known_quantities()["delta_deg"]
    'wheel angle δ of a three-wheel robot (Fig. 3) [deg]'
    """
    from slipmargin.study.quantities import QUANTITIES

    return {q.key: f"{q.meaning} [{q.unit}]" if q.unit else q.meaning for q in QUANTITIES}


def design(
    robot: RobotLike,
    surface: str,
    vary: Sequence[str] | str,
    *,
    objective: str = "f_worst",
    front: Sequence[str] | str = _FRONT,
    uncertain: Sequence[str] | str = (),
    static: bool = False,
    laps: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
    resume: Path | str | None = None,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> DesignResult:
    """Every limit of every design over grids of the robot file's quantities; the best one and why.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface of the robot file.
    vary : str or list of str
        ``KEY=FROM:TO:STEP`` or ``KEY=a,b,c``; several make a product.
    objective : str
        What makes a design the best.
    front : str or list of str
        Objectives of the Pareto front.
    uncertain : str or list of str
        ``KEY=LOW:HIGH``: quantities only known within an interval, of which the worst case counts.
    static : bool
        Static limits only, which is quicker.
    laps : bool
        Also plan benchmark paths, which is slower.
    jobs : int, optional
        Processes; −1: every core.  Without it, every core where the work takes long.
    scheduler : str, optional
        Address of a Dask scheduler that replaces ``jobs``.
    resume : str or Path, optional
        A folder that keeps finished pieces of long work: interrupted and called again, it goes on.
    progress : callable
        Called with the name of the stage and the share of it that is done (0 to 1).

    Returns
    -------
    DesignResult
        ``study.columns`` holds a column (D,) for each objective; ``best`` the best design.

    Raises
    ------
    InputError
        For a fault in the robot file or an argument.  A single impossible design is no error: its row says
        why.

    Examples
    --------
    >>> import slipmargin as sm
    >>> found = sm.design("ohio-kiwi", "paper", "delta_deg=0:60:10", static=True)
    >>> found.best
    {'delta_deg': 40.0}
    """
    from slipmargin.study.batch import batches, plain
    from slipmargin.study.influence import influences
    from slipmargin.study.objectives import Kind
    from slipmargin.study.optimum import optimum
    from slipmargin.study.pieces import Executor, clear
    from slipmargin.study.reason import reason
    from slipmargin.study.robust import robust
    from slipmargin.study.study import study
    from slipmargin.study.vary import product

    problem = _problem(robot, surface, _several(vary), objective, static, laps)
    intervals = _intervals(_several(uncertain), problem.grids)
    names = _front(front, problem)
    count = len(product(problem.base, problem.grids)) + 1
    if jobs is None:
        at_once = plain(batches([problem.base])[0], 1)[0]
        slow = [kind for kind in problem.needed() if not (kind is Kind.STATIC and at_once)]
        jobs = -1 if count * sum(COST_S[kind.name.lower()] for kind in slow) > MANY_S else 1
    folder = None if resume is None else Path(resume)
    with _placed("jobs"):
        executor = Executor(folder=folder, jobs=jobs, scheduler=scheduler)
    done = 0

    def advance(steps: int) -> None:
        nonlocal done
        done += steps
        progress("designs", done / count)

    with _placed("scheduler"):
        found = study(problem, executor=executor, advance=advance)
        if scheduler is not None and not found.pieces:
            raise InputError(
                "scheduler", "has nothing to do: these designs are known at once", "leave it out"
            )
    numeric = any(grid.numeric and len(grid.values) > 1 for grid in problem.grids)
    try:
        with _placed("vary"):
            goal, best = problem.objective, found.best()
        with _placed("uncertain"):
            sure = robust(found.designs, goal, intervals) if intervals else None
        design = found.design(best)
        return DesignResult(
            study=found,
            why=reason(design, goal),
            front=names,
            optimum=optimum(found) if numeric else None,
            robust=sure,
            influences=influences(design, goal) if goal.kind is not Kind.LAPS else (),
            work_folder=folder,
            dropped=_dropped(front, names),
        )
    except SlipmarginError:
        clear(folder)  # what is refused leaves nothing behind
        raise


def _several(texts: Sequence[str] | str) -> tuple[str, ...]:
    return (texts,) if isinstance(texts, str) else tuple(texts)


def _problem(
    robot: RobotLike, surface: str, vary: Sequence[str], goal_name: str, static: bool, laps: bool
) -> DesignProblem:
    from slipmargin.io.toml_table import one_of
    from slipmargin.study.objectives import Kind, objective
    from slipmargin.study.robot_on_surface import RobotOnSurface
    from slipmargin.study.study import DesignProblem
    from slipmargin.study.vary import parse_vary, product

    recipe = read_robot(robot)
    one_of("surface", surface, [s.name for s in recipe.robot.surfaces])
    design = RobotOnSurface(recipe=recipe, surface=surface)
    with _placed("vary"):
        grids = tuple(parse_vary(text) for text in vary)
        product(design, grids)
    with _placed("objective"):
        goal = objective(goal_name)
    kinds = (Kind.STATIC,) if static else (Kind.STATIC, Kind.MOTION)
    return DesignProblem(
        base=design, grids=grids, objective=goal, kinds=(*kinds, Kind.LAPS) if laps else kinds
    )


def _intervals(texts: Sequence[str], grids: Sequence[Vary]) -> tuple[Interval, ...]:
    from slipmargin.study.robust import parse_interval

    with _placed("uncertain"):
        intervals = tuple(parse_interval(text) for text in texts)
        both = next((i.quantity.key for i in intervals if i.quantity.key in [g.key for g in grids]), None)
        if both is not None:
            raise InputError(both, "is varied as well", "either choose it or leave it uncertain")
    return intervals


def _front(front: Sequence[str] | str, problem: DesignProblem) -> tuple[str, ...]:
    from slipmargin.study.objectives import objective

    with _placed("front"):
        goals = [objective(name) for name in _asked(front)]
    there, goal = problem.needed(), problem.objective
    found = tuple(g.name for g in goals if g.kind in there)
    if len(found) < 2:
        return (goal.name, "f_mean" if goal.name != "f_mean" else "f_worst")
    return found


def _asked(front: Sequence[str] | str) -> list[str]:
    return [name.strip() for name in (front.split(",") if isinstance(front, str) else front)]


def _dropped(front: Sequence[str] | str, names: tuple[str, ...]) -> tuple[str, ...]:
    """What to say of objectives that were asked for and that this study does not compute."""
    if front == _FRONT:
        return ()
    lost = [name for name in _asked(front) if name not in names]
    if not lost:
        return ()
    return (f"front: {', '.join(lost)} is not computed in this study, the front is of {' and '.join(names)}",)


@contextlib.contextmanager
def _placed(argument: str) -> Iterator[None]:
    """A fault inside is one of this argument; what it named itself stands behind."""
    try:
        yield
    except InputError as fault:
        if fault.source:
            raise
        inner = "" if fault.place == argument else fault.place
        raise InputError(f"{argument} {inner}".rstrip(), fault.problem, fault.cure) from None
