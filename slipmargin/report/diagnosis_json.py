"""A diagnosis as plain data: the content of ``report.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from slipmargin.checks import exact_mean
from slipmargin.diagnosis.limits_change import MOTION_CURVES, PULL_CURVES, Limits, LimitsChange
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.diagnosis.result import Diagnosis, Estimate, Finding, Lead, Score, Step, TrialTrajectories
from slipmargin.diagnosis.separate import separating_trial
from slipmargin.io.json_text import json_text
from slipmargin.report.not_given import with_reasons

SCHEMA = 1


def report_text(diagnosis: Diagnosis, change: LimitsChange) -> str:
    """The file's text; a number that is not finite is null."""
    return json_text(with_reasons(report(diagnosis, change)))


def report(diagnosis: Diagnosis, change: LimitsChange) -> dict[str, Any]:
    """Everything the report holds, as plain values.

    Parameters
    ----------
    change : LimitsChange
        Limits of ``diagnosis.recipe`` and of ``diagnosis.corrected``.
    """
    d = diagnosis
    wheels = tuple(wheel.name for wheel in d.recipe.robot.wheels)
    return {
        "schema": SCHEMA,
        "verdict": d.verdict.value,
        "data_set": d.data_set,
        "robot": d.recipe.robot.name,
        "surface": d.surface,
        "noise": dict(zip(("x_m", "y_m", "phi_rad"), d.noise, strict=True)),
        "noise_estimated": d.noise_estimated,
        "held_out": d.held_out,
        "cross_validated": d.cross_validated,
        "before": _score(d.before),
        "after": _score(d.after),
        "effects": [effect_row(f, wheels) for f in d.findings],
        "evidence": None if d.judgement is None else asdict(d.judgement),
        "rejected": [asdict(r) for r in d.rejected],
        "leads": [_lead(x) for x in d.leads],
        "map": [_entry(e) for e in d.map],
        "map_after": [_entry(e) for e in d.map_after],
        "limits": {"before": limits_row(change.before), "after": limits_row(change.after)},
        "limit_curves": curves_of(change),
        "plan": {
            "move": "1 m diagonally with a quarter turn, slip margin 0.1",
            **_plan(change),
        },
        "not_computed": change.missing,
        "pulls": None if change.pulls is None else asdict(change.pulls),
        "steps": [step_row(s) for s in d.steps],
        "where": [_where(w) for w in d.where],
        "where_after": [_where(w) for w in d.where_after],
        "turns": [asdict(r) for r in d.turns],
        "excitation": d.excitation,
        "events": [
            {"trial": e.trial, "t_s": e.t_s, "channel": e.channel, "size_sigma": e.size_sigma}
            for e in d.events
        ],
        "outliers": d.outliers,
        "data_repairs": [asdict(r) for r in d.repairs],
        "trials": [_trial(t, d) for t in d.trials],
        "remarks": d.remarks,
    }


def _plan(change: LimitsChange) -> dict[str, float | None]:
    plan = change.plan
    return {
        "duration_before_s": None if plan is None else plan.before_s,
        "duration_after_s": None if plan is None else plan.after_s,
        "use_before_believed": None if plan is None else plan.use_believed,
        "use_before_corrected": None if plan is None else plan.use_real,
    }


def _score(score: Score) -> dict[str, float]:
    return {
        "rmse_position_m": score.rmse_position_m,
        "rmse_heading_rad": score.rmse_heading_rad,
        "chi": score.chi,
    }


def effect_row(finding: Finding, wheels: tuple[str, ...]) -> dict[str, Any]:
    """An effect that was found, with its parameters and evidence, as plain data."""
    rivals = finding.confused_with
    return {
        "name": finding.name,
        "label": finding.label,
        "traced_to": finding.traced_to.value,
        "wheels": finding.wheels or wheels,
        "parameters": _estimates(finding.parameters),
        "derived": _estimates(finding.derived),
        "evidence": {
            "chi_without": finding.chi_without,
            "chi_with": finding.chi_with,
            "p_value": finding.p_value,
            "candidates_tried": finding.candidates_tried,
            "confused_with": rivals,
            "separated_by": {r: separating_trial(finding.name, finding.traced_to, r) for r in rivals},
        },
        "name_doubts": finding.doubts,
        "map_supports": finding.mapped,
        "at_bound": [e.name for e in finding.parameters if e.at_bound],
        "equation": finding.equation,
        "confirm": finding.confirm,
    }


