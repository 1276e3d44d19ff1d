"""``slipmargin.reproduce``: every number and claim of the 2002 paper beside ours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import FolderResult

if TYPE_CHECKING:
    from slipmargin.paper.reproduction import Reproduction
    from slipmargin.plots.style import Figure


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ReproductionResult(FolderResult):
    """The paper's numbers and claims, each with ours and a verdict."""

    done: Reproduction

    def summary(self) -> str:
        """How many rows are reproduced, differ or cannot be checked."""
        from slipmargin.report.reproduction import verdict_counts

        return f"reproduction of Williams et al. 2002: {verdict_counts(self.done)}"

    def lines(self) -> list[str]:
        """The tables of numbers, claims and values of Fig. 8, with their notes."""
        from slipmargin.report.reproduction import report_lines

        return report_lines(self.done)

    def to_dict(self) -> dict[str, Any]:
        """What ``reproduce.json`` holds."""
        from slipmargin.report.reproduction import reproduction_report

        return reproduction_report(self.done, sorted(self.figures()))

    def figures(self) -> dict[str, Figure]:
        """File name → figure: Figs 6 to 10, the spread over rotor angles, and the study where asked for."""
        from slipmargin.plots.reproduction import paper_figures

        return paper_figures(self.done)

    def plot(self) -> Figure:
        """Fig. 8: F_emax over the orientation on both surfaces."""
        return self.figures()["fig8.png"]

    def files(self) -> dict[str, str | bytes]:
        """``reproduce.json`` and the figures: file name → content."""
        from slipmargin.plots.style import picture

        figures: dict[str, str | bytes] = {n: picture(f, "png") for n, f in self.figures().items()}
        return figures | {"reproduce.json": self.to_json()}


def reproduce(
    *,
    seed: int = 0,
    search: bool = False,
    identifiability: bool = False,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> ReproductionResult:
    """Every printed number and claim of Williams et al. (2002), computed again with a verdict each.

    Parameters
    ----------
    seed : int
        Seed of all random draws, from 0.
    search : bool
        Whether to search again for what the paper does not print (radius, inertia, rotor angles).
    identifiability : bool
        Whether to study what the printed results leave open, about 20 000 runs.
    progress : callable
        Called with the name of the stage and the share that is done (0 to 1).

    Returns
    -------
    ReproductionResult
        ``done.numbers`` and ``done.claims``: rows with published and recomputed value and a verdict.

    Raises
    ------
    InputError
        For a negative seed.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.reproduce()  # doctest: +SKIP
    <reproduction of Williams et al. 2002: 31 reproduced, 7 differ, 23 cannot be checked>
    """
    from slipmargin.checks import from_zero
    from slipmargin.paper.reproduction import reproduce_paper, steps

    from_zero("seed", seed)
    count, total = 0, steps(search=search, study=identifiability)

    def advance() -> None:
        nonlocal count
        count += 1
        progress("the paper again", count / total)

    done = reproduce_paper(seed=seed, search=search, study=identifiability, advance=advance)
    return ReproductionResult(done=done)
