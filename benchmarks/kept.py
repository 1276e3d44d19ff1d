"""What benchmark scripts are asked for, and rows that are kept as soon as they are known.

A benchmark that was stopped goes on from the rows that its file holds.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from slipmargin.io.writes import write_text

#: A job: its name, and what makes its row.
Job = tuple[str, Callable[[], dict[str, Any]]]


@dataclass(frozen=True, slots=True)
class Keeper:
    """Where rows go, and which of the jobs are this process's."""

    target: Path | None = None
    part: int = 1
    parts: int = 1

    @classmethod
    def of(cls, words: Sequence[str], doc: str | None) -> tuple[Self, list[str]]:
        """The keeper that a command line asks for, and the words that are left; ``--help`` prints ``doc``."""
        parser = _parser(doc)
        parser.add_argument(
            "--json", type=Path, metavar="FILE", help="keep the rows there, and go on from them"
        )
        parser.add_argument("--part", default="1/1", metavar="K/N", help="every N-th job, for N processes")
        given, left = parser.parse_known_args(words)
        part, parts = (int(number) for number in given.part.split("/"))
        return cls(given.json, part, parts), left

    def run(self, jobs: Sequence[Job]) -> list[dict[str, Any]]:
        """Every row of this part; a row bears its job's name as ``set``."""
        rows = (
            json.loads(self.target.read_text(encoding="utf-8"))
            if self.target is not None and self.target.exists()
            else []
        )
        done = {row["set"] for row in rows}
        for name, job in jobs[self.part - 1 :: self.parts]:
            if name in done:
                continue
            rows.append({"set": name} | job())
            if self.target is not None:
                write_text(self.target, json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
        return rows


def with_file(doc: str | None) -> argparse.ArgumentParser:
    """A command line that may name the file for the figures; ``--help`` prints ``doc``."""
    parser = _parser(doc)
    parser.add_argument("file", nargs="?", type=Path, help="where the figures are kept (JSON)")
    return parser


def write_figures(file: Path | None, figures: object) -> None:
    """Figures as JSON, where a file is named."""
    if file is not None:
        write_text(file, json.dumps(figures, indent=1, ensure_ascii=False) + "\n")


def _parser(doc: str | None) -> argparse.ArgumentParser:
    return argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )


def collected(files: Sequence[str]) -> list[dict[str, Any]]:
    """The rows of several files."""
    return [row for file in files for row in json.loads(Path(file).read_text(encoding="utf-8"))]
