"""``slipmargin diagnose`` on a campaign: which floor a finding belongs to, who shows it, a robot for each."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from planting import Plant, planted, smooth_kiwi
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.effects import Trace
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.io.data_set_write import write_data_set

CAMPAIGN = """schema = 1
name = "two floors"
[[data_set]]
path = "dry"
[[data_set]]
path = "oily"
floor = "oily"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("campaign")
    slick = Plant(
        name="oil",
        traces=(Trace.COEFFICIENT,),
        effects=(FrictionCoefficients(drive_factor=0.5, transverse_factor=0.5),),
    )
    for name, plant in (("dry", None), ("oily", slick)):
        data = planted(smooth_kiwi(), plant, 5, count=5, duration_s=2.0, rate_hz=60.0)
        write_data_set(place / name, replace(data, name=name))
    (place / "campaign.toml").write_text(CAMPAIGN, encoding="utf-8")
    return place


def test_a_campaign_says_on_which_floor_an_effect_is_and_who_shows_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status(["diagnose", str(folder), "--out", str(folder / "report")]) == 0
    told = capsys.readouterr().out
    assert "belongs to floor oily" in told
    report = json.loads((folder / "report" / "report.json").read_text(encoding="utf-8"))
    assert report["verdict"] == "effect-found"
    row = next(g for g in report["campaign"]["groups"] if g["effect"] == "friction_coefficients")
    assert row["belongs_to"] == "floor oily" and [s["data_set"] for s in row["shown_by"]] == ["oily"]
    assert row["shown_by"][0]["chi_without"] > 2.0 * row["shown_by"][0]["chi_with"]
    dry, oily = (sm.read_robot(folder / "report" / f"corrected-{name}.toml") for name in ("dry", "oily"))
    assert not dry.effects and [e.name for e in oily.effects] == ["friction_coefficients"]
    assert "The campaign" in (folder / "report" / "report.html").read_text(encoding="utf-8")


def test_a_fault_in_a_campaign_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text('schema = 1\n[[data_set]]\npath = "nowhere"\n', encoding="utf-8")
    assert status(["diagnose", str(path), "--out", str(tmp_path / "report")]) == 2
    assert not (tmp_path / "report").exists()
