"""``slipmargin.diagnose``: what physics the model lacks, judged by measured runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.diagnosed import Diagnosed
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.api.diagnose_pulls import PullDiagnosisResult
    from slipmargin.data.data_set import DataSet
    from slipmargin.diagnosis.campaign import MemberResult
    from slipmargin.diagnosis.limits_change import LimitsChange
    from slipmargin.diagnosis.result import Diagnosis
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Image, Page


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DiagnosisResult(Diagnosed):
    """What the model lacks, the evidence, and the limits before and after."""

    diagnosis: Diagnosis
    change: LimitsChange
    members: tuple[MemberResult, ...] = ()  #: the data sets of a campaign; empty for a single one

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the robot file says and a diagnosis does not use."""
        from slipmargin.robot.warnings import NO_SPREAD, unused

        d = self.diagnosis
        return unused(d.recipe.robot, d.surface, spread=NO_SPREAD, band=False)

    def _sentence(self) -> str:
        from slipmargin.report.diagnosis_words import verdict_sentence

        return verdict_sentence(self.diagnosis)

    def _source(self) -> str:
        return f"the data set {self.diagnosis.data_set}"

    def _page(self, images: dict[str, Image]) -> Page:
        from slipmargin.report.diagnosis_page import page

        built = page(self.diagnosis, self.change, images)
        if not self.members:
            return built
        from slipmargin.report.campaign import section

        first, *others = built.sections
        return replace(built, sections=(first, section(self.diagnosis, self.members), *others))

    def lines(self) -> list[str]:
        """Verdict, effects, error and limits before and after."""
        from slipmargin.report.diagnosis_words import summary_lines

        told = summary_lines(self.diagnosis, self.change)
        if self.members:
            from slipmargin.report.campaign import lines

            told += lines(self.diagnosis, self.members)
        return told

    def to_dict(self) -> dict[str, Any]:
        """What ``report.json`` holds."""
        from slipmargin.report.diagnosis_json import report

        told = report(self.diagnosis, self.change)
        if self.members:
            from slipmargin.report.campaign import as_json

            told["campaign"] = as_json(self.diagnosis, self.members)
        return told

    def files(self) -> dict[str, str | bytes]:
        """File name → content; of a campaign also the corrected robot of each data set."""
        from slipmargin.io.robot_text import write_recipe

        made = Diagnosed.files(self)
        for m in self.members:
            head = f"{m.corrected.robot.name}, corrected by slipmargin diagnose: {m.member.name}."
            made[f"corrected-{m.member.name}.toml"] = write_recipe(m.corrected, head)
        return made

    def figures(self) -> dict[str, Figure]:
        """Every figure by name: residual, where, candidates, held-out, limits; empty ones are left out."""
        from slipmargin.plots.diagnosis import figures

        return figures(self.diagnosis, self.change)

    def plot(self) -> Figure:
        """Measured and predicted paths and headings of held-out runs."""
        from slipmargin.plots.diagnosis import held_out_figure

        return held_out_figure(self.diagnosis)


