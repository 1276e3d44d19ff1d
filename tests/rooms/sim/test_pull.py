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
from slipmargin.model.parts import Drives
from slipmargin.physics.friction_laws import LAWS
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


@pytest.mark.parametrize("law", range(len(LAWS)), ids=LAWS)
def test_every_friction_law_breaks_away_at_the_limit(law):
    """The limit knows no law; with the file's eq. (11) taken for granted two of three were missed."""
    model = nominal_model(kiwi(), "paper")
    model = replace(model, grip=replace(model.grip, law=law))
    np.testing.assert_allclose(pull_test(model, PHI[:6]).force_N, sweep(model, PHI[:6]).f_max_N, rtol=5e-3)


@pytest.mark.parametrize("case", ["softer", "creepage"])
def test_breakaway_where_an_effect_changed_the_steepness(case):
    """k = 50 instead of the file's 1000, or a half that goes with 1/speed: the limit stays, and is found."""
    from slipmargin.effects.friction_coefficients import FrictionCoefficients
    from slipmargin.effects.recipe import with_effects
    from slipmargin.effects.slip_ratio_friction import SlipRatioFriction

    soft = FrictionCoefficients(drive_factor=1.0, transverse_factor=1.0, steepness_factor=0.05)
    effect = soft if case == "softer" else SlipRatioFriction(share=0.5, steepness=20.0)
    model = with_effects(nominal_model(kiwi(), "paper"), (effect,))
    np.testing.assert_allclose(pull_test(model, PHI[:6]).force_N, sweep(model, PHI[:6]).f_max_N, rtol=5e-3)


def test_a_law_of_the_slip_ratio_alone_has_no_limit():
    """z = κ u/(u + v_0) stays below κ = 4: no slip uses more than σ(4) = 0.84 of the grip."""
    from slipmargin.effects.recipe import with_effects
    from slipmargin.effects.slip_ratio_friction import SlipRatioFriction

    model = with_effects(nominal_model(kiwi(), "paper"), (SlipRatioFriction(share=1.0, steepness=4.0),))
    with pytest.raises(NoSolution, match=r"no contact uses more than 0\.84"):
        pull_test(model, PHI[:2])


def test_motors_that_cannot_hold_the_wheels_are_driven_back():
    """A wheel gives way at the lesser of μ_W N and stall/ρ; the test says which of the two it was."""
    model, stall = nominal_model(kiwi(), "paper"), 0.03
    held = replace(model, drives=Drives(max_speed_rad_s=40.0, stall_torque_N_m=stall))
    found = pull_test(held, PHI[:6])
    roller = model.grip.roller.copy()
    roller[:, 0] = stall / 0.0254 / model.loads.rest_N  # 1.18 N where friction would hold 2.55
    want = sweep(replace(model, grip=replace(model.grip, roller=roller)), PHI[:6]).f_max_N
    np.testing.assert_allclose(found.force_N, want, rtol=5e-3)
    assert found.limit == ("motor",) * 6
    strong = replace(model, drives=Drives(max_speed_rad_s=40.0, stall_torque_N_m=1.0))
    firm = pull_test(strong, PHI[:2])
    assert firm.limit == ("friction",) * 2
    np.testing.assert_allclose(firm.force_N, sweep(model, PHI[:2]).f_max_N, rtol=5e-3)


def test_bad_pulls_are_refused():
    model = nominal_model(kiwi(), "paper")
    with pytest.raises(InputError, match="names 2 wheels"):
        pull_test(model, PHI, rigid=(True, False))
    sticky = replace(model, grip=replace(model.grip, viscous_N_s_per_m=np.array([1e6, 1e6])))
    with pytest.raises(NoSolution, match="does not run away"):
        pull_test(sticky, PHI[:1])
