"""A study as a table and as plain data, for files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.io.table import columns_text
from slipmargin.study.objectives import BY_NAME
from slipmargin.study.study import Study


def table_text(study: Study, front_of: Sequence[str]) -> str:
    """CSV: the varied quantities, every column, ``front`` (1 on the Pareto front) and ``problem``.

    A cell is empty where a design is impossible or a motion has no limit.
    """
    columns: dict[str, Array | Sequence[float] | Sequence[str]] = {}
    for k, grid in enumerate(study.problem.grids):
        column: list[Any] = [row[k] for row in study.values]
        columns[grid.key] = [str(v) for v in column] if grid.quantity.words else np.array(column, dtype=float)
    columns |= study.columns
    columns["front"] = study.front(front_of).astype(float)
    columns["problem"] = [study.impossible.get(i, "").replace(",", ";") for i in range(len(study.values))]
    return columns_text(columns)


def study_data(study: Study) -> dict[str, Any]:
    """Everything as plain data: SI, columns as lists."""
    goal = study.problem.objective
    best = study.best()
    return {
        "schema": 1,
        "robot": study.problem.base.robot.name,
        "surface": study.problem.base.surface,
        "vary": {grid.key: list(grid.values) for grid in study.problem.grids},
        "objective": {
            "name": goal.name,
            "unit": goal.unit,
            "meaning": goal.meaning,
            "better": "more" if goal.sign > 0 else "less",
        },
        "best": {
            "row": best,
            "design": dict(zip(study.keys, study.values[best], strict=True)),
            "value": float(study.columns[goal.name][best]),
        },
        "own": {
            "design": dict(zip(study.keys, study.own_values, strict=True)),
            "problem": study.own_problem,
            **study.own,
        },
        "best_by_objective": {name: _best_of(study, name) for name in study.columns if name in BY_NAME},
        "designs": [dict(zip(study.keys, row, strict=True)) for row in study.values],
        "columns": dict(study.columns),
        "problems": {str(i): text for i, text in study.impossible.items()},
    }


def _best_of(study: Study, name: str) -> dict[str, Any] | None:
    if name not in study.objectives:
        return None
    row = study.best(name)
    return {
        "row": row,
        "design": dict(zip(study.keys, study.values[row], strict=True)),
        "value": float(study.columns[name][row]),
    }
