"""What the results of every diagnosis share: verdict, corrected robot, a folder of files, the report."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from slipmargin.api.result import FolderResult, Result

if TYPE_CHECKING:
    from slipmargin.diagnosis.limits_change import LimitsChange
    from slipmargin.diagnosis.pull_diagnosis import PullDiagnosis
    from slipmargin.diagnosis.result import Diagnosis
    from slipmargin.effects import Recipe
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Image, Page


class Diagnosed(FolderResult):
    """Base of the results of a diagnosis; a subclass says of what it is, in a sentence and on a page."""

    __slots__ = ()
    diagnosis: Diagnosis | PullDiagnosis
    change: LimitsChange

    @property
    def verdict(self) -> str:
        """``effect-found``, ``no-missing-effect`` or ``unexplained``."""
        return self.diagnosis.verdict.value

    @property
    def corrected(self) -> Recipe:
        """The robot with the effects that were found: every other function accepts it."""
        return self.diagnosis.corrected

    @abstractmethod
    def figures(self) -> dict[str, Figure]:
        """Every figure by name; empty ones are left out."""

    @abstractmethod
    def _sentence(self) -> str:
        """The verdict as a sentence."""

    @abstractmethod
    def _source(self) -> str:
        """What was measured, and its name."""

    @abstractmethod
    def _page(self, images: dict[str, Image]) -> Page:
        """The page of the report."""

    def summary(self) -> str:
        """The verdict in one sentence."""
        return f"diagnosis of {self.diagnosis.data_set}: {self._sentence()}"

    def corrected_text(self) -> str:
        """The corrected robot file as TOML text."""
        from slipmargin.io.robot_text import write_recipe

        name = self.diagnosis.recipe.robot.name
        head = f"{name}, corrected by slipmargin diagnose from {self._source()}."
        return write_recipe(self.diagnosis.corrected, f"{head}\n{self._sentence()}")

    def files(self) -> dict[str, str | bytes]:
        """File name → content: report.html first, then corrected.toml, report.json and the figures."""
        from slipmargin.plots.style import image
        from slipmargin.report.page import html, pictures

        images = {name: image(figure, png=True) for name, figure in self.figures().items()}
        built = self._page(images)
        return {
            "report.html": html(built),
            "corrected.toml": self.corrected_text(),
            "report.json": self.to_json(),
            **dict(sorted(pictures(built).items())),
        }

    def write(self, path: Path | str) -> None:
        """Write ``.toml`` (the corrected robot), ``.json`` (the report) or a picture.

        Raises
        ------
        InputError
            For another ending, or where the file cannot be written.
        """
        if Path(path).suffix.lower() == ".toml":
            self.write_files(texts={path: self.corrected_text()})
        else:
            Result.write(self, path)
