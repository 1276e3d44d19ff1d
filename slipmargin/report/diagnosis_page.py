"""``report.html``: the page that shows a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.result import Diagnosis, Verdict
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.report import diagnosis_words as words
from slipmargin.report.diagnosis_details import details, limits, pulls
from slipmargin.report.diagnosis_evidence import evidence, next_steps, parameters, residual_map
from slipmargin.report.diagnosis_json import trial_chi
from slipmargin.report.page import (
    Block,
    Bullets,
    Fact,
    Facts,
    Image,
    Page,
    Picture,
    Section,
    Text,
)
from slipmargin.report.text import two_digits


def page(diagnosis: Diagnosis, change: LimitsChange, images: Mapping[str, Image]) -> Page:
    """The page as data: verdict, measurement, misfit, reason, evidence, parameters, limits, next steps.

    Parameters
    ----------
    images : mapping
        The drawn figures by name, as :func:`slipmargin.plots.diagnosis.figures` names them.
    """
    d = diagnosis
    found = bool(d.findings)
    sections = [
        Section(heading="The answer in numbers", blocks=(_facts(d, change),)),
        Section(heading="What was measured", blocks=_measured(d)),
        *_mended(d),
        Section(
            heading="What did not fit" if d.verdict is not Verdict.NO_MISSING_EFFECT else "How it fits",
            blocks=_misfit(d, images),
        ),
        Section(heading="Why: the candidates", blocks=_candidates(d, images)),
        Section(heading=f"The evidence: {_unseen(d)}", blocks=(*evidence(d), _held_out(d, images))),
    ]
    if found:
        sections.append(Section(heading="What was found", blocks=parameters(d)))
        sections.append(Section(heading="What it changes", blocks=limits(change, images)))
    elif change.pulls is not None:
        sections.append(Section(heading="Pull tests", blocks=pulls(change)))
    sections.append(Section(heading="What to do next", blocks=next_steps(d)))
    sections.append(Section(heading="Details", blocks=details(d)))
    return Page(
        title=f"Diagnosis of {d.recipe.robot.name} on {d.surface}: data set {d.data_set}",
        lead=words.verdict_sentence(d),
        lead_kind="good" if words.certain(d) else "attention",
        sections=tuple(sections),
        foot="Written by slipmargin diagnose. chi is the root mean square of (measured − predicted) / "
        "noise over "
        "x, y and heading: 1 is pure noise.",
    )


def _unseen(d: Diagnosis) -> str:
    """What the errors are those of."""
    if d.one_run:
        return "one run, of which none was held out"
    return (
        "runs that no fit has seen" if d.held_out or not d.findings else "each run predicted without itself"
    )


def _facts(d: Diagnosis, change: LimitsChange) -> Facts:
    def pair(before: float, after: float, unit: str) -> str:
        if not d.findings:
            return f"{after:.3g} {unit}".strip()
        return f"{before:.3g} → {after:.3g} {unit}".strip()

    held = _unseen(d)
    facts = [
        Fact(
            label="Position error",
            note=held,
            value=pair(1e3 * d.before.rmse_position_m, 1e3 * d.after.rmse_position_m, "mm"),
        ),
        Fact(
            label="Heading error",
            note=held,
            value=pair(1e3 * d.before.rmse_heading_rad, 1e3 * d.after.rmse_heading_rad, "mrad"),
        ),
        Fact(
            label="Error over noise (chi)", value=pair(d.before.chi, d.after.chi, ""), note="1 is pure noise"
        ),
        Fact(
            label="Weakest pull before slip",
            note=f"{words.over_orientations(change)}, on rollers",
            value=pair(change.before.f_max_min_N, change.after.f_max_min_N, "N"),
        ),
    ]
    return Facts(facts=tuple(facts))


def _measured(d: Diagnosis) -> tuple[Block, ...]:
    spans = np.array([t.t_s[-1] - t.t_s[0] for t in d.trials])
    step = float(np.median(np.concatenate([np.diff(t.t_s) for t in d.trials])))
    sigma = "as the data show it" if d.noise_estimated else "as stated with the data"
    x, y, phi = (float(v) for v in 1e3 * d.noise)
    runs = f"{len(d.trials)} runs"
    if d.one_run:
        runs = "One run" if len(d.trials) == 1 else f"One run in {len(d.trials)} parts"
        held = "There is no other: none was held out, and the model was compared with it as it stands."
    elif d.cross_validated:
        held = f"Each run was predicted with parameters fitted to the others (cross-validation over {runs})."
    else:
        held = f"{len(d.held_out)} of them ({', '.join(d.held_out)}) were set aside before any fit."
    items = [
        f"{runs} of {_range(spans)} s, a sample every {1e3 * step:.3g} ms. {held}",
        f"Measurement noise, {sigma}: {two_digits(x)} mm in x, {two_digits(y)} mm in y, {two_digits(phi)} "
        "mrad in heading.",
    ]
    if d.outliers:
        items.append(f"{d.outliers} outlying sample{'s' if d.outliers != 1 else ''} left out.")
    for e in d.events:
        items.append(
            f"An event, not physics: in {e.trial} at {e.t_s:.2f} s `{e.channel}` jumps by "
            f"{e.size_sigma:.3g} times the noise (a bump, a lost camera frame, a hand)."
        )
    known = [e.name for e in d.recipe.effects]
    if known:
        items.append(f"The robot file already holds: {', '.join(f'`{name}`' for name in known)}.")
    return (Bullets(items=tuple(items)),)


def _mended(d: Diagnosis) -> tuple[Section, ...]:
    """What was mended in the data, a line each; no section where nothing was."""
    if not d.repairs:
        return ()
    items = tuple(r.sentence for r in d.repairs)
    return (Section(heading="What was mended in the data", blocks=(Bullets(items=items),)),)


def _range(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.3g}" if high - low < 0.05 * high else f"{low:.3g} to {high:.3g}"


def _misfit(d: Diagnosis, images: Mapping[str, Image]) -> tuple[Block, ...]:
    worst = max(d.trials, key=lambda t: np.nan_to_num(trial_chi(t, t.before, d)))
    chi = trial_chi(worst, worst.before, d)
    if d.verdict is Verdict.NO_MISSING_EFFECT and chi <= SETTINGS.noise_size:
        first = (
            f"Nothing sticks out. The run that fits worst ({worst.name}) has chi {chi:.3g}: the colours "
            f"below are "
            "the noise of the measurement."
        )
    else:
        first = (
            f"The model as it stands, before any fit. The run that fits worst ({worst.name}) is off by "
            f"{chi:.3g} times the noise."
        )
    blocks: list[Block] = [
        Text(text=first),
        Picture(
            name="residual",
            image=images["residual"],
            alt="Heat map: a row for each run, time along it, colour the residual in units of the noise",
            caption="Measured minus predicted, one row a run. White is a perfect prediction, pale "
            "colours are "
            "noise; grey was not measured. The colour scale is linear up to 3 σ, logarithmic beyond.",
        ),
    ]
    blocks += residual_map(d)
    if d.where:
        blocks += [
            Picture(
                name="where",
                image=images["where"],
                alt="Bars: share of the residual explained by each variable and channel",
                caption="How much of the unexplained motion each measured variable accounts for by itself, "
                "seen from the robot (sideways, forwards, turning). Variables go together (a robot that "
                "accelerates also slips): a hint, nothing is decided by it.",
            ),
        ]
    return tuple(blocks)


def _candidates(d: Diagnosis, images: Mapping[str, Image]) -> tuple[Block, ...]:
    if not d.steps:
        return (Text(text="No candidate was tried."),)
    tried = max([*(len(s.tried) for s in d.steps), *(f.candidates_tried for f in d.findings)])
    compared = (
        "on the run they are fitted to, for there is no other"
        if d.one_run
        else "on the runs they are fitted to and on runs left out of the fit, half and half"
    )
    decided = (
        "No proposal is claimed: one run bears out nothing that is fitted to it."
        if d.one_run
        else "Whether a proposal is claimed is decided below, by runs that it has not seen."
    )
    text = (
        f"Candidates: {tried}. They are effects with a name, and for every measured variable a general form "
        "with free coefficients. The search estimates by tangents what each could explain, and fits the most "
        "promising by simulation; where none promises enough, the picture shows the estimates. It compares "
        f"them by the error {compared}. The best is proposed if it makes that "
        f"error clearly smaller and its permutation p-value is at most {SETTINGS.significance:g}; "
        f"then the search starts again with it in the model. {decided}"
    )
    return (
        Text(text=text),
        Picture(
            name="candidates",
            image=images["candidates"],
            alt="Dots: error of every candidate on the runs that the search compares",
            caption="Error that remains with each candidate added (further left is better). Filled: an "
            "effect with a name; open: a general form over one variable; orange: taken. Candidates that a "
            "first, short fit leaves far behind are not fitted to the end.",
        ),
    )


def _held_out(d: Diagnosis, images: Mapping[str, Image]) -> Picture:
    if d.findings and d.held_out:
        caption = "Runs that no fit has seen. Where blue runs through the dots, the correction predicts them."
    elif d.findings:
        caption = (
            "Measured runs, before and after the correction. Its parameters were fitted to these runs too."
        )
    else:
        caption = "Measured runs and the model's prediction of them."
    return Picture(
        name="held-out",
        image=images["held-out"],
        alt=f"Measured and predicted paths and headings of {words.judged_on(d)}",
        caption=f"{caption} Each prediction begins at the pose that fits its run best, as for the errors.",
    )
