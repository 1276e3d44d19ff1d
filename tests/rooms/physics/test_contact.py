"""The roller that spins, against plain root finding; laws' derivatives against differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from scipy.optimize import brentq
from strategies import reals

from slipmargin.physics.contact import BOX, contact, disc_strip, spun
from slipmargin.physics.friction_laws import LAWS, law_inverse, law_share, law_slope, law_slopes
from slipmargin.physics.grips import GripShape, across_alone, rise_across

EVERY_LAW = st.sampled_from(range(len(LAWS)))


@given(EVERY_LAW, reals(1e-6, 0.999), reals(-9.0, 4.0), reals(1e-6, 4.0))
@example(law=0, part=0.2, digits=-9.0, beyond=4.0)
def test_a_roller_spins_as_fast_as_its_bearing_asks(
    law: int, part: float, digits: float, beyond: float
) -> None:
    drive = 10.0**digits

    def miss(z: float) -> float:
        return float(law_share(law, np.hypot(drive, z)) * z / np.hypot(drive, z)) - part

    still = float(law_inverse(law, part))
    far = np.hypot(still, drive) * 10.0**beyond
    while miss(far) <= 1e-9:  # as far as the law's tail needs
        far *= 2.0
    z = brentq(miss, 0.5 * still, far, xtol=1e-300, rtol=1e-14)
    p, share, slope = spun(law, part, drive, float(np.hypot(drive, far)))
    assert p == pytest.approx(np.hypot(drive, z), rel=1e-8 / (1.0 - part))
    assert share == pytest.approx(law_share(law, p), rel=1e-14)
    assert slope == pytest.approx(law_slope(law, p), rel=1e-6, abs=1e-15)


@given(EVERY_LAW, reals(0.01, 1.2), reals(0.0, 1.0), reals(-3.0, 3.0), reals(-3.0, 3.0))
def test_the_disc_strip_keeps_to_disc_and_strip(
    law: int, disc: float, part: float, along: float, across: float
) -> None:
    k, bearing = 300.0, part * disc
    f, g, *_ = disc_strip(law, along, across, disc, bearing, k)
    assert np.hypot(f, g) <= disc * (1.0 + 1e-12) and abs(g) <= bearing * (1.0 + 1e-12)
    assert f * along >= 0.0 and g * across >= 0.0


@given(EVERY_LAW, reals(-6.0, 6.0))
def test_slopes_of_the_laws_are_their_derivatives(law: int, z: float) -> None:
    step = 1e-5
    first, second = law_slopes(law, z, law_share(law, z))
    ahead, behind = law_share(law, z + step), law_share(law, z - step)
    assert first == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-9)
    bend = (law_slope(law, z + step) - law_slope(law, z - step)) / (2.0 * step)
    assert second == pytest.approx(bend, abs=1e-9)


@given(
    EVERY_LAW,
    st.sampled_from(list(enumerate(GripShape))),
    reals(0.0, 1.0),
    st.tuples(reals(0.05, 1.2), reals(0.0, 1.2)),
    st.tuples(reals(0.5, 3.0), reals(0.5, 3.0)),
    reals(-5.0, 0.5),
)
def test_a_wheel_that_slips_across_only_has_the_force_of_the_whole_law(
    law: int,
    named: tuple[int, GripShape],
    coupling: float,
    mu: tuple[float, float],
    steep: tuple[float, float],
    digits: float,
) -> None:
    (number, shape), slip, (kw, kt) = named, 10.0**digits, (10.0 ** steep[0], 10.0 ** steep[1])
    part = 0.0 if number == BOX else coupling
    for way in (slip, -slip):
        whole = contact(law, number, part, 0.0, way, *mu, kw, kt)[1]
        alone = across_alone(law, part, way, (mu[1], kt), rise_across(shape, *mu, kw))
        assert alone == pytest.approx(whole, rel=1e-9, abs=1e-15)
