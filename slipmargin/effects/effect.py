"""What an effect is: a small frozen value that rewrites one part of a model.

Adding one takes one file (the class) and one line (its entry in
:data:`slipmargin.effects.catalogue.CATALOGUE`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, ClassVar, Self, final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.errors import InputError
from slipmargin.model import Model


class Trace(Enum):
    """The measured variable that a residual depends on."""

    WHEEL_ANGLE = "wheel_angle"
    WHEEL_LOAD = "wheel_load"
    SLIP_SPEED = "slip_speed"
    SLIP_COUPLING = "slip_coupling"
    SLIP_RATIO = "slip_ratio"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    HEADING = "heading"
    POSITION = "position"
    TIME = "time"
    CONSTANT_FORCE = "constant_force"
    COEFFICIENT = "coefficient"
    WHEEL = "wheel"
    ACTUATION = "actuation"
    MEASUREMENT = "measurement"


class Part(Enum):
    """The part of the model an effect rewrites, by its word in robot files."""

    CONTACTS = "contacts"
    LOADS = "loads"
    GRIP = "grip"
    LOSSES = "losses"
    TRANSIENTS = "transients"
    SENSING = "sensing"

    @property
    def field(self) -> str:
        """The field of :class:`Model` that holds it."""
        return _FIELDS.get(self, self.value)


_FIELDS = {
    Part.CONTACTS: "geometry",
    Part.LOSSES: "external",
    Part.TRANSIENTS: "actuators",
    Part.SENSING: "measurement",
}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number of an effect: bounds that contain the value that does nothing."""

    name: str
    unit: str
    low: float
    high: float
    null: float
    scale: float  #: a change worth noticing; the fit's unit of length
    meaning: str
    starts: tuple[float, ...] = ()  #: where a fit starts; empty: one scale above null


class Effect(ABC):
    """Abstract.  A concrete effect is a frozen dataclass whose fields are its parameters.

    ``wheels`` names the wheels it acts on; empty means all.
    """

    name: ClassVar[str]
    traced_to: ClassVar[Trace]
    part: ClassVar[Part]
    parameters: ClassVar[tuple[Parameter, ...]]
    source: ClassVar[str]  #: paper, equation, sign convention
    confirm: ClassVar[str]  #: the measurement that would confirm it

    wheels: tuple[str, ...]

    @abstractmethod
    def rewrite(self, part: Any, nominal: Model) -> Any:
        """The part with this effect; ``nominal`` is the model before any effect."""

    @classmethod
    def null(cls) -> Self:
        """The effect that does nothing."""
        return cls(**{p.name: p.null for p in cls.parameters})

    def values(self) -> Array:
        """The parameters' values in the order of :attr:`parameters`."""
        return np.array([getattr(self, p.name) for p in self.parameters], dtype=float)

    @classmethod
    def of(cls, values: Array, wheels: tuple[str, ...] = ()) -> Self:
        """The effect with these parameter values."""
        named: dict[str, Any] = {p.name: float(v) for p, v in zip(cls.parameters, values, strict=True)}
        return cls(**named, **({"wheels": wheels} if wheels else {}))

    def to_table(self) -> dict[str, Any]:
        """As a ``[[effect]]`` table of the robot file."""
        table: dict[str, Any] = {"name": self.name}
        table.update({p.name: getattr(self, p.name) for p in self.parameters})
        if self.wheels:
            table["wheels"] = list(self.wheels)
        return table

    def _check(self) -> None:
        known = {f.name for f in fields(self)}  # type: ignore[arg-type]
        for p in self.parameters:
            assert p.name in known, f"{type(self).__name__} has no field {p.name}"
            value = real(
                p.name,
                getattr(self, p.name),
                low=p.low,
                high=p.high,
                cure=f"{p.meaning} lies between {p.low:g} and {p.high:g} [{p.unit}]",
            )
            object.__setattr__(self, p.name, value)

    def mask(self, nominal: Model) -> Array:
        """(N,) weights: 1 for the wheels the effect acts on, 0 for the others."""
        names = nominal.geometry.names
        for wheel in self.wheels:
            if wheel not in names:
                raise InputError(
                    "wheels", f"{wheel!r} is not a wheel of this robot", f"use one of: {', '.join(names)}"
                )
        return np.array([float(not self.wheels or name in self.wheels) for name in names])
