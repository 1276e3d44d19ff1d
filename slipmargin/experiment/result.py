"""The next runs and what is expected of them, as frozen values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.checks import Array
from slipmargin.diagnosis.pull_next import NextPull
from slipmargin.diagnosis.result import Verdict
from slipmargin.experiment.motions import Space
from slipmargin.experiment.remaining import Question
from slipmargin.paths.trajectory import Trajectory


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ProposedRun:
    """A run to drive.

    ``legs``: each path as the planner reads it, waypoints (K, 3), in the order in which they are driven;
    ``repeats``: how often this is done; ``trajectory``: pose, velocity, wheel speeds and the largest share of
    each wheel's grip by any explanation that is left, from rest to rest; ``predicted``: the pose (T, 3) by
    each explanation, the best first.
    """

    name: str
    words: str
    legs: tuple[Array, ...]
    repeats: int
    trajectory: Trajectory
    predicted: tuple[Array, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Separation:
    """How far two explanations are apart, in χ²: today, and expected once the runs are added.

    ``right`` is taken to be right, and ``rival`` is fitted again to all runs.  ``by_run`` is what the first
    run, the first two … add to it by linear steps; ``expected`` is by simulation where the rival has few
    parameters (``simulated``).  ``apart_mm`` and ``apart_deg`` are the largest differences of their
    predictions in the runs before that refit.
    """

    right: str
    rival: str
    today: float
    expected: float
    simulated: bool
    by_run: tuple[float, ...]
    apart_mm: float
    apart_deg: float


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Narrowing:
    """Half the 95 % interval of a parameter, as far as noise decides: today, and with the runs.

    For an effect that was not found it is what could hide: how large it may be and not be seen.
    """

    parameter: str
    unit: str
    today: float
    expected: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NextRuns:
    """What to drive next, why, and what was compared.

    Parameters
    ----------
    data_set, robot, surface : str
        What was diagnosed.
    verdict : Verdict
        That of the diagnosis.
    question : Question or None
        What the runs are to answer; None where there are pulls alone.
    explanations : tuple of str
        What is left, the best first.
    runs : tuple of ProposedRun
        In the order in which they were chosen: each is the best beside those before it.
    separations : tuple of Separation
        Every ordered pair of explanations.
    narrowings : tuple of Narrowing
        Parameters, the widest in units of its scale first.
    compared : int
        Motions that were compared.
    space : Space or None
        Where they stay.
    reach_m : float
        Radius of the circle that holds the robot's wheels.
    share : float
        Largest share of a wheel's grip that is allowed.
    misfit : float
        What the best explanation leaves, times the noise.
    noise : array (3,)
        Of x, y [m] and φ [rad], as the data have it.
    front_rad : float
        Direction of the robot's front in the body frame.
    pulls : tuple of NextPull
        Where there are pulls alone, what to pull next.
    was_cut : bool
        Whether time ended the search for explanations.
    """

    data_set: str
    robot: str
    surface: str
    verdict: Verdict
    question: Question | None
    explanations: tuple[str, ...]
    runs: tuple[ProposedRun, ...]
    separations: tuple[Separation, ...]
    narrowings: tuple[Narrowing, ...]
    compared: int
    space: Space | None
    reach_m: float
    share: float
    misfit: float
    noise: Array
    front_rad: float
    pulls: tuple[NextPull, ...] = ()
    was_cut: bool = False

    @property
    def weakest(self) -> Separation | None:
        """The pair that the runs will tell apart least."""
        return min(self.separations, key=lambda s: s.expected, default=None)
