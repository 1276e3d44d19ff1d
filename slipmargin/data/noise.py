"""The noise of the measured pose: how large it is, and how long it lasts.

White noise is what a sample misses the smooth curve through its neighbours by.  Noise that lasts (a marker
that is recognised a little beside its place, and again so in the next frame) moves neighbours together and
is not seen that way.  It is read where the robot stands: all motion there is noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS

#: Neighbours of a sample that its curve goes through: two make a line, four a cubic.
_LINE, _CUBIC = (-1, 1), (-2, -1, 1, 2)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LastingNoise:
    """The part of the noise that lasts: its share of the variance (3,) and the time (3,) [s] to fade.

    It is a process of first order: its autocorrelation is exp(−lag / time).
    """

    share: Array
    time_s: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "share", frozen("share", self.share, (3,)))
        object.__setattr__(self, "time_s", frozen("time_s", self.time_s, (3,)))


def white_noise(records: tuple[Record, ...]) -> Array:
    """Standard deviation (3,) of x [m], y [m], φ [rad], from neighbours that smooth motion cannot explain.

    Each sample is compared with the curve through its neighbours; the spread of that difference is
    σ √(1 + Σ w²), w the neighbours' weights.  The median makes it robust against outliers and against short
    hard accelerations.  A line sees curved motion as noise and a cubic hardly; the smaller one counts.
    """
    found = np.empty(3)
    for axis in range(3):
        spreads = []
        steps = np.zeros(0)
        for around in (_LINE, _CUBIC):
            misses = np.concatenate([np.abs(_against_neighbours(r, axis, around)) for r in records])
            if not len(misses):
                continue
            spreads.append(1.4826 * float(np.median(misses)))
            steps = misses[misses > 0.0] if around == _LINE else steps
        if not spreads:
            found[axis] = 1e-3
            continue
        spread = min(spreads)
        if spread == 0.0:  # a coarse sensor repeats its value: its step is the noise
            spread = float(np.min(steps)) if len(steps) else 1e-6
        found[axis] = max(spread, 1e-9)
    return found


def _against_neighbours(record: Record, axis: int, around: tuple[int, ...]) -> Array:
    """Each inner sample that is known minus the curve through known neighbours, per √(1 + Σ w²)."""
    known = np.isfinite(record.pose[:, axis])
    t, value = record.t_s[known], record.pose[known, axis]
    edge = max(around)
    if len(t) < 2 * edge + 1:
        return np.zeros(0)
    inner = np.arange(edge, len(t) - edge)
    at = t[inner]
    curve, power = np.zeros(len(inner)), np.ones(len(inner))
    for j in around:
        weight = np.ones(len(inner))
        for m in around:
            if m != j:
                weight *= (at - t[inner + m]) / (t[inner + j] - t[inner + m])
        curve += weight * value[inner + j]
        power += weight**2
    return np.asarray((value[inner] - curve) / np.sqrt(power))


#: Samples in the windows whose spectra are read.
_WINDOWS = (64, 128, 256)
#: How many times to fade and how many shares are tried.
_TIMES, _SHARES = 24, 40


def lasting_noise(
    residuals: list[tuple[Array, Array]], stated: Array | None = None
) -> tuple[Array, LastingNoise | None]:
    """Standard deviation (3,) of the whole noise and the part of it that lasts, None where it is white.

    Parameters
    ----------
    residuals : list of pairs (T,), (T, 3)
        Times [s] and measured minus predicted pose of each run, NaN where missing.
    stated : array (3,), optional
        The standard deviation that is stated: a residual of this size is nothing but noise.

    Notes
    -----
    The spectrum of noise of first order over white noise falls with the square of the frequency to a flat
    floor.  That of a motion that forces would make falls with its fourth power.  The spectra of short
    windows tell the two apart; a low quantile over the windows leaves out those in which something else
    happens.
    """
    sigma, share, time = np.zeros(3), np.zeros(3), np.full(3, 1.0)
    scale = np.array([_roughness(residuals, axis) for axis in range(3)])
    residuals = [(t, r / scale) for t, r in residuals]
    for axes in ((0, 1), (2,)):
        spectra = [s for size in _WINDOWS if (s := _spectrum(residuals, axes, size)) is not None]
        if not spectra:
            sigma[list(axes)] = scale[list(axes)]
            continue
        pooled = np.concatenate([r[:, axes].ravel() for _, r in residuals])
        size, flat = float(np.sqrt(np.nanmean(pooled**2))), float(np.median(spectra[0][1]))
        as_stated = stated is not None and size < SETTINGS.as_stated * float(
            np.mean(stated[list(axes)] / scale[list(axes)])
        )
        near = size < SETTINGS.nearly_noise * np.sqrt(flat) or as_stated
        # One camera sees both: noise that lasts in x and y is expected to last in the heading.
        apart = SETTINGS.not_steep if near or share.any() else SETTINGS.not_steep_far
        shortest, *longer = [_first_order(*s, apart) for s in (spectra if near else spectra[:1])]
        good = [fit for fit in longer if fit[3] < SETTINGS.good_spectrum and fit[1] > 0.0]
        white, part, fades, _ = good[-1] if good else shortest
        if near and part > 0.0:
            white, part, fades = _as_large(white, part, fades, size)
        for axis in axes:
            sigma[axis], share[axis], time[axis] = scale[axis] * np.sqrt(white / (1.0 - part)), part, fades
    if not share.any():
        return sigma, None
    return sigma, LastingNoise(share=share, time_s=time)


def _as_large(white: float, part: float, fades: float, size: float) -> tuple[float, float, float]:
    """White variance, lasting share and time of noise of this spectrum that is as large as a residual.

    A spectrum down to its first line tells the ratio of variance and time, not how large both are.
    """
    lasting = white * part / (1.0 - part)
    whole = max(lasting, size**2 - white)
    return white, whole / (white + whole), fades * whole / lasting


def _roughness(residuals: list[tuple[Array, Array]], axis: int) -> float:
    """About the size of one channel's white noise: what samples miss the middle of their neighbours by."""
    known = [r[np.isfinite(r[:, axis]), axis] for _, r in residuals]
    misses = np.concatenate([np.diff(values, n=2) for values in known])
    return max(1.4826 * float(np.median(np.abs(misses))) / np.sqrt(6.0), 1e-12) if len(misses) else 1.0


