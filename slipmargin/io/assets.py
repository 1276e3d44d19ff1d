"""The files of the local page, which come with the package."""

from __future__ import annotations

from importlib.resources import files


def asset(name: str) -> str:
    """The text of a file of ``slipmargin/live/page``."""
    return (files("slipmargin.live") / "page" / name).read_text(encoding="utf-8")


def report_text(path: str) -> str:
    """The text of a report that the local page shows.

    Raises
    ------
    InputError
        Where it cannot be read or is no page.
    """
    from pathlib import Path

    from slipmargin.errors import InputError

    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as fault:
        reason = getattr(fault, "strerror", None) or "is no text"
        raise InputError("", f"cannot be read ({reason})", "give a report.html", path) from None
    if "<html" not in text[:2000].lower():
        raise InputError("", "is no HTML page", "give the report.html that slipmargin diagnose wrote", path)
    return text
