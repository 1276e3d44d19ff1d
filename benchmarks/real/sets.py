"""Data sets of real robots and how their runs are split: what may be fitted, what is judged.

A split is by whole runs and fixed by their names, so that a figure can be compared with anybody else's.

- ``robotino-load``: Robotino with its weight moved to the front. Fitted: every second heading (0, 10, …)
  of ``table_0.1``, ``gray_0.1`` and ``load_0.1`` (all of the table for the camera's calibration);
  judged: the other headings of ``load_0.1``.
- ``robotino-gray``: a carpet. Fitted: every second heading of ``gray_0.1`` and ``gray_0.2``; judged: the
  other headings at both speeds. Camera as calibrated on the table; each speed is a recording of its own,
  between which camera or marker may have been touched.
- ``robotino-green``: the same on a thick carpet.
- ``robojackets``: a RoboCup SSL robot, cut into runs of 2.5 s. Fitted: the blocks of 5 s with even
  numbers, counted from the first row; judged: those with odd numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from slipmargin.data.calibration import calibrate
from slipmargin.data.campaign import Part, joined
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.data.segments import segments
from slipmargin.effects import Recipe
from slipmargin.io.importers.plug import import_files
from slipmargin.io.importers.robojackets import RobojacketsImporter
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.robot_file import read_recipe

#: The payload's total mass as its authors state it [kg].
PAYLOAD_KG = 12.69
#: Length of a run cut from a recording, and of the blocks that are fitted or judged as a whole [s].
RUN_S, BLOCK_S = 2.5, 5.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RealSet:
    """A data set with its split: ``fitted`` (a campaign's runs joined) and ``judged`` with their recipe.

    A run of a campaign is called after its recording and itself, ``slow/heading_005``.  Where the robot
    drove the same run in every direction, ``beside`` gives for a run's name the two fitted runs to its left
    and right.
    """

    name: str
    fitted: DataSet
    judged: tuple[Record, ...]
    recipe: Recipe
    surface: str
    beside: dict[str, tuple[Record, Record]] = field(default_factory=dict)

    @property
    def own(self) -> tuple[Record, ...]:
        """The fitted runs of the judged recordings: what a model without groups is fitted to."""
        if not self.fitted.members:
            return self.fitted.trials
        judged = {self.member(run) for run in self.judged}
        return tuple(run for run in self.fitted.trials if self.member(run) in judged)

    def member(self, run: Record) -> int:
        """The number of a run's recording in the fitted campaign; 0 where there is no campaign."""
        names = [member.name for member in self.fitted.members]
        return names.index(run.name.partition("/")[0]) if names else 0


def all_around(recording: Part) -> tuple[Record, ...]:
    """The runs of a recording in every direction, called as they are in a campaign."""
    return joined("", [recording]).trials


def every_second(recording: Part) -> Part:
    """The recording with the runs that may be fitted."""
    return replace(recording, data_set=replace(recording.data_set, trials=recording.data_set.trials[::2]))


def neighbours(runs: Sequence[Record]) -> dict[str, tuple[Record, Record]]:
    """Of runs in the order of their headings, all around, the fitted ones (every second) beside each."""
    apart = [2 - i % 2 for i in range(len(runs))]
    pairs = [(runs[i - d], runs[(i + d) % len(runs)]) for i, d in enumerate(apart)]
    return {run.name: pair for run, pair in zip(runs, pairs, strict=True)}


def robotino(folder: Path) -> list[RealSet]:
    """The sets of the Robotino whose folders are there."""

    def logs(name: str) -> tuple[Record, ...]:
        return import_files(RobotinoImporter(), sorted((folder / name).glob("*.csv"))).records

    if not (folder / "table_0.1").is_dir():
        return []
    recipe = read_recipe("robotino")
    table = logs("table_0.1")
    camera = calibrate(table, recipe.build("table").geometry)
    believed = replace(recipe, effects=camera.effects())

    def part(
        name: str,
        records: Sequence[Record],
        recipe: Recipe,
        surface: str,
        loading: str = "as stated",
        instrument: str = "camera",
    ) -> Part:
        runs = tuple(camera.rectified(r) for r in records)
        data = DataSet(
            name=name, recipe=recipe, surface=surface, wheel_signal=WheelSignal.MEASURED, trials=runs
        )
        return Part(data_set=data, floor=surface, loading=loading, instrument=instrument)

    found = []
    if (folder / "load_0.1").is_dir() and (folder / "gray_0.1").is_dir():
        body = replace(believed.robot.body, mass_kg=PAYLOAD_KG)
        heavy = replace(believed, robot=replace(believed.robot, body=body))
        gray = part("gray", logs("gray_0.1"), believed, "gray")
        load = part("load", logs("load_0.1"), heavy, "gray", loading="payload")
        level = part("table", table, believed, "table")
        around = all_around(load)
        found.append(
            RealSet(
                name="robotino-load",
                fitted=joined("robotino-load", [every_second(r) for r in (gray, load, level)]),
                judged=around[1::2],
                recipe=heavy,
                surface="gray",
                beside=neighbours(around),
            )
        )
    for carpet in ("gray", "green"):
        if not ((folder / f"{carpet}_0.1").is_dir() and (folder / f"{carpet}_0.2").is_dir()):
            continue
        slow, fast = (
            part(word, logs(f"{carpet}_{speed}"), believed, "gray", instrument=word)
            for word, speed in (("slow", "0.1"), ("fast", "0.2"))
        )
        one, two = all_around(slow), all_around(fast)
        name = f"robotino-{carpet}"
        found.append(
            RealSet(
                name=name,
                fitted=joined(name, [every_second(r) for r in (slow, fast)]),
                judged=(*one[1::2], *two[1::2]),
                recipe=believed,
                surface="gray",
                beside=neighbours(one) | neighbours(two),
            )
        )
    return found


def robojackets(file: Path) -> list[RealSet]:
    """The recording of the SSL robot, if it is there."""
    if not file.is_file():
        return []
    importer = RobojacketsImporter()
    runs, _ = segments(importer.read(file).record, RUN_S)
    block = [int(run.name.rsplit("_", 1)[1]) // round(BLOCK_S / RUN_S) for run in runs]
    recipe = read_recipe("robojackets-2018")
    data = DataSet(
        name="robojackets",
        recipe=recipe,
        surface="carpet",
        wheel_signal=WheelSignal.MEASURED,
        trials=tuple(run for run, b in zip(runs, block, strict=True) if b % 2 == 0),
        nominal_rate_Hz=importer.rate_Hz,
    )
    judged = tuple(run for run, b in zip(runs, block, strict=True) if b % 2)
    return [RealSet(name="robojackets", fitted=data, judged=judged, recipe=recipe, surface="carpet")]


def read(folder: Path) -> list[RealSet]:
    """Every set that lies in ``folder``: ``robotino/…`` and ``robojackets/*.txt``."""
    found = robotino(folder / "robotino")
    for file in sorted((folder / "robojackets").glob("*.txt")):
        found += robojackets(file)
    return found
