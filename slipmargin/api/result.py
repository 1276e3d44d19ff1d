"""What every result of the front door can do: say itself, become plain data, be drawn and be written."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.plots.style import Figure
    from slipmargin.report.page import Page


def head(robot: str, surface: str, margin: float | None = None) -> dict[str, Any]:
    """What ``to_dict`` of a result begins with: form, robot, floor, and margin where it has one."""
    found: dict[str, Any] = {"schema": 1, "robot": robot, "surface": surface}
    return found if margin is None else {**found, "margin": margin}


class Result(ABC):
    """Base of all results; a result overrides what it has."""

    __slots__ = ()

    @abstractmethod
    def summary(self) -> str:
        """The answer in one line, with its unit."""

    @abstractmethod
    def lines(self) -> list[str]:
        """The lines that the command prints, the answer first."""

    def table_lines(self) -> list[str]:
        """The table that the command prints below them; empty where there is none."""
        return []

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data with arrays: what ``--json`` writes."""

    def to_json(self) -> str:
        """:meth:`to_dict` as JSON text; a number that is not finite is null, and ``not_given`` says why."""
        from slipmargin.io.json_text import json_text
        from slipmargin.report.not_given import with_reasons

        return json_text(with_reasons(self.to_dict()))

    def plot(self) -> Figure:
        """The picture that ``--plot`` writes, as a matplotlib figure that belongs to no window."""
        raise InputError("plot", f"a {type(self).__name__} has no picture", "use lines() or to_dict()")

    def table_text(self) -> str:
        """The table that ``--out`` writes, as CSV text."""
        raise InputError("write", f"a {type(self).__name__} has no table", "write a .json file")

    def page(self) -> Page:
        """The page that ``--report`` writes, as data: verdict, numbers, picture, table, what to do next."""
        raise InputError("report", f"a {type(self).__name__} has no report page", "use lines() or to_dict()")

    def page_text(self, made: str = "") -> str:
        """:meth:`page` as one self-contained HTML page.

        Parameters
        ----------
        made : str
            When, by which version and how the page was made; stands at its end.
        """
        from slipmargin.report.page import html

        page = self.page()
        return html(replace(page, foot=" ".join(part for part in (page.foot, made) if part)))

    def write(self, path: Path | str) -> None:
        """Write the result whole or not at all; the file's ending says what is written.

        ``.json``: :meth:`to_dict`; ``.png``, ``.svg`` or ``.pdf``: :meth:`plot`; ``.csv``: the table;
        ``.html``: :meth:`page_text`.

        Raises
        ------
        InputError
            For another ending, or where the file cannot be written; the previous file is then untouched.
        """
        from slipmargin.io.writes import ENDINGS

        ending = Path(path).suffix.lower()
        if ending == ".json":
            self.write_files(json=path)
        elif ending in ENDINGS["picture"]:
            self.write_files(plot=path)
        elif ending == ".csv":
            self.write_files(table=path)
        elif ending in ENDINGS["page"]:
            self.write_files(texts={path: self.page_text()})
        else:
            raise InputError(
                "", f"ends in {ending!r}", "use .csv, .html, .json, .png, .svg or .pdf", str(path)
            )

    def write_files(
        self,
        *,
        table: Path | str | None = None,
        plot: Path | str | None = None,
        json: Path | str | None = None,
        texts: Mapping[Path | str, str | bytes] | None = None,
    ) -> None:
        """Write several files, all complete before the first replaces its predecessor.

        Parameters
        ----------
        table, plot, json
            Where the table (CSV), the picture and :meth:`to_dict` (JSON) go; None: not written.
        texts
            Further files, path to content.
        """
        from slipmargin.io.writes import check_format, write_together

        files: dict[Path | str, str | bytes] = dict(texts or {})
        if plot is not None:
            from slipmargin.plots.style import picture

            files[plot] = picture(self.plot(), check_format(plot))
        if table is not None:
            files[table] = self.table_text()
        if json is not None:
            files[json] = self.to_json()
        if files:
            write_together(files)

    def __repr__(self) -> str:
        return f"<{self.summary()}>"

    def _repr_html_(self) -> str:
        from slipmargin.report.page import cell

        drawn = None
        if type(self).plot is not Result.plot:
            from slipmargin.plots.style import image

            with suppress(InputError):  # nothing to draw in this one: the lines say the rest
                drawn = image(self.plot())
        return cell(self.summary(), self.lines(), drawn)


class FolderResult(Result):
    """Base of results that are written as a folder of files."""

    __slots__ = ()

    @abstractmethod
    def files(self) -> dict[str, str | bytes]:
        """File name → content; empty where there is nothing to write."""

    def write_folder(self, folder: Path | str) -> list[str]:
        """Write :meth:`files` into a folder, all or none, and return their names.

        Raises
        ------
        InputError
            Where the folder cannot be written; then nothing has changed.
        """
        from slipmargin.io.folder import write_folder

        files = self.files()
        if files:
            write_folder(folder, files)
        return list(files)
