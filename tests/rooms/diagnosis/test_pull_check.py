"""Pull tests beside a diagnosis: the corrected robot must predict another experiment better, or be told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnoses import diagnosis
from json_schemas import faults
from matplotlib.figure import Figure

from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.limits_change import limits_change
from slipmargin.diagnosis.pull_check import predicted, pull_check
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Effect, Recipe
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.plots.style import image
from slipmargin.report.diagnosis_json import report_text
from slipmargin.report.diagnosis_page import page
from slipmargin.report.diagnosis_words import pulls_sentence, summary_lines
from slipmargin.report.page import html

IMAGES = ("residual", "where", "candidates", "held-out", "limits")
PHI = np.deg2rad(np.arange(0.0, 360.0, 15.0))


@pytest.fixture(scope="module")
def believed() -> Recipe:
    return read_recipe("ohio-kiwi")


@pytest.fixture(scope="module")
def corrected(believed: Recipe) -> Recipe:
    shift = np.array([0.0, 0.012, *[0.0] * (len(WheelLoads.parameters) - 2)])
    return believed.with_effects(WheelLoads.of(shift))


def test_known_angles_tell_the_contact_state(believed: Recipe) -> None:
    model = believed.build("paper")
    pitch = 2.0 * np.pi / 8
    on_rollers, on_rigid = 0.45 * pitch, 0.95 * pitch  # a tenth of each sector is rigid, at its end
    theta = np.tile([on_rollers, on_rigid, on_rollers], (len(PHI), 1))
    wanted = limit(model, PHI, Pull(), np.array([False, True, False]))
    found = predicted(model, Pulls(phi_rad=PHI, force_N=np.ones(len(PHI)), theta_rad=theta - 3.0 * pitch))
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


def test_unknown_angles_leave_the_band(believed: Recipe) -> None:
    model = believed.build("paper")
    low = limit(model, PHI, Pull())
    inside = predicted(model, Pulls(phi_rad=PHI, force_N=1.2 * low))
    np.testing.assert_allclose(inside, 1.2 * low)  # between rollers and rigid material nothing is a miss
    np.testing.assert_allclose(predicted(model, Pulls(phi_rad=PHI, force_N=0.5 * low)), low, rtol=1e-9)


def test_pulls_of_the_corrected_robot_confirm_it_and_others_do_not(
    believed: Recipe, corrected: Recipe
) -> None:
    theta = np.zeros((len(PHI), 3))
    real = limit(corrected.build("paper"), PHI, Pull())
    pulls = Pulls(phi_rad=PHI, force_N=real, theta_rad=theta)
    change = limits_change(believed, corrected, "paper", pulls)
    assert change.pulls is not None
    assert change.pulls.rms_after_N < 1e-9 < 0.05 < change.pulls.rms_before_N
    assert "confirm" in pulls_sentence(change.pulls)
    against = replace(pulls, force_N=limit(believed.build("paper"), PHI, Pull()))
    check = pull_check(believed.build("paper"), corrected.build("paper"), against)
    assert check.rms_before_N < 1e-9 and "speak against" in pulls_sentence(check)
    assert check.mean_after_N == pytest.approx(np.mean(against.force_N - real))


@pytest.mark.parametrize("found", [(), (CameraDelay(delay_s=0.05),)])
def test_pulls_are_told_of_where_no_limit_moves(believed: Recipe, found: tuple[Effect, ...]) -> None:
    # They were read, and neither the lines nor the page said a word of them.
    real = limit(believed.build("paper"), PHI, Pull())
    pulls = Pulls(phi_rad=PHI, force_N=0.5 * real, theta_rad=np.zeros((len(PHI), 3)), sigma_N=0.1)
    change = limits_change(believed, believed.with_effects(*found), "paper", pulls)
    off = np.sqrt(np.mean((0.5 * real) ** 2))
    said = f"differ by {off:.3g} N (root mean square), the measured one is {0.5 * real.mean():.3g} N less"
    one = diagnosis(Verdict.EFFECT_FOUND if found else Verdict.NO_MISSING_EFFECT)
    assert not change.moved
    for text in (
        " ".join(summary_lines(one, change)),
        html(page(one, change, dict.fromkeys(IMAGES, image(Figure(), png=True)))),
    ):
        text = " ".join(text.replace("\u202f", " ").replace("\xa0", " ").split())
        assert said in text and "the stated noise is 0.1 N" in text
    assert faults("diagnose", report_text(one, change)) == []


def test_a_pull_is_compared_with_the_limit_of_its_own_direction_and_height(believed: Recipe) -> None:
    model, one = believed.build("paper"), np.ones(len(PHI))
    pulls = Pulls(
        phi_rad=PHI,
        force_N=one,
        theta_rad=np.zeros((len(PHI), 3)),
        direction_rad=0.5 * np.pi * one,
        height_m=0.05 * one,
    )
    wanted = limit(model, PHI, Pull(direction_rad=0.5 * np.pi, height_m=0.05))
    np.testing.assert_allclose(predicted(model, pulls), wanted, rtol=1e-9)
