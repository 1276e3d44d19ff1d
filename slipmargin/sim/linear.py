"""Small dense linear systems in place (compiled): factors once, solutions many times."""

from __future__ import annotations

from typing import Any

from slipmargin.sim.compiled import inner


@inner
def decompose(A: Any, pivots: Any, n: int) -> None:
    """Factors of A (n, n), with row exchanges, written over it."""
    for k in range(n):
        p = k
        for r in range(k + 1, n):
            if abs(A[r, k]) > abs(A[p, k]):
                p = r
        pivots[k] = p
        if p != k:
            for c in range(n):
                A[k, c], A[p, c] = A[p, c], A[k, c]
        for r in range(k + 1, n):
            A[r, k] /= A[k, k]
            for c in range(k + 1, n):
                A[r, c] -= A[r, k] * A[k, c]


@inner
def back(A: Any, pivots: Any, n: int, b: Any, x: Any) -> None:
    """x with A x = b, from the factors."""
    for k in range(n):
        x[k] = b[k]
    for k in range(n):
        p = pivots[k]
        x[k], x[p] = x[p], x[k]
    for k in range(n):
        for c in range(k):
            x[k] -= A[k, c] * x[c]
    for k in range(n - 1, -1, -1):
        for c in range(k + 1, n):
            x[k] -= A[k, c] * x[c]
        x[k] /= A[k, k]
