"""What an effect is: a small frozen value that rewrites one part of a model.

Adding one takes one file (the class) and one line (its entry in
:data:`slipmargin.effects.catalogue.CATALOGUE`).  The class says everything that other rooms ask: whether
it acts on single wheels, what data can show it, which of its parameters a diagnosis fits and from where,
and what follows from it that can be checked by hand.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import TYPE_CHECKING, Any, ClassVar, final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.errors import InputError
from slipmargin.model import Model

if TYPE_CHECKING:
    from typing_extensions import Self


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
    INERTIA = "inertia"
    LOADS = "loads"
    GRIP = "grip"
    LOSSES = "losses"
    DRIVES = "drives"
    TRANSIENTS = "transients"
    SENSING = "sensing"

    @property
    def field(self) -> str:
        """The field of :class:`Model` that holds it."""
        return _FIELDS.get(self, self.value)

    @property
    def counts_in(self) -> str:
        """Where an effect on it counts, in words, where that is not in every command."""
        return _COUNTS_IN.get(self, "")


_FIELDS = {
    Part.CONTACTS: "geometry",
    Part.LOSSES: "external",
    Part.TRANSIENTS: "actuators",
    Part.SENSING: "measurement",
}
#: Where an effect counts that limits leave out; what they are those of comes after it.
IN_MOTIONS = "simulated motions and diagnose; limits and plans are those of "
_COUNTS_IN = {
    Part.SENSING: "diagnose only: it is a fault of what is measured, not of the robot",
    Part.TRANSIENTS: "simulate and diagnose with commands; limits, plans and stops are those of wheels "
    "that turn as they are told",
}


class Scope(Enum):
    """What an effect belongs to, so that data sets of one robot which share that share its parameters."""

    MACHINE = "machine"  #: radii, toe, layout, what depends on the wheel's angle, drives: all data sets
    FLOOR = "floor"  #: coefficients, creep law, nap, drag
    LOADING = "loading"  #: loads, centre of mass, what pulls at the robot
    INSTRUMENT = "instrument"  #: scale, rotation, delay and clock of what measures the pose


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number of an effect, with bounds that contain the value that does nothing."""

    name: str
    unit: str
    low: float
    high: float
    null: float
    scale: float  #: a change worth noticing; the fit's unit of length
    meaning: str
    starts: tuple[float, ...] = ()  #: where fits start; empty: one scale above null
    idle: bool = False  #: whether it has no influence while the effect's first parameter is at null
    along: str = ""  #: "position", "time" or "body": starts are shares of what runs cover, or of its size
    #: "x", "y" or "offset" of a place of the floor: a fit counts from the middle of where the runs were …
    coordinate: str = ""
    within: float = np.inf  #: … and looks no farther from there than this
    least_wheels: int = 0  #: with fewer wheels it has no influence
    needs_own_law_across: bool = False  #: whether a grip with one law for all directions has none of it
    usual: float | None = None  #: an end of the range that is an ordinary value; the null by default
    near: tuple[float, ...] = ()  #: where fits start at a line or place that the data point to
    meant: int = 0  #: the side of null that the effect's name means, −1 or 1; 0: both


