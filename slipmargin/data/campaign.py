"""A campaign: several data sets of one robot, joined into one whose runs remember what they belong to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.data.data_set import DataSet, Member
from slipmargin.data.repair import Repair
from slipmargin.errors import InputError

#: Between the name of a data set and that of a run of it.
_OF = "/"
#: What of a wheel is the machine's, beside its place: the same in all data sets.
_OF_THE_MACHINE = ("radius_m", "drive_direction_deg", "roller_angle_deg", "rollers", "rigid_fraction")


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """A data set of a campaign, and the words of what it shares with others: floor, loading, instrument."""

    data_set: DataSet
    floor: str
    loading: str
    instrument: str


def joined(name: str, parts: Sequence[Part]) -> DataSet:
    """All runs as one data set; a run is called after its data set and itself.

    Raises
    ------
    InputError
        Where there is none, two have one name, or they are not of one robot.
    """
    if not parts:
        raise InputError("data_set", "there is none", "name the data sets, one [[data_set]] each")
    sets = [part.data_set for part in parts]
    names = [data_set.name for data_set in sets]
    for i, (other, word) in enumerate(zip(sets, names, strict=True)):
        place = f"data_set[{i + 1}]"
        if word in names[:i]:
            raise InputError(place, f"is called {word!r} like another one", "give each a name of its own")
        _check_same(place, sets[0], other)
    return DataSet(
        name=name,
        recipe=sets[0].recipe,
        surface=sets[0].surface,
        wheel_signal=sets[0].wheel_signal,
        trials=tuple(replace(t, name=f"{d.name}{_OF}{t.name}") for d in sets for t in d.trials),
        sigma=_common_sigma(sets),
        nominal_rate_Hz=next((d.nominal_rate_Hz for d in sets if d.nominal_rate_Hz is not None), None),
        members=tuple(
            Member(
                name=p.data_set.name,
                recipe=p.data_set.recipe,
                surface=p.data_set.surface,
                floor=p.floor,
                loading=p.loading,
                instrument=p.instrument,
                folder=p.data_set.folder,
                pulls=p.data_set.pulls,
                noise_stated=p.data_set.sigma is not None,
                nominal_rate_Hz=p.data_set.nominal_rate_Hz,
            )
            for p in parts
        ),
        member_of=tuple(i for i, d in enumerate(sets) for _ in d.trials),
    )


def _check_same(place: str, first: DataSet, other: DataSet) -> None:
    if not other.trials:
        raise InputError(
            place, f"{other.name} has no runs", "leave it out: pulls have a diagnosis of their own"
        )
    if other.wheel_signal is not first.wheel_signal:
        raise InputError(
            place,
            f"{other.name} has {other.wheel_signal.value} wheel speeds, {first.name} has not",
            "diagnose them apart",
        )
    one, two = first.recipe.robot.wheels, other.recipe.robot.wheels
    same = len(one) == len(two) and all(
        np.allclose(a.position_m, b.position_m)
        and all(getattr(a, key) == getattr(b, key) for key in _OF_THE_MACHINE)
        for a, b in zip(one, two, strict=True)
    )
    if not same:
        raise InputError(
            place,
            f"{other.name} is of a robot with other wheels than {first.name}",
            "name data sets of one robot; what the machine is must be the same in their robot files",
        )


def _common_sigma(sets: Sequence[DataSet]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]] | None:
    stated = [d.sigma for d in sets]
    known = [s for s in stated if s is not None]
    return np.sqrt(np.mean(np.square(known), axis=0)) if len(known) == len(stated) else None


def apart(data_set: DataSet) -> tuple[DataSet, ...]:
    """The runs of each member of a campaign as a data set; the data set itself where it is no campaign's."""
    if not data_set.members:
        return (data_set,)
    return tuple(
        replace(
            data_set,
            name=member.name,
            nominal_rate_Hz=member.nominal_rate_Hz,
            recipe=member.recipe,
            surface=member.surface,
            folder=member.folder,
            trials=tuple(t for t, m in zip(data_set.trials, data_set.member_of, strict=True) if m == number),
            members=(),
            member_of=(),
        )
        for number, member in enumerate(data_set.members)
    )


Mended = tuple[DataSet, tuple[Repair, ...]]


def each(data_set: DataSet, mend: Callable[[DataSet], Mended]) -> Mended:
    """Every member mended for itself, with what was done to which."""
    if not data_set.members:
        return mend(data_set)
    done: list[Repair] = []
    own: list[DataSet] = []
    for member in apart(data_set):
        mended, repairs = mend(member)
        own.append(mended)
        done += [replace(r, sentence=f"{member.name}: {r.sentence}") for r in repairs]
    return replace(
        data_set,
        trials=tuple(t for d in own for t in d.trials),
        member_of=tuple(i for i, d in enumerate(own) for _ in d.trials),
    ), tuple(done)
