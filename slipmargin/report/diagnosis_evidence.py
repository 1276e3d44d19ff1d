"""The evidence, the parameters and the advice of a diagnosis page."""

from __future__ import annotations

from slipmargin.diagnosis.result import Diagnosis, Finding, Verdict
from slipmargin.diagnosis.separate import separating_trial
from slipmargin.io.robot_text import effect_text
from slipmargin.report import diagnosis_words as words
from slipmargin.report.page import Block, Bullets, Code, Fold, Table, Text

#: Parameters of a general form that the page spells out.
_SHOWN = 12
#: The true model, with the wheels' motion rebuilt from a log, reaches chi 1.03 to 1.10.
NOTICEABLE = 1.15


def evidence(d: Diagnosis) -> tuple[Block, ...]:
    """Before and after on held-out runs, and the test of every finding."""
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
        table = Table(
            caption="Error on held-out runs", head=("error", "value"), rows=tuple(r[:2] for r in rows)
        )
        return (table,)
    blocks: list[Block] = [
        Table(
            caption="Error on held-out runs", head=("error", "as believed", "corrected", "change"), rows=rows
        )
    ]
    tests = tuple(
        (
            f"`{f.name}`",
            f"{f.chi_without:.3g}",
            f"{f.chi_with:.3g}",
            words.p_words(f.p_value),
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
            text="The p-value is that of a permutation test: the probability that the best of all candidates "
            "tried gains as much from surrogate noise alone. The number of candidates is already counted in."
        )
    )
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
        sure = [w for w in d.where_after if w.p_value <= 0.05]
        follows = max(sure, key=lambda w: w.share) if sure else None
        rest = (
            f"depends most on {words.plain(follows.variable)} ({100 * follows.share:.0f} % of its "
            f"{words.CHANNEL_WORDS[follows.channel]} part)"
            if follows
            else "depends significantly on no measured variable"
        )
        blocks.append(Text(text=f"What remains (chi {d.after.chi:.3g}) {rest}."))
    return tuple(blocks)


def _rival(finding: Finding, name: str) -> str:
    return f"`{finding.name}` or `{name}`: {separating_trial(finding.name, finding.traced_to, name)}."


def parameters(d: Diagnosis) -> tuple[Block, ...]:
    """What each effect is, its equation and its numbers."""
    blocks: list[Block] = []
    for f in d.findings:
        few = 0 < len(f.wheels) < len(d.recipe.robot.wheels)
        wheels = f" On wheel{'s' if len(f.wheels) > 1 else ''} {', '.join(f.wheels)}." if few else ""
        blocks.append(
            Text(text=f"`{f.name}`: {words.meaning(f)} It depends on {words.VARIABLES[f.traced_to]}.{wheels}")
        )
        if f.equation:
            blocks.append(Code(text=f.equation))
        shown = (*f.parameters[:_SHOWN], *f.derived)
        rows = tuple(
            (f"`{e.name}`", words.number(e), "" if e.unit == "1" else e.unit, words.edge(e).lstrip(", "))
            for e in shown
        )
        more = len(f.parameters) - _SHOWN
        note = f"; {more} more coefficients are in report.json" if more > 0 else ""
        blocks.append(
            Table(
                caption=f"Value and interval (95 % for all together){note}",
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
        return (
            Text(
                text="Nothing. These runs give no reason to add anything to the model, and its limits "
                "stand as "
                "they were. This says nothing about motions that these runs do not contain: other floors, "
                "speeds, loads."
            ),
        )
    if d.verdict is Verdict.UNEXPLAINED:
        ruled = sorted({t.traced_to for s in d.steps for t in s.tried}, key=lambda trace: trace.value)
        names = ", ".join(words.VARIABLES[t] for t in ruled)
        items = [
            "Do not trust the limits of this model beyond the error shown above.",
            f"Ruled out as the whole explanation, in a general form each: {names}."
            if names
            else "Nothing could be ruled out.",
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
