"""Write a family of cone programs row by row, by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.solve.program import Block, ConeFamily, ConeKind

#: A coefficient: one number for all programs, or one a program (M,).
Entry = float | Array


@final
class Assembly:
    """A family under construction; rows keep their order within equalities, inequalities and cones."""

    def __init__(self, *, count: int) -> None:
        self._count = count
        self._costs: dict[str, float] = {}
        self._rows: dict[ConeKind, list[tuple[str, dict[str, Entry], Entry]]] = {k: [] for k in ConeKind}
        self._cones: list[int] = []

    def variable(self, name: str, cost: float = 0.0) -> None:
        """A free variable with its price in the objective."""
        assert name not in self._costs, f"variable {name} is already there"
        self._costs[name] = cost

    def equations(self, names: Sequence[str], right: Array) -> None:
        """Empty equalities ``0 = right`` (M, len(names)), filled by :meth:`column`."""
        for k, name in enumerate(names):
            self._rows[ConeKind.ZERO].append((name, {}, right[:, k]))

    def column(self, variable: str, rows: Sequence[str], values: Array) -> None:
        """A variable's coefficients (M, len(rows)) in named equalities."""
        values = np.broadcast_to(values, (self._count, len(rows)))
        place = {name: row for name, row, _ in self._rows[ConeKind.ZERO]}
        for k, name in enumerate(rows):
            place[name][variable] = values[:, k]

    def inequality(self, name: str, row: Mapping[str, Entry], right: Entry) -> None:
        """``row · x ≤ right``."""
        self._rows[ConeKind.NONNEGATIVE].append((name, dict(row), right))

    def second_order(self, name: str, rows: Sequence[tuple[Mapping[str, Entry], Entry]]) -> None:
        """``right − row · x`` of the rows lie in a second-order cone, its height first."""
        for k, (row, right) in enumerate(rows):
            self._rows[ConeKind.SECOND_ORDER].append((name if k == 0 else f"{name} [{k}]", dict(row), right))
        self._cones.append(len(rows))

    def family(self, what: tuple[str, ...]) -> ConeFamily:
        """The programs as arrays."""
        at = {name: k for k, name in enumerate(self._costs)}
        rows = [row for kind in ConeKind for row in self._rows[kind]]
        a = np.zeros((self._count, len(rows), len(at)))
        b = np.empty((self._count, len(rows)))
        for r, (_, row, right) in enumerate(rows):
            for name, value in row.items():
                a[:, r, at[name]] = value
            b[:, r] = right
        return ConeFamily(
            what=what,
            variables=tuple(at),
            blocks=self._blocks(),
            a=a,
            b=b,
            c=np.array(list(self._costs.values())),
        )

    def _blocks(self) -> tuple[Block, ...]:
        blocks = [
            Block(kind=kind, rows=tuple(name for name, _, _ in self._rows[kind]))
            for kind in (ConeKind.ZERO, ConeKind.NONNEGATIVE)
            if self._rows[kind]
        ]
        names = [name for name, _, _ in self._rows[ConeKind.SECOND_ORDER]]
        for size in self._cones:
            blocks.append(Block(kind=ConeKind.SECOND_ORDER, rows=tuple(names[:size])))
            names = names[size:]
        return tuple(blocks)
