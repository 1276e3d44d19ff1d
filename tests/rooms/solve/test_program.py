"""Programs as data, and certificates from the definition: a wrong answer must not look proven."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slipmargin.errors import InputError, NoSolution
from slipmargin.solve import clarabel_
from slipmargin.solve.assemble import Assembly
from slipmargin.solve.program import Block, ConeFamily, ConeKind, ConeProgram, Solution, distance


def knapsack() -> ConeProgram:
    """Minimise −3x − 2y, x + y ≤ 4, x + 3y ≤ 7, x ≤ 3: by hand x = 3, y = 1, multipliers (2, 0, 1)."""
    return ConeProgram(
        what="knapsack",
        variables=("x", "y"),
        blocks=(Block(kind=ConeKind.NONNEGATIVE, rows=("weight", "room", "stock")),),
        a=np.array([[1.0, 1.0], [1.0, 3.0], [1.0, 0.0]]),
        b=np.array([4.0, 7.0, 3.0]),
        c=np.array([-3.0, -2.0]),
    )


def ball() -> ConeProgram:
    """Minimise x + 2y + 2z, x = 1, ‖(y, z)‖ ≤ 5: by hand y = z = −5/√2, value 1 − 10√2."""
    return ConeProgram(
        what="ball",
        variables=("x", "y", "z"),
        blocks=(
            Block(kind=ConeKind.ZERO, rows=("fix",)),
            Block(kind=ConeKind.SECOND_ORDER, rows=("ball", "ball y", "ball z")),
        ),
        a=np.array([[1.0, 0, 0], [0, 0, 0], [0, 1, 0], [0, 0, 1]]),
        b=np.array([1.0, 5.0, 0.0, 0.0]),
        c=np.array([1.0, 2.0, 2.0]),
    )


def exact() -> Solution:
    return Solution(
        program=knapsack(),
        x=np.array([3.0, 1.0]),
        s=np.array([0.0, 1.0, 0.0]),
        z=np.array([2.0, 0.0, 1.0]),
        solver="hand",
    )


def test_equal_programs_are_solved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    one = knapsack()
    b = np.array([one.b, one.b, [4.0, 7.0, 2.0], [4.0, 7.0, 2.0], one.b])
    family = ConeFamily(
        what=tuple("abcde"), variables=one.variables, blocks=one.blocks, a=np.stack([one.a] * 5), b=b, c=one.c
    )
    solved: list[object] = []
    make = clarabel_._solver

    class Counted:
        def __init__(self, *args: object) -> None:
            self.own: Any = make(*args)  # type: ignore[arg-type]

        def update(self, **changes: object) -> None:
            self.own.update(**changes)

        def solve(self) -> object:
            solved.append(self.own.solve())
            return solved[-1]

    monkeypatch.setattr(clarabel_, "_solver", Counted)
    x = clarabel_.solve_family(family)[0]
    np.testing.assert_allclose(x, [[3, 1], [3, 1], [2, 5 / 3], [2, 5 / 3], [3, 1]], atol=1e-8)
    assert len(solved) == 3


def test_knapsack_by_clarabel() -> None:
    found = clarabel_.solve(knapsack())
    np.testing.assert_allclose(found.x, [3.0, 1.0], atol=1e-8)
    np.testing.assert_allclose(found.z, [2.0, 0.0, 1.0], atol=1e-8)
    assert found.value == pytest.approx(-11.0)
    assert found.proven().binding() == ("weight", "stock")


def test_ball_by_clarabel_names_the_cone() -> None:
    found = clarabel_.solve(ball()).proven()
    np.testing.assert_allclose(found.x, [1.0, -5 / np.sqrt(2), -5 / np.sqrt(2)], rtol=1e-8)
    assert found.value == pytest.approx(1.0 - 10.0 * np.sqrt(2.0))
    assert found.binding() == ("ball",)


def test_ball_by_cvxpy_has_the_same_multipliers() -> None:
    cvxpy_ = pytest.importorskip("slipmargin.solve.cvxpy_")
    for program in (ball(), knapsack()):
        one, two = clarabel_.solve(program), cvxpy_.solve(program)
        np.testing.assert_allclose(two.x, one.x, atol=1e-8)
        np.testing.assert_allclose(two.z, one.z, atol=1e-8)
        assert two.certificate().worst < 1e-8


def test_exact_answer_is_certified() -> None:
    assert exact().certificate().worst == 0.0


@pytest.mark.parametrize(
    ("field", "value", "part"),
    [
        ("x", [3.1, 1.0], "primal"),
        ("s", [-0.1, 1.0, 0.0], "primal"),
        ("z", [2.0, 0.1, 1.0], "dual"),
        ("z", [2.5, -0.5, 2.0], "dual"),
    ],
)
def test_wrong_answers_show_in_the_certificate(field: str, value: list[float], part: str) -> None:
    wrong = replace(exact(), **{field: np.array(value)})
    assert getattr(wrong.certificate(), part) > 0.01
    with pytest.raises(NoSolution, match="residual") as caught:
        wrong.proven()
    assert caught.value.evidence is wrong


def test_feasible_but_not_best_shows_as_gap() -> None:
    lazy = replace(exact(), x=np.array([2.0, 1.0]), s=np.array([1.0, 2.0, 1.0]))
    proof = lazy.certificate()
    assert proof.primal == 0.0
    assert proof.dual == 0.0
    assert proof.gap == pytest.approx(3.0 / 9.0)


@pytest.mark.parametrize(
    ("kind", "vector", "dual", "want"),
    [
        (ConeKind.ZERO, [0.5], False, 0.5),
        (ConeKind.ZERO, [0.5], True, 0.0),
        (ConeKind.NONNEGATIVE, [1.0, -0.2], False, 0.2),
        (ConeKind.SECOND_ORDER, [4.0, 3.0, 4.0], False, 1.0),
        (ConeKind.SECOND_ORDER, [5.0, 3.0, 4.0], True, 0.0),
    ],
)
def test_distance_from_a_cone(kind: ConeKind, vector: list[float], dual: bool, want: float) -> None:
    assert distance(kind, np.array(vector), dual) == pytest.approx(want)


@pytest.mark.parametrize("solver", ["clarabel_", "cvxpy_"])
def test_infeasible_program_is_refused_with_itself_as_evidence(solver: str) -> None:
    module = pytest.importorskip(f"slipmargin.solve.{solver}")
    p = knapsack()
    never = replace(p, a=np.vstack([p.a[:2], [[-1.0, 0.0]]]), b=np.array([4.0, 7.0, -8.0]))
    with pytest.raises(NoSolution) as caught:
        module.solve(never)
    assert caught.value.evidence is not None


def test_unbounded_program_is_refused() -> None:
    with pytest.raises(NoSolution, match="no bound"):
        clarabel_.solve(replace(knapsack(), c=np.array([3.0, 2.0])))


def test_names_that_do_not_exist_list_those_that_do() -> None:
    assert knapsack().row("room") == 1
    assert knapsack().variable("y") == 1
    with pytest.raises(InputError, match="weight, room, stock"):
        knapsack().row("colour")
    with pytest.raises(InputError, match="x, y"):
        knapsack().variable("w")


def test_family_is_its_programs() -> None:
    put = Assembly(count=3)
    put.variable("x", cost=-1.0)
    put.variable("y", cost=-1.0)
    put.equations(["tie"], np.zeros((3, 1)))
    put.column("x", ["tie"], np.array([[1.0], [2.0], [3.0]]))
    put.column("y", ["tie"], -np.ones((3, 1)))
    put.inequality("top", {"y": 1.0}, np.array([1.0, 2.0, 4.0]))
    put.second_order("disc", [({}, 10.0), ({"x": -1.0}, 0.0), ({"y": -1.0}, 0.0)])
    family = put.family(("a", "b", "c"))
    x, _, z = clarabel_.solve_family(family)
    np.testing.assert_allclose(x, [[1.0, 1.0], [1.0, 2.0], [4 / 3, 4.0]], rtol=1e-8)
    for m in range(len(family)):
        alone = clarabel_.solve(family.program(m))
        np.testing.assert_allclose(alone.x, x[m], rtol=1e-8)
        np.testing.assert_allclose(alone.z, z[m], atol=1e-8)
    assert family.program(2).what == "c"


def test_family_without_members() -> None:
    put = Assembly(count=0)
    put.variable("x", cost=1.0)
    put.inequality("low", {"x": -1.0}, 0.0)
    x, s, z = clarabel_.solve_family(put.family(()))
    assert x.shape == (0, 1)
    assert s.shape == z.shape == (0, 1)


def test_infeasible_member_is_named() -> None:
    put = Assembly(count=2)
    put.variable("x", cost=1.0)
    put.inequality("low", {"x": -1.0}, np.array([0.0, -2.0]))
    put.inequality("high", {"x": 1.0}, 1.0)
    with pytest.raises(NoSolution, match="second"):
        clarabel_.solve_family(put.family(("first", "second")))
