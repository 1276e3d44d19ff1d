"""Constructed diagnoses for the tests of whatever shows one: each verdict, no simulation behind them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from strategies import kiwi

from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.conditions import Ready
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.diagnosis.result import (
    Diagnosis,
    Estimate,
    Event,
    Finding,
    Lead,
    LeadSource,
    Score,
    Step,
    TrialTrajectories,
    Tried,
    Verdict,
)
from slipmargin.diagnosis.verdict import Judgement
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Recipe, Trace
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

NOISE = np.array([5e-4, 5e-4, 2e-3])


def taken_for_noise(plain: Callable[..., Ready]) -> Callable[..., Ready]:
    """``ready`` that takes most of what the model misses for noise that lasts two seconds."""

    def ready(*given: Any) -> Ready:
        made = plain(*given)
        sigma = made.data_set.sigma
        assert sigma is not None
        lasting = LastingNoise(share=np.full(3, 0.99), time_s=np.full(3, 2.0))
        return replace(made, data_set=replace(made.data_set, sigma=10.0 * sigma, lasting=lasting))

    return ready


def trials(count: int = 6, *, wrong: float = 1.0, samples: int = 120) -> tuple[TrialTrajectories, ...]:
    """Curves with a drift of ``wrong`` times 30 mm and 0.1 rad that the model before does not have."""
    random = np.random.default_rng(5)
    made = []
    for k in range(count):
        t = np.linspace(0.0, 3.0, samples)
        way, s = 2.0 * np.pi * k / count, 0.5 * (1.0 - np.cos(np.pi * t / 3.0))
        true = np.stack([0.6 * s * np.cos(way), 0.6 * s * np.sin(way), 0.5 * s * (k % 3 - 1)], axis=1)
        drift = np.stack([0.03 * s**2 * np.sin(way), -0.03 * s**2 * np.cos(way), 0.1 * s**2], axis=1)
        measured = true + NOISE * random.standard_normal(true.shape)
        if k == 1:
            measured[30:40] = np.nan
        made.append(
            TrialTrajectories(
                name=f"trial-{k + 1:02d}",
                run=k,
                data_set="drawn",
                held_out=k >= count - 3,
                t_s=t,
                measured=measured,
                before=true + wrong * drift,
                after=true + 0.02 * wrong * drift,
            )
        )
    return tuple(made)


def wheel_loads(**change: object) -> Finding:
    """A finding: the load centre is shifted."""
    values: dict[str, object] = {
        "effect": WheelLoads(shift_x_m=0.012, shift_y_m=-0.008),
        "name": "wheel_loads",
        "label": "wheel_loads",
        "traced_to": Trace.WHEEL_LOAD,
        "wheels": (),
        "parameters": (
            Estimate(name="shift_x_m", value=0.012, low=0.0115, high=0.0125, unit="m"),
            Estimate(name="shift_y_m", value=-0.008, low=-0.0086, high=-0.0074, unit="m"),
        ),
        "derived": tuple(
            Estimate(name=f"load_fraction{i}", value=v, low=v - 0.004, high=v + 0.004, unit="1")
            for i, v in enumerate((0.41, 0.28, 0.31), 1)
        ),
        "chi_without": 24.0,
        "chi_with": 1.06,
        "p_value": 0.001,
        "candidates_tried": 41,
        "confused_with": (),
        "confirm": WheelLoads.confirm,
        "equation": (WheelLoads.__doc__ or "").splitlines()[0],
    }
    return Finding(**(values | change))  # type: ignore[arg-type]


def unnamed() -> Finding:
    """A finding without a name: friction that depends on the place."""
    effect = GeneralEffect(
        traced_to=Trace.POSITION,
        part=Part.GRIP,
        terms=(
            Multiplier(
                variable=Variable.POSITION_X,
                basis=Basis.HATS,
                shape=np.array([-1.0, 1.0]),
                target=Target.BOTH,
                coefficients=np.array([0.1, 0.0, -0.1]),
                wheels=np.ones(3),
            ),
        ),
    )
    return wheel_loads(
        effect=effect,
        name="unnamed_position",
        label="unnamed_position: friction over x",
        traced_to=Trace.POSITION,
        derived=(),
        confused_with=("floor_nap", "unnamed_heading: friction"),
        parameters=tuple(
            Estimate(name=f"c{i}", value=v, low=v - 0.02, high=v + 0.02, unit="1", at_bound=i == 3)
            for i, v in enumerate((0.1, 0.0, -0.1), 1)
        ),
        confirm="repeat one manoeuvre with the same heading in different places of the floor",
        equation="friction (1 + sum of c_j h_j(x)), h_j hats over x",
        chi_with=1.4,
        p_value=0.004,
    )


def steps() -> tuple[Step, ...]:
    """Two rounds: one that takes wheel_loads, one that stops."""

    def row(label: str, trace: Trace, size: int, chi: float) -> Tried:
        return Tried(
            label=label, traced_to=trace, named=not label.startswith("unnamed"), parameters=size, chi=chi
        )

    first = (
        row("wheel_loads", Trace.WHEEL_LOAD, 2, 1.06),
        row("unnamed_wheel: friction of each", Trace.WHEEL, 3, 1.09),
        row("floor_tilt", Trace.CONSTANT_FORCE, 2, 9.3),
        row("wheel_radius[right]", Trace.WHEEL, 1, 14.0),
        row("unnamed_heading: friction", Trace.HEADING, 4, 16.5),
        row("stribeck", Trace.SLIP_SPEED, 2, 22.0),
        row("camera_delay", Trace.MEASUREMENT, 1, 23.9),
        row("tether", Trace.POSITION, 3, float("inf")),
    )
    second = tuple(
        row(t.label, t.traced_to, t.parameters, 1.05 + 0.004 * i) for i, t in enumerate(first[2:7])
    )
    return (
        Step(chi_before=24.0, tried=first, taken="wheel_loads"),
        Step(chi_before=1.06, tried=second, taken=None),
    )


def where(strength: float = 1.0) -> tuple[ResidualDependence, ...]:
    """Shares of some variables."""
    rows = [
        ("wheel_load", "turn", 0.61, 0.01),
        ("wheel_load", "right", 0.35, 0.01),
        ("velocity", "turn", 0.22, 0.01),
        ("heading", "forward", 0.12, 0.04),
        ("time", "turn", 0.05, 0.2),
        ("slip_speed", "right", 0.02, 0.5),
    ]
    return tuple(
        ResidualDependence(variable=v, channel=c, share=strength * s, surprise=10.0 * s, p_value=p)
        for v, c, s, p in rows
    )


def residual_map(strength: float = 1.0) -> tuple[MapEntry, ...]:
    """One variable that the residual follows, one that it does not."""
    clear = strength > 0.1
    return (
        MapEntry(
            traced_to=Trace.ACCELERATION,
            form="proportional to acceleration",
            share=0.4 * strength,
            p_value=0.005 if clear else 0.4,
        ),
        MapEntry(traced_to=Trace.TIME, form="force over time", share=-0.01, p_value=1.0),
    )


def lead(**change: object) -> Lead:
    """A lead of the map."""
    values: dict[str, object] = {
        "traced_to": Trace.POSITION,
        "source": LeadSource.MAP,
        "why": "friction over the place explains 12 % of the velocity residual of runs left out",
        "next_run": "repeat one manoeuvre with the same heading in different places of the floor",
        "share": 0.12,
        "p_value": 0.005,
        "candidate": "unnamed_position: friction over position",
    }
    return Lead(**(values | change))  # type: ignore[arg-type]


def judgement(**change: object) -> Judgement:
    """Nine of nine runs get better, down to the noise."""
    values: dict[str, object] = {
        "failures": (),
        "explained": 0.998,
        "p_value": 0.002,
        "runs": 9,
        "better": 9,
        "worse": 0,
        "chi_before": 23.0,
        "chi_after": 1.05,
        "partial": False,
    }
    return Judgement(**(values | change))  # type: ignore[arg-type]


def diagnosis(
    verdict: Verdict = Verdict.EFFECT_FOUND, findings: tuple[Finding, ...] | None = None, **change: object
) -> Diagnosis:
    """A diagnosis with this verdict."""
    found = verdict is Verdict.EFFECT_FOUND
    if findings is None:
        findings = (wheel_loads(),) if found else ()
    recipe = Recipe(robot=kiwi())
    effects: tuple[AnyEffect, ...] = tuple(f.effect for f in findings)
    null = verdict is Verdict.NO_MISSING_EFFECT
    before = Score(
        rmse_position_m=5.2e-4 if null else 0.0192,
        rmse_heading_rad=2e-3 if null else 0.061,
        chi=1.03 if null else 24.0,
    )
    after = Score(rmse_position_m=6e-4, rmse_heading_rad=2.1e-3, chi=1.06) if found else before
    values: dict[str, object] = {
        "data_set": "drawn",
        "surface": "paper",
        "verdict": verdict,
        "noise": NOISE,
        "noise_estimated": True,
        "held_out": ("trial-04", "trial-05", "trial-06"),
        "cross_validated": False,
        "before": before,
        "after": after,
        "judgement": judgement() if found else None,
        "rejected": (),
        "findings": findings,
        "steps": steps() if found else steps()[1:],
        "map": residual_map(),
        "map_after": residual_map(0.01),
        "leads": () if null else (lead(),),
        "where": where(),
        "where_after": where(0.02),
        "turns": (),
        "excitation": (812.0, 95.0),
        "events": (Event(trial="trial-02", t_s=1.25, channel="phi_rad", size_sigma=22.0),),
        "outliers": 4,
        "trials": trials(wrong=0.02 if null else 1.0),
        "recipe": recipe,
        "corrected": Recipe(robot=recipe.robot, effects=effects),
        "remarks": ("a remark about the log",),
    }
    return Diagnosis(**(values | change))  # type: ignore[arg-type]
