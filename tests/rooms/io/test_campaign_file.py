"""A campaign file: defaults, what a loading changes, and faults by their place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from planting import planted, smooth_kiwi

from slipmargin.data.campaign import Part, joined
from slipmargin.diagnosis.remarks import of_noise, of_nominal_rates
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


def test_a_folder_that_is_a_data_set_as_well_is_not_guessed(folder: Path) -> None:
    """The campaign was ignored in silence."""
    beside = folder / "gray" / "campaign.toml"
    beside.write_text('schema = 1\n[[data_set]]\npath = "."\n', encoding="utf-8")
    own = folder / "gray" / "dataset.toml"
    with pytest.raises(InputError, match="holds a data set and a campaign") as fault:
        campaign_file(folder / "gray")
    assert str(own) in str(fault.value) and str(beside) in str(fault.value)
    assert campaign_file(beside) == beside and campaign_file(own) is None
    assert read_data_set(own).name == read_data_set(folder / "gray").name == "gray"


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


@pytest.mark.parametrize("name", ["../../outside", "a/b", "a\\\\b", "..", ".", "a\\nb"])
def test_the_name_of_a_data_set_is_a_plain_file_name(folder: Path, name: str) -> None:
    """A report wrote corrected-NAME.toml, and with name = "../../corrected" over a file of somebody else."""
    path = written(folder, f'[[data_set]]\npath = "gray"\nname = "{name}"')
    with pytest.raises(InputError, match=r"campaign.toml.*data_set\[1\].name.*no plain file name"):
        read_joined(path)


def test_members_keep_their_place_their_pulls_and_whether_noise_is_stated(folder: Path) -> None:
    (folder / "gray" / "pulls.csv").write_text("phi_rad,force_N\n0.0,5.0\n", encoding="utf-8")
    head = folder / "load" / "dataset.toml"
    head.write_text(head.read_text(encoding="utf-8").split("[sigma]")[0], encoding="utf-8")
    one, two = read_joined(written(folder, TWO)).members
    assert (one.folder, two.folder) == (str(folder / "gray"), str(folder / "load"))
    assert one.pulls is not None and one.pulls.force_N.tolist() == [5.0] and two.pulls is None
    said = of_noise((one, two))
    assert len(said) == 1 and "states in gray was not used: none is stated in load" in said[0]
    assert of_noise((one, one)) == of_noise((two, two)) == ()


def test_whose_rows_have_no_time_stamps_is_said(folder: Path) -> None:
    """The nominal rate of one data set was said to be that of all."""
    parts = [read_data_set(folder / name) for name in ("gray", "load")]

    def said(*rates: float | None) -> tuple[str, ...]:
        sets = [replace(d, nominal_rate_Hz=r) for d, r in zip(parts, rates, strict=True)]
        own = [Part(data_set=d, floor="f", loading="l", instrument="i") for d in sets]
        return of_nominal_rates(joined("both", own))

    assert said(None, None) == ()
    one, free = said(60.0, None)
    assert one.startswith("Rows of gray have no time stamps, only a nominal rate of 60 Hz:")
    assert free.startswith("The clock of load, whose rows are stamped,")
    assert said(60.0, 60.0)[0].startswith("Rows have no time stamps, only a nominal rate of 60 Hz:")
    assert "a nominal rate of 60 and 100 Hz" in said(60.0, 100.0)[0]


def test_a_nominal_rate_beside_other_times_is_refused(tmp_path: Path) -> None:
    """The report said that rows have no time stamps, though all had."""
    write_data_set(tmp_path / "d", planted(smooth_kiwi(), None, 3, count=1, duration_s=0.5, rate_hz=50.0))
    head = tmp_path / "d" / "dataset.toml"
    head.write_text("nominal_rate_Hz = 17.0\n" + head.read_text(encoding="utf-8"), encoding="utf-8")
    with pytest.raises(InputError, match=r"trial00.csv: 1:1: t_s has other times than nominal_rate_Hz = 17"):
        read_data_set(tmp_path / "d")


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
