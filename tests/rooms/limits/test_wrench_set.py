"""Wrench sets: per-wheel supports add up, loads enter linearly, import stays light."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from strategies import kiwi, models

from slipmargin.limits import wrench_set
from slipmargin.model import Model, nominal_model
from slipmargin.robot import GripShape

NORMALS = np.random.default_rng(0).normal(size=(50, 3))


@settings(max_examples=30, deadline=None)
@given(models())
def test_support_is_the_zonotopes(model: Model) -> None:
    wrenches = wrench_set(model)
    zonotope = wrenches.zonotope()
    np.testing.assert_allclose(wrenches.support(NORMALS), zonotope.support(NORMALS), rtol=1e-12)
    corners = zonotope.vertices()
    np.testing.assert_allclose(wrenches.offsets, np.max(corners @ wrenches.normals.T, axis=0), rtol=1e-10)


@settings(max_examples=30, deadline=None)
@given(models(shapes=tuple(GripShape)))
def test_offsets_are_linear_in_the_loads(model: Model) -> None:
    wrenches = wrench_set(model)
    other = replace(wrenches, load_N=2.0 * wrenches.load_N[::-1])
    np.testing.assert_allclose(other.offsets, wrenches.share(wrenches.normals) @ other.load_N, rtol=1e-13)
    np.testing.assert_array_equal(other.normals, wrenches.normals)


@settings(max_examples=30, deadline=None)
@given(models(shapes=tuple(GripShape)))
def test_points_of_the_surface_attain_the_support(model: Model) -> None:
    """Each lies in the set (no normal sees it beyond the support) and on its surface."""
    wrenches = wrench_set(model)
    points, height = wrenches.points(NORMALS), wrenches.support(NORMALS)
    np.testing.assert_allclose(np.sum(points * NORMALS, axis=1), height, rtol=1e-12)
    assert np.all(points @ NORMALS.T <= height * (1.0 + 1e-12))


def test_the_body_is_that_of_the_robot_s_own_grip() -> None:
    """Its hull lies a percent inside at most; the box holds the disc-strip, which holds the ellipse."""
    volume = {}
    for shape in GripShape:
        wrenches = wrench_set(nominal_model(kiwi(grip=shape), "paper"))
        body = wrenches.body()
        normals, offsets = body.half_spaces()
        reach = wrenches.support(normals) / offsets
        assert np.min(reach) > 1.0 - 1e-9 and np.max(reach) < 1.01
        assert np.max(body.vertices() @ normals.T - offsets) < 1e-9 * np.max(offsets)
        volume[shape] = body.volume()
    assert volume[GripShape.ELLIPSE] < volume[GripShape.DISC_STRIP] < volume[GripShape.BOX]


def test_state_chooses_the_coefficients() -> None:
    model = nominal_model(kiwi(), "paper")
    mixed = wrench_set(model, np.array([True, False, False]))
    np.testing.assert_allclose(mixed.coefficients[..., 1], [[0.47, 0.47], [0.26, 0.09], [0.26, 0.09]])


def test_only_the_box_is_polyhedral() -> None:
    for shape in GripShape:
        model = nominal_model(kiwi(grip=shape), "paper")
        assert wrench_set(model).polyhedral is (shape is GripShape.BOX)
    soft = nominal_model(kiwi(grip=GripShape.ELLIPSE), "paper")
    assert wrench_set(replace(soft, grip=replace(soft.grip, coupling=0.0))).polyhedral


def test_importing_limits_loads_no_solver() -> None:
    code = (
        "import sys, slipmargin.limits\n"
        "print([m for m in ('cvxpy', 'clarabel', 'scipy', 'numba', 'matplotlib') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_box_sweep_loads_no_solver() -> None:
    code = (
        "import sys, numpy as np\nsys.path.insert(0, 'tests')\n"
        "from slipmargin.limits import sweep\nfrom slipmargin.model import nominal_model\n"
        "from slipmargin.robot import *\n"
        "a = [15, 165, -90]\n"
        "w = tuple(Wheel(name=str(k), position_m=[np.cos(np.deg2rad(k)), np.sin(np.deg2rad(k))],\n"
        "                drive_direction_deg=k + 90.0, radius_m=0.02) for k in a)\n"
        "c = Coefficients(drive=0.3, transverse=0.1)\n"
        "r = Robot(name='r', body=Body(mass_kg=1.0, inertia_kg_m2=1.0), wheels=w,\n"
        "          surfaces=(Surface(name='s', roller=c, rigid=c),))\n"
        "sweep(nominal_model(r, 's'), np.zeros(3)).limiting()\n"
        "print([m for m in ('cvxpy', 'clarabel', 'scipy', 'numba', 'matplotlib') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"
