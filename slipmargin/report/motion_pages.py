"""The report pages of ``check``, ``plan`` and ``simulate``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.model import Model
from slipmargin.paths.check import Check
from slipmargin.paths.plan import Plan
from slipmargin.paths.trajectory import Trajectory
from slipmargin.paths.verify import Verified
from slipmargin.physics.friction_laws import law_inverse
from slipmargin.report.page import Fact, Image, Page, Picture, Table
from slipmargin.report.paths import broken, covered, not_proved, pace, top_speed_m_s, turned
from slipmargin.report.result_page import result_page
from slipmargin.report.text import thinned
from slipmargin.sim.run import Run

#: Wheels whose largest slips differ by less than this share slip alike [1].
_ALIKE = 0.01
#: Rows of a table that shows a motion.
_ROWS = 16
#: A trajectory whose wheels could give no more than this many times as much uses what there is [1].
_ROOM = 1.02
#: A wheel that slips so fast that it uses this share of its friction is said to slide; below it creeps [1].
SLIDES = 0.95


def check_page(
    model: Model,
    c: Check,
    pose: Array,
    images: Mapping[str, Image],
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """Whether a trajectory slips, where, and the cure."""
    t, x, y, k = c.worst
    names, cure = model.geometry.names, c.time_scale_needed
    wheel = names[k]
    if c.admissible:
        lead = (
            f"This trajectory can be driven: no wheel of {model.robot} on {model.surface} is asked for more "
            f"than {100 * c.max_use:.3g} % of its grip."
        )
    elif c.max_use > 1.0:
        lead = (
            f"This trajectory slips: at {t:.3g} s wheel {wheel} is asked for {100 * c.max_use:.3g} % of its "
            "grip."
        )
    elif c.max_use > c.share:
        lead = (
            f"This trajectory does not slip, but leaves too little in reserve: at {t:.3g} s wheel {wheel} is "
            f"asked for {100 * c.max_use:.3g} % of its grip, {100 * c.share:.3g} % is allowed."
        )
    else:
        lead = f"This trajectory asks too much, although no wheel slips: {'; '.join(broken(names, c))}."
    if c.unsmoothed is not None:
        lead += f" Smoothing {turned(names, c, c.unsmoothed)}."
    if c.admissible:
        room = c.share / c.max_use if c.max_use > 0.0 else math.inf
        steps = ["Nothing must change."]
        if _ROOM < room < 100.0:
            steps.append(
                f"The wheel that works hardest could give {room:.3g} times as much: `slipmargin plan` finds "
                "the fastest motion on this path."
            )
    elif math.isfinite(cure):
        steps = [
            f"Drive it {cure:.3g} times as slowly: multiply every time by {cure:.4g}.",
            "Or let `slipmargin plan` find the fastest motion on the same path.",
        ]
    else:
        steps = ["Slowing down does not help: constant speed itself needs too much grip. Change the path."]
    at = thinned(len(c.t_s), _ROWS, [int(np.argmax(c.use.max(axis=1)))])
    return result_page(
        title=f"Check of a trajectory of {model.robot} on {model.surface}",
        lead=lead,
        good=c.admissible,
        facts=(
            Fact(label="Most grip asked", value=f"{100 * c.max_use:.3g} %", note=f"of wheel {wheel}"),
            Fact(label="Where", value=f"t = {t:.3g} s", note=f"x {x:.3g} m, y {y:.3g} m"),
            Fact(
                label="Stretch time by",
                value="1" if c.admissible else f"{cure:.4g}" if math.isfinite(cure) else "no cure",
                note="1: leave it as it is",
            ),
        ),
        pictures=(
            Picture(
                name="path",
                image=images["path"],
                alt="The path, coloured by the wheel near its limit",
                caption="The path; colours are wheels near their limit, the circle is the worst point.",
            ),
            _use_picture(images),
        ),
        tables=(_grip_table(c.t_s[at], pose[at], c.use[at], names),),
        next_steps=steps,
        lines=lines,
        warnings=warnings,
    )


def plan_page(
    p: Plan,
    rows: Trajectory,
    proofs: Mapping[str, Verified],
    images: Mapping[str, Image],
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """How fast the path can be driven, and what sets the pace."""
    share = p.request.share
    speed, way = top_speed_m_s(p), covered(p)
    first, longest = pace(p)[0]
    steps = ["`--export choreo FILE` (or `pathplanner`, `ros-path`) writes the motion for your robot."]
    if not proofs:
        steps.insert(0, "Run again with `--verify`: the simulator drives the plan and says whether it slips.")
    stopped = [f"{name} it is {not_proved(proof.stopped)}" for name, proof in proofs.items() if proof.stopped]
    against = [f"{name} it slips in the simulator" for name, proof in proofs.items() if proof.slips]
    against += [
        f"{name} a wheel lifts in the simulator"
        for name, proof in proofs.items()
        if proof.lifts_s is not None
    ]
    if against:
        steps.insert(0, "Plan with a larger `--margin`.")
    against += stopped
    lead = (
        f"{p.model.robot} can drive this path of {way} in {p.duration_s:.3g} s on {p.model.surface}: no "
        f"wheel slips, and {100 * (1.0 - share):.3g} % of the grip stays in reserve."
    )
    if against:
        lead = f"Do not rely on this plan of {way} in {p.duration_s:.3g} s: {'; '.join(against)}."
    at = thinned(len(rows.t_s), _ROWS)
    return result_page(
        title=f"Plan for {p.model.robot} on {p.model.surface}",
        lead=lead,
        good=not against,
        facts=(
            Fact(label="Time", value=f"{p.duration_s:.4g} s", note=f"for {way}"),
            Fact(label="Top speed", value=f"{speed:.3g} m/s"),
            Fact(label="Most grip used", value=f"{100 * p.max_use:.3g} %", note="of any wheel"),
            Fact(
                label="What sets the pace",
                value=first,
                note=f"{100 * longest:.0f} % of the time",
            ),
        ),
        pictures=(
            Picture(
                name="path",
                image=images["path"],
                alt="The path, coloured by the wheel near its limit",
                caption="The path; colours are wheels near their limit.",
            ),
            Picture(
                name="speed",
                image=images["speed"],
                alt="Speed along the path, turning counted, under its limit",
                caption="Speed under the highest speed from which the rest can be driven. Turning counts as "
                "the way of the wheels.",
            ),
            _use_picture(images),
        ),
        tables=(_grip_table(rows.t_s[at], rows.pose[at], rows.use[at], rows.wheels),),
        next_steps=steps,
        lines=lines,
        warnings=warnings,
    )


def _who(wheels: Sequence[str], slip: Array) -> str:
    """Which wheels slip most: one, or those that slip alike."""
    alike = np.flatnonzero(slip >= (1.0 - _ALIKE) * np.max(slip))
    if len(alike) == len(wheels):
        return "all wheels slip"
    names = [wheels[int(k)] for k in alike]
    if len(names) == 1:
        return f"wheel {names[0]} slips"
    return f"wheels {', '.join(names[:-1])} and {names[-1]} slip"


def simulate_page(
    run: Run,
    model: Model,
    work_J: float,
    goal: Array | None,
    images: Mapping[str, Image],
    lines: Sequence[str],
    warnings: Sequence[str],
) -> Page:
    """What the robot really did, and how far it missed a plan."""
    slip = np.abs(run.slip[..., 0])
    when, wheel = (int(k) for k in np.unravel_index(int(np.argmax(slip)), slip.shape))
    x, y, phi = (float(v) for v in np.round(run.pose[-1], 6) + 0.0)
    creep = float(law_inverse(model.grip.law, SLIDES)) / model.grip.k_s_per_m
    slides = float(slip[when, wheel]) > creep
    who = _who(run.wheels, slip.max(axis=0))
    lead = (
        f"After {run.duration_s:.3g} s the robot stands {math.hypot(x, y):.3g} m from the origin, turned by "
        f"{math.degrees(phi):.3g}°. "
        + (
            f"{who[:1].upper()}{who[1:]}, at most by {slip[when, wheel]:.3g} m/s."
            if slides
            else "No wheel slides: the largest slip is the creep that any driven wheel has."
        )
    )
    facts = [
        Fact(label="Ends at", value=f"x {x:.3g} m, y {y:.3g} m", note=f"φ = {math.degrees(phi):.3g}°"),
        Fact(
            label="Largest drive slip",
            value=f"{slip[when, wheel]:.3g} m/s",
            note=f"{who.rpartition(' ')[0]} at {run.t_s[when]:.2f} s",
        ),
        Fact(
            label="Energy lost at the wheels",
            value=f"{-work_J:.3g} J",
            note="drag of the rollers across their wheels, and sliding",
        ),
    ]
    if goal is not None:
        miss = run.pose[-1] - goal
        facts.append(
            Fact(
                label="Misses the planned end by",
                value=f"{1e3 * math.hypot(miss[0], miss[1]):.3g} mm",
                note=f"and {math.degrees(miss[2]):.3g}°",
            )
        )
    steps = (
        ["`slipmargin plan` finds the fastest motion along a path that does not slip."]
        if slides
        else ["The same commands on a more slippery floor: `--surface` names another floor of the file."]
    )
    at = thinned(len(run.t_s), _ROWS, [when])
    head = ("t [s]", "x [m]", "y [m]", "φ [°]", *(f"slip {name} [m/s]" for name in run.wheels))
    table = Table(
        caption="The run",
        head=head,
        rows=tuple(
            (
                f"{run.t_s[k]:.3f}",
                *(f"{v:.4f}" for v in np.round(run.pose[k, :2], 4) + 0.0),
                f"{math.degrees(run.pose[k, 2]):.2f}",
                *(f"{v:.4f}" for v in np.round(run.slip[k, :, 0], 4) + 0.0),
            )
            for k in at
        ),
    )
    return result_page(
        title=f"Simulation of {model.robot} on {model.surface}",
        lead=lead,
        good=not slides,
        facts=facts,
        pictures=(
            Picture(
                name="motion",
                image=images["motion"],
                alt="Displacements over time",
                caption="Where the robot goes.",
            ),
            Picture(
                name="slip",
                image=images["slip"],
                alt="Drive slip of each wheel over time",
                caption="How fast each wheel slides along its drive direction; 0 is rolling.",
            ),
        ),
        tables=(table,),
        next_steps=steps,
        lines=lines,
        warnings=warnings,
    )


def _use_picture(images: Mapping[str, Image]) -> Picture:
    shown = "The share of its grip that each wheel needs over time"
    return Picture(name="use", image=images["use"], alt=shown, caption=f"{shown}.")


def _grip_table(t_s: Array, pose: Array, use: Array, wheels: Sequence[str]) -> Table:
    return Table(
        caption="Share of its grip that each wheel uses",
        head=("t [s]", "x [m]", "y [m]", "φ [°]", *(f"{name} [%]" for name in wheels)),
        rows=tuple(
            (
                f"{t:.3f}",
                f"{p[0]:.3f}",
                f"{p[1]:.3f}",
                f"{math.degrees(p[2]):.1f}",
                *(f"{100 * v:.1f}" for v in u),
            )
            for t, p, u in zip(t_s, pose, use, strict=True)
        ),
    )
