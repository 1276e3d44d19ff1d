"""The limits before and after, and the details, of a diagnosis page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.result import Diagnosis, Step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.report import diagnosis_words as words
from slipmargin.report.diagnosis_json import trial_chi
from slipmargin.report.page import Block, Bullets, Fold, Image, Picture, Table, Text


def pulls(change: LimitsChange) -> tuple[Block, ...]:
    """What pull tests beside the runs say; nothing where there are none."""
    return () if change.pulls is None else (Text(text=words.pulls_sentence(change.pulls)),)


def limits(change: LimitsChange, images: Mapping[str, Image]) -> tuple[Block, ...]:
    """What the found effects change."""
    if not change.moved:
        return (
            Text(
                text="No limit changes: what was found is in how the motion is commanded or measured, "
                "not in what "
                "the wheels can do."
            ),
            *pulls(change),
        )
    b, a = change.before, change.after
    turned = change.floor_directions > 1
    floor_too, worst = (" and direction of the floor", ", each in the floor's worst direction")
    rows = (
        (f"Pull, weakest orientation{floor_too if turned else ''}", b.f_max_min_N, a.f_max_min_N, "N"),
        (f"Pull, mean over orientations{worst if turned else ''}", b.f_max_mean_N, a.f_max_mean_N, "N"),
        ("Pull, lowest over what wheels may stand on", float(b.f_low_N.min()), float(a.f_low_N.min()), "N"),
        ("Speeding up, worst direction", float(b.start_m_s2.min()), float(a.start_m_s2.min()), "m/s²"),
        ("Speeding up, mean", float(b.start_m_s2.mean()), float(a.start_m_s2.mean()), "m/s²"),
        ("Braking, worst direction", float(b.brake_m_s2.min()), float(a.brake_m_s2.min()), "m/s²"),
        ("Braking, mean", float(b.brake_m_s2.mean()), float(a.brake_m_s2.mean()), "m/s²"),
        ("Starting to turn on the spot", b.spin_rad_s2, a.spin_rad_s2, "rad/s²"),
    )
    table = Table(
        caption="Limits of the machine as believed and as corrected",
        head=("limit", "believed", "corrected", "change"),
        rows=tuple(
            (name, words.value(one, unit), words.value(two, unit), words.percent(one, two))
            for name, one, two, unit in rows
        ),
    )
    floor: tuple[Block, ...] = ()
    if "floor" in images:
        floor = (
            Picture(
                name="floor",
                image=images["floor"],
                alt="Map of the floor: where friction differs, with the paths of the runs",
                caption="Seen from above: red is slicker than elsewhere, blue grips more; black: the runs.",
            ),
        )
    return (
        table,
        *(() if change.plan is None else (Text(text=words.plan_sentence(change.plan)),)),
        *pulls(change),
        *floor,
        *(Text(text=sentence) for sentence in change.missing),
        Picture(
            name="limits",
            image=images["limits"],
            alt="Polar plots of limits before and after",
            caption="Seen from above, forwards is up: the pull at the centre that first makes a wheel "
            f"slip{' in the worst direction of the floor' if turned else ''}, and the accelerations along a "
            "straight line without turning.",
        ),
    )


def details(d: Diagnosis) -> tuple[Block, ...]:
    """Every run, every candidate, how well the runs excite the parameters, remarks."""
    runs = Table(
        caption="Error over noise (chi) of every run",
        head=("run", "seen by the fit", "before", "after"),
        rows=tuple(
            (
                t.name,
                "no" if t.held_out else "yes",
                f"{trial_chi(t, t.before, d):.3g}",
                f"{trial_chi(t, t.after, d):.3g}",
            )
            for t in d.trials
        ),
    )
    blocks: list[Block] = [Fold(summary="Every run", blocks=(runs,))]
    loud = f"; a run missed by more than {SETTINGS.loudest:g} times the middle one counts as missed by that"
    blocks += candidates(d.steps, "Every candidate of round {}", "chi", loud)
    if d.excitation:
        text = (
            "Singular values of the fit's whitened Jacobian per unit of parameter: "
            + ", ".join(f"{v:.3g}" for v in d.excitation)
            + ". A value near or below 1 is a combination of parameters about which these runs say nothing."
        )
        blocks.append(Fold(summary="How well the runs excite the parameters", blocks=(Text(text=text),)))
    if d.remarks:
        blocks.append(Bullets(items=d.remarks))
    return tuple(blocks)


def candidates(steps: Sequence[Step], summary: str, chi: str, more: str = "") -> list[Block]:
    """A fold for each round with what was tried; ``chi`` heads the scores, ``more`` says how they count."""
    return [
        Fold(
            summary=summary.format(number),
            blocks=(
                Table(
                    caption=f"Without any of them chi is {step.chi_before:.4g}{more}",
                    head=("candidate", "variable", "parameters", chi),
                    rows=tuple(
                        (f"`{t.label}`", t.traced_to.value, str(t.parameters), f"{t.chi:.4g}")
                        for t in step.tried
                    ),
                ),
            ),
        )
        for number, step in enumerate(steps, 1)
    ]
