"""The sentences of a diagnosis, for the page and the command line."""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Sequence

import numpy as np

from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.plan_change import PlanChange
from slipmargin.diagnosis.pull_check import PullCheck
from slipmargin.diagnosis.result import Diagnosis, Estimate, Finding, LeadSource, Score, Verdict
from slipmargin.diagnosis.separate import separating_trial
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Effect, Trace

#: The variable of a trace as a reader would say it.
VARIABLES: dict[Trace, str] = {
    Trace.WHEEL_ANGLE: "the angle of the wheels",
    Trace.WHEEL_LOAD: "the load on each wheel",
    Trace.SLIP_SPEED: "how fast the contacts slip",
    Trace.SLIP_COUPLING: "slipping in both directions of a wheel at once",
    Trace.SLIP_RATIO: "slip relative to rolling speed",
    Trace.VELOCITY: "the robot's velocity",
    Trace.ACCELERATION: "the robot's acceleration",
    Trace.HEADING: "the heading",
    Trace.POSITION: "the place on the floor",
    Trace.TIME: "time",
    Trace.CONSTANT_FORCE: "a constant force",
    Trace.COEFFICIENT: "the friction coefficients",
    Trace.WHEEL: "a constant of one wheel",
    Trace.ACTUATION: "how the wheels follow their commands",
    Trace.MEASUREMENT: "how the pose is measured",
}


def judged_on(diagnosis: Diagnosis) -> str:
    """The runs whose errors are reported."""
    return "the one run" if diagnosis.one_run else "held-out runs"


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The answer in one sentence, or two where more must be said with it."""
    d = diagnosis
    if d.verdict is Verdict.NO_MISSING_EFFECT:
        runs = "the one run" if d.one_run else "runs it has not seen"
        follows = [lead.traced_to for lead in d.leads[:1] if lead.follows]
        return (
            f"No missing effect: the model predicts {runs} as well as the noise and the log "
            f"allow (chi {d.after.chi:.3g}; 1 is pure noise)."
            + (f" The little that is left follows {VARIABLES[follows[0]]}." if follows else "")
        )
    if d.verdict is Verdict.UNEXPLAINED:
        misses = f"chi {d.before.chi:.3g} on {judged_on(d)}; 1 is pure noise"
        if d.before.chi <= SETTINGS.noise_chi:
            misses += "; errors change as slowly as noise that lasts, but some are larger than it"
        if d.leads and d.leads[0].source is LeadSource.BORNE_OUT:
            return (
                f"Unexplained: the model misses something ({misses}). A correction over "
                f"{VARIABLES[d.leads[0].traced_to]} holds on runs that it has not seen, but these runs leave "
                "it open how large it is: look there first."
            )
        no_proof = (
            "and one run bears out no correction that is fitted to it"
            if d.one_run
            else "but no correction holds on runs that it has not seen"
        )
        return f"Unexplained: the model misses something ({misses}), {no_proof}. {_first_lead(d)}"
    names = listed([_named(f, d) for f in d.findings])
    falls = (
        f"the error on held-out runs falls from {error(d.before)} to {error(d.after)}"
        if d.after.chi < d.before.chi
        else f"the error on held-out runs goes from {error(d.before)} to {error(d.after)}"
    )
    sentence = f"The model lacks {names}; with {'it' if len(d.findings) == 1 else 'them'} {falls}."
    if in_part(d):
        sentence = (
            f"Found in part: {sentence[0].lower()}{sentence[1:]} What remains is still {d.after.chi:.3g} "
            "times the noise, so something else is missing or the form is only approximate."
        )
    return sentence


def in_part(diagnosis: Diagnosis) -> bool:
    """Whether something was found and what it leaves on held-out runs is well above the noise."""
    return diagnosis.verdict is Verdict.EFFECT_FOUND and diagnosis.after.chi > SETTINGS.noise_chi


def certain(diagnosis: Diagnosis) -> bool:
    """Whether the answer needs no second look: nothing left, no other name as good."""
    d = diagnosis
    unsure = in_part(d) or any(f.confused_with or f.doubts for f in d.findings)
    return d.verdict is not Verdict.UNEXPLAINED and not unsure


def open_questions(diagnosis: Diagnosis) -> bool:
    """Whether further runs are to decide something: leads, or names that cannot be told apart."""
    return bool(diagnosis.leads) or any(f.confused_with for f in diagnosis.findings)


def next_run_command(diagnosis: Diagnosis) -> str:
    """The command that proposes the runs to drive next; of a campaign for the data set that fits worst."""
    noise = diagnosis.noise
    worst = max(diagnosis.trials, key=lambda t: float(np.nansum(((t.measured - t.after) / noise) ** 2)))
    return f"slipmargin next-run {shlex.quote(worst.data_set)}"


#: So many names that cannot be told apart are still read; the rest are counted, and listed with the finding.
_FEW = 4


def on_wheels(finding: Finding, diagnosis: Diagnosis) -> str:
    """`` of wheel 2`` where not all wheels have it, else nothing."""
    few = 0 < len(finding.wheels) < len(diagnosis.recipe.robot.wheels)
    return f" of wheel{'s' if len(finding.wheels) > 1 else ''} {listed(finding.wheels)}" if few else ""


def called(finding: Finding, diagnosis: Diagnosis) -> str:
    """A finding's name with its wheel, or with what its general form is free in."""
    form = finding.label.startswith(f"{finding.name}:")
    return finding.label if form else finding.name + on_wheels(finding, diagnosis)


