"""An ellipse whose wheel slides sideways at full slip has no grip left to drive."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.bounds_inside import inside
from slipmargin.limits.bounds_summary import bounds
from slipmargin.limits.motion import acceleration_limit, needed_share
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model
from slipmargin.physics.friction_laws import law_share
from slipmargin.physics.grips import GripShape
from slipmargin.report.exports import bounds_table, plain_json

ROUND = headings(5.0)


def robot(shape: GripShape = GripShape.ELLIPSE, coupling: float = 1.0) -> Model:
    model = nominal_model(kiwi(), "paper")
    return replace(model, grip=replace(model.grip, shape=shape, coupling=coupling))


def coasting(model: Model, heading: float) -> np.ndarray:
    """Acceleration by full drag alone, wheel by wheel."""
    v = np.array([np.cos(heading), np.sin(heading), 0.0])
    slide = model.geometry.lateral_rows() @ v
    force = np.zeros(3)
    for i in range(3):
        if abs(slide[i]) > 1e-9:
            f = -np.sign(slide[i]) * 0.09 * model.loads.rest_N[i] * model.geometry.free[i]
            p = model.geometry.position_m[i]
            force += [*f, p[0] * f[1] - p[1] * f[0]]
    return force / model.inertia.diagonal


def test_drag_that_pushes_ahead_is_named_too() -> None:
    """Turning wheels drag rollers at an angle along, which may push ahead; no grip is left all the same."""
    plain = kiwi()
    wheels = tuple(replace(w, roller_angle_deg=60.0) for w in plain.wheels)
    model = nominal_model(replace(plain, wheels=wheels), "paper")
    model = replace(model, grip=replace(model.grip, shape=GripShape.ELLIPSE, coupling=1.0))
    found = directions(model, ROUND + 0.01, motor=False)
    assert np.any(found.starting_m_s2 > 0.01) and np.all(np.isinf(found.steady_use))
    assert set(found.starting.cause) == {"drag uses the whole grip"} and np.all(found.starting.coasts)
    for names, spent in zip(found.starting.wheels, found.starting.rows.spent, strict=True):
        assert names == tuple(np.array(model.geometry.names)[spent])


def test_bounds_of_an_ellipse_are_numbers_to_read() -> None:
    model = robot()
    found = bounds(model, step_deg=5.0)
    for d in (found.full, found.safe):
        for values in (d.starting_m_s2, d.turning_m_s2, d.braking_m_s2):
            assert np.all(np.isfinite(values)) and np.max(np.abs(values)) < 1.0
        assert np.all(np.isinf(d.steady_use))  # no share of the drive grip holds constant speed
        assert set(d.starting.cause) == {"drag uses the whole grip"}
        assert all(d.starting.wheels)
    for k, way in enumerate(ROUND):
        slowing = float(coasting(model, way)[:2] @ [np.cos(way), np.sin(way)])
        assert found.full.starting_m_s2[k] == pytest.approx(slowing, rel=1e-9)
        assert found.full.braking_m_s2[k] == pytest.approx(-slowing, rel=1e-9)
    assert found.recommended_m_s2 == 0.0
    assert found.inside is None and "drag uses the whole grip" in found.why_not
    table = json.loads(plain_json(found), parse_constant=lambda word: pytest.fail(f"{word} in JSON"))
    assert table["steady_use"] == [None] * len(ROUND)
    assert bounds_table(found)["cause"][0] == "drag uses the whole grip"


def test_wheels_named_are_those_that_slide_sideways() -> None:
    found = directions(robot(), np.array([0.0, np.pi / 2])).starting
    # along +X the rear wheel rolls as it drives and slides nowhere
    assert found.wheels[0] == ("right", "left")
    assert np.array_equal(found.rows.spent[0], [True, True, False])


@pytest.mark.parametrize("speed", [1e-3, 0.05])
def test_at_a_speed_the_ellipse_leaves_what_the_law_says(speed: float) -> None:
    model = robot()
    ahead = np.array([[np.cos(0.3), np.sin(0.3), 0.0]])
    slide = speed * ahead @ model.geometry.lateral_rows().T
    # the ellipse's law where nothing slips along the grip (physics/contact.py)
    share = law_share(model.grip.law, 1000.0 * 0.09 / 0.26 * slide)[0]
    left = np.sqrt(1.0 - share**2)
    rows = acceleration_limit(model, Motion(velocity=speed * ahead), ahead)
    assert not np.any(rows.rows.spent) and np.all(left > 0.0)
    # by the three balances: drive forces within what is left
    drag = 0.09 * share * model.loads.rest_N
    drive, side = model.wrench_maps()
    asked = rows.value[0] * ahead[0] * model.inertia.diagonal + side @ drag
    use = np.abs(np.linalg.solve(drive, asked)) / (0.26 * left * model.loads.rest_N)
    assert np.max(use) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("coupling", [0.5, 0.999])
def test_a_blend_leaves_its_box_part(coupling: float) -> None:
    model = robot(coupling=coupling)
    way = ROUND + 0.01  # every wheel slides sideways
    found = directions(model, way)
    assert np.all(np.isfinite(found.steady_use)) and not np.any(found.starting.rows.spent)
    box = directions(robot(GripShape.BOX), way)
    assert found.steady_use == pytest.approx(box.steady_use / (1.0 - coupling), rel=1e-9)


def test_disc_and_strip_on_rigid_material_is_spent_too() -> None:
    """There μ_T = μ_W: a wheel that slides sideways on it has nothing left."""
    model = robot(GripShape.DISC_STRIP)
    motion = Motion.full_drag(np.array([[1.0, 0.0, 0.0]]))
    assert np.isfinite(needed_share(model, motion)[0])
    assert needed_share(model, motion, contact=Contact.RIGID)[0] == np.inf
    with pytest.raises(NoSolution, match="drag uses the whole grip"):
        inside(model, contact=Contact.RIGID)
