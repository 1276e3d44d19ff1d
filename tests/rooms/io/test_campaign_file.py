"""A campaign file: defaults, what a loading changes, and faults by their place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from planting import planted, smooth_kiwi

from slipmargin.errors import InputError
from slipmargin.io.campaign_file import campaign_file, read_joined
from slipmargin.io.data_set import read_data_set
from slipmargin.io.data_set_write import write_data_set


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for k, name in enumerate(("gray", "load")):
        data = planted(smooth_kiwi(), None, k, count=2, duration_s=0.5, rate_hz=50.0)
        write_data_set(tmp_path / name, replace(data, name=name))
    return tmp_path


def written(folder: Path, text: str) -> Path:
    path = folder / "campaign.toml"
    path.write_text("schema = 1\n" + text, encoding="utf-8")
    return path


TWO = """
[loading.payload]
mass_kg = 4.5
[[data_set]]
path = "gray"
[[data_set]]
path = "load"
loading = "payload"
"""


def test_a_campaign_says_what_data_sets_share(folder: Path) -> None:
    one, two = read_joined(written(folder, TWO)).members
    assert (one.floor, one.loading, one.instrument) == ("paper", "as stated", "the same")
    assert (two.floor, two.loading) == ("paper", "payload")
    assert one.recipe.robot.body.mass_kg == 3.0 and two.recipe.robot.body.mass_kg == 4.5
    whole = read_joined(written(folder, 'name = "both"\n' + TWO))
    assert whole.name == "both" and len(whole.trials) == 4 and whole.member_of == (0, 0, 1, 1)


def test_a_folder_or_a_file_may_be_a_campaign(folder: Path) -> None:
    path = written(folder, TWO)
    assert campaign_file(path) == path and campaign_file(folder) == path
    assert campaign_file(folder / "gray") is None and campaign_file(folder / "nothing") is None


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "data_set"),
        ('[[data_set]]\npath = "gray"\nflor = "a"', r"data_set\[1\].flor"),
        ('[[data_set]]\npath = "nowhere"', "nowhere"),
        ('[loading.payload]\nmass_kg = 4.0\n[[data_set]]\npath = "gray"', "loading.payload"),
        ('[loading.payload]\nmass_kg = -4.0\n[[data_set]]\npath = "gray"', "loading.payload.mass_kg"),
        ('[[data_set]]\npath = "gray"\n[[data_set]]\npath = "gray"', r"data_set\[2\]"),
    ],
)
def test_a_fault_is_named_with_its_place(folder: Path, text: str, place: str) -> None:
    with pytest.raises(InputError, match=place) as fault:
        read_joined(written(folder, text))
    assert "campaign.toml" in str(fault.value) or "nowhere" in str(fault.value)


def test_a_log_without_time_stamps_says_its_nominal_rate(tmp_path: Path) -> None:
    data = planted(smooth_kiwi(), None, 3, count=1, duration_s=0.5, rate_hz=50.0)
    write_data_set(tmp_path / "d", replace(data, nominal_rate_Hz=50.0))
    assert read_data_set(tmp_path / "d").nominal_rate_Hz == 50.0
    trial = next((tmp_path / "d" / "trials").glob("*.csv"))
    rows = [line.split(",", 1)[1] for line in trial.read_text(encoding="utf-8").splitlines()]
    trial.write_text("\n".join(rows) + "\n", encoding="utf-8")
    assert read_data_set(tmp_path / "d").trials[0].t_s[-1] == pytest.approx(data.trials[0].t_s[-1])
    head = tmp_path / "d" / "dataset.toml"
    head.write_text(head.read_text(encoding="utf-8").replace("nominal_rate_Hz = 50.0", ""), encoding="utf-8")
    with pytest.raises(InputError, match="t_s"):
        read_data_set(tmp_path / "d")