def _named(finding: Finding, diagnosis: Diagnosis) -> str:
    own = called(finding, diagnosis)
    names = list(dict.fromkeys([own, *(_short(label) for label in finding.confused_with)]))
    if len(names) > _FEW:
        few, more = " or ".join(names[: _FEW - 1]), len(names) - _FEW + 1
        return f"{few} or one of {more} others (these runs cannot tell them apart)"
    if len(names) > 1:
        return f"{' or '.join(names)} (these runs cannot tell them apart)"
    return f"{own} (depends on {VARIABLES[finding.traced_to]})"


def _short(label: str) -> str:
    """A candidate's label without the form of a general one, and with its wheel in words."""
    return re.sub(r"\[(.*?)\]", r" of wheel \1", label.split(": ", 1)[0])


def _first_lead(d: Diagnosis) -> str:
    if not d.leads:
        return "The residual follows no measured variable significantly."
    first = d.leads[0]
    if first.follows:
        return f"The residual follows {VARIABLES[first.traced_to]}: look there first."
    if first.source is LeadSource.MAP:
        return f"No measured variable stands out; {VARIABLES[first.traced_to]} comes nearest."
    return f"First to look at, without proof: {VARIABLES[first.traced_to]}."


def meaning(finding: Finding) -> str:
    """What an effect is, in one plain sentence."""
    if finding.doubts:
        return f"An effect that is written as {plain(finding.label)}; its evidence does not carry the name."
    if isinstance(finding.effect, Effect):
        return finding.effect.summary
    return "An effect that no entry of the catalogue explains, added in a general form."


def error(score: Score) -> str:
    """Held-out error: position in mm, heading in mrad, chi."""
    return (
        f"{1e3 * score.rmse_position_m:.3g} mm and {1e3 * score.rmse_heading_rad:.3g} mrad "
        f"(chi {score.chi:.3g})"
    )


def interval(estimate: Estimate) -> str:
    """``name = value (low … high) unit``, with as many digits as its interval supports."""
    return f"{estimate.name} = {number(estimate)}{_unit(estimate.unit)}{edge(estimate)}"


def number(estimate: Estimate) -> str:
    """``value (low … high)``; the value alone where it has no interval: a count that was tried."""
    if estimate.low == estimate.high:
        return f"{estimate.value:g}"
    digits = decimals(estimate.high - estimate.low, estimate.value)
    return f"{estimate.value:.{digits}f} ({estimate.low:.{digits}f} … {estimate.high:.{digits}f})"


def decimals(width: float, value: float) -> int:
    """Decimal places that show two digits of an interval's width (or four of the value)."""
    size = width if math.isfinite(width) and width > 0.0 else 1e-2 * abs(value) or 1.0
    return max(0, min(9, 1 - math.floor(math.log10(size))))


def edge(estimate: Estimate) -> str:
    """A note where a parameter ended on the edge of its range."""
    return ", at the edge of its range" if estimate.at_bound else ""


def p_words(p_value: float) -> str:
    """A p-value, with no more digits than the permutations support."""
    return f"p ≤ {p_value:.1g}" if p_value <= 0.01 else f"p = {p_value:.2g}"


def search_words(finding: Finding) -> str:
    """The p-value of the round of the search that tried an effect, or that none did (its value is 1 then)."""
    return p_words(finding.p_value) if finding.p_value < 1.0 else "no round compared it"


def plain(label: str) -> str:
    """A candidate's label or a variable's name without underscores."""
    return label.removeprefix("unnamed_").replace("_", " ")


def _unit(unit: str) -> str:
    return "" if unit in ("", "1") else f" {unit}"


def listed(parts: Sequence[str]) -> str:
    """Parts in one phrase: "a, b and c"."""
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def percent(before: float, after: float) -> str:
    """``−38 %``."""
    if math.isnan(before) or math.isnan(after):
        return ""
    if not before > 0.0:
        return "unchanged" if after == before else ""
    share = 100.0 * (after / before - 1.0)
    if abs(share) < 0.05:
        return "unchanged"
    return f"{share:+.{0 if abs(share) >= 10.0 else 1}f} %".replace("-", "−")


