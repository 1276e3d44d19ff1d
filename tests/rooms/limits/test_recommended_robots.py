"""Everything that is recommended, driven as a motion: drawn robots of ``benchmarks/recommended.py``."""

from __future__ import annotations

import recommended
from hypothesis import given, settings, strategies as st


@settings(max_examples=5)
@given(st.integers(0, 2**31))
def test_a_drawn_robot_keeps_its_margin_and_slips_beyond_the_limit(seed: int) -> None:
    row = recommended.drawn(seed, 0)
    for name, share in (row["used"] | {f"torque, {n}": v for n, v in row["torque"].items()}).items():
        assert share <= 1.0 - recommended.MARGIN + recommended.ALLOWED, (name, row)
    assert row["top_speed"] <= 1.0
    assert all(b["as_named"] for b in row["beyond"]), row["beyond"]
