"""General forms: what a few numbers of them follow."""

from __future__ import annotations

import numpy as np
import pytest
from planting import smooth_kiwi

from slipmargin.diagnosis.forms import Ranges
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.effects import GeneralEffect
from slipmargin.physics.terms import Multiplier, basis_values
from slipmargin.physics.variables import Target, Variable

DURATION_S = 4.0
RANGES = Ranges(
    speed_m_s=1.0,
    slip_m_s=0.5,
    acceleration_m_s2=2.0,
    yaw_rate_rad_s=3.0,
    position_m=1.0,
    middle_m=(0.0, 0.0),
    duration_s=DURATION_S,
    command_rad_s=20.0,
)


@pytest.mark.parametrize("time_s", [0.4, 1.0, 4.0])
def test_two_numbers_follow_friction_that_settles_soon_or_late(time_s: float) -> None:
    """Seen where few runs had to say seven numbers: fading friction was called the rate of a clock."""
    listed = {c.label: c for c in general_candidates(smooth_kiwi().build("paper"), RANGES, False)}
    form = listed["unnamed_time: friction that settles"]
    assert form.size == 2
    effect = form.build(np.ones(2))
    assert isinstance(effect, GeneralEffect)
    t = np.linspace(0.0, DURATION_S, 200)
    columns = [basis_values(m.basis, m.shape, len(m.coefficients), t) for m in effect.terms]
    assert all(isinstance(m, Multiplier) and m.variable is Variable.TIME for m in effect.terms)
    matrix, fade = np.column_stack(columns), np.expm1(-t / time_s)
    share, *_ = np.linalg.lstsq(matrix, fade, rcond=None)
    np.testing.assert_allclose(matrix @ share, fade, atol=0.12)
    assert np.abs(matrix[0]).max() == 0.0, "a run begins with the friction of the file"


def test_no_form_takes_all_steepness_away() -> None:
    """A steepness that fell to nothing at speed held nothing: fits stopped there, runs went anywhere."""
    forms = general_candidates(smooth_kiwi().build("paper"), RANGES, False)
    seen, v = 0, np.linspace(0.0, 10.0, 200)
    for form in forms:
        for x in (form.low, form.high):
            effect = form.build(x)
            assert isinstance(effect, GeneralEffect)
            for term in effect.terms:
                if isinstance(term, Multiplier) and term.target >= Target.STIFFNESS:
                    seen += 1
                    assert term.factor(v).min() >= 0.05 - 1e-12
    assert seen >= 10
