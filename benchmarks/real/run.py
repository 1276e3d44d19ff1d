"""Real robots, one table: how far each model is off on runs that it has not seen.

    python benchmarks/real/run.py DATA [--json FILE] [--set NAME]… [--row NAME]…

DATA holds what you have of ``robotino/`` (folders table_0.1, gray_0.1, gray_0.2, load_0.1, green_0.1 and
green_0.2 of the public repository BrOleg5/research-wheel-slippage) and ``robojackets/`` (enc_vis*.txt of
RoboJackets/robocup-firmware-data, branch nn-processing). Nothing is downloaded. ``--json`` keeps each
row as soon as it is known, and goes on from there. ``python benchmarks/real/page.py --write`` makes the
page.

Errors are those of displacement in the body frame, by each one's own heading, and of the change of
heading, root mean squares over stretches of 0.5 s and 2 s that follow each other, and over whole runs;
the velocity's over 0.1 s. NLL is that of the 0.5 s stretches' errors (x, y, heading) under a Gaussian
whose covariance is that of the same errors on the fitted runs: a model that is sure of itself where it
is wrong pays for it [nats a stretch].
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from real.models import ROWS, Model, measured_path, rate, rows_for, windows
from real.sets import RealSet, read
from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.io.writes import write_text

HORIZONS: dict[str, float | None] = {"0.5 s": 0.5, "2 s": 2.0, "run": None}


def stretches(model: Model, records: tuple[Record, ...], horizon_s: float | None) -> tuple[Array, Array]:
    """Predicted − measured displacement and heading (K, 3) of every stretch, and the way (K,) it is long."""
    errors, ways = [], []
    for record in records:
        measured, predicted = measured_path(record), model.path(record)
        for first, last in windows(record.t_s, record.seen, horizon_s):
            went = measured[last] - measured[first]
            errors.append(predicted[last] - predicted[first] - went)
            ways.append(float(np.hypot(*went[:2])))
    return np.array(errors).reshape(-1, 3), np.array(ways)


def velocity_error(model: Model, records: tuple[Record, ...]) -> Array:
    """Root mean square (3,) of the velocity's error, body frame [m/s, m/s, rad/s]."""
    gaps = []
    for record in records:
        t = record.t_s
        gap = rate(t, measured_path(record)) - rate(t, model.path(record))
        gaps.append(gap[np.isfinite(gap).all(axis=1)])
    return np.asarray(np.sqrt(np.mean(np.concatenate(gaps) ** 2, axis=0)))


def nll(fitted: Array, judged: Array) -> float:
    """Mean negative log likelihood of errors (K, 3) under a Gaussian of the fitted ones' second moment."""
    covariance = fitted.T @ fitted / len(fitted)
    covariance += 1e-9 * np.trace(covariance) * np.eye(3)
    sign, size = np.linalg.slogdet(2.0 * np.pi * covariance)
    assert sign > 0
    return float(
        0.5 * np.mean(np.einsum("ki,ij,kj->k", judged, np.linalg.inv(covariance), judged)) + 0.5 * size
    )


def row(data: RealSet, name: str) -> dict[str, Any]:
    """A model fitted and judged."""
    model = ROWS[name]()
    began = time.process_time()
    model.fit(data)
    spent = time.process_time() - began
    found: dict[str, Any] = {"set": data.name, "model": name, "fit_cpu_s": round(spent, 1)}
    for word, horizon in HORIZONS.items():
        error, way = stretches(model, data.judged, horizon)
        if not len(error):
            continue
        found[word] = {
            "displacement_mm": 1e3 * float(np.sqrt(np.mean(np.sum(error[:, :2] ** 2, axis=1)))),
            "displacement_of_way": float(np.sqrt(np.sum(error[:, :2] ** 2) / max(np.sum(way**2), 1e-12))),
            "heading_deg": float(np.rad2deg(np.sqrt(np.mean(error[:, 2] ** 2)))),
            "stretches": len(error),
        }
    x, y, turn = velocity_error(model, data.judged)
    found["velocity"] = {"x_m_s": float(x), "y_m_s": float(y), "yaw_rad_s": float(turn)}
    found["nll"] = nll(stretches(model, data.own, 0.5)[0], stretches(model, data.judged, 0.5)[0])
    found["said"] = list(getattr(model, "said", ()))
    return found


def told(found: dict[str, Any]) -> str:
    """A row as a line."""
    parts = [f"{found['set']:16s}{found['model']:44s}"]
    for word in HORIZONS:
        if word in found:
            e = found[word]
            parts.append(
                f"{word}: {e['displacement_mm']:7.2f} mm {100 * e['displacement_of_way']:5.2f} % "
                f"{e['heading_deg']:5.2f} deg"
            )
    v = found["velocity"]
    parts.append(
        f"v {v['x_m_s']:.3f} {v['y_m_s']:.3f} m/s {v['yaw_rad_s']:.3f} rad/s  NLL {found['nll']:.2f}"
    )
    return "  ".join(parts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--set", action="append")
    parser.add_argument("--row", action="append", choices=list(ROWS))
    chosen = parser.parse_args()
    rows = (
        json.loads(chosen.json.read_text(encoding="utf-8")) if chosen.json and chosen.json.is_file() else []
    )
    for data in read(chosen.data):
        if chosen.set and data.name not in chosen.set:
            continue
        print(f"{data.name}: {len(data.fitted.trials)} runs fitted, {len(data.judged)} judged", flush=True)
        for name in chosen.row or rows_for(data):
            if name not in rows_for(data):
                print(f"{data.name}: its runs do not lie beside each other, so there is no {name}")
                continue
            known = next((r for r in rows if (r["set"], r["model"]) == (data.name, name)), None)
            if known is None:
                known = row(data, name)
                rows.append(known)
                rows.sort(key=lambda r: (r["set"], list(ROWS).index(r["model"])))
                if chosen.json:
                    write_text(chosen.json, json.dumps(rows, indent=1) + "\n")
            print(told(known), *(f"    {line}" for line in known["said"]), sep="\n", flush=True)


if __name__ == "__main__":
    main()
