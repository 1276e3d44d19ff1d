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
    #: a single run must also grow by more than this share of what all runs' mean square falls by: parameters
    #: from other runs are not exact.
    worse_factor: float = 0.065
    #: [standard deviations] By how much a run's sum of squares must change to count as changed at all, and
    #: that of all runs for the more usual of two names to give way.
    noise_deviations: float = 2.0
    #: [1] Level of the paired test over runs.
    level: float = 0.05
    #: [runs] With fewer changed runs than five no pattern is rarer than 5 %; then all must get better, and
    #: there must be so many (all runs of a smaller set).
    fewest_runs: int = 3
    #: [runs] … or so many, where each of them, predicted by what was fitted to others, falls to the noise,
    #: but for as small a part of its gain as a run may pay: an accident of one run does not explain another
    #: one to the last sample.
    fewest_explained: int = 2
    #: [runs] Fewer unseen runs than this cannot rule out chance by themselves.  Far above the noise runs
    #: differ by what the form of a model leaves: where they get better, but by less than is asked, all runs
    #: decide, unless the unseen ones fare worse than chance would have it.
    few_unseen: int = 5
    #: [1] Share of the runs that may get clearly worse: one in ten may hold an accident of its own.
    worse_share: float = 0.1
    #: [chi] Above this a residual is well above the noise: three times what the reconstruction leaves.
    noise_chi: float = 1.3
    #: [1] What is this many times as large as the noise is no noise, however long that lasts: of noise that
    #: lasts as long as a run, six runs have a root mean square 1.6 times as large once in a thousand.  Such
    #: errors are searched, and what explains them is judged by their own size, though chi is near 1.
    noise_size: float = 2.0
    #: [runs] The searched runs are left out in so many folds: each fit then has three quarters of them.
    folds: int = 4
    #: [steps] Gauss–Newton steps without a fold; the fit starts where all searched runs put it.
    fold_steps: int = 4
    #: [candidates] So many single candidates (over another variable, or free instead of named) are asked
    #: once a proposal has failed: each is one more look at the held-out runs.
    others: int = 3
    #: [1] Level of the permutation test of a proposal against surrogate noise.
    significance: float = 0.01
    #: [s] How long a push stays in the velocity: friction of 0.2 g stops a slip of 0.2 m/s in this time.
    probe_memory_s: float = 0.1
    #: [s] Distance of the probes' knots over time: an event is a tenth of a second long.
    probe_knot_s: float = 0.15
    #: [1] Cells of the probes along each side of the floor: a fifth of the way that the runs reach.
    probe_cells: int = 6
    #: [rad] The play that a probe tries: how long it takes to take it up changes little with its size.
    probe_play_rad: float = 0.03
    #: [1] Lines of the floor lie so far apart, and fits start so far to either side, as a share of a ridge's
    #: width or of a ramp's length: less than half of it.
    crossing_apart: float = 1.0 / 3.0
    #: [s] The velocity on such lines is taken over so long: what a wheel at 1 m/s needs for a
    #: narrow ridge …
    crossing_s: float = 0.06
    #: [s/m] … at instants no nearer than this times what the line is looked at for is long: a wheel at 1 m/s
    #: is then seen six times on it.
    crossing_step_s_per_m: float = 0.16
    #: [rad] Two lines are one if they differ by no more than this in direction, …
    crossing_same_rad: float = 0.26
    #: [m] … and by this in distance: from there a fit reaches the better one.
    crossing_same_m: float = 0.1
    #: [1] A line that wheels hardly touch counts as if they touched it more, by this share of the line that
    #: they touch most: else a single instant of noise would come first.
    crossing_touched: float = 0.02
    #: [lines] Of each candidate so many lines that look most like it are simulated: of 11 true ones the last
    #: came eleventh.
    crossings: int = 12
    #: [1] Places of the floor lie so far apart as a share of a patch's radius: none is then farther from one
    #: of them than a third of it, …
    patch_apart: float = 0.5
    #: [places] … but no more than so many along each side, for on a wide floor there would be millions: it is
    #: twice what the smallest patch asks for where runs go a metre to either side.
    patch_places: int = 120
    #: [s] The heading beside patches is smoothed over so long, what a wheel at 1 m/s needs for a small one:
    #: its noise would turn every step of the motion.
    patch_heading_s: float = 0.12
    #: [patches] So many patches, which explain the error of the motion best, are simulated: other
    #: things look like a patch as well, and come between.
    patches: int = 8
    #: [starts] So many starts of a named candidate are simulated as they are, for friction that sticks hides
    #: small changes.
    secants: int = 4
    #: [1] Ridge of the linear steps, as a share of a column's own sum of squares: above rounding only.
    ridge: float = 1e-6
    #: [1] Ridges that hold back the free coefficients of a form or a probe, as shares of its columns' mean
    #: sum of squares; the one that predicts left-out runs best is taken, three steps of ten are enough.
    ridges: tuple[float, ...] = (0.01, 0.1, 1.0)
    #: [1] A fit is a lead if it takes off at least this share of chi: half of what a later effect must.
    least_lead: float = 0.05
    #: [runs] Whether something changes from run to run is asked of at least so many: of five chance orders
    #: one in sixty by size, up or down, and several quantities are looked at.
    drift_runs: int = 6
    #: [1] The factors between which each run's own is fitted: beyond them another cause is likelier.
    drift_factors: tuple[float, float] = (0.2, 3.0)
    #: [1] A run tells its factor if its residual depends on it so steeply, by the squares of the median run.
    drift_tells: float = 0.01
    #: [s] So much longer than its time a search takes for a first list, without which it has not even a lead;
    #: candidates that are not reached by then are left out.
    list_s: float = 3.0
    #: [variables] … and candidates of so many of the first list are fitted even then: one alone is no
    #: comparison, and a list that was cut short has put two others before the right one.
    fewest_fitted: int = 3
    #: [draws] Surrogate residuals that go through the whole screening: they resolve p = 0.005.
    surrogates: int = 199
    #: [1] Share of chi that a first effect must take off: as least_chi, for sets far above the noise.
    first_effect: float = 0.02
    #: [1] An error that grows by less than this share has not grown: the simulation's steps follow the
    #: position, so that a camera's scale alone moved headings by 5e-7 rad and their error by 5e-5 of itself.
    same_error: float = 3e-4
    #: [1] Share of chi that a further effect must take off: what the first leaves is also its form's fault.
    #: In more runs than are searched it falls with the root of their number, as the spread of a mean does.
    later_effect: float = 0.1
    #: [1] Share of the mean square beyond the noise that a further effect must take off where one of the two
    #: has no name: a general form is only approximate, and what it leaves must not be given names.
    with_unnamed: float = 0.75
    #: [1] Tangents promise about this share of what a fit takes off: friction that sticks answers small steps
    #: less than large ones.  Beside a form an effect is fitted if that much more would be worth having.
    tangents_promise: float = 0.7
    #: [1] The least factor that one term of a form makes of the contact's steepness: with none the contact
    #: holds nothing, and a fit that gets there moves no more.  By it a term that fades at most doubles it.
    least_steepness: float = 0.05
    #: [effects] More than this many were never borne out by ten runs.  All of a larger set may bear more.
    most_effects: int = 4
    #: [1] Two runs drive alike if their wheels turn in the same proportions: the cosine of 8°.
    alike_runs: float = 0.99
    #: [chi] No model predicts better than this: the noise is known to 3 %.
    floor_chi: float = 0.97
    #: [s] Length of a piece while searching far above the noise, before the heading goes astray; doubled
    #: while what the model lacks is not far above the noise in it, as with slow robots.
    piece_s: float = 0.5
    #: [chi] Above this runs may be compared in pieces …
    far_chi: float = 5.0
    #: [1] … where the position is off by more than this share of the way that a run covers …
    far_share: float = 0.01
    #: [rad] … or the heading by more than this: whole runs then bend too much with the parameters.
    far_rad: float = 0.03
    #: [1] A fit to whole runs seldom takes more than this factor off the chi at which pieces put them.
    within_reach: float = 3.0
    #: [standard errors] A left-out error is as good as the best one where, run by run, it is larger by no
    #: more than the spread of the difference: the rule of one standard error …
    as_good_errors: float = 1.0
    #: [1] … and chi by no more than this factor, where few runs make that spread large.
    as_good_factor: float = 1.06
    #: [chi] Up to here a residual is nothing but noise, whose size is known to 3 %, and nothing is searched …
    quiet_chi: float = 1.03
    #: [standard deviations] … unless a run is farther above that than chance makes one of a hundred runs.
    quiet_deviations: float = 4.0
    #: [1] A clock that stamps every row is wrong by this share at most: friction that differs by more than
    #: about twice this, which looks the same, is no clock.
    stamped_clock: float = 0.05
    #: [1] … and by this share at least: quartzes are a hundred times better, and friction that is off by
    #: twice as much, which looks the same, is nothing unusual.
    stamped_clock_least: float = 0.005
    #: [1] A run that the model misses counts as if it were missed by at most this many times as much as the
    #: middle one of those: four times its weight in a sum of squares.
    loudest: float = 2.0
    #: [runs] So many are enough to search with, one in four left out of each fold; the parameters are then
    #: fitted to all.
    most_searched: int = 8
    #: [samples of the wheels' motion] … and fewer, but one a fold, where these runs would have more samples
    #: together: a simulation takes as long as it has samples, and the list has four hundred columns.
    most_samples: int = 2000
    #: [1] A form is simulated at these shares of the step that its tangents put first: one that is too small
    #: at rest makes the step too long.
    step_shares: tuple[float, ...] = (1.0, 0.5)
    #: [1] What promises less than this share of the best one's gain is not fitted.
    hopeless: float = 0.2
    #: [candidates] How many names are fitted by simulation, each once; half as many general forms
    #: and half as many pairs, and so many forms more where no name leaves nothing but noise.
    finalists: int = 5
    #: [1] What promises this share of what the last of them does is fitted as well, up to as many again: a
    #: list knows a promise to some percent.
    nearly_promised: float = 0.95
    #: [candidates] So many further names are given a few steps there: the right one may stand far down a list
    #: that tangents have made, a stiff roller on another wheel twentieth.  Of a list in all runs
    #: as many stand on the next one.
    contenders: int = 20
    #: [starts] So many are simulated for what a candidate promises, the best by its tangents; and fitted, the
    #: best by simulation, where it says a place or a time.
    starts: int = 2
    #: [steps] Gauss–Newton steps after which the best of the starts is known.
    first_steps: int = 3
    #: [1] A pair is fitted where its tangents leave at most this share of what the best single one leaves.
    pair_leaves: float = 0.7
    #: [candidates] Far above the noise so many names are followed by a round of their own beside the best:
    #: with it they make three, the variables of a wheel that rolls (its slip, its load, its geometry).  As
    #: many that a few runs cannot tell from it are fitted to all runs beside it.
    followed: int = 2
    #: [1] … each of which takes off at least this share of what the best does: what is found beside it may
    #: be worth as much again, while a name's own rank depends on what is still missing.  Once more is known
    #: such names are asked again.
    followed_share: float = 0.5
    #: [1] A fit that cannot come within this factor of the best one's cost is not finished.
    out_of_reach: float = 1.3
    #: [1] Stated noise is replaced where the measured one is this many times larger or smaller …
    stated_wrong: float = 1.5
    #: [1] … or this many times, where part of it lasts: whitening needs the sizes of both parts.
    stated_wrong_lasting: float = 1.1
    #: [1] A camera is too slow for the motion where the roughness of what the model leaves is at most this
    #: share of the poses' own: two estimates of one noise differ by 5 %.
    motion_seen_as_noise: float = 0.75
    #: [1] Noise is called smaller than stated where the whole residual is at most this share of the stated
    #: noise: nothing else is in it then.
    understood: float = 0.75
    #: [white noise] A sample is a lone outlier if it is so far from the middle of the residuals around it:
    #: chance gives one in a million samples …
    lone_deviations: float = 5.0
    #: [samples] … which are so many on either side.
    lone_around: int = 3
    #: [1] Commands hold from row to row if this leaves at most this share of the squared residual …
    held_leaves: float = 0.8
    #: [noise²] … or nothing but noise, and this much less: noise alters the difference of two predictions, of
    #: which one is true, by twice its root, a quarter of this.
    held_gains: float = 64.0
    #: [1] A camera's clock is off if this leaves at most this share of the squared residual …
    clock_leaves: float = 0.5
    #: [1] … by this at least (quartzes are a hundred times better), …
    clock_least: float = 0.002
    #: [1] … by this at most, …
    clock_most: float = 0.1
    #: [1] … and if the runs agree on it to this share of it.
    clock_agree: float = 0.3
    #: [1] Runs on another floor are at most this share of all: the others say which floor is meant …
    other_floor_share: float = 0.4
    #: [1] … two floors leave at most this share of one floor's squared residual, …
    two_floors_leave: float = 0.2
    #: [1] … (this, while frictions are tried in steps of a fifth: each floor may then lie between two) …
    two_floors_may_leave: float = 0.5
    #: [1] … their frictions differ by this factor at least, …
    floors_differ: float = 1.1
    #: [1] … and the sum of squares of each such run falls by this factor.
    floor_gains: float = 3.0
    #: [chi] Below this no run differs from the others.
    differs_chi: float = 1.5
    #: [1] Coverage of the intervals.
    interval_level: float = 0.95
    #: [runs] With at least so many some are held out altogether; with fewer all are left out in turn …
    enough_to_hold_out: int = 6
    #: [1] … this share of them: two of ten.
    held_out_share: float = 0.2
    #: [standard deviations] A run that diverges counts with so many times the noise: sums stay finite, and
    #: no such run outweighs all others.
    wild: float = 1e4
    #: [leads] At most so many are listed.
    most_leads: int = 6
    #: [standard deviations] A sample farther than this from the line between its neighbours, and from their
    #: median, is an outlier: chance gives none in a million samples.
    outlier_sigma: float = 8.0
    #: [s] Within how long an event, a bump or a push, happens.
    event_span_s: float = 0.1
    #: [standard deviations] A jump of the residual is an event above this, …
    event_sigmas: float = 16.0
    #: [1] … and above so many times the largest ordinary jump, the 99th percentile over the other runs.
    event_ordinary: float = 8.0
    #: [1] … of which the model without effects shows this share at least: what only the effects make did not
    #: happen.
    event_own: float = 0.5
    #: [s] A run's first poses within this time say how fast it began …
    start_s: float = 0.2
    #: [1] … if there are so many of them, for the three numbers of a parabola, …
    start_poses: int = 6
    #: [1] … where the wheels' first speeds say otherwise by so many standard deviations, …
    start_deviations: float = 4.0
    #: [1] … and are at least this share of the wheels' mean speeds in that time: from rest all slides.
    start_pace: float = 0.5
    #: [1] A robot whose commands alone are known moves from the start if its first speed is this share of its
    #: mean speed then: from rest it was 0.6 at most, and 0.83 where a wheel's top speed is soon reached; in
    #: motion 0.9 to 1.2.
    start_share: float = 0.75
    #: [s] A part of a run that was cut at an event is kept if it is as long as this.
    least_part_s: float = 0.4
    #: [1] A fault of the data is spoken of where the effects found could take up this share of the squared
    #: residual that it makes …
    taken_up: float = 0.5
    #: [standard deviations] … and those parameters are named that this moves by more than so many of theirs.
    moved: float = 2.0
    #: [1] The noise has heavy tails if its root mean square is this many times what its middle half says.
    heavy_tails: float = 1.07
    #: [1/turn] Counts a turn that are looked at by order analysis: 1, 2, … up to this.
    most_orders: int = 24
    #: [counts] Half counts near each whole one that it is compared with.
    near_orders: int = 6
    #: [turns] A run in which a wheel turns less cannot tell neighbouring counts apart.
    least_turns: float = 2.0
    #: [periods] A count that advances by more than this between two samples is not seen.
    fastest_order: float = 0.2
    #: [samples] Nor is anything in a run with fewer.
    order_samples: int = 100
    #: [1] Probability of a count that is named where nothing is periodic.
    order_level: float = 0.01
    #: [1] Runs whose wheel turns at paces within this factor are drawn together.
    one_pace: float = 1.05
    #: [counts] At most so many are named.
    named_orders: int = 6
    #: [1] Share of the way its wheels turn in a run after which the first part ends, from which a phase that
    #: was not logged is guessed.
    phase_part: float = 0.5
    #: [samples] The first part has at least so many.
    phase_samples: int = 8
    #: [s] Phases are guessed in pieces this long: a wrong one early on must not spoil what follows.
    phase_piece_s: float = 0.3

    @property
    def least_lead_of_squares(self) -> float:
        """The share of a sum of squares that ``least_lead`` is of chi [1]."""
        return 1.0 - (1.0 - self.least_lead) ** 2


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class PullSettings:
    """What decides in a diagnosis by pulls.  A setting: one orientation, direction and point of the pull."""

    #: [1] An effect is taken only if luck gives as much, among all candidates, no more often than this.
    significance: float = 0.01
    #: [effects] At most so many: twenty-four pulls bear no more parameters.
    most_effects: int = 3
    #: [candidates] So many, by the likelihood of what they were fitted to, are scored without it.
    shortlist: int = 8
    #: [parts] Into so many settings are divided, to be left out in turn while searching …
    search_folds: int = 8
    #: [parts] … and to be left out of the whole search.
    folds: int = 5
    #: [1] Share of the time for the search in all pulls; the others are for those without a part.
    first_share: float = 0.3
    #: [effects] So many first effects are tried in pairs.
    firsts: int = 4
    #: [standard errors] A state counts as no worse than the best one while its score is within so many of the
    #: difference, setting by setting, …
    as_good_errors: float = 1.0
    #: [log-likelihood] … or within this much: one parameter costs about 1 of noise alone.
    alike: float = 2.0
    #: [1] Root mean square over typical difference beyond which repeats are no single Gaussian: 24 pairs of
    #: one reach 1.5 by chance once in a hundred.
    scatters: float = 1.5
    #: [1] chi on settings left out must fall by this share at least, the error in newtons must not grow, …
    least_share: float = 0.1
    #: [1] … luck must give as much no more often than this, by random signs, …
    by_luck: float = 0.05
    #: [standard deviations] … and no setting's sum of squares may grow by more than the square of this.
    worse: float = 4.0
    #: [1] Above the scatter of repeats with less than this probability, what is left is no noise.
    no_noise: float = 0.01
    #: [1] What moves a limit by less than this share of it at a start value moves nothing.
    moves: float = 1e-6
    #: [pitches] How sharply a measured wheel angle says what the wheel stands on, one standard deviation: a
    #: contact some millimetre long leaves a roller while its middle is that near the edge.
    edge: float = 0.02
    #: [1] Contact states rarer than this at every pull are left out.
    rare: float = 1e-6
    #: [standard deviations] Residual of a model that cannot stand: a wheel lifts, the robot slips by itself.
    wild: float = 1e3


SETTINGS = SearchSettings()
PULLS = PullSettings()
