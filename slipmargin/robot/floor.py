"""The floors of a robot file and the friction law of the wheels on them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from slipmargin.errors import InputError
from slipmargin.physics.friction_laws import LAWS
from slipmargin.physics.grips import GripShape
from slipmargin.robot.fields import check, number, table, text, word


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Coefficients:
    """Friction coefficients along the grip (``drive``) and the roller direction (``transverse``)."""

    drive: float = field(
        metadata=number(
            "1", "friction coefficient along the grip direction", 0.0, 10.0, above=True, uncertain=True
        )
    )
    transverse: float = field(
        metadata=number(
            "1",
            "friction coefficient along the direction in which the rollers roll",
            0.0,
            10.0,
            uncertain=True,
        )
    )

    def __post_init__(self) -> None:
        check(self)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """A floor: coefficients of a wheel standing on a roller and on rigid material (Table I)."""

    name: str
    library: str | None = field(
        default=None,
        metadata=text(
            "name of a published surface (`slipmargin surfaces list`) whose coefficients are used where "
            "`roller` and `rigid` do not give them"
        ),
    )
    roller: Coefficients = field(
        metadata=table(Coefficients, "a wheel standing on a roller", vary=("mu_drive", "mu_transverse"))
    )
    rigid: Coefficients = field(
        metadata=table(
            Coefficients, "a wheel standing on the rigid material between rollers", vary=("mu_rigid",)
        )
    )

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError("", f"has the name {self.name!r}", "give the surface a name")
        check(self)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionLaw:
    """μ(v) = μ_max σ(k v) by the law ``name`` (eq. 11: atan), and the set the force lies in.

    A law with a key of its own adds a field here, ``needs=(("name", LAW),)``, default None.
    """

    name: str = field(
        default="atan",
        metadata=word(
            LAWS,
            "how friction grows with slip speed v, with z = k v",
            (
                "(2/π) atan z, eq. (11) of the paper",
                "tanh z, the usual regularised Coulomb law",
                "z/√(1 + z²), a smoothed Coulomb law",
            ),
            name="law",
            vary=("friction_law",),
        ),
    )
    k_s_per_m: float = field(
        default=1000.0,
        metadata=number(
            "s/m",
            "slope of the friction law: a slip of 1/k already uses much of the grip",
            0.0,
            1e6,
            above=True,
            vary=("k_s_per_m",),
        ),
    )
    grip: GripShape = field(
        default=GripShape.BOX,
        metadata=word(
            GripShape,
            "set in which a wheel's friction force lies; for a new file take disc-strip",
            (
                "drive and transverse friction have each their own limit, eq. (17) of the paper",
                "the whole force is within the drive limit and its transverse part within the transverse one",
                "an ellipse over the two limits: a wheel that slides as a whole",
            ),
            vary=("grip",),
        ),
    )

    def __post_init__(self) -> None:
        check(self)
