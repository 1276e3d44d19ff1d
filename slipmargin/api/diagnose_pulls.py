"""``slipmargin.diagnose`` of a data set that holds pulls alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.diagnosed import Diagnosed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from slipmargin.diagnosis.limits_change import LimitsChange
    from slipmargin.diagnosis.pull_diagnosis import PullDiagnosis
    from slipmargin.effects import Recipe


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PullDiagnosisResult(Diagnosed):
    """What the model lacks by its pulls, the evidence, and the limits before and after."""

    diagnosis: PullDiagnosis
    change: LimitsChange

    @property
    def verdict(self) -> str:
        """``effect-found``, ``no-missing-effect`` or ``unexplained``."""
        return self.diagnosis.verdict.value

    @property
    def corrected(self) -> Recipe:
        """The robot with the effects that were found: every other function accepts it."""
        return self.diagnosis.corrected

    def summary(self) -> str:
        """The verdict in one sentence."""
        from slipmargin.report.pulls import verdict_sentence

        return f"diagnosis of {self.diagnosis.data_set}: {verdict_sentence(self.diagnosis)}"

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

    def corrected_text(self) -> str:
        """The corrected robot file as TOML text."""
        from slipmargin.io.robot_text import write_recipe
        from slipmargin.report.pulls import verdict_sentence

        d = self.diagnosis
        return write_recipe(
            d.corrected,
            f"{d.recipe.robot.name}, corrected by slipmargin diagnose from the pulls of {d.data_set}.\n"
            f"{verdict_sentence(d)}",
        )

    def files(self) -> dict[str, str | bytes]:
        """File name → content: report.html first, then corrected.toml, report.json and the figures."""
        from slipmargin.plots.style import image
        from slipmargin.report.page import html, pictures
        from slipmargin.report.pulls import page

        images = {name: image(figure, png=True) for name, figure in self.figures().items()}
        built = page(self.diagnosis, self.change, images)
        return {
            "report.html": html(built),
            "corrected.toml": self.corrected_text(),
            "report.json": self.to_json(),
            **dict(sorted(pictures(built).items())),
        }
