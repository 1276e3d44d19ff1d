"""The command line: parses, calls the package, renders.  One command a file."""

from __future__ import annotations

import sys


def run() -> None:
    """Entry point of the ``slipmargin`` script: Ctrl-C while modules are loaded ends as quietly as later."""
    try:
        from .main import run as carry_out

        carry_out()
    except KeyboardInterrupt:
        sys.exit(130)
