"""Every constant by which a diagnosis decides, with its unit and its reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """What decides in a diagnosis.  Units are those of the noise (chi), of the data (runs) or seconds."""

    #: [1] Share of the mean square beyond the noise, chi² − 1, that a correction must remove on runs that
    #: nothing has seen.  Less is not worth another law: the robot's limits move by less than their spread.
    explained_share: float = 0.25
    #: [chi] What the reconstruction of the wheels' motion from a log may add or take away: the true model
    #: reaches 1.03 to 1.10 where angles and speeds are logged, and two ways of rebuilding differ by 0.02.
    least_chi: float = 0.02
    #: [1] A chi has grown clearly if it grows by more than this share of itself: five standard deviations
    #: of the chi of a run of 1000 samples in three channels (1 / √6000 each).
    worse_factor: float = 0.065
    #: [standard deviations] By how much a run's sum of squares must change to count as changed at all.
    noise_deviations: float = 2.0
    #: [1] Level of the paired test over runs.
    level: float = 0.05
    #: [runs] With fewer changed runs than five no pattern is rarer than 5 %; then all must get better, and
    #: there must be so many (all runs of a smaller set).
    fewest_runs: int = 3
    #: [1] Share of the runs that may get clearly worse: one in ten may hold an accident of its own.
    worse_share: float = 0.1
    #: [chi] Above this a residual is well above the noise: three times what the reconstruction leaves.
    noise_chi: float = 1.3
    #: [runs] The searched runs are left out in so many folds: each fit then has three quarters of them.
    folds: int = 4
    #: [steps] Gauss–Newton steps without a fold; the fit starts where all searched runs put it.
    fold_steps: int = 4
    #: [candidates] So many single candidates over other variables are asked once a proposal has failed:
    #: each is one more look at the held-out runs.
    others: int = 2
    #: [s] Over how long the map differentiates poses: at 0.5 mm of noise a velocity is then known to 1 cm/s.
    map_span_s: float = 0.08
    #: [s] Time between the map's instants: a third of its span, closer ones say the same again.
    map_step_s: float = 0.025
    #: [s] How long a push stays in the velocity: friction of 0.2 g stops a slip of 0.2 m/s in this time.
    map_memory_s: float = 0.1
    #: [s] Distance of the knots over time: an event is a tenth of a second long.
    map_knot_s: float = 0.15
    #: [1] Cells along each side of the floor: a fifth of the way that the runs reach.
    map_cells: int = 6
    #: [draws] Permutations of the runs: they resolve p = 0.005.
    map_permutations: int = 199


SETTINGS = SearchSettings()
