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
    #: of the chi of a run of 1000 samples in three channels (1 / √6000 each).  The mean square of
    #: a single run must also grow by more than this share of what all runs' mean square falls by.
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
    #: [candidates] So many single candidates (over another variable, or free instead of named) are asked
    #: once a proposal has failed: each is one more look at the held-out runs.
    others: int = 3
    #: [1] Level of the permutation test of a proposal against surrogate noise.
    significance: float = 0.01
    #: [1] Share of chi that a first effect must take off: as least_chi, for sets far above the noise.
    first_effect: float = 0.02
    #: [1] Share of chi that a further effect must take off: what the first leaves is also its form's fault.
    later_effect: float = 0.1
    #: [1] To this share a further effect must bring chi where one of the two has no name: a general form is
    #: only approximate, and what it leaves must not be given names.
    with_unnamed: float = 0.5
    #: [effects] More than this many were never borne out by ten runs.
    most_effects: int = 4
    #: [chi] No model predicts better than this: the noise is known to 3 %.
    floor_chi: float = 0.97
    #: [s] Length of a piece while searching far above the noise: the camera's noise is small beside what a
    #: model lacks, and the heading has not yet gone astray.
    piece_s: float = 0.5
    #: [s] The same in the last fits, which start near the answer.
    long_piece_s: float = 2.0
    #: [chi] Above this runs are compared in pieces: whole ones bend too much with the parameters.
    far_chi: float = 5.0
    #: [1] A fit to whole runs seldom takes more than this factor off the chi at which pieces put them.
    within_reach: float = 3.0
    #: [1], [chi] A candidate is as good as the best if its chi is within this factor and this offset.
    as_good_factor: float = 1.06
    as_good_offset: float = 0.02
    #: [chi] This close to 1 nothing is left for another form to explain.
    at_noise_chi: float = 1.06
    #: [candidates] How many go from the first, short fit to the full one.
    finalists: int = 6
    #: [runs] From so many on, first short fits use every other one.
    many_runs: int = 6
    #: [1] By what share of chi a parameter, one stuck at a bound, an effect, and the lack of a name must pay
    #: for themselves when candidates are as good as each other.
    parameter_price: float = 0.004
    stuck_price: float = 0.03
    effect_price: float = 0.03
    unnamed_price: float = 0.03
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
    #: [1] Share of the residual beyond the noise that a fault of the camera or of unlogged motors must
    #: explain to be on the map: such a fault is linear, a force that it resembles is not.
    map_signal_share: float = 0.5
    #: [draws] Permutations of the runs: they resolve p = 0.005.
    map_permutations: int = 199


SETTINGS = SearchSettings()
