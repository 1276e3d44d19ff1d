"""Shells that ask what fits are offered robots, surfaces, effects and quantities: bash, zsh and fish."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import slipmargin as sm

SHELLS = ("bash", "zsh", "fish")


def offered(shell: str, line: str) -> str:
    """What the program offers for the word that the cursor is in, as the shell's own script asks for it."""
    words = line.split(" ")
    asked = {
        "_SLIPMARGIN_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
        "_TYPER_COMPLETE_ARGS": line,
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
    }
    done = subprocess.run(
        [sys.executable, "-m", "slipmargin"],
        env=os.environ | asked,
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.stderr == ""
    return done.stdout


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize(
    ("line", "wanted", "others"),
    [
        ("slipmargin sweep ohio", ["ohio-kiwi", "ohio-kiwi-symmetric"], ["robotino"]),
        ("slipmargin sweep robotino --surface ", ["gray", "table"], ["paper"]),
        ("slipmargin effects show rigid", ["rigid_sector"], ["tether"]),
        ("slipmargin design ohio-kiwi --surface paper --vary com_", ["com_x_m=", "com_y_m="], ["wheels="]),
        ("slipmargin import ros run --robot mec", ["mecanum4"], ["omni4"]),
        ("slipmargin export sdf ohio-kiwi --surface ", ["paper"], ["gray", "floor"]),
        ("slipmargin import csv run --robot robotino --surface ", ["gray"], ["paper"]),
        ("slipmargin exp", ["export"], ["plan"]),
    ],
)
def test_names_that_fit_are_offered(shell: str, line: str, wanted: list[str], others: list[str]) -> None:
    found = offered(shell, line)
    assert all(word in found for word in wanted), found
    assert not any(word in found for word in others), found


def test_every_quantity_and_surface_is_offered() -> None:
    found = offered("bash", "slipmargin design ohio-kiwi --surface paper --vary ").split()
    assert found == [f"{key}=" for key in sm.known_quantities()] and len(found) > 20
    found = offered("bash", "slipmargin surfaces show ").split()
    assert set(found) == set(sm.known_surfaces().names) and found
    of_any = offered("bash", "slipmargin sweep no-such-file.toml --surface ").split()
    assert {"paper", "floor", "gray"} <= set(of_any)
