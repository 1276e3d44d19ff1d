"""The values of Fig. 8 that ``reproduce`` reports are docs/theory.md's, section 2."""

from __future__ import annotations

import numpy as np
import pytest

from slipmargin.paper.figure8 import HEADINGS_DEG, fig8_curves

#: docs/theory.md, section 2, "checked" there independently: F_emax / (m g), equal loads, five decimals.
CHECKED = {
    ("paper", "rollers", 15.0): (0.16705, 0.17295, 0.19290, 0.19357, 0.19357, 0.20570, 0.21296),
    ("paper", "rollers", 30.0): (0.18196, 0.18838, 0.21011, 0.18838, 0.18196, 0.18838, 0.21011),
    ("paper", "rigid", 15.0): (0.49987, 0.51751, 0.57720, 0.55339, 0.54042, 0.52201, 0.54042),
    ("carpet", "rollers", 15.0): (0.20149, 0.20860, 0.23267, 0.22814, 0.22814, 0.22880, 0.23687),
    ("carpet", "rigid", 15.0): (0.59559, 0.61660, 0.68773, 0.65935, 0.64390, 0.62196, 0.64390),
}


@pytest.mark.parametrize("curve", fig8_curves(), ids=lambda c: f"{c.surface}-{c.state}-{c.delta_deg:g}")
def test_values_of_figure_8(curve) -> None:
    assert HEADINGS_DEG == (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
    wanted = CHECKED[curve.surface, curve.state, curve.delta_deg]
    np.testing.assert_allclose(curve.per_weight, wanted, rtol=0.0, atol=0.5e-5)


def test_every_checked_curve_is_there() -> None:
    assert {(c.surface, c.state, c.delta_deg) for c in fig8_curves()} == set(CHECKED)
