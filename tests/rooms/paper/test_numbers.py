"""The printed numbers: each stands in the words quoted for it, and the words stand in the paper."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from slipmargin.io.robot_file import read_recipe
from slipmargin.paper.numbers import BY_KEY, CLAIMS, NUMBERS, published
from slipmargin.paper.published import paper_robot

#: Copied from the text by hand, not from the package: sentences with every printed number.
EXCERPTS = (
    "omni-directional wheel contains $n=8$ rollers",
    "We chose $k=1000$ by eye and to ensure numerical stability",
    "Paper 0.26 0.09 0.47 0.47",
    "Carpet 0.25 0.15 0.56 0.56",
    "final point $\\mathbf{X}_F = \\{0.4 \\ 0.0 \\ 0\\}^T$ (m) in a specified time of $t_F = 3.5$ sec",
    "our design has $\\delta = 15^\\circ$",
    "$\\delta = 30^\\circ$ is preferable for robot symmetry",
    "$\\dot{\\theta}_1 = \\dot{\\theta}_2 = +1.16$ and $\\dot{\\theta}_3 = -4.50$ (rad/s)",
    "x falls short by 14 mm its goal of 0.4 m, while y drifts -9 mm from the desired zero",
    "ϕ drifts from its commanded value of zero by -0.016 rad at the end; in the middle of motion",
    "From approximately $t = 0.25$ sec to $t = t_F = 3.5$ sec, the x motion is linear",
    "accounts for 90% of each angular sector",
    "(the rigid material) accounts for 10%",
    "x falls short by 53 mm its goal of 0.4 m, while y drifts -22 mm from the desired zero",
    "ϕ drifts from its commanded value of zero by -0.111 rad in the worst case at the end",
    "the simulated (improved friction model) ending value of ϕ is -0.111 rad",
    "the simulated ending value of ϕ is 0.558 rad",
    "measured experimental values of 0.524, 0.506, and 0.489 rad",
)
TEXT = Path(__file__).resolve().parents[3].parent / "shared" / "paper" / "williams2002.txt"


def plain(text: str) -> str:
    return re.sub(r"\s+", " ", text)


@pytest.mark.parametrize("source", NUMBERS, ids=lambda p: p.key)
def test_a_printed_number_stands_in_its_quote(source) -> None:
    assert re.search(rf"(?<![\d.]){re.escape(source.printed)}(?!\d)", source.quote)
    assert any(plain(source.quote) in excerpt for excerpt in EXCERPTS)


def test_values_are_si() -> None:
    assert (
        published("initial_paper_x_short") == 0.014 and BY_KEY["initial_paper_x_short"].half_digit == 0.0005
    )
    assert published("improved_paper_y") == -0.022 and published("rigid_share") == 0.1
    assert published("omega_3") == -4.5 and BY_KEY["omega_3"].half_digit == 0.005
    with pytest.raises(ValueError, match="claim in words"):
        published("equal_loads")


def test_keys_are_unique_and_claims_have_no_number() -> None:
    assert len(BY_KEY) == len(NUMBERS) + len(CLAIMS)
    assert all(c.value is None and c.half_digit == 0.0 for c in CLAIMS)


def test_the_built_in_robot_is_the_papers() -> None:
    mine, shipped = paper_robot(improved=True), read_recipe("ohio-kiwi").robot
    for a, b in zip(mine.wheels, shipped.wheels, strict=True):
        assert a.position_m == pytest.approx(b.position_m, abs=1e-9) and a.radius_m == b.radius_m
        assert (a.rollers, a.rigid_fraction) == (b.rollers, b.rigid_fraction)
    assert mine.surfaces == shipped.surfaces and mine.friction == shipped.friction
    assert mine.body.inertia_kg_m2 == pytest.approx(shipped.body.inertia_kg_m2, rel=0.01)


@pytest.mark.skipif(not TEXT.is_file(), reason="the paper's text is not beside the repository")
def test_quotes_and_excerpts_stand_in_the_paper() -> None:
    text = plain(TEXT.read_text(encoding="utf-8"))
    wrong = [p.key for p in (*NUMBERS, *CLAIMS) if plain(p.quote) not in text]
    wrong += [e for e in EXCERPTS if e not in text]
    assert not wrong


@pytest.mark.parametrize("source", (*NUMBERS, *CLAIMS), ids=lambda p: p.key)
def test_the_page_has_a_row_for_it(source) -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "paper.md").read_text(encoding="utf-8")
    assert f"| `{source.key}` |" in page
