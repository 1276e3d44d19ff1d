"""A progress bar that names the stage the work is in, on stderr and only on a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def stages() -> Iterator[Callable[[str, float], None]]:
    """Yields ``report(stage, share)``, share from 0 to 1 of this stage."""
    if not sys.stderr.isatty():
        yield lambda stage, share: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    layout = (BarColumn(bar_width=24), TimeElapsedColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*layout, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading the data", total=1.0)
        yield lambda stage, share: bar.update(task, description=stage, completed=min(1.0, max(0.0, share)))