def diagnose(
    data_set: DataSet | Path | str,
    *,
    seed: int = 0,
    progress: Callable[[str, float], None] = lambda stage, share: None,
    budget_s: float | None = None,
) -> DiagnosisResult | PullDiagnosisResult:
    """What the model lacks, proved on runs (or, without runs, on pulls) that no fit has seen.

    Parameters
    ----------
    data_set : DataSet, str or Path
        A data set, or the folder of one (``dataset.toml``, the robot file, ``trials/*.csv``, ``pulls.csv``
        or both), or a campaign: a TOML file that names several data sets of one robot and says which floor,
        loading and instrument each has (see :mod:`slipmargin.io.campaign_file`).
    seed : int
        Seed of everything random, from 0; the same data and seed give the same result.
    progress : callable
        Called with the name of each stage and the share of it that is done (0 to 1).
    budget_s : float, optional
        Seconds after which the search stops and the best answer so far is given as such.

    Returns
    -------
    DiagnosisResult, or PullDiagnosisResult where there are pulls alone
        ``verdict``, ``diagnosis.findings``, ``corrected`` (a robot for all other functions), ``change``
        (limits before and after).

    Raises
    ------
    InputError
        For a fault in the data set, also where its runs show wrong units, swapped wheels or a mirrored
        frame.  What the data show how to mend is mended and reported (``diagnosis.repairs``).

    Examples
    --------
    >>> import slipmargin as sm
    >>> found = sm.diagnose("measured-runs")  # doctest: +SKIP
    >>> sm.sweep(found.corrected, "paper")  # doctest: +SKIP
    """
    from slipmargin.checks import from_zero
    from slipmargin.data.clean_up import repaired
    from slipmargin.diagnosis.limits_change import limits_change
    from slipmargin.diagnosis.loop import diagnose as search
    from slipmargin.diagnosis.turned import FRAME, change_in, data_set_in, diagnosis_in

    from_zero("seed", seed)
    data, source = read_data(data_set)
    if data.members:
        return _campaign(data, source, seed, progress, budget_s)
    if not data.trials:
        check_sense(data, source)
        return _pulls(data, source, seed, progress, budget_s)
    turned = data_set_in(data, FRAME)
    mended = repaired(turned)
    check_sense(data_set_in(mended.data_set, data.recipe.robot.convention), source)
    diagnosis = search(
        mended.data_set, seed=seed, progress=progress, repairs=mended.repairs, budget_s=budget_s
    )
    progress("limits before and after", 0.2)
    change = limits_change(diagnosis.recipe, diagnosis.corrected, diagnosis.surface, turned.pulls)
    return DiagnosisResult(
        diagnosis=diagnosis_in(diagnosis, data.recipe), change=change_in(change, data.recipe.robot.convention)
    )


def _campaign(
    data: DataSet, source: str, seed: int, progress: Callable[[str, float], None], budget_s: float | None
) -> DiagnosisResult:
    from slipmargin.data.campaign import apart, each
    from slipmargin.data.clean_up import repaired
    from slipmargin.diagnosis.campaign import by_group
    from slipmargin.diagnosis.limits_change import limits_change
    from slipmargin.diagnosis.loop import diagnose as search

    data, repairs = each(data, lambda d: ((mended := repaired(d)).data_set, mended.repairs))
    for member in apart(data):
        check_sense(member, f"{source}: {member.name}")
    diagnosis = search(data, seed=seed, progress=progress, repairs=repairs, budget_s=budget_s)
    progress("evidence of each data set", 0.2)
    diagnosis, members = by_group(data.members, diagnosis)
    progress("limits before and after", 0.2)
    change = limits_change(diagnosis.recipe, diagnosis.corrected, diagnosis.surface)
    return DiagnosisResult(diagnosis=diagnosis, change=change, members=members)


def _pulls(
    data: DataSet, source: str, seed: int, progress: Callable[[str, float], None], budget_s: float | None
) -> PullDiagnosisResult:
    from slipmargin.api.diagnose_pulls import PullDiagnosisResult
    from slipmargin.diagnosis.limits_change import limits_change
    from slipmargin.diagnosis.pull_diagnosis import diagnose_pulls

    try:
        found = diagnose_pulls(data, seed=seed, progress=progress, budget_s=budget_s)
    except InputError as fault:
        raise fault if fault.source else fault.in_file(source) from None
    progress("limits before and after", 0.2)
    change = limits_change(found.recipe, found.corrected, found.surface)
    return PullDiagnosisResult(diagnosis=found, change=change)


def read_data(data_set: DataSet | Path | str) -> tuple[DataSet, str]:
    """A data set or campaign, read where a place is given, and what messages call it."""
    if isinstance(data_set, Path | str):
        from slipmargin.io.campaign_file import campaign_file, read_joined
        from slipmargin.io.data_set import read_data_set

        campaign = campaign_file(Path(data_set))
        if campaign is not None:
            return read_joined(campaign), str(campaign)
        return read_data_set(Path(data_set)), str(data_set)
    return data_set, data_set.name


def check_sense(data_set: DataSet, source: str) -> None:
    """Refuse data whose fault is not the robot's: wrong units, swapped wheels, a mirrored frame."""
    from slipmargin.data.checks import check_data_set
    from slipmargin.diagnosis.conditions import spins

    for fault in check_data_set(data_set):
        if fault.arrangement is not None and spins(data_set, fault.arrangement):
            continue
        raise InputError(fault.place, fault.problem, f"likely cause: {fault.cause}", source)
