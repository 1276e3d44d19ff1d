"""Golden numbers of static slip limits.

Birth certificate: docs/theory.md, sections 2 and 3, golden there: computed independently of this package
(the linear program of Williams, Carter, Gallina and Rosati 2002, eqs 13–18, with Table I), and the
benchmark reference of shared/peers.md section 3.1.  Tolerance: the digits printed there.
"""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.limits import Pull, sweep, wrench_set
from slipmargin.limits.cones import cone_limits
from slipmargin.limits.sweep import limit
from slipmargin.model import nominal_model
from slipmargin.physics.loads import load_centre
from slipmargin.robot import LoadRule

HEADINGS = np.deg2rad([0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0])

# docs/theory.md, section 2, golden table: F_emax / (m g), equal loads.
# (surface, all rigid, delta) -> seven headings.
TABLE = {
    ("paper", False, 15.0): (0.16705, 0.17295, 0.19290, 0.19357, 0.19357, 0.20570, 0.21296),
    ("paper", False, 30.0): (0.18196, 0.18838, 0.21011, 0.18838, 0.18196, 0.18838, 0.21011),
    ("paper", True, 15.0): (0.49987, 0.51751, 0.57720, 0.55339, 0.54042, 0.52201, 0.54042),
    ("carpet", False, 15.0): (0.20149, 0.20860, 0.23267, 0.22814, 0.22814, 0.22880, 0.23687),
    ("carpet", True, 15.0): (0.59559, 0.61660, 0.68773, 0.65935, 0.64390, 0.62196, 0.64390),
}
PRINTED = 0.5e-5  # five decimals


@pytest.mark.parametrize("radius_m", [0.05, 0.095, 0.3])
@pytest.mark.parametrize("row", TABLE, ids=lambda r: f"{r[0]}-{'rigid' if r[1] else 'rollers'}-{r[2]:g}")
def test_table_of_section_2_by_facets(row: tuple[str, bool, float], radius_m: float) -> None:
    surface, rigid, delta = row
    model = nominal_model(kiwi(delta, radius_m=radius_m), surface)
    force = limit(model, HEADINGS, Pull(), np.full(3, rigid)) / model.inertia.weight_N
    np.testing.assert_allclose(force, TABLE[row], rtol=0.0, atol=PRINTED)


@pytest.mark.parametrize("row", TABLE, ids=lambda r: f"{r[0]}-{'rigid' if r[1] else 'rollers'}-{r[2]:g}")
def test_table_of_section_2_by_clarabel(row: tuple[str, bool, float]) -> None:
    surface, rigid, delta = row
    model = nominal_model(kiwi(delta), surface)
    force = cone_limits(model, HEADINGS, rigid=np.full(3, rigid)).force_N / model.inertia.weight_N
    np.testing.assert_allclose(force, TABLE[row], rtol=0.0, atol=PRINTED)


@pytest.mark.parametrize(("delta", "vertices"), [(15.0, 28), (30.0, 24)])
def test_vertices_of_section_2(delta: float, vertices: int) -> None:
    assert len(wrench_set(nominal_model(kiwi(delta), "paper")).zonotope().vertices()) == vertices


def test_facets_at_fifteen_degrees() -> None:
    # peers.md section 3.2, "trap for tests": the three axles are coplanar, so 22 facets and not 30.
    assert len(wrench_set(nominal_model(kiwi(15.0), "paper")).normals) == 22


def test_volume_of_the_paper_robot() -> None:
    # docs/theory.md does not print it; 8 Σ|det| (McMullen) against the hull of the vertices, another road.
    spatial = pytest.importorskip("scipy.spatial")
    zonotope = wrench_set(nominal_model(kiwi(), "paper")).zonotope()
    assert spatial.ConvexHull(zonotope.vertices()).volume == pytest.approx(zonotope.volume(), rel=1e-12)


def test_reference_forces_at_three_kilograms() -> None:
    # peers.md section 3.1: F(0°) = 4.916375680 N (minimum), maximum 6.267303495 N; m = 3 kg, g = 9.81.
    found = sweep(nominal_model(kiwi(), "paper"), np.deg2rad(np.arange(0.0, 360.5, 0.5)))
    assert found.weakest == (0.0, pytest.approx(4.916375680, abs=0.5e-9))
    assert found.strongest[1] == pytest.approx(6.267303495, abs=0.5e-9)


def test_static_loads_of_section_3() -> None:
    # docs/theory.md, section 3: N_3 = 0.2056 m g, N_1 = N_2 = 0.3972 m g.
    model = nominal_model(kiwi(load_rule=LoadRule.STATIC), "paper")
    share = model.loads.rest_N / model.inertia.weight_N
    np.testing.assert_allclose(share, [0.3972, 0.3972, 0.2056], rtol=0.0, atol=0.5e-4)


def test_equal_loads_need_the_centre_of_mass_behind() -> None:
    # docs/theory.md, section 3: 0.161 of the centre-to-wheel radius behind the centre.
    model = nominal_model(kiwi(), "paper")
    centre = load_centre(model.geometry.position_m, model.loads.rest_N)
    np.testing.assert_allclose(centre / 0.095, [0.0, -0.161], rtol=0.0, atol=0.5e-3)


def test_symmetric_layout_repeats_every_sixty_degrees() -> None:
    model = nominal_model(kiwi(30.0), "carpet")
    phi = np.linspace(0.0, 1.0, 50)
    first, turned, mirrored = (limit(model, p, Pull()) for p in (phi, phi + np.pi / 3, np.pi / 3 - phi))
    np.testing.assert_allclose(turned, first, rtol=1e-12)
    np.testing.assert_allclose(mirrored, first, rtol=1e-12)


def test_band_edges_are_the_two_published_rows() -> None:
    # docs/theory.md, section 2: rigid coefficients exceed the rollers', so the band runs from row to row.
    model = nominal_model(kiwi(), "paper")
    found = sweep(model, HEADINGS)
    weight = model.inertia.weight_N
    np.testing.assert_allclose(found.f_low_N / weight, TABLE["paper", False, 15.0], rtol=0.0, atol=PRINTED)
    np.testing.assert_allclose(found.f_high_N / weight, TABLE["paper", True, 15.0], rtol=0.0, atol=PRINTED)
