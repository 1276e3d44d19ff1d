"""``slipmargin.diagnose`` of a data set that holds pulls alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.diagnosed import Diagnosed

if TYPE_CHECKING:
    from slipmargin.diagnosis.limits_change import LimitsChange
    from slipmargin.diagnosis.pull_diagnosis import PullDiagnosis
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Image, Page


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PullDiagnosisResult(Diagnosed):
    """What the model lacks by its pulls, the evidence, and the limits before and after."""

    diagnosis: PullDiagnosis
    change: LimitsChange

    def _sentence(self) -> str:
        from slipmargin.report.pulls import verdict_sentence

        return verdict_sentence(self.diagnosis)

    def _source(self) -> str:
        return f"the pulls of {self.diagnosis.data_set}"

    def _page(self, images: dict[str, Image]) -> Page:
        from slipmargin.report.pulls import page

        return page(self.diagnosis, self.change, images)

    def lines(self) -> list[str]:
        """Verdict, effects, error and limits before and after, the pulls to make next."""
        from slipmargin.report.pulls import summary_lines

        return summary_lines(self.diagnosis, self.change)

    def to_dict(self) -> dict[str, Any]:
        """What ``report.json`` holds."""
        from slipmargin.report.pulls import report

        return report(self.diagnosis, self.change)

    def figures(self) -> dict[str, Figure]:
        """Every figure by name: pulls, limits; empty ones are left out."""
        from slipmargin.plots.pulls import figures

        return figures(self.diagnosis, self.change)

    def plot(self) -> Figure:
        """Measured and predicted pulls over the orientation."""
        from slipmargin.plots.pulls import pulls_figure

        return pulls_figure(self.diagnosis)
