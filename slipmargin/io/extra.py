"""Packages that only some readers and writers need: where one is missing, the command says how to get it."""

from __future__ import annotations

from importlib.util import find_spec

from slipmargin.errors import InputError


def need(what: str, package: str, extra: str) -> None:
    """Refuse a format whose package is not installed.

    Parameters
    ----------
    what : str
        The format, as the message names it.
    package : str
        The package to import.
    extra : str
        The extra of slipmargin that installs it.

    Raises
    ------
    InputError
        With the command that installs it.
    """
    if find_spec(package) is None:
        raise InputError(
            what,
            f"the package {package} is not installed",
            f"install it: pip install 'slipmargin[{extra}]'",
            "command line",
        )
