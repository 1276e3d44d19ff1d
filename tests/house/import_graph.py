"""The graph of rooms as Mermaid, drawn from the code: ``python tests/house/import_graph.py``."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from source import rooms

#: Rooms that all others may use; leaving them out keeps the drawing readable.
EVERYWHERE = {"slipmargin.errors", "slipmargin.checks", "slipmargin.work"}


def reduced(graph: dict[str, frozenset[str]]) -> dict[str, set[str]]:
    """The graph without arrows that other arrows imply."""

    def below(node: str, seen: set[str]) -> set[str]:
        for other in graph.get(node, ()):
            if other not in seen:
                seen.add(other)
                below(other, seen)
        return seen

    return {
        node: {
            other
            for other in others
            if not any(other in below(third, set()) for third in others if third != other)
        }
        for node, others in graph.items()
    }


def mermaid() -> str:
    """Lines ``room --> room it imports``, arrows that others imply left out."""
    graph = {
        node: frozenset(others - EVERYWHERE) for node, others in rooms().items() if node not in EVERYWHERE
    }
    lines = ["graph TD"]
    for node, others in sorted(reduced(graph).items()):
        short = node.removeprefix("slipmargin.")
        lines += [f"  {short} --> {other.removeprefix('slipmargin.')}" for other in sorted(others)]
    return "\n".join(lines)


if __name__ == "__main__":
    print(mermaid())
