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

ROOT = Path(__file__).resolve().parents[2]
ROOMS = {"slipmargin": ROOT / "slipmargin", "slipmargin_cli": ROOT / "cli"}

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
    "slipmargin.limits": {"slipmargin.effects", "slipmargin.sim"},
    "slipmargin.paths": {"slipmargin.effects"},
    "slipmargin.sim": {"slipmargin.effects", "slipmargin.limits"},
    "slipmargin.sets": {"slipmargin.robot", "slipmargin.model"},
    "slipmargin.solve": {"slipmargin.robot", "slipmargin.model"},
    "slipmargin.physics": {"slipmargin.robot", "slipmargin.model", "slipmargin.effects"},
    "slipmargin.robot": {"slipmargin.model"},
    "slipmargin.data": {"slipmargin.io"},
    "slipmargin.model": {"slipmargin.effects"},
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
def modules() -> dict[str, Path]:
    found = {}
    for package, folder in ROOMS.items():
        for path in sorted(folder.rglob("*.py")):
            parts = [package, *path.relative_to(folder).with_suffix("").parts]
            found[".".join(p for p in parts if p != "__init__")] = path
    return found


@cache
def tree(name: str) -> ast.Module:
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


@cache
def imports(name: str) -> frozenset[str]:
    """Every module that a module imports, its packages included."""
    found: set[str] = set()
    is_package = modules()[name].name == "__init__.py"
    for node in ast.walk(tree(name)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = name.split(".")[: len(name.split(".")) - node.level + (1 if is_package else 0)]
                base = ".".join([*parents, *([base] if base else [])])
            found.add(base)
            found.update(f"{base}.{alias.name}" for alias in node.names)
    whole = {".".join(one.split(".")[:k]) for one in found for k in range(1, one.count(".") + 2)}
    return frozenset(whole)


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


def test_the_package_prints_nothing() -> None:
    broken = [
        f"{name}:{node.lineno}"
        for name in modules()
        for node in ast.walk(tree(name))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]
    assert not broken, "; ".join(broken)


def test_nothing_catches_everything() -> None:
    allowed = {"slipmargin_cli.main"}  # the one place that tells a defect from a refusal
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
