"""The evidence, the parameters and the advice of a diagnosis page."""

from __future__ import annotations

from slipmargin.diagnosis.result import Diagnosis, Finding, LeadSource, Verdict
from slipmargin.diagnosis.separate import separating_trial
from slipmargin.diagnosis.verdict import Judgement
from slipmargin.io.robot_text import effect_text
from slipmargin.report import diagnosis_words as words
from slipmargin.report.page import Block, Bullets, Code, Fold, Table, Text

#: Parameters of a general form that the page spells out.
_SHOWN = 12
#: The true model, with the wheels' motion rebuilt from a log, reaches chi 1.03 to 1.10.
NOTICEABLE = 1.15


def evidence(d: Diagnosis) -> tuple[Block, ...]:
    """Before and after on held-out runs, or on the one run there is, and the test of every finding."""
    names = ("position, rms", "heading, rms", "error over noise (chi)")
    b, a = d.before, d.after
    cells = (
        (1e3 * b.rmse_position_m, 1e3 * a.rmse_position_m, " mm"),
        (1e3 * b.rmse_heading_rad, 1e3 * a.rmse_heading_rad, " mrad"),
        (b.chi, a.chi, ""),
    )
    rows = tuple(
        (name, f"{one:.3g}{unit}", f"{two:.3g}{unit}", words.percent(one, two))
        for name, (one, two, unit) in zip(names, cells, strict=True)
    )
    if not d.findings:
        caption = f"Error on {words.judged_on(d)}"
        table = Table(caption=caption, head=("error", "value"), rows=tuple(r[:2] for r in rows))
        return (table, *_rejected(d))
    blocks: list[Block] = [
        Table(
            caption="Error on held-out runs", head=("error", "as believed", "corrected", "change"), rows=rows
        )
    ]
    if d.judgement is not None:
        blocks.append(Text(text=_judged(d.judgement, bool(d.held_out))))
    tests = tuple(
        (
            f"`{f.name}`",
            f"{f.chi_without:.3g}",
            f"{f.chi_with:.3g}",
            words.search_words(f),
            str(f.candidates_tried),
        )
        for f in d.findings
    )
    blocks.append(
        Table(
            caption="Each effect on its own: chi with the others in the model, without and with this one",
            head=("effect", "chi without", "chi with", "p-value", "candidates tried"),
            rows=tests,
        )
    )
    blocks.append(
        Text(
            text="The p-value is that of a permutation test on the searched runs: the probability that "
            "the best of the candidates compared gains as much from surrogate noise alone."
        )
    )
    blocks += [Text(text=f"`{f.label}`: {_traced(f)}") for f in d.findings]
    blocks += [
        Text(text=f"The name `{f.label}` is not claimed: {doubt}.") for f in d.findings for doubt in f.doubts
    ]
    blocks += _rejected(d)
    rivals = tuple(_rival(f, name) for f in d.findings for name in f.confused_with)
    if rivals:
        blocks.append(
            Text(
                text="These runs cannot distinguish some effects. Either may be the true one until a run "
                "separates them:"
            )
        )
        blocks.append(Bullets(items=rivals))
    else:
        blocks.append(Text(text="No other candidate explains these runs as well."))
    if d.after.chi > NOTICEABLE:
        sure = [e for e in d.map_after if e.supported]
        if not d.map_after:
            rest = "was not compared with the variables again"
        elif sure:
            rest = (
                f"follows {words.VARIABLES[sure[0].traced_to]} ({sure[0].form}: "
                f"{100 * sure[0].share:.2g} % of the squared residual of runs left out, "
                f"p = {sure[0].p_value:.2g})"
            )
        else:
            rest = "follows none of the variables of the residual map significantly"
        blocks.append(Text(text=f"What remains (chi {d.after.chi:.3g}) {rest}."))
    return tuple(blocks)


def residual_map(d: Diagnosis) -> list[Block]:
    """The residual map as a table."""
    if not d.map:
        return []
    rows = tuple(
        (
            words.VARIABLES[e.traced_to],
            e.form,
            f"{100 * e.share:.2g} %".replace("-", "−"),
            f"{e.p_value:.2g}",
        )
        for e in d.map
    )
    on = "the one run, which it is fitted to" if d.one_run else "runs left out"
    return [
        Table(
            caption="The residual map: share of the squared residual that the best candidate of each "
            f"variable takes off on {on}, "
            "and how likely noise alone gives the best of all as much",
            head=("variable", "candidate", "takes off", "p-value"),
            rows=rows,
        ),
    ]


def _judged(j: Judgement, held_out: bool) -> str:
    where = "On the runs that nothing has seen" if held_out else "On these runs, which chose the correction,"
    return (
        "Judged on every run, each predicted with parameters that were fitted to others: chi falls from "
        f"{j.chi_before:.3g} to {j.chi_after:.3g}; of {j.runs} runs whose error changes by more than noise "
        f"{j.better} get better (paired permutation over runs, {words.p_words(j.p_value)}), {j.worse} "
        f"clearly worse. {where} {100 * j.explained:.0f} % of the mean square "
        "beyond the noise is explained."
    )