def parameter(
    name: str,
    unit: str,
    span: tuple[float, float, float],
    scale: float,
    meaning: str,
    *,
    starts: tuple[float, ...] = (),
    idle: bool = False,
    along: str = "",
    least_wheels: int = 0,
    needs_own_law_across: bool = False,
    usual: float | None = None,
    near: tuple[float, ...] = (),
    coordinate: str = "",
    within: float = np.inf,
    meant: int = 0,
) -> Parameter:
    """A :class:`Parameter` in one line; ``span`` is (lowest, null, highest) value."""
    low, null, high = span
    return Parameter(
        name=name,
        unit=unit,
        low=low,
        high=high,
        null=null,
        scale=scale,
        meaning=meaning,
        starts=starts,
        idle=idle,
        along=along,
        least_wheels=least_wheels,
        needs_own_law_across=needs_own_law_across,
        usual=usual,
        near=near,
        coordinate=coordinate,
        within=within,
        meant=meant,
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """A form of an effect that a diagnosis fits: ``free`` parameters vary, ``fixed`` ones have these values.

    Parameters in neither stay at null.  ``label`` follows the effect's name where it has several variants.
    """

    free: tuple[str, ...]
    fixed: Mapping[str, float] = field(default_factory=dict)
    label: str = ""


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A number that follows from an effect and can be measured by hand."""

    name: str
    value: float
    unit: str


class Effect(ABC):
    """Abstract.  A concrete effect is a frozen dataclass whose fields are its parameters.

    Effects that may act on some wheels only derive from :class:`WheelEffect`.
    """

    __slots__ = ()

    name: ClassVar[str]
    summary: ClassVar[str]  #: one plain sentence
    traced_to: ClassVar[Trace]
    part: ClassVar[Part]
    parameters: ClassVar[tuple[Parameter, ...]]  #: the first one is the effect's size
    #: What it belongs to; the whole machine unless the effect says otherwise.
    scope: ClassVar[Scope] = Scope.MACHINE
    source: ClassVar[str]  #: paper, equation, sign convention
    confirm: ClassVar[str]  #: the measurement that would confirm it
    #: The forms a diagnosis fits; empty: one form with every parameter free.
    variants: ClassVar[tuple[Variant, ...]] = ()
    #: Whether it shows only in data with commanded wheel speeds.
    needs_commands: ClassVar[bool] = False
    #: Whether it is the clock of a log's rows: a nominal rate may be far off, time stamps are nearly right.
    is_the_clock: ClassVar[bool] = False
    #: Whether it turns tracks to one side whichever way the robot drives, as no force does.
    turns_all_ways: ClassVar[bool] = False
    #: Whether it depends on where a wheel stands, so that wheel angles need a known zero.
    needs_wheel_phase: ClassVar[bool] = False
    #: Whether only logs that hold wheel angles show it: a whole turn's phase cannot be guessed.
    needs_wheel_angles: ClassVar[bool] = False
    #: The effect that says the other half of one thing, as loads at rest and their shift with the
    #: acceleration both say where the centre of mass is: a diagnosis that fits one of them also fits both.
    other_half: ClassVar[str] = ""
    #: Where it counts, in words, where that is neither in every command nor as its part says.
    counts_in: ClassVar[str] = ""
    #: Parameters that no fit varies, with the values that a diagnosis compares once all else is fitted.
    scanned: ClassVar[Mapping[str, tuple[float, ...]]] = {}
    #: Parameters that say what a quantity is taken to be, with the values that a diagnosis compares with null
    #: once all else is found: no fit varies them.
    definitions: ClassVar[Mapping[str, tuple[float, ...]]] = {}

    def __post_init__(self) -> None:
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

    def check_wheels(self, count: int) -> None:
        """Refuse a parameter that has no influence on a robot with so few wheels.

        Raises
        ------
        InputError
            Placed at the parameter.
        """
        for p in self.parameters:
            if p.least_wheels > count and getattr(self, p.name) != p.null:
                problem = f"has no effect on {count} wheels, only on {p.least_wheels} or more"
                raise InputError(p.name, problem, "remove it")

    @abstractmethod
    def rewrite(self, part: Any, nominal: Model) -> Any:
        """The part with this effect; ``nominal`` is the model before any effect."""

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """What follows from it in a model that holds it and can be measured by hand; by default nothing."""
        del model
        return ()

    @classmethod
    def null(cls) -> Self:
        """The effect that does nothing."""
        return cls(**{p.name: p.null for p in cls.parameters})

    def values(self) -> Array:
        """The parameters' values in the order of :attr:`parameters`."""
        return np.array([getattr(self, p.name) for p in self.parameters], dtype=float)

    @classmethod
    def of(cls, values: Array) -> Self:
        """The effect with these parameter values."""
        return cls(**{p.name: float(v) for p, v in zip(cls.parameters, values, strict=True)})

    def to_table(self) -> dict[str, Any]:
        """As a ``[[effect]]`` table of the robot file."""
        return {"name": self.name, **{p.name: getattr(self, p.name) for p in self.parameters}}


@dataclass(frozen=True, slots=True, kw_only=True)
class WheelEffect(Effect):
    """Abstract.  An effect that acts on single wheels: ``wheels`` names them; empty means all."""

    #: Whether wheels have it in common, so that a diagnosis tries it on all at once …
    all_wheels: ClassVar[bool] = True
    #: … and whether one wheel has it alone, so that a diagnosis tries it on each.
    one_wheel: ClassVar[bool] = False

    wheels: tuple[str, ...] = ()

    @classmethod
    def of(cls, values: Array, wheels: tuple[str, ...] = ()) -> Self:
        """The effect with these parameter values on these wheels."""
        named: dict[str, Any] = {p.name: float(v) for p, v in zip(cls.parameters, values, strict=True)}
        return cls(**named, wheels=wheels)

    def to_table(self) -> dict[str, Any]:
        """As a ``[[effect]]`` table of the robot file."""
        return Effect.to_table(self) | ({"wheels": list(self.wheels)} if self.wheels else {})

    def mask(self, nominal: Model) -> Array:
        """(N,) weights: 1 for the wheels the effect acts on, 0 for the others.

        Raises
        ------
        InputError
            Where a named wheel does not exist.
        """
        names = nominal.geometry.names
        for wheel in self.wheels:
            if wheel not in names:
                raise InputError(
                    "wheels", f"{wheel!r} is not a wheel of this robot", f"use one of: {', '.join(names)}"
                )
        return np.array([float(not self.wheels or name in self.wheels) for name in names])
