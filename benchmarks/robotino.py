"""A real robot: what explains its slip, on headings and speeds that no fit has seen.

Run: ``python benchmarks/robotino.py LOGS [FILE.json] [--quick] [--judge FILE]``; LOGS holds the folders
``table_0.1``, ``gray_0.1``, ``gray_0.2`` of the public repository BrOleg5/research-wheel-slippage, one run a
file.

Split: fitted on ``gray`` at 0.1 m/s with commanded headings 0, 10, 20, … degrees (36 runs); held out are
the other 36 and all 72 at 0.2 m/s.  Calibration (scale, rotation, delay and tilt of the camera) comes from
``table`` and is held fixed, but for the row that refits the scale, the honest baseline.

Errors are those of ``robotino_campaign.py``; with ``--judge FILE`` those of any robot file, for example the
``corrected.toml`` of ``slipmargin diagnose``.  Fits are by least squares with a soft L1 loss
at 1 % (a wheel that stands keeps one roller angle for the whole run: such runs scatter by 7 %).
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from robotino_campaign import Array, Campaign, Runs
from robotino_checks import currents, limits
from scipy.optimize import least_squares

from slipmargin.effects import Effect, Recipe
from slipmargin.effects.camera_scale import CameraScale
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.io.robot_file import read_recipe

#: One row of a fit's vector: displacement / distance (2) and this much of the heading change [1/rad].
HEADING_WEIGHT = 0.15
#: Above this a run's error counts by its size, not its square [1].
SOFT = 0.01
#: What was promised: root mean square over all held-out runs, and its share of the honest baseline.
PROMISED = {"all effects, held out": 0.02, "all effects / honest baseline": 0.45}


Build = Callable[[Array], tuple[Effect, ...]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Form:
    """A set of effects with free parameters: names, start, size of a noticeable change."""

    label: str
    keys: tuple[str, ...]
    start: Array
    scale: Array
    low: Array
    high: Array
    build: Build
    refit_scale: bool = False


def forms() -> list[Form]:
    """The effects in the order in which they take most off the error of the fitted runs."""
    level = 1.0 / 0.3  # drive coefficient 1: only the ratio of the two tells in steady motion

    def made(label: str, free: dict[str, tuple[float, float, float, float]]) -> Form:
        keys = tuple(free)

        def build(x: Array) -> tuple[Effect, ...]:
            v = dict(zip(keys, (float(a) for a in x), strict=True))
            out: list[Effect] = [
                SlipRatioFriction(
                    share=1.0, steepness=v["kappa"], transverse_factor=v.get("kappa_across", 1.0)
                )
            ]
            ratio = v.get("coefficient_ratio", 0.05 / 0.3)
            out.append(FrictionCoefficients(drive_factor=level, transverse_factor=ratio / 0.05))
            if "shift_x_m" in v:
                out.append(WheelLoads(shift_x_m=v["shift_x_m"], shift_y_m=v["shift_y_m"], com_share=1.0))
            if "lever_m" in v:
                out.append(TrailingLoad(lever_m=v["lever_m"]))
            return tuple(out)

        start, scale, low, high = np.array(list(free.values())).T
        return Form(label=label, keys=keys, build=build, start=start, scale=scale, low=low, high=high)

    # start, a noticeable change, lowest, highest
    creep = {"kappa": (4.5, 0.5, 0.6, 100.0)}
    ratio = {"coefficient_ratio": (0.45, 0.05, 0.0, 3.0)}
    loads = {"shift_x_m": (0.0, 0.002, -0.06, 0.06), "shift_y_m": (0.0, 0.002, -0.06, 0.06)}
    lever = {"lever_m": (0.0, 0.001, -0.02, 0.02)}
    across = {"kappa_across": (1.0, 0.3, 0.1, 15.0)}
    return [
        made("+ slip ratio friction", creep),
        made("+ friction coefficients", creep | ratio),
        made("+ wheel loads", creep | ratio | loads),
        made("+ trailing load", creep | ratio | loads | lever),
        made("+ steepness across (all)", creep | ratio | loads | lever | across),
    ]


def fitted(runs: Runs, recipe: Recipe, form: Form, which: NDArray[np.int64], steps: int = 6) -> Array:
    """Parameters that fit the runs ``which`` best (soft L1)."""

    def residual(points: list[Array]) -> Array:
        chosen = [with_effects(recipe, form.build(p), form, p) for p in points]
        error = runs.errors(chosen, "gray", which)
        return np.concatenate(
            [error[..., :2].reshape(len(points), -1), HEADING_WEIGHT * error[..., 2]], axis=1
        )

    unit = np.diag(0.02 * form.scale)

    def slope(x: Array) -> Array:
        rows = residual([x, *(x + u for u in unit)])
        return np.asarray((rows[1:] - rows[0]).T / (0.02 * form.scale))

    return np.asarray(
        least_squares(
            lambda x: residual([x])[0],
            form.start,
            jac=slope,
            x_scale=form.scale,
            bounds=(form.low, form.high),
            loss="soft_l1",
            f_scale=SOFT,
            max_nfev=steps,
            xtol=1e-4,
        ).x
    )


def with_effects(recipe: Recipe, effects: tuple[Effect, ...], form: Form, x: Array) -> Recipe:
    """The calibrated recipe with these effects, and the camera's scale where a form refits it."""
    kept = recipe.effects
    if form.refit_scale:
        kept = tuple(
            CameraScale(scale_x=x[-1], scale_y=x[-1]) if isinstance(e, CameraScale) else e for e in kept
        )
    return replace(recipe, effects=(*kept, *effects))


