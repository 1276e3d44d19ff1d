"""The laws of the house, read from the source: who may import whom, and who owns which library.

Imports inside functions count: a prohibition that a late import may break is none.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import slipmargin

sys.path.insert(0, str(Path(__file__).resolve().parent))
from import_graph import mermaid
from source import ROOT, cycles, imported, imports, modules, named, room, rooms, steps, tree

#: Library → the rooms that may import it.
OWNERS = {
    "matplotlib": {"slipmargin.plots"},
    "mpl_toolkits": {"slipmargin.plots"},
    "typer": {"slipmargin_cli"},
    "click": set(),
    "rich": {"slipmargin_cli"},
    "clarabel": {"slipmargin.solve"},
    "cvxpy": {"slipmargin.solve", "slipmargin.study", "slipmargin.paths", "slipmargin.limits"},
}
#: Room → rooms that it must not reach, however many steps away.
PROHIBITED = {
    "slipmargin.physics": {
        "slipmargin.robot",
        "slipmargin.model",
        "slipmargin.effects",
        "slipmargin.io",
        "slipmargin.data",
    },
    "slipmargin.limits": {"slipmargin.effects", "slipmargin.sim", "slipmargin.io"},
    "slipmargin.paths": {"slipmargin.effects", "slipmargin.io"},
    "slipmargin.sim": {"slipmargin.effects", "slipmargin.limits", "slipmargin.io"},
    "slipmargin.sets": {"slipmargin.robot", "slipmargin.model"},
    "slipmargin.solve": {"slipmargin.robot", "slipmargin.model"},
    "slipmargin.robot": {"slipmargin.model"},
    "slipmargin.data": {"slipmargin.io", "slipmargin.limits", "slipmargin.sim", "slipmargin.diagnosis"},
    "slipmargin.model": {"slipmargin.effects"},
    "slipmargin.diagnosis": {"slipmargin.io", "slipmargin.report", "slipmargin.plots"},
    "slipmargin.experiment": {"slipmargin.io", "slipmargin.report", "slipmargin.plots", "slipmargin.api"},
    "slipmargin.io": {"slipmargin.report", "slipmargin.plots", "slipmargin.limits"},
    "slipmargin.study": {"slipmargin.report", "slipmargin.plots", "slipmargin.sim", "slipmargin.diagnosis"},
    "slipmargin.report": {"slipmargin.plots", "slipmargin.api", "slipmargin_cli"},
    "slipmargin.plots": {"slipmargin.api", "slipmargin_cli"},
    "slipmargin.onboard": {
        "slipmargin.effects",
        "slipmargin.sim",
        "slipmargin.diagnosis",
        "slipmargin.io",
        "slipmargin.data",
        "slipmargin.report",
        "slipmargin.plots",
    },
    "slipmargin.paper": {"slipmargin.io", "slipmargin.report", "slipmargin.plots", "slipmargin.api"},
    "slipmargin.api": {"slipmargin_cli"},
}
#: Calls that open a file, allowed in io only.
OPENERS = {
    "read_text",
    "read_bytes",
    "write_text",
    "write_bytes",
    "open",
    "loadtxt",
    "savetxt",
    "genfromtxt",
    "tofile",
    "fromfile",
    "unlink",
    "mkdir",
    "replace_file",
}


@cache
def reach(name: str) -> frozenset[str]:
    """Every module of ours that importing ``name`` may lead to."""
    seen, todo = set(), [name]
    while todo:
        one = todo.pop()
        if one in seen or one not in modules():
            continue
        seen.add(one)
        todo.extend(imports(one))
    return frozenset(seen)


def inside(name: str, room: str) -> bool:
    return name == room or name.startswith(room + ".")


def test_the_source_is_found() -> None:
    assert {"slipmargin.errors", "slipmargin.limits.sweep", "slipmargin_cli.main"} <= set(modules())
    assert "slipmargin.limits.band" in reach("slipmargin.limits.sweep")
    assert "slipmargin.limits.cones" in imports("slipmargin.limits.sweep")  # a late import
    assert "slipmargin_cli.render" in reach("slipmargin_cli.sweep")  # a relative one


@pytest.mark.parametrize("room", PROHIBITED)
def test_prohibited_rooms_are_out_of_reach(room: str) -> None:
    rooms = [m for m in modules() if inside(m, room)]
    assert rooms, f"there is no room {room}"
    broken = [
        f"{m} reaches {other}"
        for m in rooms
        for other in sorted(reach(m))
        for banned in PROHIBITED[room]
        if inside(other, banned)
    ]
    assert not broken, "; ".join(broken[:5])


def test_rooms_import_each_other_one_way_only() -> None:
    assert cycles(rooms()) == []


@pytest.mark.parametrize("here", sorted(rooms()))
def test_modules_of_a_room_import_each_other_one_way_only(here: str) -> None:
    inner = [m for m in modules() if room(m) == here]
    assert cycles({m: frozenset(o for o in steps(m) if o in inner) for m in inner}) == []


def test_a_cycle_would_be_found() -> None:
    assert cycles({"a": frozenset("b"), "b": frozenset("c"), "c": frozenset("a")}) == [["a", "b", "c"]]


def test_the_graph_of_rooms_can_be_drawn() -> None:
    lines = mermaid().splitlines()
    assert lines[0] == "graph TD" and "  slipmargin_cli --> slipmargin" in lines
    assert not any(line.startswith("  sim --> limits") for line in lines)


#: Importer → what it may import besides the front door, ``slipmargin.errors`` and its neighbours, and why.
BEHIND_THE_DOOR = (
    ("slipmargin_cli.options", "slipmargin.io.writes", "outputs are checked before any work"),
    ("slipmargin_cli.main", "slipmargin.notice", "the first run says that it compiles"),
    ("slipmargin_cli.render", "slipmargin.notice", "reading a long log shows how far it is"),
    ("slipmargin_cli.options", "slipmargin.io.folder", "outputs are checked before any work"),
    ("slipmargin_cli.options", "slipmargin.io.data_set_write", "outputs are checked before any work"),
    ("notebooks.data_loop", "slipmargin.effects", "the truth is planted"),
    ("notebooks.data_loop", "slipmargin.robot", "the truth is planted"),
    ("notebooks.real_data", "slipmargin.data.odometry", "a figure of raw logs"),
)
_ALLOWED = ("slipmargin.errors", "slipmargin.__version__")


def behind(names: frozenset[str], importer: str) -> list[str]:
    """Imports that reach past the front door without a reason."""
    reasons = [what for who, what, _ in BEHIND_THE_DOOR if who == importer]
    door = tuple(f"slipmargin.{name}" for name in dir(slipmargin))
    return sorted(
        name
        for name in names
        if inside(name, "slipmargin")
        and name != "slipmargin"
        and name not in door
        and not any(inside(name, one) for one in (*_ALLOWED, *reasons))
    )


@pytest.mark.parametrize("name", [m for m in modules() if inside(m, "slipmargin_cli")])
def test_a_command_uses_the_front_door(name: str) -> None:
    assert behind(named(name), name) == []


@pytest.mark.parametrize("path", sorted((ROOT / "notebooks").glob("*.py")), ids=lambda p: p.stem)
def test_a_notebook_uses_the_front_door(path: Path) -> None:
    found = imported(ast.parse(path.read_text(encoding="utf-8")), "")
    assert behind(found, f"notebooks.{path.stem}") == []


@pytest.mark.parametrize("name", [m for m in modules() if inside(m, "slipmargin.plots") and "plots." in m])
def test_only_what_draws_is_in_plots(name: str) -> None:
    assert "matplotlib" in imports(name)


@pytest.mark.parametrize("library", OWNERS)
def test_every_library_has_its_room(library: str) -> None:
    broken = [
        m for m in modules() if library in imports(m) and not any(inside(m, room) for room in OWNERS[library])
    ]
    assert not broken, f"{library} is imported by {', '.join(broken)}"


def test_only_io_opens_files() -> None:
    broken = []
    for name in modules():
        if inside(name, "slipmargin.io"):
            continue
        for node in ast.walk(tree(name)):
            if isinstance(node, ast.Call):
                called = node.func
                if isinstance(called, ast.Name) and called.id == "open":
                    broken.append(f"{name}:{node.lineno} open()")
                elif (
                    isinstance(called, ast.Attribute)
                    and called.attr in OPENERS
                    and not (isinstance(called.value, ast.Name) and called.value.id == "os")
                ):
                    broken.append(f"{name}:{node.lineno} .{called.attr}()")
    assert not broken, "; ".join(broken)


def test_every_text_that_is_read_or_written_names_its_encoding() -> None:
    bare = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for part in ("slipmargin", "cli", "tests", "benchmarks")
        for path in sorted((ROOT / part).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        if node.func.attr in ("read_text", "write_text")
        if not any(word.arg == "encoding" for word in node.keywords)
        if len(node.args) == (node.func.attr == "write_text")  # one more is the encoding
    ]
    assert not bare, f"fails where the locale is not UTF-8: {', '.join(bare)}"


def test_the_package_prints_nothing() -> None:
    broken = [
        f"{name}:{node.lineno}"
        for name in modules()
        for node in ast.walk(tree(name))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]
    assert not broken, "; ".join(broken)


def test_nothing_catches_everything() -> None:
    # where a defect is told from a refusal: to the terminal, and to the local page
    allowed = {"slipmargin_cli.main", "slipmargin.live.server"}
    broken = [
        f"{name}:{node.lineno}"
        for name in modules()
        for node in ast.walk(tree(name))
        if isinstance(node, ast.ExceptHandler)
        and name not in allowed
        and (node.type is None or (isinstance(node.type, ast.Name) and node.type.id == "Exception"))
    ]
    assert not broken, "; ".join(broken)


HEAVY = ("numpy", "scipy", "cvxpy", "clarabel", "matplotlib", "numba", "rich", "pandas")


def loaded(*arguments: str) -> set[str]:
    """Heavy libraries in memory after a command line, in a fresh process."""
    code = (
        "import sys; from slipmargin_cli.main import status; "
        f"code = status({list(arguments)!r}); "
        f"print('LOADED', code, *(m for m in {HEAVY!r} if m in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    words = done.stdout.splitlines()[-1].split()
    assert words[:2] == ["LOADED", "0"], done.stderr
    return set(words[2:])


@pytest.mark.parametrize(
    "arguments",
    [
        ("--help",),
        ("--version",),
        ("sweep", "--help"),
        ("design", "--help"),
        ("diagnose", "--help"),
        ("simulate", "--help"),
        ("plan", "--help"),
        ("import", "--help"),
        ("reproduce", "--help"),
        ("bounds", "--help"),
    ],
    ids=" ".join,
)
def test_help_loads_nothing_heavy(arguments: tuple[str, ...]) -> None:
    from slipmargin_cli.main import COMMANDS

    if arguments[0] in COMMANDS and COMMANDS[arguments[0]][0].partition(":")[0] not in modules():
        pytest.skip(f"there is no command {arguments[0]} yet")
    assert loaded(*arguments) == set()


@pytest.mark.parametrize(
    "arguments",
    [
        ("sweep", "ohio-kiwi", "--surface", "paper"),
        ("polytope", "mecanum4", "--surface", "floor"),
        ("robots", "show", "ohio-kiwi"),
        ("effects", "list"),
    ],
    ids=" ".join,
)
def test_statics_needs_numpy_alone(arguments: tuple[str, ...]) -> None:
    assert loaded(*arguments) <= {"numpy"}
