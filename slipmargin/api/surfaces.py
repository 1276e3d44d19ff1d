"""The library of published friction coefficients."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, final

from slipmargin.api.result import Result
from slipmargin.robot.library import LIBRARY, PublishedSurface, published


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceDescription(Result):
    """One entry of the library: coefficients, how they were measured, where they were published."""

    surface: PublishedSurface

    def summary(self) -> str:
        """Wheel, floor and coefficients."""
        s = self.surface
        return f"surface {s.name}: {s.wheel} on {s.floor}; {_numbers(s)}"

    def lines(self) -> list[str]:
        """Everything that is published, and the table to put into a robot file."""
        s = self.surface
        more = "".join(f", {k} = …" for k in s.missing).removeprefix(", ")
        lines = [
            f"wheel       {s.wheel}",
            f"floor       {s.floor}",
            f"numbers     {_numbers(s)}",
            f"measured    {s.method}",
            f"source      {s.source}",
            *([f"remark      {s.remark}"] if s.remark else []),
            "",
            "[surface.floor]",
            f'library = "{s.name}"',
        ]
        return [*lines, f"roller = {{ {more} }}   # not published: measure it"] if more else lines

    def to_dict(self) -> dict[str, Any]:
        """The entry as plain data."""
        return {"schema": 1, **asdict(self.surface)}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceLibrary(Result):
    """Every entry of the library."""

    surfaces: tuple[PublishedSurface, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(s.name for s in self.surfaces)

    def summary(self) -> str:
        """How many there are."""
        return f"{len(self.surfaces)} published surfaces"

    def lines(self) -> list[str]:
        """A row each: name, wheel, floor, coefficients."""
        from slipmargin.report.text import columns

        return columns(
            ["name", "drive", "transverse", "rigid", "wheel on floor"],
            [
                [s.name, *(_span(v) for v in (s.drive, s.transverse, s.rigid)), f"{s.wheel} on {s.floor}"]
                for s in self.surfaces
            ],
        )

    def to_dict(self) -> dict[str, Any]:
        """Every entry as plain data."""
        return {"schema": 1, "surfaces": [asdict(s) for s in self.surfaces]}


def known_surfaces() -> SurfaceLibrary:
    """The published friction coefficients that a robot file may name (``library = "…"``).

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.known_surfaces().names[:2]
    ('paper-omni-williams2002', 'carpet-omni-williams2002')
    """
    return SurfaceLibrary(surfaces=LIBRARY)


def describe_surface(name: str) -> SurfaceDescription:
    """One entry of the library of published friction coefficients.

    Parameters
    ----------
    name : str
        Its name, as :func:`known_surfaces` lists it.

    Raises
    ------
    InputError
        If there is none of that name.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.describe_surface("carpet-omni-williams2002").surface.drive
    (0.245, 0.255)
    """
    from slipmargin.io.toml_table import one_of

    found = published(one_of("name", name, [s.name for s in LIBRARY]))
    assert found is not None
    return SurfaceDescription(surface=found)


def _numbers(s: PublishedSurface) -> str:
    spans = (("drive", s.drive), ("transverse", s.transverse), ("rigid", s.rigid))
    return ", ".join(f"{name} {_span(value)}" for name, value in spans)


def _span(value: tuple[float, float] | None) -> str:
    return "not published" if value is None else f"{value[0]:g} to {value[1]:g}"