def _traced(f: Finding) -> str:
    variable = words.VARIABLES[f.traced_to]
    if f.mapped is None:
        return f"it depends on {variable}, of which the residual map can say nothing: this rests on the fit."
    if f.mapped:
        return f"it is traced to {variable}, and the residual map supports this."
    return f"it depends on {variable}, which the residual map does not support: this rests on the fit."


def _rejected(d: Diagnosis) -> list[Block]:
    """What was proposed and not claimed, with the first reason."""
    if not d.rejected:
        return []
    return [
        Text(text="Proposed by the search, and not claimed:"),
        Bullets(items=tuple(f"`{' + '.join(r.labels)}`: {'; '.join(r.failures)}." for r in d.rejected)),
    ]


def _rival(finding: Finding, name: str) -> str:
    return f"`{finding.name}` or `{name}`: {separating_trial(finding.name, finding.traced_to, name)}."


def parameters(d: Diagnosis) -> tuple[Block, ...]:
    """What each effect is, its equation and its numbers."""
    blocks: list[Block] = []
    for f in d.findings:
        blocks.append(
            Text(
                text=f"`{f.name}`{words.on_wheels(f, d)}: {words.meaning(f)} It is traced to "
                f"{words.VARIABLES[f.traced_to]}."
            )
        )
        if f.equation:
            blocks.append(Code(text=f.equation.replace("``", "")))
        shown = (*f.parameters[:_SHOWN], *f.derived)
        rows = tuple(
            (f"`{e.name}`", words.number(e), "" if e.unit == "1" else e.unit, words.edge(e).lstrip(", "))
            for e in shown
        )
        more = len(f.parameters) - _SHOWN
        note = f"; {more} more coefficients are in report.json" if more > 0 else ""
        blocks.append(
            Table(
                caption=f"Value and interval (95 % each){note}",
                head=("parameter", "value", "unit", ""),
                rows=rows,
            )
        )
        blocks.append(
            Fold(summary="As it stands in corrected.toml", blocks=(Code(text=effect_text(f.effect)),))
        )
    return tuple(blocks)


def next_steps(d: Diagnosis) -> tuple[Block, ...]:
    """Advice: what to confirm, what to separate, how to use the correction; or what was ruled out."""
    if d.verdict is Verdict.NO_MISSING_EFFECT:
        if d.leads:
            return (
                Text(
                    text="Nothing has to be done: the limits of the model stand as they were. What is left "
                    "is near the noise, but it is no chance. Whoever wants it smaller looks here:"
                ),
                Bullets(items=(*_leads(d), *_drive_next(d)), numbered=True),
            )
        return (
            Text(
                text="Nothing. These runs give no reason to add anything to the model, and its limits "
                "stand as "
                "they were. This says nothing about motions that these runs do not contain: other floors, "
                "speeds, loads."
            ),
        )
    if d.verdict is Verdict.UNEXPLAINED:
        left_open = {lead.traced_to for lead in d.leads if lead.source is LeadSource.BORNE_OUT}
        ruled = sorted(
            {t.traced_to for s in d.steps for t in s.tried} - left_open, key=lambda trace: trace.value
        )
        names = ", ".join(words.VARIABLES[t] for t in ruled)
        unseen = "one run alone" if d.one_run else "unseen runs"
        items = [
            *_leads(d),
            *_drive_next(d),
            "Do not trust the limits of this model beyond the error shown above.",
            f"Tried in a general form each, and not borne out by {unseen}: {names}."
            if names
            else "Nothing could be tried.",
            "Check the log first: the same clock for camera and wheels, wheel numbers in the robot "
            "file's order, "
            "signs of the wheel speeds, the units.",
            "Then repeat one run exactly, several times: if the runs differ from each other as much as "
            "from the "
            "model, the cause is in what was not recorded.",
        ]
        return (Bullets(items=tuple(items), numbered=True),)
    items = [f"Confirm `{f.name}`: {f.confirm}." for f in d.findings if f.confirm]
    items += [f"Separate {_rival(f, name)}" for f in d.findings for name in f.confused_with]
    items += _drive_next(d)
    stuck = [f"`{f.name}.{e.name}`" for f in d.findings for e in f.parameters if e.at_bound]
    if stuck:
        items.append(
            f"Doubt {', '.join(stuck)}: the fit ended at the edge of the range, so the true cause may be "
            "another one."
        )
    items.append(
        "Use `corrected.toml` in place of the robot file: every command accepts it "
        f"(`slipmargin sweep corrected.toml --surface {d.surface}`)."
    )
    return (Bullets(items=tuple(items), numbered=True),)


def _leads(d: Diagnosis) -> list[str]:
    """Each lead with its reason and the run that confirms or refutes it."""
    return [
        f"{words.VARIABLES[lead.traced_to][0].upper()}{words.VARIABLES[lead.traced_to][1:]}: {lead.why}. "
        f"To confirm or refute it, {lead.next_run}."
        for lead in d.leads
    ]


def _drive_next(d: Diagnosis) -> list[str]:
    """The command that proposes runs, where something is open."""
    if not words.open_questions(d):
        return []
    return [
        f"Drive this next: `{words.next_run_command(d)}` proposes runs, with commands, that tell what is "
        "left apart, within the limits and in the space that you give."
    ]
