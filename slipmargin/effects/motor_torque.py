"""The effect ``motor_torque``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Quantity, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Drives


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MotorTorque(WheelEffect):
    """1/T_i ← 1/T_i + shortfall/T_g: T_i what a motor gives at standstill.

    T is ∞ where the robot file states no ``stall_torque_N_m``; T_g is what the grip of a wheel bears at rest,
    in the mean of all.  A motor that is asked for more gives what it has, and its wheel falls behind its
    command.
    """

    name = "motor_torque"
    summary = "Motors give less torque than is asked for: a current limit, a weak battery, one worn motor."
    traced_to = Trace.ACTUATION
    part = Part.DRIVES
    scope = Scope.MACHINE
    one_wheel = True
    parameters = (
        parameter(
            "shortfall",
            "1",
            (0.0, 0.0, 20.0),
            0.1,
            "0: no less than the robot file says; where that states no torque, above 1 a motor gives way "
            "before a wheel slips that bears the mean load",
            starts=(1.05, 1.3, 2.0, 4.0, 1.12, 1.6),
        ),
    )
    needs_commands = True
    source = "the drives' straight torque–speed line, docs/theory.md; positive = less torque"
    confirm = "pull at the robot while its wheels are commanded to turn, and read when they stop"

    shortfall: float

    def rewrite(self, part: Drives, nominal: Model) -> Drives:
        """Drives with less torque."""
        if self.shortfall == 0.0:
            return part
        weaker = self.mask(nominal) * self.shortfall / float(np.mean(nominal.grip_torques_N_m()))
        with np.errstate(divide="ignore"):
            stall = 1.0 / (1.0 / part.stall_torques(nominal.count) + weaker)
        return replace(part, stall_torque_N_m=stall)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The torque that such a motor gives at standstill."""
        torque = model.drives.stall_torques(model.count)[self.mask(model) > 0.0]
        if not np.isfinite(torque).all():
            return ()
        return (Quantity(name="stall_torque_N_m", value=float(torque.min()), unit="N m"),)