def _estimates(estimates: tuple[Estimate, ...]) -> dict[str, Any]:
    return {
        e.name: {"value": e.value, "low": e.low, "high": e.high, "unit": e.unit, "at_bound": e.at_bound}
        for e in estimates
    }


def _lead(lead: Lead) -> dict[str, Any]:
    return {
        "traced_to": lead.traced_to.value,
        "name": lead.candidate,
        "source": lead.source.value,
        "evidence": {"share": lead.share, "p_value": lead.p_value, "why": lead.why},
        "next_run": lead.next_run,
    }


def _entry(entry: MapEntry) -> dict[str, Any]:
    return {
        "traced_to": entry.traced_to.value,
        "form": entry.form,
        "share": entry.share,
        "p_value": entry.p_value,
        "supported": entry.supported,
    }


def limits_row(limits: Limits) -> dict[str, float]:
    """Least and mean pull and acceleration limits of a model as plain data."""
    return {
        "f_max_min_N": limits.f_max_min_N,
        "f_max_mean_N": limits.f_max_mean_N,
        "f_low_min_N": float(limits.f_low_N.min()),
        "f_high_max_N": float(limits.f_high_N.max()),
        "start_min_m_s2": float(limits.start_m_s2.min()),
        "start_mean_m_s2": exact_mean(limits.start_m_s2),
        "brake_min_m_s2": float(limits.brake_m_s2.min()),
        "brake_mean_m_s2": exact_mean(limits.brake_m_s2),
        "spin_rad_s2": limits.spin_rad_s2,
        "spin_worst_rad_s2": limits.spin_worst_rad_s2,
    }


def curves_of(change: LimitsChange) -> dict[str, Any]:
    """Limits over orientation and direction before and after, as plain data."""
    curves: dict[str, Any] = {"phi_rad": change.phi_rad, "direction_rad": change.direction_rad}
    if change.floor_directions > 1:
        curves["floor_directions"] = change.floor_directions
    for name, limits in (("before", change.before), ("after", change.after)):
        curves[name] = {key: getattr(limits, key) for key in (*PULL_CURVES, *MOTION_CURVES)}
    return curves


def step_row(step: Step) -> dict[str, Any]:
    """A round of the search as plain data."""
    return {
        "chi_before": step.chi_before,
        "taken": step.taken,
        "tried": [
            {
                "label": t.label,
                "traced_to": t.traced_to.value,
                "named": t.named,
                "parameters": t.parameters,
                "chi": t.chi,
            }
            for t in step.tried
        ],
    }


def _where(dependence: ResidualDependence) -> dict[str, Any]:
    return {
        "variable": dependence.variable,
        "channel": dependence.channel,
        "share": dependence.share,
        "surprise": dependence.surprise,
        "p_value": dependence.p_value,
    }


def _trial(trial: TrialTrajectories, diagnosis: Diagnosis) -> Mapping[str, Any]:
    return {
        "name": trial.name,
        "held_out": trial.held_out,
        "duration_s": float(trial.t_s[-1] - trial.t_s[0]),
        "samples": len(trial.t_s),
        "chi_before": trial_chi(trial, trial.before, diagnosis),
        "chi_after": trial_chi(trial, trial.after, diagnosis),
    }


def trial_chi(
    trial: TrialTrajectories,
    predicted: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    diagnosis: Diagnosis,
) -> float:
    """Root mean square of (measured − predicted) / noise over one run; NaN where nothing was seen."""
    gap = (trial.measured - predicted) / diagnosis.noise
    seen = gap[np.isfinite(gap)]
    return float(np.sqrt(exact_mean(seen**2))) if len(seen) else float("nan")
