"""Text from files is data: no name moves a cursor, becomes markup, a formula or a comment's end."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from robot_files import GOOD, broken
from slipmargin_cli.main import status

NAMES = ("<b>&\"'", "=1+1", "@sum", "$x^{2", "*/ int x; /*", '"; x', "日本 🤖", "%s%n", "-- >", "]]>")
REFUSED = ("\x1b[31mred", "two\nlines", "nul\0", "\u202eevil", "x" * 10_000, "\u2028", "del\x7f")


def robot(folder: Path, name: str) -> Path:
    """The good robot with this name, and a wheel and a surface of this name."""
    quoted = json.dumps(name, ensure_ascii=False).replace("\x7f", "\\u007f")
    text = GOOD.split("[[effect]]")[0].replace('"kiwi"', quoted).replace('"rear"', quoted)
    file = folder / "r.toml"
    file.write_text(text.replace("[surface.paper]", f"[surface.{quoted}]"), encoding="utf-8")
    return file


@pytest.mark.parametrize("name", NAMES)
def test_names_of_any_letters(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    robot(tmp_path, name)
    on = ["r.toml", "--surface", name]
    assert (
        status(["sweep", *on, "--step", "45", "--out", "o.csv", "--json", "o.json", "--plot", "o.svg"]) == 0
    )
    assert status(["export", "c", *on, "--out", "o.h"]) == 0
    assert status(["export", "sdf", *on, "--out", "o.sdf"]) == 0
    assert json.loads((tmp_path / "o.json").read_text(encoding="utf-8"))["robot"] == name
    assert not re.search(r'(^|,)"?[=+@]', (tmp_path / "o.csv").read_text(encoding="utf-8"), re.MULTILINE)
    for file in ("o.svg", "o.sdf"):
        ElementTree.parse(tmp_path / file)
    header = (tmp_path / "o.h").read_text(encoding="utf-8")
    assert header.count("/*") == header.count("*/") or "*/ int x" not in header
    said = capfd.readouterr()
    assert "Traceback" not in said.err


@pytest.mark.parametrize("name", REFUSED)
def test_names_that_cannot_stand_on_a_line_are_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    robot(tmp_path, name)
    assert status(["sweep", "r.toml", "--surface", "paper"]) == 2
    said = capfd.readouterr().err
    assert said.startswith("error: r.toml: ") and said.count("\n") == 1 and len(said) < 1000
    assert said[:-1].isprintable()


def test_what_is_printed_moves_no_cursor(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """``robots show`` prints the file as it is, with its comments."""
    file = tmp_path / "r.toml"
    file.write_text("# tab\there \x85 \u2028\n" + GOOD, encoding="utf-8")
    assert status(["robots", "show", str(file)]) == 0
    said = capfd.readouterr().out
    assert "\x85" not in said and "\u2028" not in said and "\\x85" in said


def test_a_long_argument_is_not_repeated_whole(capfd: pytest.CaptureFixture[str]) -> None:
    assert status(["robots", "new", "x" * 9_000, "--type", "kiwi"]) == 2
    assert len(capfd.readouterr().err) < 1000


@pytest.mark.parametrize("name", ["", ".", "..", ".toml"])
def test_a_robot_needs_a_name(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert status(["robots", "new", name, "--type", "kiwi"]) == 2
    assert "NAME" in capfd.readouterr().err


TERM = """
[[effect]]
name = "unnamed_heading"
part = "grip"
[[effect.term]]
variable = "heading"
basis = "fourier"
shape = [6.28, 0.0]
target = "both"
wheel_weights = {weights}
coefficients = {values}
"""


@pytest.mark.parametrize(
    ("weights", "values", "place"),
    [
        ("[1.0]", "[0.1]", "effect[2].term[1].wheel_weights: has 1 weights"),
        ("[1.0, 1.0, 1.0, 1.0]", "[0.1]", "effect[2].term[1].wheel_weights: has 4 weights"),
        ("[1.0, 1.0, 1.0]", "[1" + "0" * 400 + "]", "effect[2].term[1].coefficients[1]: is a whole number"),
        ("[1.0, nan, 1.0]", "[0.1]", "effect[2].term[1].wheel_weights[2]: is nan"),
    ],
)
def test_terms_of_an_effect_that_do_not_fit(
    weights: str, values: str, place: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Wrong lengths gave "cannot reshape", numbers beyond a float an OverflowError."""
    file = tmp_path / "r.toml"
    file.write_text(GOOD + TERM.format(weights=weights, values=values), encoding="utf-8")
    assert status(["bounds", str(file), "--surface", "paper", "--step", "45"]) == 2
    assert place in capfd.readouterr().err


def test_pulls_of_no_robot_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """1e300 N gave an SVD that did not converge."""
    pulls = "phi_rad,force_N\n" + "".join(f"{0.3 * k},{'LARGE' if k == 2 else 5}\n" for k in range(6))
    for large, says in (("1e300", "force_N is 1e+300"), ("1e6", "times the robot's weight")):
        (tmp_path / "p.csv").write_text(pulls.replace("LARGE", large), encoding="utf-8")
        assert status(["measure", str(tmp_path / "p.csv"), "ohio-kiwi", "--surface", "paper"]) == 2
        assert says in capfd.readouterr().err


def test_a_plan_of_ages_is_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Its table took 18 GiB."""
    (tmp_path / "w.csv").write_text("x_m,y_m,phi_rad\n0,0,0\n1,0,0\n", encoding="utf-8")
    words = ["plan", "ohio-kiwi", str(tmp_path / "w.csv"), "--surface", "paper", "--points", "40"]
    assert status([*words, "--step", "1e-8"]) == 2
    said = capfd.readouterr().err
    assert "numbers of a table, and at most 3e+06" in said and "SLIPMARGIN_WORK" in said and "--step" in said


def test_the_good_robot_is_still_good(tmp_path: Path) -> None:
    (tmp_path / "r.toml").write_text(broken('name = "kiwi"', 'name = "' + "x" * 200 + '"'), encoding="utf-8")
    assert status(["sweep", str(tmp_path / "r.toml"), "--surface", "paper", "--step", "45"]) == 0
