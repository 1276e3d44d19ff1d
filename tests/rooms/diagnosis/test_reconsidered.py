"""An effect taken early, far above the noise, is asked again beside what the next round found."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from slipmargin.diagnosis import search
from slipmargin.diagnosis.candidate import named_candidates

WHEELS = ("1", "2", "3", "4")
KNOWN = {c.label: c for c in named_candidates(WHEELS, False, (), timed=False)}
#: Left-out errors: two effects that show together, and a third that stands for them alone.
CHI = {
    ("slip_ratio_friction",): 7.5,
    ("slip_ratio_friction", "wheel_radius[1]"): 5.8,
    ("slip_ratio_friction", "wheel_loads"): 6.5,
    ("slip_ratio_friction", "wheel_radius[1]", "load_transfer"): 5.4,
    ("slip_ratio_friction", "wheel_loads", "load_transfer"): 5.0,
}


def state(*labels, piece=8):
    structure = tuple(KNOWN[name] for name in labels)
    return SimpleNamespace(
        structure=structure,
        last=structure[-1],
        named=True,
        chi=CHI[labels],
        scores=np.full(4, CHI[labels] ** 2),
        samples=4.0,
        fit=SimpleNamespace(x=np.concatenate([c.starts[0] for c in structure]), trials=np.arange(4)),
        view=SimpleNamespace(piece=piece, possible=lambda effects: object()),
    )


def step(before, *tried, taken, best):
    return search.Round(
        before=before,
        screening=SimpleNamespace(p_value=lambda share: 0.005),
        tried=tried,
        best=best,
        taken=taken,
    )


@pytest.fixture
def quick(monkeypatch):
    asked = []

    def fit(view, structure, x, trials):
        assert len(x) == sum(c.size for c in structure)
        return SimpleNamespace(structure=structure, x=x, cost=0.0)

    def scored(view, found, samples, runs):
        asked.append(tuple(c.label for c in found.structure))
        return state(*asked[-1])

    monkeypatch.setattr(search, "fit", fit)
    monkeypatch.setattr(search, "scored", scored)
    return asked


class Silent:
    expired = False

    def __call__(self, stage, share):
        pass


@pytest.mark.parametrize("piece", [8, None])
def test_two_effects_that_show_together_replace_the_one_that_stood_for_them(quick, piece):
    law, radius = state("slip_ratio_friction"), state("slip_ratio_friction", "wheel_radius[1]", piece=piece)
    first = step(law, radius, state("slip_ratio_friction", "wheel_loads"), taken=True, best=radius)
    late = state("slip_ratio_friction", "wheel_radius[1]", "load_transfer", piece=piece)
    second = step(radius, late, taken=False, best=late)
    found = search.reconsidered(second, [first], (0, 1, 2, 3), Silent())
    if piece is None:  # near the noise the first choice is kept
        assert found is second and not quick
        return
    assert found.taken and found.best is not None
    assert [c.name for c in found.best.structure] == ["slip_ratio_friction", "wheel_loads", "load_transfer"]


def test_what_was_far_behind_in_its_round_is_not_asked(quick, monkeypatch):
    monkeypatch.setitem(CHI, ("slip_ratio_friction", "wheel_loads"), 7.4)
    law, radius = state("slip_ratio_friction"), state("slip_ratio_friction", "wheel_radius[1]")
    first = step(law, radius, state("slip_ratio_friction", "wheel_loads"), taken=True, best=radius)
    late = state("slip_ratio_friction", "wheel_radius[1]", "load_transfer")
    second = step(radius, late, taken=False, best=late)
    assert search.reconsidered(second, [first], (0, 1, 2, 3), Silent()) is second and not quick
