"""Published friction coefficients: each entry with its source, usable by name in a robot file."""

from __future__ import annotations

import pytest
from strategies import CARPET, PAPER

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.io.robot_file import recipe_from_text, robot_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.robot import Robot
from slipmargin.robot.library import LIBRARY, PublishedSurface

TEXT = robot_text("omni4")[0]


def on(table: str, text: str = TEXT) -> Robot:
    return recipe_from_text(f"{text}\n[surface.mine]\n{table}\n").robot


@pytest.mark.parametrize("entry", LIBRARY, ids=[e.name for e in LIBRARY])
def test_every_entry_is_furnished_and_usable(entry: PublishedSurface) -> None:
    assert entry.method and entry.wheel and entry.floor and len(entry.source) > 30
    spans = [v for v in (entry.drive, entry.transverse, entry.rigid) if v is not None]
    assert spans and all(0.0 < low < high < 1.5 for low, high in spans)
    given = ", ".join(f"{name} = 0.07" for name in entry.missing)
    robot = on(f'library = "{entry.name}"' + (f"\nroller = {{ {given} }}" if given else ""))
    found = sm.sweep(robot, "mine", step_deg=45.0)
    assert found.slip_chance is not None and found.f_max_N.min() > 0.0
    assert entry.name in "\n".join(sm.describe_surface(entry.name).lines())


def test_the_papers_entries_are_table_one() -> None:
    for name, table in (("paper", PAPER), ("carpet", CARPET)):
        found = sm.describe_surface(f"{name}-omni-williams2002").surface
        for span, value in (
            (found.drive, table.roller.drive),
            (found.transverse, table.roller.transverse),
            (found.rigid, table.rigid.drive),
        ):
            assert span is not None and sum(span) / 2.0 == pytest.approx(value, abs=1e-12)


def test_what_is_not_published_must_be_given() -> None:
    with pytest.raises(InputError, match=r"surface.mine.roller.transverse: is not published"):
        on('library = "foam-omni-vex4"')
    sectors = TEXT.replace("rigid_fraction = 0.0", "rigid_fraction = 0.1")
    with pytest.raises(InputError, match=r"surface.mine.rigid: is not published"):
        on('library = "foam-omni-vex4"\nroller = { transverse = 0.1 }', sectors)
    with pytest.raises(InputError, match="did you mean 'foam-omni-vex"):
        on('library = "foam-omni-vex5"')


def test_what_the_file_gives_wins_and_the_name_is_kept() -> None:
    robot = on('library = "carpet-omni-williams2002"\nroller = { drive = 0.3 }')
    floor = robot.surface("mine")
    assert float(floor.roller.drive) == 0.3 and float(floor.roller.transverse) == pytest.approx(0.15)
    text = write_recipe(sm.read_robot(robot))
    assert 'library = "carpet-omni-williams2002"' in text
    assert write_recipe(recipe_from_text(text)) == text


def test_the_list_names_all() -> None:
    known = sm.known_surfaces()
    assert len(known.lines()) == len(LIBRARY) + 1 and len(known.names) == len(set(known.names))
    assert [s["name"] for s in known.to_dict()["surfaces"]] == list(known.names)
    with pytest.raises(InputError, match="name"):
        sm.describe_surface("ice")
