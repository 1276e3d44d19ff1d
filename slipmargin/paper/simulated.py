"""Sections III.B.1 and IV.C: what the text says of the simulated runs, initial and improved model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from slipmargin.paper.numbers import BY_KEY, MEASURED_CARPET_PHI_RAD, published
from slipmargin.paper.published import DISTANCE_M, DURATION_S, FOUND, Unprinted, straight_line
from slipmargin.paper.rows import SPEED_M_S, Row, claim, end_of, number, sample_at, unchecked
from slipmargin.sim.run import Run

#: Runs of the paper by (surface, whether the model is the improved one).
Runs = Mapping[tuple[str, bool], Run]
#: Drive slip above this share of the commanded speed counts as slipping.
SLIPPING = 0.02
#: Two curves closer than this share of a figure's full scale look identical in it.
LINE_WIDTH = 0.01


def paper_runs(unprinted: Unprinted = FOUND) -> Runs:
    """The four straight-line runs: paper and carpet, initial and improved model."""
    return {
        (s, improved): straight_line(s, improved=improved, unprinted=unprinted)
        for s in ("paper", "carpet")
        for improved in (False, True)
    }


def initial_rows(unprinted: Unprinted, runs: Runs) -> list[Row]:
    """Section III.B.1: rollers only."""
    run, carpet = runs["paper", False], runs["carpet", False]
    stop = sample_at(run, DURATION_S)
    x, y, phi = end_of(run)
    phis = run.pose[: stop + 1, 2]
    peak = int(np.argmax(np.abs(phis)))
    slip = np.abs(run.slip[..., 0])
    middle = slip[(run.t_s > 0.3) & (run.t_s < DURATION_S)].max()
    at_stop = DISTANCE_M - run.pose[stop, 0]
    between = f"14 mm lies between {1e3 * x:.1f} mm after stopping and {1e3 * at_stop:.1f} mm at 3.5 s"
    turned = abs(float(carpet.pose[-1, 2]))
    measured = float(np.mean(MEASURED_CARPET_PHI_RAD))
    return [
        number("initial_paper_x_short", x, f"DISCREPANCY: after stopping; {between}"),
        number(
            "initial_paper_x_short_at_stop",
            at_stop,
            f"DISCREPANCY: at t = 3.5 s, before it stands still; {between}",
        ),
        number("initial_paper_y", y, "after stopping"),
        number("initial_paper_phi", phi, "after stopping"),
        _steady(run),
        *_both_ends(run, "initial"),
        claim(
            "initial_no_slip_in_the_middle",
            middle,
            bool(middle < SLIPPING * SPEED_M_S),
            f"holds below {1e3 * SLIPPING * SPEED_M_S:.1f} mm/s, 2 % of the speed; it is creep of eq. (11)",
        ),
        claim(
            "initial_phi_larger_in_mid_motion",
            phis[peak],
            abs(phis[peak]) > abs(phi),
            f"at {run.t_s[peak]:.2f} s; {phi:.4f} rad after stopping",
        ),
        _alike(run, "initial", ""),
        unchecked(
            "initial_carpet_x_short",
            f"drawn in Fig. 7b, not printed; ours ends {1e3 * end_of(carpet)[0]:.0f} mm short",
            float(end_of(carpet)[0]),
        ),
        claim(
            "initial_disagrees_on_carpet",
            turned,
            abs(turned - measured) > 0.5 * measured,
            f"{measured - turned:.2f} rad less than measured; the end points of Fig. 7 are not in the text",
        ),
    ]


def _steady(run: Run) -> Row:
    v = run.velocity[:, 0]
    wanted = v[sample_at(run, 0.5 * DURATION_S)]
    late = np.flatnonzero((np.abs(v - wanted) > 0.02 * abs(wanted)) & (run.t_s < DURATION_S))
    since = float(run.t_s[late[-1] + 1])
    before = since <= published("initial_paper_steady_from")
    return number(
        "initial_paper_steady_from",
        since,
        "the speed stays within 2 % from then on; holds if not later",
        before,
    )


def improved_rows(unprinted: Unprinted, runs: Runs) -> list[Row]:
    """Section IV.C: with the rigid material between the rollers."""
    run, carpet, first = runs["paper", True], runs["carpet", True], runs["paper", False]
    stop = sample_at(run, DURATION_S)
    x, y, phi = end_of(run)
    worst = int(np.argmax(np.abs(run.pose[:, 2])))
    middle = np.abs(run.slip[(run.t_s > 0.8) & (run.t_s < 3.4)][..., 0]).max(axis=0)
    before = np.abs(first.slip[(first.t_s > 0.8) & (first.t_s < 3.4)][..., 0]).max(axis=0)
    ratios = np.abs(end_of(run) / end_of(first))
    turned, measured = float(carpet.pose[-1, 2]), float(np.mean(MEASURED_CARPET_PHI_RAD))
    printed = published("improved_carpet_phi")
    same = replace(unprinted, angles_rad=unprinted.angles_rad[[0, 0, 2]])
    twins = straight_line("paper", improved=True, unprinted=same)
    apart = float(np.abs(twins.slip[:, 0, 0] - twins.slip[:, 1, 0]).max())
    points = "the points and curves drawn are not in the text"
    return [
        number("improved_paper_x_short", x, "after stopping"),
        number("improved_paper_y", y, "after stopping"),
        number("improved_paper_phi", phi, "after stopping"),
        number(
            "improved_paper_phi_worst",
            run.pose[worst, 2],
            f"DISCREPANCY: the worst comes before the end, at {run.t_s[worst]:.2f} s; "
            f"{run.pose[stop, 2]:.3f} rad at 3.5 s, {phi:.3f} rad after stopping",
            holds=abs(run.pose[worst, 2] - phi) <= BY_KEY["improved_paper_phi_worst"].half_digit,
        ),
        number(
            "improved_carpet_phi",
            turned,
            "DISCREPANCY: same size, opposite sign; eq. (10) gives a negative heading",
        ),
        *_both_ends(run, "improved"),
        _alike(
            run,
            "improved",
            f"wheels 1 and 2 start at different rotor angles; from equal ones {1e3 * apart:.1f} mm/s",
        ),
        claim(
            "improved_wheel_3_slips_in_mid_motion",
            middle[2],
            bool(middle[2] > 10.0 * max(middle[:2].max(), before[2])),
            f"wheels 1 and 2 {1e3 * middle[:2].max():.1f} mm/s; initial model {1e3 * before[2]:.1f} mm/s",
        ),
        claim(
            "improved_drifts_larger",
            ratios.min(),
            bool(ratios.min() > 2.0),
            f"x short {ratios[0]:.1f}, y {ratios[1]:.1f}, φ {ratios[2]:.1f} times as large; holds above 2",
        ),
        unchecked(
            "improved_carpet_x_short",
            f"drawn in Fig. 10b, not printed; ours ends {1e3 * end_of(carpet)[0]:.0f} mm short",
            float(end_of(carpet)[0]),
        ),
        unchecked("improved_agrees_better", f"{points}; of the printed headings see the next two rows"),
        claim(
            "improved_carpet_phi_compares",
            turned - measured,
            abs(turned - measured) <= 2.0 * abs(printed - measured),
            f"DISCREPANCY: printed {printed:g} rad is {printed - measured:.3f} rad from the measured mean; "
            f"ours is as near in size ({abs(turned) - measured:.3f} rad) but turns the other way",
        ),
        unchecked(
            "paper_phi_very_small",
            f"the measured angles are not printed; {first.pose[-1, 2]:.3f} rad of the initial model "
            "agrees better with “very small” than the improved model",
            float(phi),
        ),
    ]


def _both_ends(run: Run, name: str) -> list[Row]:
    """Slip right after the start and right after the stop."""
    slip = np.abs(run.slip[..., 0]).max(axis=1)
    start, stop = (float(slip[(run.t_s >= t0) & (run.t_s <= t0 + 0.05)].max()) for t0 in (0.0, DURATION_S))
    return [
        claim(
            f"{name}_slip_at_start_and_end",
            min(start, stop),
            min(start, stop) > 0.5 * SPEED_M_S,
            f"{1e3 * start:.0f} mm/s at the start, {1e3 * stop:.0f} mm/s at the stop; "
            f"the commanded speed is {1e3 * SPEED_M_S:.0f} mm/s",
        )
    ]


def _alike(run: Run, name: str, why: str) -> Row:
    apart = float(np.abs(run.slip[:, 0, 0] - run.slip[:, 1, 0]).max())
    scale = float(np.abs(run.slip[..., 0]).max())
    holds = apart <= LINE_WIDTH * scale
    note = f"holds below 1 % of the figure's scale, {1e3 * LINE_WIDTH * scale:.1f} mm/s"
    if not holds:
        note = f"DISCREPANCY: {note}"
    return claim(f"{name}_wheels_1_and_2_alike", apart, holds, f"{note}; {why}" if why else note)
