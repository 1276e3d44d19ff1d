"""What the two coupled laws share: a grip has one of them, and effects that name different ones refuse."""

from __future__ import annotations

from dataclasses import replace

from slipmargin.effects.effect import parameter
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.grips import GripShape

STRENGTH = parameter(
    "strength", "1", (0.0, 0.0, 1.0), 0.2, "share of the coupled law", starts=(1.0,), usual=1.0
)
CONFIRM = (
    "drag the robot with one wheel locked at 45 degrees to its drive direction and compare the force"
    " with the straight pulls"
)


def coupled(part: Grip, nominal: Model, shape: GripShape, strength: float, names: tuple[str, str]) -> Grip:
    """The grip with a share of a coupled law; as it was at strength 0.

    Raises
    ------
    InputError
        Naming both effects (``names``: this one, the other), where the other has been here already.
    """
    if strength == 0.0:
        return part
    if part.shape not in (GripShape.BOX, shape, nominal.grip.shape):
        both = " and ".join(names)
        raise InputError("effect", f"{both} are two laws for one wheel", "keep one of them")
    return replace(part, shape=shape, coupling=strength)
