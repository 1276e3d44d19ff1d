"""``slipmargin.SlipMonitor``: is a wheel slipping, which one, and what does the body really do?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from io import TextIOBase
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from slipmargin.api.monitor_log import MonitoredLog, SlipEstimate, Tally
from slipmargin.api.robots import RobotLike, model_of, read_robot
from slipmargin.checks import Array, from_zero, frozen, measurable, real, shaped
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.onboard.likelihood import LabelledRun
    from slipmargin.onboard.stream import Lines


@final
class SlipMonitor:
    """A likelihood ratio between "every wheel grips" and "a wheel slips" on a stream of samples.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file (also a ``corrected.toml`` of a diagnosis), or a robot that was read.
    surface : str
        A surface of the robot file.
    false_alarm_rate : float
        Share of the samples without slip that may alarm on a run like the training runs, above 0 and up to
        0.5.  Where these are too few to be sure of it, a warning says so and there is no alarm.
    commanded, gyro, current : bool
        Which channels every sample will have besides wheel speeds.
    training : sequence of LabelledRun, or a data set's folder, optional
        Runs with known truth (:meth:`labelled`), or logged ones with poses; without them the robot's own
        model is simulated.
    torque_per_ampere_N_m : float, optional
        Torque at the wheel per ampere [N m/A]: simulated runs need it where currents are logged.
    seed : int
        Seed of the simulated runs; for these alone.

    Notes
    -----
    Three wheels without gyro, current and command have no redundancy: every set of wheel speeds is a body
    motion.  Then only the model speaks: whether that motion asks for more than the grip.

    Examples
    --------
    >>> import slipmargin as sm
    >>> monitor = sm.SlipMonitor("ohio-kiwi", "paper", false_alarm_rate=0.01)
    >>> monitor.update(0.0, [0.0, 0.0, 0.0]).alarm
    False
    """

    def __init__(
        self,
        robot: RobotLike,
        surface: str,
        *,
        false_alarm_rate: float = 0.01,
        commanded: bool = False,
        gyro: bool = False,
        current: bool = False,
        training: Sequence[LabelledRun] | Path | str | None = None,
        torque_per_ampere_N_m: float | None = None,
        seed: int = 0,
    ) -> None:
        from slipmargin.api.monitor_training import from_data_set, simulated
        from slipmargin.onboard.likelihood import learn
        from slipmargin.onboard.signals import Channels, Signals
        from slipmargin.onboard.table import limit_table

        recipe = read_robot(robot)
        model, self.warnings = model_of(recipe, surface)
        rate = real("false_alarm_rate", false_alarm_rate, above=0.0, high=0.5, cure="give a share up to 0.5")
        if torque_per_ampere_N_m is not None and (training is not None or not current):
            why = "the runs to train on hold currents" if current else "the log has no currents"
            raise InputError("torque_per_ampere_N_m", f"has no effect: {why}", "leave it out")
        from_zero("seed", seed)
        if training is not None and seed:
            raise InputError("seed", "has no effect: no run is simulated to train on", "leave it out")
        self.table = limit_table(model, 0.0)
        self.channels = Channels(commanded=commanded, gyro=gyro, current=current)
        runs: Sequence[LabelledRun]
        if training is None:
            runs = simulated(model, self.table, self.channels, seed, torque_per_ampere_N_m, rate)
        elif isinstance(training, str | Path):
            runs, said = from_data_set(model, self.table, self.channels, training)
            self.warnings += said
        else:
            runs = training
        self.ratio = learn(runs)
        self.false_alarm_rate, self.threshold = rate, self.ratio.threshold(rate)
        self._square, self._line, self._constant = self.ratio.polynomial()
        if not math.isfinite(self.threshold):
            self.warnings += (
                f"{len(self.ratio.gripping)} training runs with grip are too few for a false-alarm rate of "
                f"{rate:g}: about {self.ratio.runs_needed(rate)} like them are needed; there "
                "will be no alarm, the slip probability is given all the same",
            )
        self._signals, self._now = Signals(self.table, self.channels), -math.inf
        if model.count == 3 and not (gyro or current):
            blind = "three wheels without gyro or current have no redundancy: only the model tells slip"
            self.warnings += (blind,)

    def restart(self) -> None:
        """Forget the samples so far: a new run begins."""
        from slipmargin.onboard.signals import Signals

        self._signals, self._now = Signals(self.table, self.channels), -math.inf

    def labelled(
        self,
        t_s: Array,
        omega: Array,
        twist: Array,
        slips: Array,
        *,
        commanded: Array | None = None,
        gyro_rad_s: Array | None = None,
        current_A: Array | None = None,
    ) -> LabelledRun:
        """A run for training: T samples of the channels, the true body twist and whether a wheel slips.

        Parameters
        ----------
        t_s, omega : (T,), (T, N)
            Times [s] and wheel speeds [rad/s].
        twist, slips : (T, 3), (T,)
            What the body did [m/s, m/s, rad/s], and the label; a sample with NaN in its twist is left out.

        Raises
        ------
        InputError
            Where a channel that was announced is missing or another one given, or one holds what is no
            finite number for every sample.
        """
        from slipmargin.onboard.likelihood import labelled

        given = {
            "commanded": (commanded, self.channels.commanded, (len(t_s), self.table.count)),
            "gyro_rad_s": (gyro_rad_s, self.channels.gyro, (len(t_s),)),
            "current_A": (current_A, self.channels.current, (len(t_s), self.table.count)),
        }
        frozen("t_s", t_s, (None,))
        if np.any(np.diff(t_s) <= 0.0):
            raise InputError("t_s", "does not increase from sample to sample", "give the samples in order")
        frozen("omega", omega, (len(t_s), self.table.count))
        frozen("twist", np.nan_to_num(twist), (len(t_s), 3))
        known = np.isfinite(twist).all(axis=1)
        frozen("slips", shaped("slips", slips, (len(t_s),))[known], (None,))
        for place, (values, announced, shape) in given.items():
            _check_announced(place, values, announced, "give it for every sample")
            if values is not None:
                frozen(place, values, shape)

        return labelled(
            self.table,
            self.channels,
            t_s,
            omega,
            twist,
            slips,
            commanded=commanded,
            gyro_rad_s=gyro_rad_s,
            current_A=current_A,
        )

    def update(
        self,
        t_s: float,
        omega_rad_s: Sequence[float] | Array,
        *,
        commanded_rad_s: Sequence[float] | Array | None = None,
        gyro_rad_s: float | None = None,
        current_A: Sequence[float] | Array | None = None,
    ) -> SlipEstimate:
        """What one more sample says.

        Parameters
        ----------
        t_s : float
            Time [s].
        omega_rad_s, commanded_rad_s : (N,)
            Measured and commanded wheel speeds [rad/s].
        gyro_rad_s : float
            Yaw rate [rad/s].
        current_A : (N,)
            Motor currents [A]; only their size counts.

        Raises
        ------
        InputError
            Where a channel that was announced is missing or another one given, no robot measures a value,
            or time goes back.
        """
        omega = self._channel("omega_rad_s", omega_rad_s, True)
        commanded = self._channel("commanded_rad_s", commanded_rad_s, self.channels.commanded)
        current = self._channel("current_A", current_A, self.channels.current)
        if self.channels.gyro and (gyro_rad_s is None or not math.isfinite(gyro_rad_s)):
            raise InputError("gyro_rad_s", "is missing", "give the yaw rate of every sample")
        if gyro_rad_s is not None and not self.channels.gyro:
            cure = "leave it out, or make the monitor with gyro=True"
            raise InputError("gyro_rad_s", "has no effect: the monitor was made without it", cure)
        if self.channels.gyro:
            measurable("gyro_rad_s", np.array([gyro_rad_s]))
        if not math.isfinite(t_s):
            raise InputError("t_s", f"is {t_s}", "give a finite time [s]")
        measurable("t_s", np.array([t_s]))
        if t_s < self._now:
            cure = "give each run a log of its own (in Python: call restart())"
            raise InputError("t_s", f"goes back from {self._now:.10g} to {t_s:.10g} s", cure)
        self._now = t_s
        assert omega is not None
        numbers = self._signals.update(t_s, omega, commanded, gyro_rad_s, current)
        value = float(numbers @ (self._square @ numbers + self._line)) + self._constant
        p = 1.0 / (1.0 + math.exp(-min(max(value, -50.0), 50.0)))
        grips, slips = self.ratio.grips, self.ratio.slips
        wheels = self._signals.twist
        if self.channels.gyro and gyro_rad_s is not None:
            wheels[2] = gyro_rad_s
        one, two = grips.gain * wheels, slips.gain * wheels
        apart = two - one
        twist = one + p * apart
        covariance = (1.0 - p) * grips.covariance + p * slips.covariance
        covariance = covariance + p * (1.0 - p) * apart[:, None] * apart
        alarm = value > self.threshold
        wheel = self.table.names[int(np.argmax(self._signals.shares()))] if alarm else ""
        return SlipEstimate(
            t_s=t_s,
            slip_probability=p,
            log_ratio=value,
            alarm=alarm,
            wheel=wheel,
            twist=twist,
            covariance=covariance,
        )

    def _channel(self, place: str, value: Sequence[float] | Array | None, wanted: bool) -> Array | None:
        cure = f"give {self.table.count} finite numbers, one a wheel"
        _check_announced(place, value, wanted, cure)
        if value is None:
            return None
        array = np.asarray(value, dtype=float)
        if array.shape != (self.table.count,) or not np.isfinite(array).all():
            raise InputError(place, f"is {np.array2string(array, threshold=6)}", cure)
        return measurable(place, array)

    def stream(
        self, lines: Iterable[str], kept: list[SlipEstimate] | Tally | None = None, source: str = ""
    ) -> Iterator[str]:
        """A CSV line out for every line in: the first line names the columns.

        In: ``t_s``, ``omega{i}_rad_s``, and of the channels announced ``omega{i}_cmd_rad_s``, ``gyro_rad_s``,
        ``current{i}_A``; other columns are not read (:meth:`of_header` warns of them).  Out: ``t_s,
        slip_probability, alarm, wheel``, the corrected twist and the six entries of its covariance.  ``kept``
        gets the estimates too; ``source`` is what faults call the lines.

        Raises
        ------
        InputError
            Where a column is missing or a cell is no number, with the line.
        """
        try:
            yield from self._answered(lines, kept)
        except InputError as fault:
            raise fault if fault.source or not source else fault.in_file(source) from None

    def _answered(self, lines: Iterable[str], kept: list[SlipEstimate] | Tally | None) -> Iterator[str]:
        """:meth:`stream`, whose faults have no source yet."""
        from slipmargin.onboard.stream import HEADER, Columns, line

        number, at = 0, Columns(())
        for text in lines:
            number += 1
            cells = [cell.strip() for cell in text.rstrip("\r\n").split(",")]
            if number == 1:
                at = Columns.of(cells, self.table.count, self.channels)
                yield HEADER
                continue
            if cells == [""]:
                continue
            try:
                values = [float(cells[k]) for k in at.places]
            except (ValueError, IndexError):
                raise InputError(
                    f"line {number}", "has a cell that is no number", "give every column"
                ) from None
            if len(cells) != at.count:
                problem = f"has {len(cells)} cells, the header {at.count}"
                raise InputError(f"line {number}", problem, "give every row one cell a column")
            try:
                found = self.update(values[0], **at.split(values, self.table.count, self.channels))
            except InputError as fault:
                raise InputError(f"line {number}: {fault.place}", fault.problem, fault.cure) from None
            if kept is not None:
                kept.append(found)
            yield line(
                found.t_s, found.slip_probability, found.alarm, found.wheel, found.twist, found.covariance
            )

    @staticmethod
    def lines(source: Path | str, stream: Iterable[str] | None = None) -> Lines:
        """Lines of a log file, read one at a time, or of a given stream; the first can be looked at."""
        from slipmargin.io.source import lines_of, utf8, whole_lines
        from slipmargin.onboard.stream import Lines

        if stream is None:
            return Lines(str(source), lines_of(Path(source)))
        given = whole_lines(stream, str(source)) if isinstance(stream, TextIOBase) else stream
        return Lines(str(source), utf8(given, str(source)))

    @classmethod
    def of_header(cls, robot: RobotLike, surface: str, lines: Lines, **others: Any) -> SlipMonitor:
        """A monitor of the channels that the first line of a log names; ``others`` as for the class.

        Raises
        ------
        InputError
            Where a column is missing: that is said before the monitor learns.
        """
        from slipmargin.onboard.signals import Channels
        from slipmargin.onboard.stream import Columns

        names, recipe = [cell.strip() for cell in lines.first.split(",")], read_robot(robot)
        channels = Channels(
            commanded=any(name.startswith("omega") and name.endswith("_cmd_rad_s") for name in names),
            gyro="gyro_rad_s" in names,
            current=any(name.startswith("current") and name.endswith("_A") for name in names),
        )
        try:
            columns = Columns.of(names, len(recipe.robot.wheels), channels)
        except InputError as fault:
            raise fault.in_file(lines.source) from None
        watch = cls(
            recipe,
            surface,
            commanded=channels.commanded,
            gyro=channels.gyro,
            current=channels.current,
            **others,
        )
        if columns.unread:
            watch.warnings = (*watch.warnings, f"columns not read: {', '.join(columns.unread)}")
        return watch

    def _told(self, lines: Iterable[str], source: str, tally: Tally) -> Iterator[str]:
        """:meth:`stream` of a whole log; one without samples is a fault."""
        yield from self.stream(lines, tally, source)
        if not tally.samples:
            cure = "give a log with rows below its header"
            raise InputError("line 2", "there is no sample", cure, source)

    def log(self, lines: Iterable[str], source: str, out: Path | None = None) -> MonitoredLog:
        """What a log of any length holds: samples, alarms and events.

        Parameters
        ----------
        lines : iterable of str
            As for :meth:`stream`; read one at a time.
        source : str
            What the log is called.
        out : Path, optional
            The lines of every sample go there as they come.
        """
        tally = Tally()
        told = self._told(lines, source, tally)
        if out is None:
            for _ in told:
                pass
        else:
            from slipmargin.io.writes import write_lines

            write_lines(out, told)
        t_s, probability = tally.curve()
        return MonitoredLog(
            robot=self.table.robot,
            surface=self.table.surface,
            source=source,
            false_alarm_rate=self.false_alarm_rate,
            quiet=not math.isfinite(self.threshold),
            samples=tally.samples,
            alarms=tally.alarms,
            events=tuple(tally.events),
            t_s=t_s,
            probability=probability,
            warnings=self.warnings,
        )


def _check_announced(place: str, value: object, announced: bool, cure: str) -> None:
    """Refuse a channel that was announced and is missing, or is given and was not announced."""
    if announced and value is None:
        raise InputError(place, "is missing", cure)
    if value is not None and not announced:
        raise InputError(place, "has no effect: the monitor was made without it", "leave it out")
