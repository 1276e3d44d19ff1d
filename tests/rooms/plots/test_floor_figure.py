"""The map of the floor: the patch is drawn where the finding puts it, and only where there is one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnoses import diagnosis, wheel_loads
from matplotlib.image import AxesImage

from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.result import Diagnosis
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Trace
from slipmargin.effects.floor_border import FloorBorder
from slipmargin.effects.floor_patch import FloorPatch
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable
from slipmargin.plots.diagnosis import figures
from slipmargin.plots.floor import floor_figure, floor_terms

PATCH = FloorPatch(factor=0.4, centre_x_m=0.2, centre_y_m=-0.35, radius_m=0.16)


def found(*effects: AnyEffect) -> Diagnosis:
    return diagnosis(findings=tuple(wheel_loads(effect=e) for e in effects))


def drawn_at(image: AxesImage, x: float, y: float) -> float:
    """The value that the picture shows at a place of its axes."""
    left, right, bottom, top = image.get_extent()
    values = np.asarray(image.get_array())
    row = round((y - bottom) / (top - bottom) * (len(values) - 1))
    column = round((x - left) / (right - left) * (values.shape[1] - 1))
    return float(values[row, column])


@pytest.mark.parametrize(
    ("effects", "place", "want"),
    [
        ((PATCH,), (0.2, -0.35), 0.4),
        ((PATCH,), (0.2, -0.23), 0.4),
        ((PATCH,), (0.2, -0.15), 1.0),
        ((PATCH,), (-0.35, 0.2), 1.0),  # x and y changed over
        ((FloorBorder(factor=1.6, offset_m=0.1, direction_rad=np.pi / 2),), (-0.4, 0.15), 1.6),
        ((FloorBorder(factor=1.6, offset_m=0.1, direction_rad=np.pi / 2),), (0.4, 0.05), 1.0),
        ((PATCH, FloorBorder(factor=1.6, offset_m=0.1)), (0.25, -0.35), 0.64),
    ],
)
def test_friction_is_drawn_where_it_is(
    effects: tuple[AnyEffect, ...], place: tuple[float, float], want: float
) -> None:
    (image,) = floor_figure(found(*effects)).axes[0].images
    assert drawn_at(image, *place) == pytest.approx(want, abs=0.01)


def test_the_map_holds_every_contact_of_the_runs() -> None:
    result = found(PATCH)
    (image,) = floor_figure(result).axes[0].images
    reach = np.max(np.hypot(*result.recipe.build("paper").geometry.position_m.T))
    left, right, bottom, top = image.get_extent()
    for t in result.trials:
        assert np.nanmin(t.measured[:, 0]) - reach > left and np.nanmax(t.measured[:, 0]) + reach < right
        assert np.nanmin(t.measured[:, 1]) - reach > bottom and np.nanmax(t.measured[:, 1]) + reach < top


def test_a_finding_without_a_place_draws_no_map() -> None:
    for result, drawn in ((diagnosis(), False), (found(PATCH), True)):
        change = limits_change(result.recipe, result.corrected, result.surface)
        assert ("floor" in figures(result, change)) is drawn


def test_a_place_that_one_wheel_alone_feels_is_none_of_the_floor() -> None:
    for weights, drawn in ((np.ones(3), 1), (np.array([1.0, 0.0, 0.0]), 0)):
        term = Multiplier(
            variable=Variable.FROM_PLACE,
            basis=Basis.STEP,
            coefficients=np.array([-0.5]),
            shape=np.array([0.2, 0.01]),
            wheels=weights,
        )
        effect = GeneralEffect(traced_to=Trace.POSITION, part=Part.GRIP, terms=(term,))
        assert len(floor_terms(found(effect))) == drawn


def test_a_patch_too_weak_to_see_is_pale() -> None:
    (image,) = floor_figure(found(replace(PATCH, factor=0.999))).axes[0].images
    low, high = image.get_clim()
    assert low < 0.95 and high > 1.05