def _spectrum(
    residuals: list[tuple[Array, Array]], axes: tuple[int, ...], window: int
) -> tuple[Array, Array, float, float, float] | None:
    """Angle per sample of each line, power there (white noise of variance 1: 1), its spread, step, span."""
    steps = [np.diff(t[np.isfinite(r[:, axes[0]])]) for t, r in residuals]
    if not any(len(s) for s in steps):
        return None
    step_s = float(np.median(np.concatenate(steps)))
    shortest = int(np.median([np.isfinite(r[:, axes[0]]).sum() for _, r in residuals]))
    size = min(window, shortest // 2 if window == _WINDOWS[0] else shortest)
    if size < (16 if window == _WINDOWS[0] else window // 2 + 1):
        return None
    taper = np.hanning(size + 2)[1:-1]
    taper /= np.sqrt(np.sum(taper**2))
    line = np.column_stack([np.ones(size), np.linspace(-1.0, 1.0, size)])
    level = line @ np.linalg.pinv(line)
    spectra = []
    for _, residual in residuals:
        for axis in axes:
            known = residual[np.isfinite(residual[:, axis]), axis]
            for start in range(0, len(known) - size + 1, size // 2):
                piece = known[start : start + size]
                spectra.append(np.abs(np.fft.rfft((piece - level @ piece) * taper)) ** 2)
    if len(spectra) < 6:
        return None
    first = SETTINGS.first_line
    if window == _WINDOWS[0]:
        first = max(first, min(size // 4, int(np.ceil(SETTINGS.motion_hz * size * step_s))))
    lines = np.arange(first, size // 2)
    quiet = SETTINGS.quiet_windows
    power = np.quantile(np.array(spectra), quiet, axis=0)[lines] / -np.log(1.0 - quiet)
    # A quantile of n exponential values; windows that overlap by half count for two thirds, as do lines of
    # a taper.
    count = len(spectra) / 1.5
    spread = float(np.sqrt(quiet / (1.0 - quiet) / count) / -np.log(1.0 - quiet)) * np.sqrt(1.5)
    return 2.0 * np.pi * lines / size, np.maximum(power, 1e-30), spread, step_s, shortest * step_s


def _first_order(
    line: Array, power: Array, spread: float, step_s: float, longest_s: float, apart: float
) -> tuple[float, float, float, float]:
    """Variance of the white noise, share of the variance that lasts, fading time [s], chi² a line."""
    level = np.log(power)

    def misfit(shape: Array) -> Array:
        gap = level - np.log(shape)
        return np.asarray(np.sum((gap - gap.mean(axis=-1, keepdims=True)) ** 2, axis=-1) / spread**2)

    shares = np.linspace(0.0, 0.999, _SHARES)[:, None]
    flat = float(misfit(np.ones(len(line))))
    steep = (2.0 - 2.0 * np.cos(line)) ** -2
    strength = np.geomspace(1e-6, 1e2, 60)[:, None]
    steepest = float(misfit(1.0 + strength * steep / steep.max()).min())
    times = np.geomspace(0.5 * step_s, longest_s, _TIMES)
    keep = np.exp(-step_s / times)[:, None, None]
    lasting = (1.0 - keep**2) / (1.0 - 2.0 * keep * np.cos(line) + keep**2)
    # Long times need shares very near one: the shares are of the variance within a window's time.
    within = np.minimum(1.0, len(line) * 2.0 * step_s / times)[:, None, None]
    odds = shares / (1.0 - shares) / within
    fits = misfit(1.0 + odds * lasting)
    found = float(fits.min())
    if flat - found < SETTINGS.lasts or steepest - found < apart:
        return float(np.exp(level.mean())), 0.0, float(times[0]), flat / len(line)
    # Where a spectrum falls down to its first line, all long times fit: the shortest claims the least.
    first = int(np.argmax(fits.min(axis=1) < found + SETTINGS.as_good_spectrum))
    at = (first, int(np.argmin(fits[first])))
    odd = float(odds[at[0], at[1], 0])
    white = float(np.exp(np.mean(level - np.log(1.0 + odd * lasting[at[0], 0]))))
    part = odd / (1.0 + odd)
    if part * np.exp(-step_s / times[at[0]]) < SETTINGS.least_correlation:
        return float(np.exp(level.mean())), 0.0, float(times[0]), flat / len(line)
    return white, part, float(times[at[0]]), found / len(line)