def plan_sentence(change: PlanChange) -> str:
    """The duration of the standard move before and after, and whether the old plan slips."""
    move = "A standard move (1 m diagonally with a quarter turn, a tenth of the grip in reserve)"
    if change.before_s is None or change.use_believed is None:
        return f"{move} has no plan without slip in the model as believed."
    old = f"{move} was planned to take {change.before_s:.3g} s with the model as believed"
    if change.use_real is None or change.use_real > 1.0:
        share = (
            ""
            if change.use_real is None
            else f" (it asks a wheel for {100 * change.use_real:.0f} % of its grip)"
        )
        verdict = f"the corrected model says that this plan slips{share}"
    else:
        verdict = f"by the corrected model it takes up to {100 * change.use_real:.0f} % of a wheel's grip"
    if change.after_s is None:
        return f"{old}; {verdict}, and finds no way to make the move without slip."
    return f"{old}; {verdict}. Planned anew it takes {change.after_s:.3g} s."


def pulls_sentence(check: PullCheck) -> str:
    """Whether pull tests, to which nothing was fitted, confirm the corrected robot, or their gap."""
    one, two = check.rms_before_N, check.rms_after_N
    noise = "" if check.noise_N is None else f"; the stated noise is {check.noise_N:.3g} N"
    tests = f"{check.count} pull tests, which nothing was fitted to"
    differ = f"measured and predicted force differ by {one:.3g} N (root mean square)"
    if math.isclose(one, two, rel_tol=1e-6, abs_tol=1e-9):
        mean, side = abs(check.mean_after_N), "less" if check.mean_after_N < 0.0 else "more"
        return f"{tests}: {differ}, the measured one is {mean:.3g} N {side} in the mean{noise}."
    said = "confirm it" if two < 0.8 * one else "do not decide" if two <= 1.2 * one else "speak against it"
    after = f"with the model as believed, {two:.3g} N with the corrected one"
    return f"{tests}, {said}: {differ} {after}{noise}."


def arrow(before: float, after: float, unit: str) -> str:
    """``4.92 → 4.6 N (−6.5 %)``."""
    if math.isnan(before) or math.isnan(after):
        return f"{value(before, unit)} → {value(after, unit)}"
    return f"{before:.3g} → {after:.3g} {unit} ({percent(before, after) or 'new'})"


def value(number: float, unit: str) -> str:
    """``4.92 N``, or that it could not be computed."""
    return "not computed" if math.isnan(number) else f"{number:.3g} {unit}"


def over_orientations(change: LimitsChange) -> str:
    """What the weakest pull is the weakest of."""
    floor = " and directions of the floor" if change.floor_directions > 1 else ""
    return f"over all orientations{floor}"


def pull_lines(change: LimitsChange) -> list[str]:
    """Weakest and mean pull before and after."""
    b, a = change.before, change.after
    floor = ", each orientation in the floor's worst direction" if change.floor_directions > 1 else ""
    if not change.moved:
        pulls = f"weakest pull {b.f_max_min_N:.3g} N, mean {b.f_max_mean_N:.3g} N"
        return [f"limits   unchanged: {pulls}{floor}"]
    return [
        f"limits   weakest pull {arrow(b.f_max_min_N, a.f_max_min_N, 'N')}, mean "
        f"{arrow(b.f_max_mean_N, a.f_max_mean_N, 'N')}{floor}"
    ]


def summary_lines(d: Diagnosis, change: LimitsChange) -> list[str]:
    """Verdict, effects, error and limits before and after: what the command prints."""
    lines = [f"{d.verdict.value}: {verdict_sentence(d)}"]
    for f in d.findings:
        values = ", ".join(interval(e) for e in f.parameters[:4])
        more = f", and {len(f.parameters) - 4} more" if len(f.parameters) > 4 else ""
        lines.append(
            f"found    {called(f, d)} (traced to {f.traced_to.value}; {search_words(f)} among "
            f"{f.candidates_tried} candidates): {values}{more}"
        )
        lines += [
            f"         cannot be distinguished from {name}: {separating_trial(f.name, f.traced_to, name)}"
            for name in f.confused_with
        ]
        lines += [f"         doubt: {doubt}" for doubt in f.doubts]
    if not d.findings:
        lines += [
            f"lead {i}   {VARIABLES[lead.traced_to]}: {lead.why}" for i, lead in enumerate(d.leads[:3], 1)
        ]
    lines.append(
        f"error    {error(d.before)}" + (f" → {error(d.after)}" if d.findings else "") + f" on {judged_on(d)}"
    )
    lines += pull_lines(change)
    b, a = change.before, change.after
    if change.moved:
        high = arrow(float(b.f_high_N.max()), float(a.f_high_N.max()), "N")
        start = arrow(float(b.start_worst_m_s2.min()), float(a.start_worst_m_s2.min()), "m/s²")
        turn = arrow(b.spin_worst_rad_s2, a.spin_worst_rad_s2, "rad/s²")
        lines += [
            f"         whatever the wheels stand on: strongest pull {high}, least start {start}",
            f"         turning on the spot {turn}",
        ]
    if change.pulls is not None:
        lines.append(f"pulls    {pulls_sentence(change.pulls)}")
    if open_questions(d):
        lines.append(f"next     the runs that would decide: {next_run_command(d)}")
    lines += [f"data     {repair.sentence}" for repair in d.repairs]
    lines += [f"note     {remark}" for remark in (*change.missing, *d.remarks)]
    return lines
