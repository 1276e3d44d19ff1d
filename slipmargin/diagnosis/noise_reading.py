"""What the base model's residual says of the noise beyond its size: heavy tails, and words for the report."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.noise import LastingNoise
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.settings import SETTINGS


def tails(residuals: list[tuple[Array, Array]], sigma: Array) -> Array:
    """What the noise's root mean square is over its size by the middle half (3,): 1 but for heavy tails."""
    out = np.ones(3)
    for axis in range(3):
        jumps = []
        for _, residual in residuals:
            known = residual[np.isfinite(residual[:, axis]), axis]
            jumps.append((known[2:] - 2.0 * known[1:-1] + known[:-2]) / np.sqrt(6.0) / sigma[axis])
        values = np.concatenate(jumps)
        values = values[np.abs(values) < SETTINGS.outlier_sigma]
        if len(values) > 100:
            # The middle half of the same values: what is not noise in them is in both.
            middle = 1.4826 * float(np.median(np.abs(values)))
            ratio = float(np.sqrt(np.mean(values**2))) / max(middle, 1e-12)
            out[axis] = ratio if ratio > SETTINGS.heavy_tails and 0.7 < middle < 1.4 else 1.0
    return out


_CHANNELS = (("x", 1e3, "mm"), ("y", 1e3, "mm"), ("heading", 1e3, "mrad"))


def stated_wrong(stated: Array, found: Array, worst: int, every: tuple[str, ...]) -> Repair:
    """That the stated noise is not the one the data have, most so in channel ``worst``."""
    name, factor, unit = _CHANNELS[worst]
    return Repair(
        kind="stated_noise",
        runs=every,
        size=float(found[worst] / stated[worst]),
        unit="1",
        sentence=f"The noise is stated as {factor * stated[worst]:.2g} {unit} in {name}, the data have "
        f"{factor * found[worst]:.2g} {unit}: that was used.",
    )


def lasts(lasting: LastingNoise, every: tuple[str, ...]) -> Repair:
    """That part of the noise lasts, and how long."""
    worst = int(np.argmax(lasting.share))
    return Repair(
        kind="lasting_noise",
        runs=every,
        size=float(lasting.time_s[worst]),
        unit="s",
        sentence=f"The noise is not white: {100.0 * lasting.share[worst]:.0f} % of its variance in "
        f"{_CHANNELS[worst][0]} lasts "
        f"{lasting.time_s[worst]:.2g} s. Residuals were whitened by that.",
    )
