"""Every constant by which measured data are called faulty, mended or read, with its unit and its reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class DataSettings:
    """What decides while data are read and mended.  Units are those of the noise, of samples or SI."""

    # --- times and clocks ---------------------------------------------------------------------------------
    #: [s] Runs do not start as late as this on a clock of their own: 11 days.
    epoch_s: float = 1e6
    #: [1] Stamps tremble if they miss equal steps by more than this share of a step (root mean square) …
    tremble: float = 0.01
    #: [1] … and equal steps make the measured angles smoother by this factor.
    smoother: float = 0.7
    #: [1] A log that would have so many times its rows on an even clock holds a wrong time stamp.
    sparse: float = 100.0
    #: [s] Rows farther apart than this are in another unit than seconds: no robot is driven at 1 Hz …
    slowest_row_s: float = 0.9
    #: [s] … and so are rows as close as this: no log is written at 50 kHz.
    fastest_row_s: float = 2e-5
    #: [rows] A clock jumps where a step is longer than so many usual ones …
    jump_rows: float = 50.0
    #: [s] … and by this longer than 20 usual ones: a log that pauses for a moment is none.
    jump_s: float = 1.0

    # --- single camera frames -----------------------------------------------------------------------------
    #: [1] A pose of zeros is no measurement if its neighbours are farther from zero than so many usual steps.
    zero_steps: float = 5.0
    #: [frames] Frames are repeated if a run has at least so many repeats while the pose is known to change.
    least_repeats: int = 3
    #: [1] A camera is slower than its log where at most this share of the rows holds a frame of its own.
    slow_camera: float = 0.8
    #: [standard deviations] A frame farther than this from where the last frames lead is off …
    off_sigma: float = 8.0
    #: [m/s²] … and farther than the robot can accelerate: a rubber wheel on a dry floor gives less …
    acceleration_m_s2: float = 12.0
    #: [m] … with this lever for turning: no robot is smaller.
    lever_m: float = 0.05
    #: [s] The robot is back from a mistaken marker within this time; otherwise the jump is an event.
    back_within_s: float = 0.6
    #: [frames] At the ends of a run, where it is not seen to come back, at most so many frames are off.
    most_at_ends: int = 3
    #: [frames] The velocity before a jump is that of so many frames.
    velocity_frames: int = 6

    # --- signals of the wheels ----------------------------------------------------------------------------
    #: [1] Angles are wrapped if at least this share of their large steps are whole turns.
    whole_turns: float = 0.8
    #: [1] A factor between angles and speeds is that of a unit if it is as near as this.
    unit_within: float = 0.02
    #: [1] Speeds that differ from the rate of the angles by more than this share are no measurement of it.
    no_speed: float = 0.1
    #: [1] A clock is wrong if speeds and angles differ by more than this share: an encoder is a count and a
    #: controller's clock a quartz, and both are far better …
    clock_least: float = 0.003
    #: [standard errors] … and by so many.
    clock_errors: float = 5.0
    #: [s] Blocks over which angles and integrated speeds are compared: many rows, and short against a run.
    block_s: float = 0.25
    #: [1/turn] Encoders of fewer ticks a turn than this are smoothed: a finer tick is below the noise.
    fine_ticks: float = 1500.0
    #: [ticks] Angles agree with integrated speeds if the difference has at most this root mean square:
    #: rounding makes 0.29.
    within_tick: float = 0.45
    #: [ticks] Speeds are no differences of the counts if the third differences of the way they add up to stay
    #: below this while the wheel turns (three quarters of them): differences of counts come in quarters.
    own_speed: float = 0.15

    # --- wheels against the camera ------------------------------------------------------------------------
    #: [s] Pieces in which the wheels' displacement is compared with the camera's are at least so long …
    piece_s: float = 0.1
    #: [samples] … and hold so many: two ends and one between.
    piece_samples: int = 3
    #: [1] A piece moves if it goes at least this share of the way of the fastest pieces.
    piece_moves: float = 0.2
    #: [1] The share of the pieces by which an arrangement is judged, the better ones: wheels slip in others.
    better_pieces: float = 0.35
    #: [wheels] Orders of the columns are tried up to so many wheels: 120 orders.
    most_permuted: int = 5
    #: [1] Another arrangement is named when it leaves less than this share of the stated one's mismatch.
    #: With right data, whatever slips, all others leave 0.95 times or more; with wrong data the right one
    #: leaves a third or less …
    clearly_better: float = 0.5
    #: [1] … and the stated one misses at least this share of the motion where wheels slip least.
    misses: float = 0.3
    #: [1] Among arrangements that match about as well, by this factor, the one with fewest faults is named.
    as_good: float = 1.1
    #: [1] A channel is dead where its motion is this share of the other's, of the squares: a ten-thousandth.
    dead: float = 1e-8
    #: [1] Slip and a worn wheel leave a robot at least this share of what its wheels roll, …
    least_moved: float = 0.13
    #: [1] … and at most this one: what is outside is in another unit.
    most_moved: float = 1.6
    #: [1] A factor is that of a unit if it is at most this share below it (slip takes half) …
    unit_below: float = 0.5
    #: [1] … or this share above it (a worn wheel).
    unit_above: float = 0.1
    #: [1] One run is mended where its columns as they stand miss more than this share of the motion …
    run_misses: float = 0.45
    #: [1] … and another arrangement less than this, …
    run_matches: float = 0.2
    #: [1] … and less than this share of what the columns miss as they stand.
    run_clearly_better: float = 0.35
    #: [pieces] A run says something of its columns if it has so many.
    least_pieces: int = 6

    # --- noise of the pose --------------------------------------------------------------------------------
    #: [1] The share of the windows, those of the lowest spectrum, that is read: there the residual is least
    #: anything but noise.
    quiet_windows: float = 0.4
    #: [chi² a line] A spectrum of longer windows counts if first-order noise fits it as well as this: low
    #: frequencies hold most of what a model lacks.
    good_spectrum: float = 1.5
    #: [lines] Lines of a window from this one on are read: the tapered window blurs the first …
    first_line: int = 2
    #: [Hz] … and in the shortest windows from this frequency on: below, a residual is mostly motion.
    motion_hz: float = 3.0
    #: [chi²] Part of the noise lasts where that explains the spectrum better than white noise by so much …
    lasts: float = 15.0
    #: [chi²] … and better than a steep one, of forces that a model lacks, whose motion has no high
    #: frequencies …
    not_steep: float = 1.0
    #: [chi²] … by so much where the residual is far more than noise.
    not_steep_far: float = 16.0
    #: [chi²] Fits within this of the best are as good.
    as_good_spectrum: float = 1.0
    #: [1] Least correlation of the noise from sample to sample that is called lasting.
    least_correlation: float = 0.15
    #: [1] Long windows are read where the residual is less than this many times the white noise (root mean
    #: square): else a model lacks something whose motion reaches into their lines …
    nearly_noise: float = 2.5
    #: [1] … or less than this many times the stated noise.
    as_stated: float = 1.3
    #: [1] Samples slower than this share of the fastest say nothing of the instants of frames.
    jitter_moves: float = 0.1
    #: [1] Level of the interval of the frames' jitter.
    sure: float = 0.95

    # --- calibration and delay ----------------------------------------------------------------------------
    #: [s] Length of the pieces a calibration run is cut into: long against the delay, short against the
    #: picture.
    calibration_piece_s: float = 2.0
    #: [standard deviations] A tilt of the camera less sure than this is left out.
    tilt_sure: float = 4.0
    #: [s] So much of a run, from where it starts to move, tells the delay: later motion is a straight line.
    early_s: float = 2.5
    #: [s] Lead-in of a segment: longer than a camera is late and than friction takes to change a velocity.
    lead_s: float = 0.4
    #: [1] A piece at the end of a recording shorter than this share of a segment is left out.
    shortest_segment: float = 0.5
    #: [rows] Of so many rows of a run what concerns all of it is told, a delay or wheels in another order:
    #: more than an hour at 100 Hz.  All of the longest logs would ask for gigabytes.
    first_rows: int = 400_000

    # --- pulls --------------------------------------------------------------------------------------------
    #: [rad] Pulls closer together than this belong to one orientation: a fifth of a degree.
    same_rad: float = 3.5e-3
    #: [m] Points of pull closer together than this are one.
    same_m: float = 1e-3


SETTINGS = DataSettings()
