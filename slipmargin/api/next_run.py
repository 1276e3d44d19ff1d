"""``slipmargin.next_run``: the runs to drive next, chosen by what a diagnosis leaves open."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.result import FolderResult
from slipmargin.api.robots import checked_margin
from slipmargin.checks import from_zero, real
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.data.data_set import DataSet
    from slipmargin.experiment.result import NextRuns
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page

#: More runs than this are no choice but a list.
_MOST_RUNS, _RUNS = 20, 3
#: Slip margin that proposed motions keep by default [1].
_MARGIN = 0.1
_PULLS_ALONE = "has no effect: the data set holds pulls and no runs"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class NextRunResult(FolderResult):
    """The runs to drive next, what was compared, and what is expected of them.

    ``next_runs.runs`` hold each a ``trajectory`` with wheel speeds that :func:`slipmargin.simulate` and a
    robot can follow; ``next_runs.separations`` say how far the explanations are apart before and after.
    """

    next_runs: NextRuns
    warnings: tuple[str, ...] = ()

    def summary(self) -> str:
        """What is open and what the runs will do about it."""
        from slipmargin.report.next_run import answer

        return f"next runs for {self.next_runs.data_set}: {answer(self.next_runs)}"

    def lines(self) -> list[str]:
        """The question, each run, what is expected of them."""
        from slipmargin.report.next_run import lines

        return lines(self.next_runs)

    def to_dict(self) -> dict[str, Any]:
        """Everything as numbers."""
        from slipmargin.report.next_run import report

        return report(self.next_runs)

    def plot(self) -> Figure:
        """The proposed runs on the floor."""
        from slipmargin.plots.next_run import next_runs_figure

        if not self.next_runs.runs:
            raise InputError("plot", "there are no runs to draw, only pulls", "use lines()")
        return next_runs_figure(self.next_runs)

    def page(self) -> Page:
        """The report: what is open, the runs on the floor, what is expected, what to do next."""
        from slipmargin.plots.style import images
        from slipmargin.report.next_run import page

        figures = {"floor": self.plot()} if self.next_runs.runs else {}
        return page(self.next_runs, images(figures), self.warnings)

    def files(self) -> dict[str, str | bytes]:
        """File name → content: each run as ``plan`` writes one, and each of its legs as ``plan`` reads it."""
        from slipmargin.io.table import columns_text

        made: dict[str, str | bytes] = {}
        for run in self.next_runs.runs:
            made[f"{run.name}.csv"] = columns_text(run.trajectory.columns(), digits=12)
            for k, leg in enumerate(run.legs, 1):
                columns = dict(zip(("x_m", "y_m", "phi_rad"), np.asarray(leg).T, strict=True))
                made[f"{run.name}-path-{k}.csv"] = columns_text(columns)
        return made


def next_run(
    data_set: DataSet | Path | str,
    *,
    space_m: tuple[float, float] | None = None,
    runs: int = _RUNS,
    margin: float = _MARGIN,
    longest_s: float | None = None,
    max_speed_m_s: float | None = None,
    max_yaw_rate_rad_s: float | None = None,
    seed: int = 0,
    progress: Callable[[str, float], None] = lambda stage, share: None,
    budget_s: float | None = None,
    picture: bool = False,
) -> NextRunResult:
    """The runs that would tell most of what a diagnosis of the data set leaves open.

    Where several explanations are left, the runs are chosen so that the pair that is hardest to tell apart
    is told apart best; where there is one, so that its widest interval becomes narrowest; where nothing is
    missing, so that what could hide becomes smallest.

    Parameters
    ----------
    data_set : DataSet, str or Path
        A data set, or the folder of one, as :func:`slipmargin.diagnose` takes it; no campaign.
    space_m : (2,), optional
        Sides of the floor along x and y [m], about the middle of the runs; the robot's wheels stay inside.
        By default what the runs have covered.
    runs : int
        How many runs to propose, 1 to 20.
    margin : float
        Share of the grip kept in reserve by every explanation that is left, 0 to below 1.
    longest_s : float, optional
        Longest run [s]; by default as long as the longest one of the data set, 5 s at least.
    max_speed_m_s, max_yaw_rate_rad_s : float, optional
        Caps [m/s, rad/s].
    seed : int
        Seed of the diagnosis, and of the wheel angles at which proposed runs start.
    progress : callable
        Called with the name of each stage and the share of it that is done (0 to 1).
    budget_s : float, optional
        Seconds after which the search for explanations stops with the best so far.
    picture : bool
        Whether the result is to be drawn: refused for pulls alone, which have no runs to draw.

    Returns
    -------
    NextRunResult

    Raises
    ------
    InputError
        For a fault in the data set or an argument, where the robot does not fit into the space, and where no
        motion of the list keeps every limit there.

    Examples
    --------
    >>> import slipmargin as sm
    >>> found = sm.next_run("measured-runs", space_m=(3.0, 2.0))  # doctest: +SKIP
    >>> found.write_folder("next")  # doctest: +SKIP
    """
    from slipmargin.api.diagnose import check_sense, read_data
    from slipmargin.data.clean_up import repaired
    from slipmargin.diagnosis.turned import FRAME, data_set_in
    from slipmargin.diagnosis.watch import Watch, cut_short
    from slipmargin.experiment.motions import Space, checked_space, reach_m
    from slipmargin.experiment.next_runs import Request, next_runs
    from slipmargin.experiment.turned import next_runs_in
    from slipmargin.robot.warnings import NO_SPREAD, unused

    if isinstance(runs, bool) or not isinstance(runs, int) or not 1 <= runs <= _MOST_RUNS:
        raise InputError("runs", f"is {runs}", f"give a whole number from 1 to {_MOST_RUNS}")
    from_zero("seed", seed)
    size = None if space_m is None else checked_space("space", space_m)
    share = 1.0 - checked_margin(margin)
    caps = [
        np.inf
        if value is None
        else real(name, value, above=0.0, cure="give a positive number, or leave it out")
        for name, value in (
            ("longest_s", longest_s),
            ("max_speed_m_s", max_speed_m_s),
            ("max_yaw_rate_rad_s", max_yaw_rate_rad_s),
        )
    ]
    data, source = read_data(data_set)
    if data.members:
        raise InputError("", "is a campaign", "give one of the data sets that it names", source)
    own = data.recipe.robot.convention
    if not data.trials:
        if picture:
            raise InputError("picture", _PULLS_ALONE, "leave it out")
        check_sense(data, source)
        given = {
            "runs": runs != _RUNS,
            "margin": margin != _MARGIN,
            "space_m": space_m is not None,
            "longest_s": longest_s is not None,
            "max_speed_m_s": max_speed_m_s is not None,
            "max_yaw_rate_rad_s": max_yaw_rate_rad_s is not None,
        }
        unused_here = tuple(f"{name} {_PULLS_ALONE}" for name, on in given.items() if on)
        return _pulls(data, source, share, seed, progress, budget_s, unused_here)
    if size is not None:  # what is too small is refused before the work, in the file's axes
        Space(middle_m=(0.0, 0.0), size_m=size).room_m(reach_m(data.recipe.build(data.surface)))
    mended = repaired(data_set_in(data, FRAME))
    check_sense(data_set_in(mended.data_set, own), source)
    request = Request(
        runs=runs,
        size_m=size if size is None or own is FRAME else (size[1], size[0]),
        share=share,
        longest_s=None if longest_s is None else caps[0],
        max_speed_m_s=caps[1],
        max_yaw_rate_rad_s=caps[2],
        seed=seed,
    )
    found = next_runs(mended.data_set, request, mended.repairs, Watch.of(progress, budget_s))
    cut = cut_short(budget_s) if found.was_cut else ()
    warnings = (*cut, *unused(data.recipe.robot, data.surface, spread=NO_SPREAD, band=False))
    return NextRunResult(next_runs=next_runs_in(found, FRAME, own), warnings=warnings)


def _pulls(
    data: DataSet,
    source: str,
    share: float,
    seed: int,
    progress: Callable[[str, float], None],
    budget_s: float | None,
    warnings: tuple[str, ...],
) -> NextRunResult:
    """Which pulls to make next: what a diagnosis of pulls says already."""
    from slipmargin.diagnosis.pull_diagnosis import diagnose_pulls, of_unused
    from slipmargin.diagnosis.watch import cut_short
    from slipmargin.experiment.motions import reach_m
    from slipmargin.experiment.result import NextRuns

    try:
        found = diagnose_pulls(data, seed=seed, progress=progress, budget_s=budget_s)
    except InputError as fault:
        raise fault if fault.source else fault.in_file(source) from None
    names = " + ".join(f.label for f in found.findings) or "the model as believed"
    made = NextRuns(
        data_set=data.name,
        robot=data.recipe.robot.name,
        surface=data.surface,
        verdict=found.verdict,
        question=None,
        explanations=(names,),
        runs=(),
        separations=(),
        narrowings=(),
        compared=0,
        space=None,
        reach_m=reach_m(data.recipe.build(data.surface)),
        share=share,
        misfit=max(1.0, found.after.chi),
        noise=np.full(3, np.nan),
        front_rad=data.recipe.robot.convention.front_rad,
        pulls=found.next_pulls,
    )
    cut = cut_short(budget_s) if found.was_cut else ()
    return NextRunResult(next_runs=made, warnings=(*cut, *of_unused(data), *warnings))
