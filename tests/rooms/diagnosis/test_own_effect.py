"""An effect of one's own: a class in this file, registered here, is an effect everywhere and then is none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import final

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi
from slipmargin_cli.main import status

from slipmargin.diagnosis.loop import diagnose
from slipmargin.effects import Effect, Part, Recipe, Trace, parameter
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.errors import InputError
from slipmargin.io.robot_file import recipe_from_text
from slipmargin.io.robot_text import effect_text, write_recipe
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Sail(Effect):
    """F = (0, −f cos φ) in the body frame: wind along +x of the floor in a sail that stands across."""

    name = "sail"
    summary = "The wind pushes the robot most when it shows its side."
    traced_to = Trace.HEADING
    part = Part.LOSSES
    parameters = (parameter("wind_N", "N", (-20.0, 0.0, 20.0), 0.05, "force on the side of the robot"),)
    source = "invented for this test; positive = backwards at heading zero"
    confirm = "turn the fan off"

    wind_N: float

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the wind."""
        push = ForceTerm(
            variable=Variable.HEADING,
            basis=Basis.FOURIER,
            shape=np.array([2.0 * np.pi, 0.0]),
            frame=Frame.BODY,
            coefficients=np.array([[0.0, 0.0], [-self.wind_N, 0.0], [0.0, 0.0]]),
        )
        return replace(part, terms=(*part.terms, push))


@pytest.fixture
def registered() -> Iterator[None]:
    with CATALOGUE.registered(Sail):
        yield


@pytest.mark.usefixtures("registered")
def test_a_diagnosis_finds_it() -> None:
    plant = Plant(name="sail", traces=(Trace.HEADING,), effects=(Sail(wind_N=0.4),))
    found = diagnose(planted(smooth_kiwi(), plant, seed=4, count=6, duration_s=2.5, rate_hz=100.0), seed=1)
    (finding,) = found.findings
    assert finding.name == "sail" and finding.effect == Sail(wind_N=finding.parameters[0].value)
    assert finding.parameters[0].value == pytest.approx(0.4, abs=0.02)
    assert finding.confirm == Sail.confirm and finding.equation.startswith("F = (0, −f cos φ)")
    assert found.after.chi < 0.5 * found.before.chi
    assert found.corrected.effects == (finding.effect,)


@pytest.mark.usefixtures("registered")
def test_commands_show_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["effects", "show", "sail"]) == 0
    shown = capsys.readouterr().out
    assert "sail: F = (0, −f cos φ)" in shown and "wind_N" in shown and "turn the fan off" in shown
    assert status(["effects", "list", "--markdown"]) == 0
    assert "The wind pushes the robot most" in capsys.readouterr().out


@pytest.mark.usefixtures("registered")
def test_a_robot_file_holds_it() -> None:
    recipe = Recipe(robot=smooth_kiwi().robot, effects=(Sail(wind_N=1.5),))
    text = write_recipe(recipe)
    assert effect_text(Sail(wind_N=1.5)) in text
    assert recipe_from_text(text).effects == recipe.effects
    with pytest.raises(InputError, match="whole robot"):
        recipe_from_text(text + 'wheels = ["1"]\n')


def test_nobody_knows_it_afterwards() -> None:
    text = write_recipe(Recipe(robot=smooth_kiwi().robot, effects=(Sail(wind_N=1.5),)))
    with pytest.raises(InputError, match="'sail' is not a known effect"):
        recipe_from_text(text)
