"""Statics from dynamics: where the simulated robot runs away is where the limits say it must.

docs/theory.md, section 2: with the wheels locked a creep exists exactly inside the wrench set.  The limits
room shares no code with the simulator (tests/house keeps it so); here, and only here, both meet.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels, kiwi

from slipmargin.errors import InputError, NoSolution
from slipmargin.limits import sweep
from slipmargin.limits.sensitivity import sensitivity
from slipmargin.model import nominal_model
from slipmargin.sim.pull import pull_test, standing

PHI = np.deg2rad(np.arange(24) * 15.0)


@pytest.mark.parametrize("surface", ["paper", "carpet"])
@pytest.mark.parametrize("rigid", [False, True])
def test_breakaway_is_the_static_limit(surface, rigid):
    """24 orientations × two surfaces × both contact states within 0.5 %."""
    model = nominal_model(kiwi(), surface)
    found = pull_test(model, PHI, rigid=(rigid,) * 3)
    want = sweep(standing(model, (rigid,) * 3), PHI)
    np.testing.assert_allclose(found.force_N, want.f_max_N, rtol=5e-3)


@pytest.mark.parametrize("surface", ["paper", "carpet"])
@pytest.mark.parametrize("rigid", [False, True])
def test_only_the_limiting_contacts_slide(surface, rigid):
    """The contacts (drive or transverse) that run away are those the limit names, 88 of 144.

    Two may differ: where a heading lies near the corner of two facets, a contact of the second one
    already creeps along.  No wheel slides that is not named.
    """
    model, phi = standing(nominal_model(kiwi(), surface), (rigid,) * 3), PHI + np.deg2rad(7.0)
    sliding, limits = pull_test(model, phi).sliding, sensitivity(model, phi)
    assert np.sum(sliding != limits.saturated) <= 2
    assert limits.saturated.sum() == 88
    names = np.array(model.geometry.names)
    for row, named in zip(sliding, limits.wheels(), strict=True):
        assert set(names[row.any(axis=1)]) <= set(named)


def test_four_mecanum_wheels_break_away_at_their_limit():
    model = nominal_model(four_wheels(), "carpet")
    phi = np.deg2rad([0.0, 20.0, 90.0])
    np.testing.assert_allclose(pull_test(model, phi).force_N, sweep(model, phi).f_max_N, rtol=5e-3)


def test_bad_pulls_are_refused():
    model = nominal_model(kiwi(), "paper")
    with pytest.raises(InputError, match="names 2 wheels"):
        pull_test(model, PHI, rigid=(True, False))
    sticky = replace(model, grip=replace(model.grip, viscous_N_s_per_m=np.array([1e6, 1e6])))
    with pytest.raises(NoSolution, match="does not run away"):
        pull_test(sticky, PHI[:1])
