"""A grip has one coupled law: two effects that name different ones refuse each other."""

from __future__ import annotations

from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.robot import GripShape


def check_uncoupled(part: Grip, nominal: Model, wanted: GripShape, name: str, other: str) -> None:
    """Refuse ``wanted`` on a grip that another effect has given another coupled law.

    Raises
    ------
    InputError
        Naming both effects.
    """
    taken = part.shape not in (GripShape.BOX, wanted, nominal.grip.shape)
    if taken:
        raise InputError("effect", f"{name} and {other} are two laws for one wheel", "keep one of them")
