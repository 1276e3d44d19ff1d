"""``slipmargin.compare``: which of several robots is best at what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, model_of, read_robot
from slipmargin.errors import InputError
from slipmargin.robot.warnings import FRICTION_SPREAD

if TYPE_CHECKING:
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page
    from slipmargin.study.ideas import Idea

#: The most robots that are put side by side: more fit neither a picture nor a table.
MOST = 12


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CompareResult(Result):
    """Several robots on one floor: starting, driving, braking, cornering, turning, pushing, battery."""

    surface: str
    ideas: tuple[Idea, ...]
    warnings: tuple[str, ...]

    def best(self, key: str = "start_worst_m_s2") -> list[str]:
        """The names of the best at a question, several where they are alike; empty where none has a value."""
        from slipmargin.study.ideas import QUESTIONS, ranking

        question = next((q for q in QUESTIONS if q.key == key), None)
        if question is None:
            raise InputError("key", f"is {key!r}", f"use one of: {', '.join(q.key for q in QUESTIONS)}")
        found = ranking(self.ideas, question)
        return [] if found is None else [self.ideas[k].name for k in sorted(found.order[: found.alike])]

    def summary(self) -> str:
        """Who is best at starting."""
        from slipmargin.report.ideas import verdicts

        return (
            f"{len(self.ideas)} ideas on {self.surface}: starting: {dict(verdicts(self.ideas))['starting']}"
        )

    def lines(self) -> list[str]:
        """A sentence for each question, then where each centre of mass should go."""
        from slipmargin.report.ideas import moves, verdicts

        lines = [f"{word:<11} {text}" for word, text in verdicts(self.ideas)]
        return [*lines, *(f"{'':<11} {text}" for text in moves(self.ideas))]

    def table_lines(self) -> list[str]:
        """A row an idea; a star marks the best, or all that are alike."""
        from slipmargin.report.ideas import table
        from slipmargin.report.text import columns

        return [*columns(*table(self.ideas)), "* the best, or all that are alike"]

    def table_text(self) -> str:
        """A row an idea, with the standard deviation of each value by the uncertain friction."""
        from slipmargin.io.table import columns_text
        from slipmargin.study.ideas import PLACE, QUESTIONS

        found: dict[str, Any] = {"idea": [idea.name for idea in self.ideas]}
        for q in QUESTIONS:
            found[q.key] = [idea.values[q.key] for idea in self.ideas]
            if q.key != PLACE:
                found[f"sd_{q.key}"] = [idea.deviation(q.key) for idea in self.ideas]
        return columns_text(found)

    def plot(self) -> Figure:
        """A panel a question, a bar an idea."""
        from slipmargin.plots.ideas import ideas_figure

        return ideas_figure(self.ideas)

    def page(self) -> Page:
        """The page that compares them."""
        from slipmargin.plots.ideas import ideas_panels
        from slipmargin.plots.style import images
        from slipmargin.report.ideas import ideas_page

        return ideas_page(self.ideas, images(ideas_panels(self.ideas)), self.lines(), self.warnings)

    def to_dict(self) -> dict[str, Any]:
        """Values, standard deviations and places as plain data."""
        from slipmargin.study.ideas import QUESTIONS

        return {
            "schema": 1,
            "surface": self.surface,
            "questions": [{"key": q.key, "word": q.word, "unit": q.unit} for q in QUESTIONS],
            "ideas": [
                {
                    "name": idea.name,
                    "robot": idea.design.robot.name,
                    "values": {q.key: idea.values[q.key] for q in QUESTIONS},
                    "sd": {q.key: idea.deviation(q.key) for q in QUESTIONS},
                    "place": None
                    if idea.place is None
                    else {
                        "com_m": idea.place.own_m,
                        "best_m": idea.place.best_m,
                        "start_m_s2": idea.place.own_m_s2,
                        "best_start_m_s2": idea.place.best_m_s2,
                    },
                }
                for idea in self.ideas
            ],
            "best": {q.key: self.best(q.key) for q in QUESTIONS},
        }


def compare(robots: Sequence[RobotLike], surface: str) -> CompareResult:
    """Which of several robots is best at starting, driving, braking, cornering, turning and pushing.

    Robots whose difference may be chance are called alike: where their files give friction with a spread,
    within 95 % of what it makes; else within half a percent (the battery's place: one percent).

    Parameters
    ----------
    robots : sequence of str, Path, Recipe or Robot
        Two to twelve: built-in names, robot files, or what :func:`slipmargin.read_robot` returned.
    surface : str
        A surface that every one of them has.

    Returns
    -------
    CompareResult
        ``ideas`` hold ``values`` by question, ``deviation(key)`` and ``place``; ``best(key)`` names the best.

    Raises
    ------
    InputError
        For a fault in a robot file, a surface that one of them lacks, or fewer than two robots.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.compare(["ohio-kiwi", "ohio-kiwi-symmetric"], "paper").best("push_N")
    ['ohio-kiwi-symmetric']
    """
    from slipmargin.study.ideas import compare as compared
    from slipmargin.study.robot_on_surface import RobotOnSurface

    if not 2 <= len(robots) <= MOST:
        raise InputError("robots", f"{len(robots)} given", f"give 2 to {MOST} robots to compare")
    recipes = [read_robot(one) for one in robots]
    names = [
        Path(one).stem if isinstance(one, str | Path) else recipe.robot.name
        for one, recipe in zip(robots, recipes, strict=True)
    ]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            "robots", f"{twice!r} is given twice", "give each idea a file with a name of its own"
        )
    warnings: list[str] = []
    for name, recipe in zip(names, recipes, strict=True):
        try:
            said = model_of(recipe, surface, spread=FRICTION_SPREAD, band=True)[1]
        except InputError as fault:
            if fault.place == "surface" and not fault.source:
                raise InputError("surface", f"{fault.problem}, which {name} has not", fault.cure) from None
            raise InputError(f"{name}: {fault.place}", fault.problem, fault.cure, fault.source) from None
        warnings += [f"{name}: {line}" for line in said]
    designs = [RobotOnSurface(recipe=recipe, surface=surface) for recipe in recipes]
    return CompareResult(surface=surface, ideas=compared(names, designs), warnings=tuple(warnings))
