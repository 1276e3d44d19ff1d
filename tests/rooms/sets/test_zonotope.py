"""Zonotopes against brute force, scipy's hull and themselves; degenerate ones too."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from strategies import reals

from slipmargin.errors import InputError, NoSolution
from slipmargin.sets.facets import batch_ray_exit, facet_normals, ray_exit
from slipmargin.sets.zonotope import Zonotope, exit_from

spatial = pytest.importorskip("scipy.spatial")


@st.composite
def generator_sets(draw: st.DrawFn, most: int = 7) -> np.ndarray:
    """3 to ``most`` generators, some parallel, some coplanar, some tiny, some zero."""
    n = draw(st.integers(3, most))
    coarse = st.integers(-9, 9).map(lambda k: k / 9)  # coincidences are exact, or far from it
    columns = list(np.array(draw(st.lists(coarse, min_size=3 * n, max_size=3 * n))).reshape(n, 3))
    if draw(st.booleans()):
        columns.append(draw(coarse) * columns[0])
    if draw(st.booleans()):
        columns.append(draw(coarse) * columns[0] + draw(coarse) * columns[1])
    if draw(st.booleans()):
        columns.append(1e-7 * columns[2][::-1])
    if draw(st.booleans()):
        columns.append(np.zeros(3))
    generators = np.stack(columns, axis=1) * np.array([[1.0], [1.0], [draw(reals(0.02, 1.0))]])
    assume(spans(generators))
    return generators


def spans(generators: np.ndarray) -> bool:
    """Whether generators span all three dimensions, and not just so."""
    if generators.shape[1] < 3:
        return False
    size = np.abs(generators).max(axis=1, keepdims=True)
    return bool(size.min() > 0.0 and np.linalg.svd(generators / size)[1][-1] > 0.05)


def brute(generators: np.ndarray) -> np.ndarray:
    """All 2^n sign choices."""
    return np.array(list(product((-1.0, 1.0), repeat=generators.shape[1]))) @ generators.T


def directions(seed: int, count: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 3))


@settings(max_examples=40, deadline=None)
@given(generator_sets())
def test_vertices_are_the_hull_of_all_sign_choices(generators: np.ndarray) -> None:
    found = Zonotope(generators=generators).vertices()
    points = brute(generators)
    for n in directions(1):
        assert np.max(found @ n) == pytest.approx(np.max(points @ n), rel=1e-12)
    gaps = np.linalg.norm(found[:, None] - points[None], axis=-1).min(axis=1)
    assert gaps.max() < 1e-12  # every vertex is one of the sign choices


@settings(max_examples=40, deadline=None)
@given(generator_sets())
def test_every_vertex_is_extreme_and_listed_once(generators: np.ndarray) -> None:
    long = generators[
        :, np.linalg.norm(generators, axis=0) > 1e-3
    ]  # short ones put corners beside each other
    assume(spans(long))
    zonotope = Zonotope(generators=long)
    found = zonotope.vertices()
    normal, offset = zonotope.half_spaces()
    reach = np.linalg.norm(normal, axis=1) * np.abs(generators).sum()
    touching = (offset - found @ normal.T) < 1e-9 * reach
    for corner, facets in zip(found, touching, strict=True):
        assert np.linalg.matrix_rank(normal[facets], tol=1e-6) == 3, corner  # three facets meet in a point
    apart = np.linalg.norm(found[:, None] - found[None], axis=-1) + np.eye(len(found))
    assert apart.min() > 1e-9


@settings(max_examples=40, deadline=None)
@given(generator_sets())
def test_volume_is_the_hulls(generators: np.ndarray) -> None:
    zonotope = Zonotope(generators=generators)
    assert spatial.ConvexHull(zonotope.vertices()).volume == pytest.approx(zonotope.volume(), rel=1e-8)


@settings(max_examples=40, deadline=None)
@given(generator_sets())
def test_facets_are_tight_and_hold_every_point(generators: np.ndarray) -> None:
    zonotope = Zonotope(generators=generators, centre=np.array([0.3, -1.0, 2.0]))
    points = brute(generators) + zonotope.centre
    normal, offset = zonotope.half_spaces()
    np.testing.assert_allclose(np.max(points @ normal.T, axis=0), offset, rtol=1e-11, atol=1e-13)


@settings(max_examples=40, deadline=None)
@given(generator_sets(most=5), st.integers(0, 1000))
def test_ray_exit_lies_on_the_boundary_of_the_hull(generators: np.ndarray, seed: int) -> None:
    zonotope = Zonotope(generators=generators)
    rays = directions(seed, 10)
    hull = spatial.ConvexHull(brute(generators))
    normal, offset = hull.equations[:, :3], -hull.equations[:, 3]
    along = rays @ normal.T
    want = np.min(np.where(along > 1e-12, offset / np.where(along > 1e-12, along, 1.0), np.inf), axis=1)
    np.testing.assert_allclose(zonotope.exit(rays), want, rtol=1e-7)
    np.testing.assert_allclose(batch_ray_exit(generators[None], rays)[0], want, rtol=1e-7)


@settings(max_examples=40, deadline=None)
@given(generator_sets(), st.integers(0, 1000))
def test_exit_from_an_inner_point_ends_on_the_boundary(generators: np.ndarray, seed: int) -> None:
    zonotope = Zonotope(generators=generators, centre=np.array([1.0, 0.0, -0.5]))
    inner = zonotope.centre + 0.5 * generators @ np.sign(np.array([1.0, 2.0, 3.0]) @ generators)
    rays = directions(seed, 10)
    ends = inner + zonotope.exit(rays, inner)[:, None] * rays
    slack = zonotope.slack(ends).min(axis=1)
    rounding = 8.0 * np.finfo(float).eps * float(np.max(np.abs(ends) @ np.abs(zonotope.normals).T))
    np.testing.assert_allclose(slack, 0.0, atol=1e-11 * np.abs(zonotope.offsets).max() + rounding)


@settings(max_examples=40, deadline=None)
@given(generator_sets())
def test_support_is_attained_by_a_point_of_the_set(generators: np.ndarray) -> None:
    zonotope = Zonotope(generators=generators, centre=np.array([0.1, 0.2, 0.3]))
    n = directions(3)
    terms = np.abs(n) @ (np.abs(zonotope.centre) + np.abs(generators).sum(axis=1))  # which may cancel
    points = zonotope.centre + np.sign(n @ generators) @ generators.T
    there = np.einsum("mi,mi->m", n, points)
    np.testing.assert_array_less(np.abs(there - zonotope.support(n)), 1e-13 * terms)


@pytest.mark.parametrize("count", [4, 9, 20])
def test_generic_counts(count: int) -> None:
    # n(n−1) facets and n(n−1)+2 vertices for n generators in general position.
    zonotope = Zonotope(generators=np.random.default_rng(count).normal(size=(3, count)))
    assert 2 * len(zonotope.normals) == count * (count - 1)
    assert len(zonotope.vertices()) == count * (count - 1) + 2


def test_more_than_sixty_four_generators() -> None:
    zonotope = Zonotope(generators=np.random.default_rng(0).normal(size=(3, 70)))
    assert len(zonotope.vertices()) == 70 * 69 + 2


def test_box_has_eight_corners_however_it_is_cut() -> None:
    parts = np.array([[1, 0, 0], [0.5, 0, 0], [-0.25, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]], dtype=float).T
    zonotope = Zonotope(generators=parts)
    assert len(zonotope.normals) == 3
    np.testing.assert_allclose(np.sort(np.unique(np.abs(zonotope.vertices()), axis=0)), [[1.0, 1.0, 1.75]])
    assert len(zonotope.vertices()) == 8
    assert zonotope.volume() == pytest.approx(8 * 1.75)


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_nearly_parallel_generators_move_nothing(angle: float) -> None:
    one = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1.0]]).T
    extra = np.array([[np.cos(angle)], [np.sin(angle)], [0.0]])
    zonotope = Zonotope(generators=np.hstack([one, extra]))
    reach = float(zonotope.exit(np.array([[1.0, 0.0, 0.0]]))[0])
    assert reach == pytest.approx(2.0, abs=1.01 * angle + 1e-12)
    assert len(zonotope.vertices()) in (8, 12)


def test_flat_generators_are_refused() -> None:
    with pytest.raises(InputError, match="do not span"):
        Zonotope(generators=np.array([[1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float).T)


def test_zero_direction_is_refused() -> None:
    with pytest.raises(InputError, match="length zero"):
        facet_normals(np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]], dtype=float).T)


def test_ray_from_outside_is_refused() -> None:
    zonotope = Zonotope(generators=np.eye(3))
    with pytest.raises(NoSolution, match="outside"):
        zonotope.exit(np.array([[1.0, 0.0, 0.0]]), np.array([2.0, 0.0, 0.0]))


def test_rays_inside_a_flat_set() -> None:
    # Lengths may be zero once normals are known: a wheel without load.
    normals = facet_normals(np.eye(3))
    offsets = np.abs(normals) @ np.array([1.0, 2.0, 0.0])
    out = ray_exit(normals, offsets, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    np.testing.assert_allclose(out, [1.0, 2.0, 0.0])


def test_ray_along_a_face_never_meets_its_plane() -> None:
    normal, offset = Zonotope(generators=np.eye(3)).half_spaces()
    out = exit_from(normal, offset, np.array([0.0, 0.0, 1.0]), np.array([[1.0, 0.0, 0.0]]))
    np.testing.assert_allclose(out, [1.0])


@pytest.mark.parametrize("size", [1e-200, 1e-12, 1.0, 1e200])
def test_vertices_of_any_size(size: float) -> None:
    generators = size * np.array([[1.0, 0.0, 0.0, 1e-3], [0.0, 2.0, 0.0, 1e-3], [0.0, 0.0, 0.5, 1e-3]])
    of_one = Zonotope(generators=generators / size).vertices()
    scaled = Zonotope(generators=generators).vertices() / size
    assert len(of_one) == 14
    np.testing.assert_allclose(np.sort(scaled, axis=0), np.sort(of_one, axis=0), rtol=1e-12)


def test_a_generator_of_no_account_beside_others() -> None:
    generators = np.column_stack([np.eye(3), [1e-300, 2e-300, 1e-300]])
    corners = Zonotope(generators=generators).vertices()
    np.testing.assert_array_equal(np.abs(corners), 1.0)
    assert len(np.unique(corners, axis=0)) == 8
