"""Reading a campaign: which data sets of one robot belong together, and what each shares with the others.

A TOML file::

    schema = 1
    name = "robotino"                 # optional, default: the file's name
    [loading.payload]                 # optional: what a loading changes in the robot file
    mass_kg = 12.69
    [[data_set]]
    path = "gray"                     # folder of a data set, beside this file
    [[data_set]]
    path = "load"
    loading = "payload"               # default "as stated"
    floor = "gray"                    # default: the data set's surface
    instrument = "camera 1"           # default "the same"
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from slipmargin.checks import real
from slipmargin.data.campaign import Part, joined
from slipmargin.data.data_set import DataSet
from slipmargin.errors import InputError
from slipmargin.io.data_set import FILE as DATA_SET, read_data_set
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, document

#: What a data set shares with all others where nothing else is said.
_LOADING, _INSTRUMENT = "as stated", "the same"
#: The file of a campaign in a folder.
FILE = "campaign.toml"


def campaign_file(path: Path) -> Path | None:
    """The campaign file that a path means, itself or inside a folder; None where it is a data set.

    Raises
    ------
    InputError
        For a folder that holds both.
    """
    if not path.is_dir():
        return path if path.suffix.lower() == ".toml" and path.name != DATA_SET else None
    inside, own = path / FILE, path / DATA_SET
    if not inside.is_file():
        return None
    if own.is_file():
        raise InputError("", "holds a data set and a campaign", f"name one: {own} or {inside}", str(path))
    return inside


def read_joined(path: Path | str) -> DataSet:
    """All runs of a campaign as one data set.

    Raises
    ------
    InputError
        With file and key, what is wrong and what to do.
    """
    path = Path(path)
    name, parts = _read(path)
    try:
        return joined(name, parts)
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None


def _read(path: Path) -> tuple[str, tuple[Part, ...]]:
    """The name of a campaign and its data sets."""
    try:
        top = document(read_text(path), "name the data sets (docs/how-to/diagnose-a-campaign.md)")
        name = top.text("name") if top.has("name") else path.stem
        changes = _loadings(top)
        rows = top.tables("data_set")
        if not rows:
            raise InputError("data_set", "there is none", "name the data sets, one [[data_set]] each")
        parts = tuple(_part(row, path.parent, changes) for row in rows)
        top.done()
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None
    unused = set(changes) - {part.loading for part in parts}
    if unused:
        word = sorted(unused)[0]
        cure = f'write loading = "{word}" in its [[data_set]], or remove [loading.{word}]'
        raise InputError(f"loading.{word}", "is that of no data set", cure, str(path))
    return name, parts


def _loadings(top: Table) -> dict[str, dict[str, float]]:
    if not top.has("loading"):
        return {}
    found = {}
    for word, value in top.table("loading", "write [loading.NAME] with mass_kg").raw().items():
        table = Table(f"loading.{word}", value)
        keys = [k for k in ("mass_kg", "inertia_kg_m2") if table.has(k)]
        units = {"mass_kg": "kg", "inertia_kg_m2": "kg m²"}
        found[word] = {
            k: real(table.at(k), table.number(k, units[k]), above=0.0, cure="give a positive number")
            for k in keys
        }
        table.done()
    return found


def _file_name(place: str, name: str) -> str:
    """The name of a data set, after which its corrected robot file is called."""
    if name in ("", ".", "..") or not name.isprintable() or any(c in name for c in "/\\"):
        raise InputError(place, f"is {name!r}, which is no plain file name", "give a name without / and \\")
    return name


def _part(row: Table, beside: Path, changes: dict[str, dict[str, float]]) -> Part:
    folder = beside / row.text("path")
    data_set = read_data_set(folder)
    name = _file_name(row.at("name"), row.text("name") if row.has("name") else data_set.name)
    floor = row.text("floor") if row.has("floor") else data_set.surface
    loading = row.text("loading") if row.has("loading") else _LOADING
    instrument = row.text("instrument") if row.has("instrument") else _INSTRUMENT
    row.done()
    recipe = data_set.recipe
    if change := changes.get(loading):
        body = recipe.robot.body
        body = replace(
            body,
            mass_kg=change.get("mass_kg", body.mass_kg),
            inertia_kg_m2=change.get("inertia_kg_m2", body.inertia_kg_m2),
        )
        recipe = replace(recipe, robot=replace(recipe.robot, body=body))
    return Part(
        data_set=replace(data_set, name=name, recipe=recipe),
        floor=floor,
        loading=loading,
        instrument=instrument,
    )
