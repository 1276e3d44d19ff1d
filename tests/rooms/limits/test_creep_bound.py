"""The proven bound on creep holds where the plain one fails, and the page's figures are the script's."""

from __future__ import annotations

import json
from pathlib import Path

import creep_bound as bench
import numpy as np
import pytest
from strategies import kiwi

from slipmargin.errors import InputError
from slipmargin.limits.creep_bound import proven_creep
from slipmargin.limits.motion_friction import ROOM
from slipmargin.model import nominal_model
from slipmargin.physics.friction_laws import law_inverse

ROOT = Path(__file__).resolve().parents[3]
RESULT = json.loads((ROOT / "benchmarks/results/creep_bound.json").read_text(encoding="utf-8"))


def test_simulated_ramps_stay_below_the_proven_bound() -> None:
    found = bench.search(6, seed=11)["by_share"]
    for one in found.values():
        assert one["largest_over_the_proven"] < 1.0
        assert one["largest_excess_of_share"] <= ROOM


def test_the_search_found_creep_above_the_share_asked() -> None:
    """The sentence that was wrong: below the limit a wheel creeps by at most σ⁻¹(λ)/k of the share asked."""
    rows = RESULT["by_share"].values()
    assert max(r["largest_over_the_share_asked"] for r in rows) > 1.02
    assert max(r["largest_over_the_proven"] for r in rows) < 1.0
    assert max(r["largest_excess_of_share"] for r in rows) <= ROOM


def test_the_page_quotes_the_search() -> None:
    page, rows = (ROOT / "docs/theory.md").read_text(encoding="utf-8"), RESULT["by_share"].values()
    assert f"in {sum(r['runs'] for r in rows)} simulated ramps of {RESULT['robots']} drawn robots" in page
    assert f"at most {max(r['largest_excess_of_share'] for r in rows):.3f} more than the share asked" in page
    most = max(r["largest_over_the_share_asked"] for r in rows)
    assert f"at most {100 * (most - 1):.1f} % faster" in page
    assert f"below {max(r['largest_over_the_proven'] for r in rows):.2f} of it" in page


def test_the_bound_is_above_steady_creep_and_infinite_where_turning_may_feed_it() -> None:
    model = nominal_model(kiwi(30.0), "paper")
    for share in (0.5, 0.9):
        held = proven_creep(model, share)
        assert np.all(held > law_inverse(0, share) / 1000.0)
        assert np.all(proven_creep(model, share, speed_m_s=0.2) >= held)
    assert np.all(np.isinf(proven_creep(model, 0.95, speed_m_s=5.0)))
    with pytest.raises(InputError, match="share"):
        proven_creep(model, 1.0)


def test_the_page_quotes_the_few_rollers() -> None:
    found = json.loads((ROOT / "benchmarks/results/few_rollers.json").read_text(encoding="utf-8"))
    creep, page = found["worst_creep_per_distance"], (ROOT / "docs/theory.md").read_text(encoding="utf-8")
    assert f"wheels of 9 rollers creeps by {100 * creep['9']['0.9']:.1f} %" in page
    assert f"on wheels of 18 by {100 * creep['18']['0.9']:.1f} %" in page
    assert creep["18"]["0.9"] < found["slips_above"] == 0.015 < creep["9"]["0.9"]


def test_the_page_quotes_how_much_more_the_box_promises() -> None:
    rows = json.loads((ROOT / "benchmarks/results/rollers.json").read_text(encoding="utf-8"))
    more = [
        100.0 * (r["limit_of_the_box_m_s2"] / r["limit_m_s2"] - 1.0)
        for r in rows
        if "limit_of_the_box_m_s2" in r
    ]
    page = " ".join((ROOT / "docs/theory.md").read_text(encoding="utf-8").split())
    assert f"from {min(more):.1f} to {max(more):.0f} % for the three robots there" in page


def test_nothing_asked_nothing_creeps() -> None:
    np.testing.assert_array_equal(proven_creep(nominal_model(kiwi(), "paper"), 0.0), np.zeros(3))