def intervals(
    runs: Runs, recipe: Recipe, form: Form, x: Array, which: NDArray[np.int64], draws: int = 4000
) -> Array:
    """(draws, P) parameters by a bootstrap over runs, one weighted Gauss–Newton step each."""
    steps = 0.02 * form.scale
    points = [x, *(x + u for u in np.diag(steps))]
    rows = runs.errors([with_effects(recipe, form.build(p), form, p) for p in points], "gray", which)
    rows = rows * np.array([1.0, 1.0, HEADING_WEIGHT])
    residual, slope = rows[0], np.moveaxis((rows[1:] - rows[0]) / steps[:, None, None], 0, -1)
    weight = 1.0 / np.sqrt(1.0 + (residual / SOFT) ** 2)  # of the soft L1 loss
    normal = np.einsum("rip,riq,ri->rpq", slope, slope, weight)
    gradient = np.einsum("rip,ri,ri->rp", slope, residual, weight)
    often = np.random.default_rng(1).multinomial(
        len(which), np.full(len(which), 1.0 / len(which)), size=draws
    )
    pull = np.einsum("br,rp->bp", often, gradient)
    return np.asarray(x - np.linalg.solve(np.einsum("br,rpq->bpq", often, normal), pull[..., None])[..., 0])


def physical(recipe: Recipe, form: Form, draws: Array) -> dict[str, Array]:
    """What somebody could check with a scale, a spring balance or a ruler, for parameters (D, P)."""
    values = dict(zip(form.keys, draws.T, strict=True))
    nominal = recipe.build("gray")
    weight, place = nominal.inertia.weight_N, nominal.contacts.position_m
    share = np.linalg.inv(np.vstack([np.ones(3), place.T]))  # three wheels: loads from Σ N = W, Σ N p = W c
    loads = np.column_stack([np.ones(len(draws)), values["shift_x_m"], values["shift_y_m"]]) @ share.T
    told = {
        f"load on wheel {name} [kg]": loads[:, i] * weight / 9.81
        for i, name in enumerate(nominal.contacts.names)
    }
    return told | {
        "load centre, towards +x [mm]": 1e3 * values["shift_x_m"],
        "load centre, towards +y [mm]": 1e3 * values["shift_y_m"],
        "coefficient across / along (tilt board, spring balance) [1]": values["coefficient_ratio"],
        "steepness along κ (slip ratio) [1]": values["kappa"],
        "steepness across κ_T [1]": values["kappa"] * values["kappa_across"],
        "contact ahead of the axle [mm]": 1e3 * values["lever_m"],
    }


def paper_rows() -> list[Form]:
    """Eq. (11) as published with the calibration of ``table``, and with its scale refitted on ``gray``."""
    none = np.zeros(0)
    published = Form(
        label="paper's model, calibration of table",
        keys=(),
        start=none,
        scale=none,
        low=none,
        high=none,
        build=lambda x: (),
    )
    scale = replace(
        published,
        label="the same, scale refitted on gray (honest baseline)",
        keys=("scale",),
        start=np.array([0.72]),
        scale=np.array([0.02]),
        low=np.array([0.5]),
        high=np.array([1.0]),
        refit_scale=True,
    )
    return [published, scale]


