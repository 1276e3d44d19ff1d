"""Rows that are kept as soon as they are known: a benchmark that was stopped goes on from there.

--json FILE     keep the rows there; what it holds already is not done again
--part 1/2      every other job, for two processes
"""

from __future__ import annotations

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
    def of(cls, words: Sequence[str]) -> tuple[Self, list[str]]:
        """The keeper that a command line asks for, and the words that are left."""
        options, left = {"--json": "", "--part": "1/1"}, list(words)
        for name in options:
            if name in left:
                at = left.index(name)
                options[name] = left[at + 1]
                del left[at : at + 2]
        part, parts = (int(number) for number in options["--part"].split("/"))
        return cls(Path(options["--json"]) if options["--json"] else None, part, parts), left

    def run(self, jobs: Sequence[Job]) -> list[dict[str, Any]]:
        """Every row of this part; a row bears its job's name as ``set``."""
        rows = json.loads(self.target.read_text()) if self.target is not None and self.target.exists() else []
        done = {row["set"] for row in rows}
        for name, job in jobs[self.part - 1 :: self.parts]:
            if name in done:
                continue
            rows.append({"set": name} | job())
            if self.target is not None:
                write_text(self.target, json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
        return rows


def collected(files: Sequence[str]) -> list[dict[str, Any]]:
    """The rows of several files."""
    return [row for file in files for row in json.loads(Path(file).read_text())]
