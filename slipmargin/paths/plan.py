"""The fastest motion along a path that stays inside a share of every limit."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.paths import core
from slipmargin.paths.along import FASTER, SLOWER, Assumed, Rows, assume, rows_along
from slipmargin.paths.audit import FINER, Audit, audit
from slipmargin.paths.geometry import Geometry, Profile
from slipmargin.paths.grid import Grid, grid_of
from slipmargin.paths.infeasibility import stuck, too_fast
from slipmargin.paths.passes import held, passes
from slipmargin.paths.path import Path
from slipmargin.paths.request import Request as Request

#: Passes with fixed shares before the dense check begins: at least so many, for the drag to settle, and until
#: the duration changes by no more than this share, for the torque–speed line to be touched where it is used.
SETTLING, MOST_SETTLING, SETTLED = 3, 20, 1e-6
#: Rounds of tightening before giving up.
ROUNDS = 60
#: Halvings of the span in which the largest end speed is sought, to name it in three digits.
HALVINGS = 16
#: The dense check aims this much below the limit, so that rounding cannot exceed it [1].
AIM = 2e-7
#: A row that leaves no more room than this limits the motion [1].
BINDS = 1e-6
#: No round lowers a share by more than this factor [1].
LEAST_LEFT = 0.5
#: Each further round aims lower by this factor, down to a coarsest aim, so that rounds come to an end [1].
HASTE, COARSEST = 1.25, 3e-3
#: An interval that was lowered more often than this is lowered by HASTE times more each time: its row may
#: stand far from what it really uses, and answer to nothing until it binds.
PATIENCE = 6
#: Where no profile is found, one is sought below these parts [1] of the speed that was reached.
_BELOW = (0.93, 0.8, 0.5, 0.2)
#: … or, where none was, of this speed [m/s].
_UNKNOWN_M_S = 1.0


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """A time-optimal profile: x = ṡ² (n + 1,), s̈ (n,) and what limits it.

    ``highest`` (n + 1,) is the largest ṡ² from which the rest of the path can be driven; ``limited_by``
    (n,) indexes ``rows.names`` (−1: a speed cap, or the motors' top speed); ``audit`` holds the dense check.
    ``below_m_s`` is a bound on ṡ without which the search found no profile, None where it needed none.
    """

    model: Model
    path: Path
    request: Request
    grid: Grid
    x: Array
    u: Array
    highest: Array
    limited_by: np.ndarray[tuple[int], np.dtype[np.int64]]
    rows: Rows
    audit: Audit
    passes: int
    below_m_s: float | None = None

    @property
    def duration_s(self) -> float:
        """Time for the whole path [s]."""
        return duration(self.grid.step, self.x)

    @property
    def max_use(self) -> float:
        """Largest share of a wheel's grip, sampled 20 times finer than the grid, settling included."""
        return float(np.max(self.audit.most))

    def states(self) -> Motion:
        """The motion at both ends and in the middle of every interval."""
        geometry = self._geometry()
        return geometry.motion(self.x, self.u, geometry.times(self.x, self.u))

    def profile(self) -> Profile:
        """Way and speed at the grid points, turning counted as the way of the wheels."""
        return self._geometry().profile(self.model.reach_m, self.x, self.highest)

    def _geometry(self) -> Geometry:
        return Geometry.of(self.model, self.path, self.grid, np.array([0.0, 0.5, 1.0]))


def duration(step: Array, x: Array) -> float:
    """Σ 2 Δ / (√x_j + √x_{j+1}) [s]: exact, since s̈ is constant between grid points."""
    root = np.sqrt(np.maximum(x, 0.0))
    with np.errstate(divide="ignore"):  # at rest from one place to the next it never arrives
        return float(np.sum(2.0 * step / (root[1:] + root[:-1])))


def plan(model: Model, path: Path, request: Request | None = None, *, grid: Grid | None = None) -> Plan:
    """The fastest motion along ``path`` under ``request.share`` of every limit.

    Each interval starts with the full share.  The profile is checked FINER times finer than the grid
    with the forces that the wheels really have, on the way from one acceleration to the next as well, and
    intervals that use too much are tightened, until nothing exceeds the share.

    Raises
    ------
    InputError
        If the start or end speed is impossible.
    NoSolution
        If there is no admissible motion: says where, which wheel, why, and what would help.
    """
    request = request or Request()
    grid = grid or grid_of(path, request.points)
    work = _Work(
        model,
        request,
        grid,
        Geometry.of(model, path, grid, np.array([0.0, 0.5, 1.0])),
        Geometry.of(model, path, grid, np.linspace(0.0, 1.0, FINER + 1)),
    )
    try:
        return work.plan(path)
    except NoSolution as fault:
        for slower in work.slower():
            with contextlib.suppress(NoSolution):
                return slower.plan(path)
        raise fault from None


class _Work:
    """The state of the iteration; private to :func:`plan`."""

    def __init__(
        self,
        model: Model,
        request: Request,
        grid: Grid,
        coarse: Geometry,
        fine: Geometry,
        below: float | None = None,
    ) -> None:
        self.model, self.request, self.grid, self.coarse, self.fine = model, request, grid, coarse, fine
        self.below = below  # a bound on ṡ, and the speed of the first guess; None where none is needed
        rates = coarse.floor_rates(model.reach_m)
        self.ends = (float(request.start_m_s / rates[0]) ** 2, float(request.end_m_s / rates[1]) ** 2)  # ṡ²
        n = len(grid.step)
        self.grip, self.torque, self.speed, self.load = np.ones((4, n))
        self.times = np.zeros((4, n), dtype=np.int64)  # that each interval was lowered, in order of `limited`
        self.x, self.u, self.highest = np.zeros(n + 1), np.zeros(n), np.zeros(n + 1)
        self.passes = 0
        self.from_rest = self.x  # the profile from rest to rest that others are begun from
        self.rows: Rows
        self.seen: tuple[Array, Array, Audit] | None = None
        self.whole = False  # whether what was seen is a whole check

    def plan(self, path: Path) -> Plan:
        """Settle, then tighten what uses too much until nothing does."""
        self.settle()
        for k in range(ROUNDS):
            aim = min(AIM * HASTE**k, COARSEST)
            over = self.tighten(self.check(), aim) or self.tighten(seen := self.check(whole=True), aim)
            if not over:
                return Plan(
                    model=self.model,
                    path=path,
                    request=self.request,
                    grid=self.grid,
                    x=self.x,
                    u=self.u,
                    highest=self.ceiling(),
                    limited_by=self.named(),
                    rows=self.rows,
                    audit=seen,
                    passes=self.passes,
                    below_m_s=self.below,
                )
            self.drive(*self.ends)
        raise self.not_settled()

    def slower(self) -> Iterator[_Work]:
        """The same work below ever lower speeds: a profile may be there although this search found none.

        The full drag that is assumed at first may be more than any speed brings, and near the motors' top
        speed little torque is left of which a share is asked.
        """
        fastest = min(float(np.sqrt(np.max(self.x))) or _UNKNOWN_M_S, self.request.caps.speed_m_s)
        for part in _BELOW:
            below = part * fastest
            if below**2 > max(self.ends):
                yield _Work(self.model, self.request, self.grid, self.coarse, self.fine, below)

    def states(self) -> list[Motion]:
        """States to be safe for: full drag or the speed bound at first, then speeds of the last profile."""
        if self.passes == 0 and self.below is None:
            return [self.coarse.saturated()]
        x = self.x if self.passes or self.below is None else np.full_like(self.x, self.below**2)
        time = self.coarse.times(x, self.u)
        return [self.coarse.motion(x, None, time, scale) for scale in (SLOWER, FASTER)]

    def settle(self) -> None:
        """Passes with fixed shares until neither drag nor torque–speed line moves the profile any more."""
        start, end = self.ends
        if max(start, end) > 0.0 and self.model.drives.stall_torque_N_m is not None:
            # The torque–speed line is touched where a profile from rest to rest is, and at the ends' speeds.
            with contextlib.suppress(NoSolution):
                self._settle(0.0, 0.0)
            self.from_rest = self.x
            self.x, self.highest = self._ending(end), np.maximum(self.highest, self._ending(end))
            self.x = np.maximum(self.x, np.minimum(held(self.from_rest, start), self.ceiling()))
        self._settle(start, end)

    def _ending(self, end: float) -> Array:
        """The profile from rest to rest, but no slower than ``end`` (ṡ²) from where it comes down to it."""
        return np.maximum(self.from_rest, held(self.from_rest[::-1], end)[::-1])

    def _fastest_end(self, start: float) -> float:
        """Largest ṡ² at the end that can be reached from ``start``, below the one asked for."""
        low, high, assumed = 0.0, float(np.sqrt(self.ends[1])), self.assumed()
        for _ in range(HALVINGS):
            speed = 0.5 * (low + high)
            end = speed**2
            found = passes(self.grid, self.along(assumed, self._ending(end)), start, end)
            low, high = (speed, high) if found.status == core.OK else (low, speed)
        return low**2

    def _settle(self, start: float, end: float) -> None:
        before = np.inf
        for k in range(MOST_SETTLING):
            self.drive(start, end)
            now = duration(self.grid.step, self.x)
            if k + 1 >= SETTLING and abs(now - before) <= SETTLED * now:
                break
            before = now

    def assumed(self) -> Assumed:
        """Friction and external wrenches of every interval, at the speeds of the last profile."""
        r = self.request
        return assume(self.model, self.coarse, self.states(), share=r.share, contact=r.contact)

    def along(self, assumed: Assumed, guess: Array) -> Rows:
        """The rows of every interval, the torque–speed line being touched at a profile ṡ² (n + 1,)."""
        r = self.request
        rows = rows_along(
            self.model,
            self.coarse,
            assumed,
            share=r.share * self.grip,
            torque_share=r.share * self.torque,
            load_share=r.share * self.load[:, None],
            caps=r.caps,
            cap_share=self.speed,
            guess=guess,
        )
        return rows if self.below is None else replace(rows, cap=np.minimum(rows.cap, self.below**2))

    def drive(self, start: float, end: float) -> None:
        """One backward and forward pass between these ṡ²; what was found last is where it is linearised."""
        r = self.request
        self.rows = w = self.along(self.assumed(), self.x)
        found = passes(self.grid, w, start, end)
        if found.status == core.START:
            self.highest = found.highest
            raise too_fast(r.start_m_s, True, float(self.ceiling()[0]), self.coarse, self.model.reach_m)
        if found.status != core.OK:
            most = self._fastest_end(start) if end > 0.0 else 0.0
            if found.status == core.END or most > 0.0:
                raise too_fast(r.end_m_s, False, most, self.coarse, self.model.reach_m)
            raise stuck(self.model, self.coarse, w, *found.conflict, r.share, r.contact)
        self.x, self.u, self.highest = found.x, found.u, found.highest
        self.passes += 1

    def ceiling(self) -> Array:
        """Largest ṡ² (n + 1,) from which the rest can be driven; the torque–speed line is touched there."""
        drives, highest = self.model.drives, self.highest
        if drives.stall_torque_N_m is None or drives.max_speed_rad_s is None:
            return highest
        assumed, end = self.assumed(), self.ends[1]
        for _ in range(MOST_SETTLING):
            found = passes(self.grid, self.along(assumed, highest), 0.0, end)
            if found.status != core.OK or np.all(found.highest <= highest * (1.0 + SETTLED)):
                break
            highest = np.maximum(highest, found.highest)
        return highest

    def check(self, *, whole: bool = False) -> Audit:
        """The dense check of the profile, or unless ``whole`` of the intervals that changed since the last.

        What depends on the time of an interval alone is seen by a whole check only: one ends every plan.
        """
        if whole and self.whole and self.seen is not None and self.seen[0] is self.x:
            return self.seen[2]
        known = changed = None
        if self.seen is not None and not whole:
            x, u, known = self.seen
            same = x == self.x
            changed = ~(same[:-1] & same[1:] & (u == self.u))
        found = audit(
            self.model,
            self.fine,
            self.x,
            self.u,
            contact=self.request.contact,
            share=self.request.share,
            caps=self.request.caps,
            known=known,
            changed=changed,
        )
        self.seen, self.whole = (self.x, self.u, found), known is None
        return found

    def limited(self, seen: Audit) -> tuple[tuple[str, Array, Array, float], ...]:
        """What is limited: its name, the share kept of it (n,), what is used (n, N or 1) and the limit."""
        share = self.request.share
        return (
            ("grip", self.grip, seen.most, share),
            ("motor torque", self.torque, seen.torque.max(axis=1), share),
            ("load before it lifts", self.load, seen.tipping.max(axis=1), share),
            ("speed cap", self.speed, seen.speed.max(axis=1, keepdims=True), 1.0),
        )

    def tighten(self, seen: Audit, aim: float) -> bool:
        """Lower the shares of intervals that use too much to ``aim`` below; False where none does."""
        found = False
        for times, (_, kept, used, limit) in zip(self.times, self.limited(seen), strict=True):
            factor = _lowered(used.max(axis=1), limit, aim)
            over = factor < 1.0
            found |= bool(np.any(over))
            times += over
            insisting = HASTE ** np.maximum(times - PATIENCE, 0)
            kept *= np.maximum(1.0 - (1.0 - factor) * insisting, LEAST_LEFT)
        self.grip *= self._remembered(seen, aim)
        return found

    def not_settled(self) -> NoSolution:
        """The error where something is used too much after the last round: what is most over its limit."""
        seen = self.check(whole=True)
        what, _, used, limit = max(self.limited(seen), key=lambda row: float(np.max(row[2])) / row[3])
        i, wheel = np.unravel_index(int(np.argmax(used)), used.shape)
        who = f"wheel {self.model.geometry.names[wheel]}" if used.shape[1] > 1 else "the robot"
        return NoSolution(
            self.place(int(i)),
            f"{who} still uses {used[i, wheel]:.4f} of its {what}, where {limit:g} is allowed, "
            f"after {ROUNDS} rounds of tightening",
            "use more grid points or a larger margin",
            seen,
        )

    def _remembered(self, seen: Audit, aim: float) -> Array:
        """Factors (n,) for the intervals before one that uses too much, for as long as their creep lasts.

        An interval that pushes the other way along the path did not add to it.
        """
        if not np.any(seen.memory_s):
            return np.ones(len(self.u))
        own, start = _lowered(seen.driven, self.request.share, aim), seen.time_s[:, 0]
        out = own.copy()
        for j in range(len(out) - 2, -1, -1):
            if self.u[j] * self.u[j + 1] > 0.0:
                fades = np.exp((start[j] - start[j + 1]) / seen.memory_s[j])
                out[j] = min(out[j], 1.0 - (1.0 - out[j + 1]) * fades)
        return np.where(own < 1.0, 1.0, out)  # what uses too much is lowered already

    def named(self) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        """The row that leaves each interval no room at one of its ends; −1 where a speed cap does.

        Where neither does, the next interval limits the speed to begin with: what limits that is named.
        """
        w, u = self.rows, self.u[:, None]
        terms = np.stack([w.a * u, w.b * np.stack([self.x[:-1], self.x[1:]])[..., None], -w.c])
        size = np.maximum(np.sum(np.abs(terms), axis=0), np.finfo(float).tiny)  # a row may ask for nothing
        left = np.min(np.where(size > np.finfo(float).tiny, -np.sum(terms, axis=0) / size, 1.0), axis=0)
        capped = self.x >= (1.0 - BINDS) * w.cap
        binds = left.min(axis=1) <= BINDS
        row, n = np.where(binds, np.argmin(left, axis=1), -1), len(u)
        found = np.where(binds | capped[:-1] | capped[1:], np.arange(n), n - 1)
        return row[np.minimum.accumulate(found[::-1])[::-1]]

    def place(self, interval: int) -> str:
        """Where an interval is, in words."""
        x, y = self.coarse.pose[interval, 0, :2]
        return f"at s = {self.grid.s[interval]:.4g} m (x {x:.4g} m, y {y:.4g} m)"


def _lowered(used: Array, limit: float, aim: float) -> Array:
    """Factors (n,) on the shares of intervals: to ``aim`` below the limit where more is used, else 1."""
    over = used > limit * (1.0 + 2.0 * AIM)
    return np.where(over, np.maximum((1.0 - aim) * limit / np.where(over, used, limit), LEAST_LEFT), 1.0)
