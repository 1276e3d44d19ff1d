"""The imports of the source, read from its syntax trees: at module level, inside functions, for types."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = {"slipmargin": ROOT / "slipmargin", "slipmargin_cli": ROOT / "cli"}


@cache
def modules() -> dict[str, Path]:
    """Every module of the package and the command line, by its dotted name."""
    found = {}
    for package, folder in ROOMS.items():
        for path in sorted(folder.rglob("*.py")):
            parts = [package, *path.relative_to(folder).with_suffix("").parts]
            found[".".join(p for p in parts if p != "__init__")] = path
    return found


@cache
def tree(name: str) -> ast.Module:
    """A module's syntax tree."""
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


@cache
def named(name: str) -> frozenset[str]:
    """What a module's import statements name: modules, and the names taken from them."""
    is_package = modules()[name].name == "__init__.py"
    return imported(tree(name), name if is_package else name.rpartition(".")[0])


def imported(module: ast.Module, package: str) -> frozenset[str]:
    """What the import statements of a syntax tree name; ``package`` is where relative ones start."""
    found: set[str] = set()
    for node in ast.walk(module):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parents, *([base] if base else [])])
            if not (base in ROOMS and all(alias.name == "__version__" for alias in node.names)):
                found.add(base)
            found.update(f"{base}.{alias.name}" for alias in node.names)
    return frozenset(found)


@cache
def imports(name: str) -> frozenset[str]:
    """Every module that a module imports, the packages they are in included.

    The outermost package counts only where it is named itself: it is the front door, which loads nothing
    until one of its functions is used, and every import of a room passes through it.
    """
    found = named(name)
    whole = {".".join(one.split(".")[:k]) for one in found for k in range(1, one.count(".") + 2)}
    return frozenset(whole - set(ROOMS) | found)


@cache
def steps(name: str) -> frozenset[str]:
    """The modules of ours that a module imports itself, without the packages they are in."""
    found = set()
    for one in named(name):
        if one in modules() and one != name:
            names_below = any(other.startswith(one + ".") for other in named(name))
            if modules()[one].name != "__init__.py" or not names_below or _takes_a_name(name, one):
                found.add(one)
    return frozenset(found)


def _takes_a_name(name: str, package: str) -> bool:
    """Whether a module takes from a package a name that is not one of its modules."""
    return any(other.rpartition(".")[0] == package and other not in modules() for other in named(name))


def room(name: str) -> str:
    """The room of a module: the first folder below the package, or the package's own file."""
    parts = name.split(".")
    return parts[0] if parts[0] == "slipmargin_cli" else ".".join(parts[:2])


@cache
def rooms() -> dict[str, frozenset[str]]:
    """Room → the rooms that its modules import."""
    found: dict[str, set[str]] = {}
    for name in modules():
        here = found.setdefault(room(name), set())
        here.update(room(other) for other in imports(name) if other in modules())
    return {one: frozenset(others - {one}) for one, others in found.items()}


def cycles(graph: dict[str, frozenset[str]]) -> list[list[str]]:
    """Groups of nodes that reach each other (Tarjan's strongly connected components of two or more)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                found.append(sorted(group))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found