def study(folder: Path, quick: bool = False) -> dict[str, object]:
    """Everything the table needs, as data."""
    began = time.perf_counter()
    campaign = Campaign.read(folder)
    rows = []
    found: dict[str, float] = {}
    best: Form | None = None
    x = np.zeros(0)
    for form in paper_rows() + forms():
        if form.keys:
            first = np.array([found.get(k, s) for k, s in zip(form.keys, form.start, strict=True)])
            form = replace(form, start=first)
            x = fitted(campaign.slow, campaign.recipe, form, campaign.seen, 3 if quick else 8)
            found |= dict(zip(form.keys, (float(v) for v in x), strict=True))
        recipe = with_effects(campaign.recipe, form.build(x), form, x)
        rows.append(
            {
                "model": form.label,
                "parameters": dict(zip(form.keys, map(float, x), strict=True)) if form.keys else {},
                "errors": campaign.judged(recipe),
            }
        )
        best = form
    assert best is not None
    numbers = physical(campaign.recipe, best, x[None])
    drawn = physical(campaign.recipe, best, intervals(campaign.slow, campaign.recipe, best, x, campaign.seen))
    recipe = with_effects(campaign.recipe, best.build(x), best, x)
    return {
        "calibration": list(campaign.calibration.lines()),
        "runs": {
            "fitted": len(campaign.seen),
            "held out": len(campaign.slow.names) + len(campaign.fast.names) - len(campaign.seen),
        },
        "rows": rows,
        "physical": {
            k: {
                "value": float(v[0]),
                "low": float(np.quantile(drawn[k], 0.025)),
                "high": float(np.quantile(drawn[k], 0.975)),
            }
            for k, v in numbers.items()
        },
        "limits": {
            "before": limits(campaign.recipe),
            "after": limits(recipe, float(x[best.keys.index("kappa")])),
        },
        "currents": currents([campaign.slow, campaign.fast], recipe),
        "seconds": time.perf_counter() - began,
    }


def told(result: dict[str, object]) -> list[str]:
    """The table as text."""
    rows = result["rows"]
    assert isinstance(rows, list)
    lines = [f"{'':55s}{'fitted':>8s}{'headings':>10s}{'speed':>8s}{'held out':>10s}{'heading change':>16s}"]
    for row in rows:
        e = row["errors"]
        lines.append(
            f"{row['model']:55s}"
            + "".join(
                f"{100 * e[k]['displacement']:{w}.2f} %"
                for k, w in (("fitted", 6), ("headings", 8), ("speed", 6), ("held out", 8))
            )
            + f"{e['held out']['heading_deg']:12.1f} deg"
        )
    last, base = rows[-1]["errors"], rows[1]["errors"]
    ratio = last["held out"]["displacement"] / base["held out"]["displacement"]
    lines.append(
        f"all effects / honest baseline, held out: {ratio:.2f} (promised at most "
        f"{PROMISED['all effects / honest baseline']}); promised at most "
        f"{100 * PROMISED['all effects, held out']:g} % of the distance"
    )
    alone = list(last)[-1]
    lines.append(f"all effects, {alone}: {100 * last[alone]['displacement']:.2f} %")
    physical_rows = result["physical"]
    assert isinstance(physical_rows, dict)
    lines += [
        f"{k:62s}{v['value']:8.3f}  ({v['low']:.3f} … {v['high']:.3f})" for k, v in physical_rows.items()
    ]
    limit_rows = result["limits"]
    assert isinstance(limit_rows, dict)
    for when, table in limit_rows.items():
        lines += [f"{'limits ' + when + ': ' + k:62s}{v:8.3f}" for k, v in table.items()]
    current_rows = result["currents"]
    assert isinstance(current_rows, dict)
    lines += [f"{'current, not fitted: ' + k:62s}{v:8.3f}" for k, v in current_rows.items()]
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("logs", type=Path)
    parser.add_argument("json", type=Path, nargs="?")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--judge", type=Path)
    chosen = parser.parse_args()
    if chosen.judge is not None:
        for runs, e in Campaign.read(chosen.logs).judged(read_recipe(str(chosen.judge))).items():
            print(f"{runs:45s}{100 * e['displacement']:6.2f} %{e['heading_deg']:8.1f} deg")
        return
    result = study(chosen.logs, chosen.quick)
    print("\n".join(told(result)))
    if chosen.json is not None:
        chosen.json.write_text(json.dumps(result, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
