"""What a camera and its clock make of a run: noise of several colours, gaps, wrong clocks, slow frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from judged.simulator import Array

#: The kinds of sets without undeclared physics: name → held back from development, instrument at fault.
NULL_KINDS = {
    "white": (False, False),
    "coloured": (False, False),
    "heavy_tailed": (True, False),
    "outliers": (False, False),
    "gaps": (False, False),
    "stamp_jitter": (True, True),
    "clock_rate_camera": (False, True),
    "clock_rate_all": (False, True),
    "camera_absent": (False, True),
    "camera_repeated": (False, True),
}
#: The kinds of noise that sets with an effect may have beside white.
BESIDE_WHITE = ("coloured", "outliers", "gaps", "camera_absent")


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrument:
    """A kind of fault and its numbers, the same for all runs of a set."""

    kind: str
    numbers: dict[str, float]
    sigma: Array  # (3,)
    rate: int


def draw_instrument(rng: np.random.Generator, kind: str, sigma: Array, rate: int) -> Instrument:
    """The numbers of a kind of fault."""
    numbers: dict[str, float] = {}
    if kind == "coloured":
        numbers["correlation_time_s"] = float(np.exp(rng.uniform(np.log(0.03), np.log(0.4))))
    elif kind == "heavy_tailed":
        numbers["degrees_of_freedom"] = float(rng.uniform(2.5, 4.0))
    elif kind == "outliers":
        numbers["share"] = float(rng.uniform(0.005, 0.03))
        numbers["size_in_sigma"] = float(rng.uniform(10.0, 100.0))
    elif kind == "gaps":
        numbers["share_missing"] = float(rng.uniform(0.05, 0.4))
        numbers["long_gaps"] = float(rng.integers(0, 3))
    elif kind == "stamp_jitter":
        numbers["jitter_s"] = float(rng.uniform(0.05, 0.3) / rate)
    elif kind in ("clock_rate_camera", "clock_rate_all"):
        numbers["rate_error"] = float(rng.choice([-0.02, 0.02]))
    elif kind in ("camera_absent", "camera_repeated"):
        frames = [k for k in (2, 3, 4, 6, 7, 8) if rate / k >= 9.0]
        numbers["rows_per_frame"] = float(rng.choice(frames))
    return Instrument(kind=kind, numbers=numbers, sigma=sigma, rate=rate)


def seen_rows(tool: Instrument, rows_s: Array) -> Array:
    """True times that the pose columns of the rows belong to."""
    if tool.kind == "clock_rate_camera":
        return rows_s / (1.0 + tool.numbers["rate_error"])
    return rows_s


def stamps(rng: np.random.Generator, tool: Instrument, rows_s: Array) -> Array:
    """What the column of times says."""
    if tool.kind == "clock_rate_all":
        return rows_s * (1.0 + tool.numbers["rate_error"])
    if tool.kind == "stamp_jitter":
        step = float(rows_s[1] - rows_s[0])
        late = np.clip(rng.normal(size=len(rows_s)) * tool.numbers["jitter_s"], -0.45 * step, 0.45 * step)
        late[0] = 0.0
        return rows_s + late
    return rows_s


def noisy(rng: np.random.Generator, tool: Instrument, pose: Array) -> Array:
    """Poses (R, 3) with this instrument's noise; NaN where it saw nothing."""
    rows, numbers = len(pose), tool.numbers
    noise = rng.normal(size=(rows, 3))
    if tool.kind == "coloured":
        keep = float(np.exp(-1.0 / tool.rate / numbers["correlation_time_s"]))
        before = keep * rng.normal(size=(1, 3))  # the noise had begun before the run
        noise = lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], noise, axis=0, zi=before)[0]
    elif tool.kind == "heavy_tailed":
        freedom = numbers["degrees_of_freedom"]
        noise = rng.standard_t(freedom, size=(rows, 3)) * np.sqrt((freedom - 2.0) / freedom)
    out = pose + noise * tool.sigma
    if tool.kind == "outliers":
        hit = rng.random(rows) < numbers["share"]
        out[hit] += rng.normal(size=(int(hit.sum()), 3)) * tool.sigma * numbers["size_in_sigma"]
    elif tool.kind == "gaps":
        lost = rng.random(rows) < numbers["share_missing"]
        for _ in range(int(numbers["long_gaps"])):
            begin = int(rng.uniform(0.1, 0.8) * rows)
            lost[begin : begin + int(rng.uniform(0.1, 0.3) * tool.rate)] = True
        lost[0] = False
        out[lost] = np.nan
    elif tool.kind == "camera_absent":
        out[np.arange(rows) % int(numbers["rows_per_frame"]) != 0] = np.nan
    elif tool.kind == "camera_repeated":
        out = out[np.arange(rows) // int(numbers["rows_per_frame"]) * int(numbers["rows_per_frame"])]
    return np.asarray(out)
