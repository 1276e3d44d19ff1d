"""Cone programs as data, with named rows, and solutions that certify themselves.

Primal:  minimise c·x  subject to  A x + s = b,  s ∈ K.
Dual:    maximise −b·z  subject to  Aᵀz + c = 0,  z ∈ K*.
K is a product of zero cones (equalities), half-lines and second-order cones {(t, v) : ‖v‖ ≤ t}.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError, NoSolution

#: Largest relative residual and gap with which a solution leaves the room [1].
PROVEN = 1e-6
#: A row binds where its multiplier exceeds this share of the largest [1].
BINDING = 1e-6


@final
class ConeKind(Enum):
    """The cone of a block of rows."""

    ZERO = "equality"
    NONNEGATIVE = "inequality"
    SECOND_ORDER = "second-order cone"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Consecutive rows in one cone, by name; a second-order cone is one row block with t first."""

    kind: ConeKind
    rows: tuple[str, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConeProgram:
    """One program: ``a`` (R, V), ``b`` (R,), ``c`` (V,), names of variables and of rows by block."""

    what: str
    variables: tuple[str, ...]
    blocks: tuple[Block, ...]
    a: Array
    b: Array
    c: Array

    def __post_init__(self) -> None:
        rows, columns, put = len(self.rows), len(self.variables), object.__setattr__
        put(self, "a", frozen("a", self.a, (rows, columns)))
        put(self, "b", frozen("b", self.b, (rows,)))
        put(self, "c", frozen("c", self.c, (columns,)))

    @property
    def rows(self) -> tuple[str, ...]:
        """Names of all rows in order."""
        return tuple(name for block in self.blocks for name in block.rows)

    def row(self, name: str) -> int:
        """Index of the row called ``name``."""
        return _index(self.rows, name, "row")

    def variable(self, name: str) -> int:
        """Index of the variable called ``name``."""
        return _index(self.variables, name, "variable")

    def slices(self) -> tuple[tuple[Block, slice], ...]:
        """Each block with the rows it holds."""
        out, start = [], 0
        for block in self.blocks:
            out.append((block, slice(start, start + len(block.rows))))
            start += len(block.rows)
        return tuple(out)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConeFamily:
    """Many programs of one shape: ``a`` (M, R, V) and ``b`` (M, R) differ, all else is shared."""

    what: tuple[str, ...]
    variables: tuple[str, ...]
    blocks: tuple[Block, ...]
    a: Array
    b: Array
    c: Array

    def __post_init__(self) -> None:
        rows = sum(len(block.rows) for block in self.blocks)
        put, count = object.__setattr__, len(self.what)
        put(self, "a", frozen("a", self.a, (count, rows, len(self.variables))))
        put(self, "b", frozen("b", self.b, (count, rows)))
        put(self, "c", frozen("c", self.c, (len(self.variables),)))

    def __len__(self) -> int:
        return len(self.what)

    def program(self, m: int) -> ConeProgram:
        """The m-th program alone."""
        return ConeProgram(
            what=self.what[m],
            variables=self.variables,
            blocks=self.blocks,
            a=self.a[m],
            b=self.b[m],
            c=self.c,
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """Relative residuals and gap, from the definition: small ones prove the answer."""

    primal: float  #: (|A x + s − b| and the distance of s from K) / (1 + |b|)
    dual: float  #: (|Aᵀz + c| and the distance of z from K*) / (1 + |c|)
    gap: float  #: |c·x + b·z| / (1 + |c·x|)

    @property
    def worst(self) -> float:
        """The largest of the three."""
        return max(self.primal, self.dual, self.gap)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """A program's answer: primal ``x`` (V,), slack ``s`` (R,), multipliers ``z`` (R,)."""

    program: ConeProgram
    x: Array
    s: Array
    z: Array
    solver: str

    def __post_init__(self) -> None:
        rows, put = len(self.program.b), object.__setattr__
        put(self, "x", frozen("x", self.x, (len(self.program.c),)))
        put(self, "s", frozen("s", self.s, (rows,)))
        put(self, "z", frozen("z", self.z, (rows,)))

    @property
    def value(self) -> float:
        """c·x."""
        return float(self.program.c @ self.x)

    def certificate(self) -> Certificate:
        """Residuals and gap computed here, not reported by the solver."""
        p = self.program
        off = max(distance(block.kind, self.s[at], False) for block, at in p.slices())
        dual_off = max(distance(block.kind, self.z[at], True) for block, at in p.slices())
        return Certificate(
            primal=max(_largest(p.a @ self.x + self.s - p.b), off) / (1.0 + _largest(p.b)),
            dual=max(_largest(p.a.T @ self.z + p.c), dual_off) / (1.0 + _largest(p.c)),
            gap=abs(self.value + float(p.b @ self.z)) / (1.0 + abs(self.value)),
        )

    def proven(self, tolerance: float = PROVEN) -> Solution:
        """This solution, or NoSolution where its certificate is worse than ``tolerance``."""
        proof = self.certificate()
        if not proof.worst <= tolerance:
            raise NoSolution(
                self.program.what,
                f"{self.solver} left primal residual {proof.primal:.1e}, "
                f"dual residual {proof.dual:.1e}, gap {proof.gap:.1e}",
                "scale the program or ask for less accuracy",
                self,
            )
        return self

    def binding(self, share: float = BINDING) -> tuple[str, ...]:
        """Names of inequalities and cones (by their first row) whose multiplier is not zero."""
        held = [(block, at) for block, at in self.program.slices() if block.kind is not ConeKind.ZERO]
        most = max((_largest(self.z[at]) for _, at in held), default=0.0)
        names: list[str] = []
        for block, at in held:
            if block.kind is ConeKind.SECOND_ORDER:
                names += [block.rows[0]] if _largest(self.z[at]) > share * most else []
            else:
                names += [n for n, z in zip(block.rows, self.z[at], strict=True) if z > share * most]
        return tuple(names)


def distance(kind: ConeKind, vector: Array, dual: bool) -> float:
    """How far ``vector`` lies outside a cone (``dual``: its dual cone), in its largest entry."""
    if kind is ConeKind.ZERO:
        return 0.0 if dual else _largest(vector)
    if kind is ConeKind.NONNEGATIVE:
        return max(0.0, -float(np.min(vector, initial=0.0)))
    return max(0.0, float(np.linalg.norm(vector[1:]) - vector[0]))


def _largest(vector: Array) -> float:
    return float(np.max(np.abs(vector), initial=0.0))


def _index(names: tuple[str, ...], name: str, noun: str) -> int:
    if name not in names:
        raise InputError(noun, f"{name!r} is not in the program", f"use one of: {', '.join(names)}")
    return names.index(name)
