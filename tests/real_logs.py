"""Real Robotino logs for tests: the excerpt in the repository, and the whole where it lies beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
EXCERPT = ROOT / "tests" / "data" / "robotino_excerpt"
WHOLE = ROOT.parent / "shared" / "data" / "robotino"

needs_whole = pytest.mark.skipif(
    not WHOLE.is_dir(), reason="the whole campaign is not beside the repository (README: where to get it)"
)


def logs(folder: Path) -> list[Path]:
    """The logs of one floor and speed, in order."""
    return sorted(folder.glob("*.csv"))
