"""A virtual pull test: wheels locked, a force that grows until the robot runs away.

With locked wheels a steady creep balances the pull: the friction law is the gradient of a convex
potential, so a creep exists exactly for pulls inside the wrench set (docs/theory.md, section 2).  The rope
keeps its direction relative to the robot, as a hand that follows it would.  Near the limit a contact that
slides at z = k u still lacks 1 − σ(z) of its friction, with σ the model's law and k its slope at that
state, after every multiplier: two creeps z and z/2 on one slow ramp give the limit without what is lacking.
The contacts that slide are those whose slip doubled between them.

Where the model has a stall torque, motors hold the wheels with no more than that; a wheel that is driven
back gives way by rolling, not by sliding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError, NoSolution
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics
from slipmargin.physics.friction_laws import law_share
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.sim import layout as at
from slipmargin.sim.batch import Batch, Outcome
from slipmargin.sim.pack import pack, stack
from slipmargin.sim.signal import held

#: z = k u at which the robot is taken to run away: eq. (11) is then within 1 % of its limit.
CREEP = 64.0
#: How many times slower the second ramp is than the robot takes to run away.
PATIENCE = 3000.0
_SAMPLES = 4000
#: How often the first ramp is slowed down to the slope of the law that it met.
_TRIES = 6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullTest:
    """Breakaway forces ``force_N`` (M,) at orientations ``phi_rad`` (M,), pulled along the floor's +x.

    ``sliding`` (M, N, 2): which contacts slide at breakaway, along ĝ and f̂; ``driven_back`` (M, N): which
    wheels turn against their motors; ``limit`` (M,): ``"motor"`` where one does, ``"friction"`` else.
    """

    phi_rad: Array
    force_N: Array
    sliding: NDArray[np.bool_]
    driven_back: NDArray[np.bool_]

    @property
    def limit(self) -> tuple[str, ...]:
        """What gave way at each orientation."""
        return tuple("motor" if back else "friction" for back in np.any(self.driven_back, axis=1).tolist())


def standing(model: Model, rigid: tuple[bool, ...]) -> Model:
    """The model with every wheel held on a roller (False) or on rigid material (True)."""
    if len(rigid) != model.count:
        raise InputError(
            "rigid", f"names {len(rigid)} wheels, the robot has {model.count}", "give one value a wheel"
        )
    mask = np.array(rigid, dtype=bool)[:, None]
    grip = replace(
        model.grip,
        roller=np.where(mask, model.grip.rigid, model.grip.roller),
        rigid_fraction=np.zeros(model.count),
    )
    return replace(model, grip=grip)


def pull_test(model: Model, phi_rad: Array, *, rigid: tuple[bool, ...] | None = None) -> PullTest:
    """Pull the robot at each orientation until it runs away.

    Parameters
    ----------
    model : Model
        The machine on its surface.
    phi_rad : array (M,)
        Orientation φ of the robot under a pull along +x of the floor, through the centre of mass [rad].
    rigid : tuple of bool, optional
        Which wheels stand on rigid material; all on rollers by default.

    Raises
    ------
    NoSolution
        If the robot does not run away at any force tried or tips first, or if its friction has no limit
        that a slip could reach: with a law of the slip ratio alone k u never exceeds κ, so that the grip
        used stays below σ(κ).
    """
    phi = frozen("phi_rad", phi_rad, (None,))
    still = standing(model, (False,) * model.count if rigid is None else rigid)
    # A locked wheel has neither lag nor droop, and holds with the same torque at any speed.
    still = replace(
        still,
        actuators=ActuatorDynamics.none(model.count),
        drives=replace(still.drives, max_speed_rad_s=None),
    )
    most = np.full(len(phi), float(np.sum(still.loads.rest_N * np.hypot(*still.grip.roller.T))))
    k = np.full(len(phi), still.grip.k_s_per_m)
    none = np.zeros(len(phi))
    for _ in range(_TRIES):
        light = _lightness(still, k, 0.3 * most)
        first = _Ramp(still, phi, none, 1.5 * most, 40.0 * light * _escape(still, k, 0.3 * most), light)
        met = first.steepness()
        if np.all(first.reached()) and np.all(np.abs(np.log(met / k)) < 0.5):
            break
        k = met
    force = first.breakaway()
    light = _lightness(still, k, force)
    seconds = PATIENCE * light * _escape(still, k, force)
    second = _Ramp(still, phi, 0.8 * force, 1.03 * force, seconds, light)
    force = second.breakaway()
    return PullTest(phi_rad=phi, force_N=force, sliding=second.sliding(), driven_back=second.driven_back())


def _escape(model: Model, k: Array, force: Array) -> Array:
    """Time to run away to the creep at a pull right at the limit of eq. (11) [s]: m v̇ = (2/π) F/(k v)."""
    return np.asarray(0.25 * np.pi * model.inertia.mass_kg * CREEP**2 / (k * force))


def _lightness(model: Model, k: Array, force: Array) -> Array:
    """Share of its inertia that the robot is pulled with, its weight as it is [1].

    The limit is one of statics: m ω v must stay small beside the pull at the speed of the creep, which a
    soft contact reaches late.
    """
    reach = model.reach_m
    coasting = model.inertia.mass_kg * (CREEP / k) ** 2 / reach
    return np.asarray(np.minimum(1.0, 0.02 * force / coasting))


class _Ramp:
    """Pulls that grow from ``low`` to ``high`` (M,) [N] in so many seconds, and what the wheels did."""

    def __init__(
        self, model: Model, phi: Array, low: Array, high: Array, seconds: Array, light: Array
    ) -> None:
        self.low, self.high, self.law = low, high, model.grip.law
        models, signals, times = [], [], []
        for angle, a, b, span in zip(phi, low, high, seconds, strict=True):
            along = np.array([np.cos(angle), -np.sin(angle), 0.0])  # R(φ)ᵀ x̂
            pull = ForceTerm(
                variable=Variable.TIME,
                basis=Basis.HATS,
                shape=np.array([0.0, span]),
                frame=Frame.BODY,
                coefficients=np.outer(along, [a, b]),
            )
            external = replace(model.external, terms=(*model.external.terms, pull))
            models.append(replace(model, external=external))
            signals.append(held(np.array([0.0, span]), np.zeros((2, model.count))))
            times.append(np.linspace(0.0, span, _SAMPLES))
        batch = Batch(signals, times, commanded=True)
        packed = stack([pack(m) for m in models])
        wheels = at.HEAD + at.WHEEL * np.arange(model.count)
        follow = [wheels + column for column in (at.LOAD_X, at.LOAD_Y, at.INERTIA_OF_WHEEL)]
        packed[:, np.concatenate([[at.MASS, at.INERTIA], *follow])] *= light[:, None]
        self.outcome: Outcome = batch.run(packed, np.zeros(3), which=np.arange(len(phi)), tell=True)
        assert self.outcome.slip is not None and self.outcome.steepness is not None
        assert self.outcome.theta is not None
        self.slip: Array = np.abs(self.outcome.slip)  # (M, T, N, 2)
        self.k: Array = self.outcome.steepness
        turning = np.gradient(self.outcome.theta, axis=1) / (seconds / (_SAMPLES - 1))[:, None, None]
        self.rolling: Array = np.abs(turning * model.geometry.radius_m)  # (M, T, N)
        self.z: Array = np.maximum(
            np.max(self.k * self.slip, axis=(2, 3)), np.max(self.k[..., 0] * self.rolling, axis=2)
        )

    def reached(self) -> NDArray[np.bool_]:
        """(M,) whether a contact crept (or a wheel was driven back) fast enough to be running away."""
        return np.asarray(np.max(self.z, axis=1) > CREEP)

    def steepness(self) -> Array:
        """(M,) slope of the law at the fastest contact, where the robot runs away or in the end [s/m]."""
        rows = np.arange(len(self.z))
        when = np.where(self.reached(), np.argmax(self.z > CREEP, axis=1), _SAMPLES - 1)
        slip, k = (a[rows, when].reshape(len(rows), -1) for a in (self.slip, self.k))
        return np.asarray(np.maximum(k[rows, np.argmax(slip, axis=1)], 1e-9))

    def breakaway(self) -> Array:
        """(M,) the force at which each robot runs away [N]."""
        for r in np.flatnonzero(~self.reached()):
            fastest, share = float(np.max(self.slip[r])), float(law_share(self.law, np.max(self.z[r])))
            if share > 0.5:
                problem = f"at {fastest:.3g} m/s no contact uses more than {share:.3f} of its grip"
                raise NoSolution(
                    "pull test",
                    f"{problem}: this friction law has no limit that a slip reaches",
                    "pull a model whose friction depends on the slip speed",
                    self.outcome.ending[r],
                )
            raise NoSolution(
                "pull test",
                "the robot does not run away",
                "check its friction and loads",
                self.outcome.ending[r],
            )
        lacking = 1.0 - law_share(self.law, np.array([CREEP, 0.5 * CREEP]))
        beyond = lacking[0] / (lacking[1] - lacking[0]) if lacking[1] > lacking[0] else 0.0
        pull = [self.low + (self.high - self.low) * x / (_SAMPLES - 1) for x in self._crossings()]
        return np.asarray(pull[0] + beyond * (pull[0] - pull[1]))

    def sliding(self) -> NDArray[np.bool_]:
        """(M, N, 2) the contacts whose slip doubled while the fastest one's did."""
        return self._doubled(self.slip)

    def driven_back(self) -> NDArray[np.bool_]:
        """(M, N) the wheels whose rolling did, where it is not just slow."""
        fast = self._at(self.rolling * self.k[..., 0], self._crossings()[0]) > 0.01 * CREEP
        return np.asarray(self._doubled(self.rolling) & fast)

    def _doubled(self, speed: Array) -> NDArray[np.bool_]:
        there, half = (self._at(speed, x) for x in self._crossings())
        return np.asarray(there > 1.5 * half)

    def _crossings(self) -> tuple[Array, Array]:
        """Sample numbers (M,), with fractions, at which z first passes CREEP and half of it."""
        found = [np.array([_crossing(z, level) for z in self.z]) for level in (CREEP, 0.5 * CREEP)]
        return found[0], found[1]

    @staticmethod
    def _at(values: Array, x: Array) -> Array:
        k = np.minimum(x.astype(int), values.shape[1] - 2)
        rows = np.arange(len(values))
        part = (x - k).reshape(-1, *(1,) * (values.ndim - 2))
        return np.asarray(values[rows, k] + part * (values[rows, k + 1] - values[rows, k]))


def _crossing(z: Array, level: float) -> float:
    """Sample number (with fraction) at which z first passes a level; 1/z is nearly straight."""
    k = max(int(np.argmax(z > level)), 1)
    a, b = 1.0 / max(z[k - 1], 1e-12), 1.0 / z[k]
    return float(k - 1 + (a - 1.0 / level) / (a - b))
