"""A design study: every limit of many designs, the best design, the Pareto front of several objectives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, read_only
from slipmargin.errors import InputError
from slipmargin.study.batch import batches, plain
from slipmargin.study.columns import columns_of_batches
from slipmargin.study.objectives import BY_NAME, Kind, Objective, names_of, objective
from slipmargin.study.pareto import front, tolerance
from slipmargin.study.pieces import Executor, in_pieces
from slipmargin.study.quantities import Value, own_value
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.task import Task
from slipmargin.study.vary import Vary, applied, product

#: Designs in one piece of the long work.
PIECE = {Kind.STATIC: 8, Kind.MOTION: 8, Kind.LAPS: 1}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DesignProblem:
    """What a study computes: the grids over one base design, the objective and the columns.

    ``kinds`` are the columns to compute; those of kind STATIC are always computed.
    """

    base: RobotOnSurface
    grids: tuple[Vary, ...]
    objective: Objective = BY_NAME["f_worst"]
    kinds: tuple[Kind, ...] = (Kind.STATIC, Kind.MOTION)

    def needed(self) -> tuple[Kind, ...]:
        """The kinds to compute: those asked for and the objective's."""
        wanted = {Kind.STATIC, *self.kinds, self.objective.kind}
        return tuple(kind for kind in Kind if kind in wanted)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Study:
    """One row a design, in the order of the grids, the last changing fastest.

    ``values`` (D tuples) of the varied quantities; ``columns`` name → (D,), NaN where a design is impossible;
    ``designs`` are the designs, None where one is impossible; ``impossible`` maps its row to the reason.
    ``own`` are the columns of the file's own design.
    """

    problem: DesignProblem
    values: tuple[tuple[Value, ...], ...]
    designs: tuple[RobotOnSurface | None, ...]
    columns: Mapping[str, Array]
    impossible: Mapping[int, str]
    own: Mapping[str, float]
    own_problem: str | None = None
    pieces: int = 0
    resumed: int = 0

    @property
    def keys(self) -> tuple[str, ...]:
        """The varied quantities."""
        return tuple(grid.key for grid in self.problem.grids)

    @property
    def own_values(self) -> tuple[Value | None, ...]:
        """The file's own values of the varied quantities; None where it has none."""
        return tuple(own_value(grid.quantity, self.problem.base) for grid in self.problem.grids)

    @property
    def objectives(self) -> tuple[str, ...]:
        """Names of the objectives of which at least one design has a value."""
        return tuple(n for n, column in self.columns.items() if n in BY_NAME and not np.isnan(column).all())

    def best(self, name: str | None = None) -> int:
        """The row that is best in an objective (the problem's by default); ties go to the greater mean pull.

        Raises
        ------
        InputError
            If no design is possible, with the first one's problem.
        """
        goal = self.problem.objective if name is None else objective(name)
        if goal.name not in self.objectives:
            why = self.impossible.get(0, f"{goal.name} cannot be computed")
            raise InputError(
                "vary", f"holds no possible design; the first: {why}", "vary within other bounds"
            )
        tied = self.ties(goal.name)
        return int(tied[np.argmax(np.nan_to_num(self.columns["f_mean"][tied], nan=-np.inf))])

    def ties(self, name: str) -> NDArray[np.int_]:
        """Rows that are as good as the best in an objective but for rounding."""
        score = objective(name).sign * self.columns[name]
        top = float(np.nanmax(score))
        return np.flatnonzero(score >= top - tolerance(top))

    def winners(self, name: str) -> NDArray[np.int_]:
        """The rows of :meth:`ties`; none where every possible design is as good as any other."""
        tied = self.ties(name)
        return tied[:0] if 1 < len(tied) == np.count_nonzero(~np.isnan(self.columns[name])) else tied

    def design(self, row: int) -> RobotOnSurface:
        """The design of a row that is possible."""
        found = self.designs[row]
        assert found is not None
        return found

    def front(self, names: Sequence[str]) -> NDArray[np.bool_]:
        """(D,) designs that no other beats in all of these objectives at once."""
        goals = [objective(name) for name in names]
        return front(np.stack([g.sign * self.columns[g.name] for g in goals], axis=1))

    def axis(self, key: str) -> tuple[Value, ...]:
        """The values of one varied quantity."""
        return self.problem.grids[self.keys.index(key)].values

    def shaped(self, name: str) -> Array:
        """A column with one axis for each grid."""
        return self.columns[name].reshape([len(grid.values) for grid in self.problem.grids])


def study(
    problem: DesignProblem,
    *,
    executor: Executor | None = None,
    advance: Callable[[int], None] = lambda steps: None,
) -> Study:
    """Return every column of every design.

    Static columns of all designs that zonotopes describe come at once; everything else, design by design, is
    done in pieces.

    Parameters
    ----------
    executor : Executor, optional
        Where finished pieces are kept and which processes compute; by default this process, keeping nothing.
    advance : callable
        Called with the number of designs that a finished piece holds.

    Raises
    ------
    InputError
        For grids that make no sense.  A single impossible design is no error: its row says why.
    """
    quantities = [grid.quantity for grid in problem.grids]
    values = product(problem.base, problem.grids)
    designs: list[RobotOnSurface | None] = []
    impossible: dict[int, str] = {}
    for i, row in enumerate(values):
        try:
            designs.append(applied(problem.base, quantities, row))
        except InputError as fault:
            designs.append(None)
            impossible[i] = str(fault)
    everyone = [*designs, problem.base]
    found, refused = batches(everyone)
    at_once = plain(found, len(everyone))
    impossible |= refused
    everyone = [None if i in impossible else m for i, m in enumerate(everyone)]
    possible = np.array([m is not None for m in everyone])
    parts = [b.take(rows) for b in found if (rows := b.plain & possible[b.index]).any()]
    columns = columns_of_batches(parts, everyone)
    slow = tuple(kind for kind in problem.needed() if kind is not Kind.STATIC)
    columns |= {name: np.full(len(everyone), np.nan) for kind in slow for name in names_of(kind)}
    if not possible[:-1].any():  # the study is refused, and its own design is not asked for
        possible[-1] = False
    pieces = resumed = 0
    for kinds, rows in (((Kind.STATIC, *slow), possible & ~at_once), (slow, possible & at_once)):
        if not kinds:
            advance(int(np.count_nonzero(rows)))
            continue
        task = Task(kinds=kinds)
        done = in_pieces(
            task,
            [everyone[i] for i in np.flatnonzero(rows)],
            key=task,
            executor=executor or Executor(),
            size=min(PIECE[kind] for kind in kinds),
            advance=advance,
        )
        pieces, resumed = pieces + done.pieces, resumed + done.resumed
        for name in done.rows[0] if done.rows else ():
            columns[name][rows] = [row[name] for row in done.rows]
    own = {name: float(column[-1]) for name, column in columns.items()}
    own_problem = impossible.pop(len(values), None)
    return Study(
        problem=problem,
        values=tuple(values),
        designs=tuple(everyone[:-1]),
        columns={name: read_only(column[:-1]) for name, column in columns.items()},
        impossible=impossible,
        own=own,
        own_problem=own_problem,
        pieces=pieces,
        resumed=resumed,
    )
