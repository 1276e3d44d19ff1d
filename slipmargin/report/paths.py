"""The words of a plan and of a check."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import MotionStopped
from slipmargin.model import Model
from slipmargin.paths.chance import PlanChance
from slipmargin.paths.check import Check
from slipmargin.paths.geometry import Geometry
from slipmargin.paths.off_heading import use_off_heading
from slipmargin.paths.plan import Plan
from slipmargin.paths.trajectory import NEAR, TIED
from slipmargin.paths.verify import Verified
from slipmargin.report.motion import ended, in_air

#: Turns of less than this all along a path are not spoken of [deg].
_TURNED_DEG = 0.05
#: Places in each interval of the grid at which a plan is measured along.
_FRACTIONS = 21
#: A heading that is a little off takes so much more of what is allowed before it is said [1].
_MORE = 0.02
#: Rollers stand where a wheel slides sideways by less than this part of the fastest wheel's turning [m], and
#: where no wheel is near its limit for longer than that part of the time, it is said [1].
_STANDS, _SPOKEN = 1e-9, 0.02


def covered(p: Plan) -> str:
    """How far a plan goes on the floor, and how far it turns where it does; the table's step is not asked."""
    pose = _samples(p).pose
    way = float(np.sum(np.linalg.norm(np.diff(pose[..., :2], axis=1), axis=-1)))
    turned = float(np.rad2deg(np.sum(np.abs(np.diff(pose[..., 2], axis=1)))))
    if turned < _TURNED_DEG:
        return f"{way:.4g} m"
    return f"{way:.4g} m and {turned:.4g}° of turning"


def top_speed_m_s(p: Plan) -> float:
    """The highest speed over the floor."""
    g = _samples(p)
    return float(np.max(np.sqrt(g.squared_speed(p.x)) * np.linalg.norm(g.first[..., :2], axis=-1)))


def _samples(p: Plan) -> Geometry:
    return Geometry.of(p.model, p.path, p.grid, np.linspace(0.0, 1.0, _FRACTIONS))


def plan_lines(p: Plan, proofs: Mapping[str, Verified], likely: PlanChance | None = None) -> list[str]:
    """Duration, grip, what limits the pace, and each simulation; the first line is the answer."""
    share = p.request.share
    i, j, k = p.audit.worst
    lines = [
        f"duration    {p.duration_s:.4f} s for {covered(p)}, top speed {top_speed_m_s(p):.4g} m/s",
        f"grip        at most {p.max_use:.6f} of each wheel's grip, {share:g} allowed (checked at "
        f"{p.audit.speed.size} places); highest: wheel {p.model.geometry.names[k]} at "
        f"t = {p.audit.time_s[i, j]:.3f} s",
        f"limited by  {_limited(p)}",
        *_still_rollers(p),
        *_off_heading(p),
    ]
    if p.model.loads.follow_acceleration:
        lost = p.audit.tipping
        i, j, k = (int(n) for n in np.unravel_index(int(np.argmax(lost)), lost.shape))
        lines.append(
            f"tipping     at most {np.max(lost):.4f} of what lifts a wheel, {share:g} allowed; highest: "
            f"wheel {p.model.geometry.names[k]} at t = {p.audit.time_s[i, j]:.3f} s"
        )
    if likely is not None:
        lines.append(_chance(likely))
    for name, proof in proofs.items():
        words = "slips" if proof.slips else "does not slip"
        if proof.lifts_s is not None:
            words += f" but {in_air(proof.wheels, proof.in_air_s, proof.lifts_s)}"
        words += (
            f"; uses at most {proof.peak:.4f} of the grip (wheel {proof.wheel}), drive slip up to "
            f"{1e3 * np.max(proof.slip_m_s):.3g} mm/s"
        )
        if proof.stopped is None:
            off_m, off_rad = proof.drift_m, proof.drift_rad
            words += f"; open loop it ends {1e3 * off_m:.3g} mm and {np.rad2deg(off_rad):.3g}° away"
        else:
            words = f"{not_proved(proof.stopped)}; until then it {words}"
        lines.append(f"simulated   {name}: {words}")
    return lines


def not_proved(stopped: MotionStopped) -> str:
    """That a simulation that ended early proves no plan: when and why it ended, and what to do."""
    return f"not proved: the simulation does not reach its end, {ended(stopped)}, {stopped.cure}"


def _chance(found: PlanChance) -> str:
    """The chance of slip of the plan, and the margin for the chosen chance."""
    share = found.at_plan
    said = f"{100 * share:.3g} %" if share > 0.0 else f"below {300 / found.draws:.2g} %"
    line = f"chance      {said} of {found.draws} draws of the uncertain numbers slip somewhere on this plan"
    if found.chance is None:
        return line
    if found.margin is None:
        return f"{line}; no margin brings {100 * found.chance:g} %"
    return f"{line}; {100 * found.chance:g} % with --margin {found.margin:.3f}, {found.duration_s:.4f} s"


def limiting(p: Plan) -> list[str]:
    """What limits each interval: the wheels whose grip does, joined by "+", or motor torque, tipping or cap.

    Of the wheels those that use most, all that tie; a cap is a speed cap or the motors' top speed.
    """
    most, names = p.audit.most, (*p.rows.names, "cap")
    tied = most >= (1.0 - TIED) * most.max(axis=1, keepdims=True)
    wheels = np.array(p.model.geometry.names)
    return [
        "+".join(wheels[on]) if names[row] == "grip" else names[row]
        for row, on in zip(p.limited_by, tied, strict=True)
    ]


def pace(p: Plan) -> list[tuple[str, float]]:
    """What sets the pace, and for which share of the time, longest first."""
    spent = np.diff(p.audit.time_s[:, [0, -1]], axis=1).ravel() / p.duration_s
    shares: dict[str, float] = {}
    for name, part in zip(limiting(p), spent, strict=True):
        shares[name] = shares.get(name, 0.0) + float(part)
    said = {
        "+".join(p.model.geometry.names): "all wheels",
        "motor torque": "motors",
        "cap": "speed caps or the motors' top speed",
    }
    return sorted(((said.get(name, name), part) for name, part in shares.items()), key=lambda x: -x[1])


def _limited(p: Plan) -> str:
    """Share of the time that each wheel's grip (or a motor, a cap) sets the pace."""
    return ", ".join(f"{name} {100 * part:.0f} %" for name, part in pace(p) if part > 0.005)


def _still_rollers(p: Plan) -> list[str]:
    """For how long the grip limits although no wheel uses what it may, since rollers that stand may help."""
    twist = Geometry.of(p.model, p.path, p.grid, np.array([0.5])).twist[:, 0]
    slide = np.abs(twist @ p.model.geometry.lateral_rows().T).max(axis=1)
    stand = slide <= _STANDS * np.max(np.abs(p.model.geometry.wheel_speeds(twist)), axis=1)
    most = p.audit.most.max(axis=1)
    spare = stand & (most < NEAR * p.request.share) & (np.array(p.rows.names)[p.limited_by] == "grip")
    spare &= p.limited_by >= 0
    part = np.diff(p.audit.time_s[:, [0, -1]], axis=1).ravel()[spare].sum() / p.duration_s
    if part <= _SPOKEN:
        return []
    return [
        f"rollers     for {100 * part:.0f} % of the time none turns and no wheel uses more than "
        f"{np.max(most[spare]):.3g} of its grip: their friction helps to drive, which the plan does not "
        "count on, as a drift to the side makes it drag"
    ]


def _off_heading(p: Plan) -> list[str]:
    """That a heading a degree off takes more than is allowed, where it does."""
    share, use = p.request.share, use_off_heading(p)
    if use <= (1.0 + _MORE) * share:
        return []
    what = (
        f"it would use {use:.3g} of a wheel's grip instead of {share:g}"
        if use <= 1.0
        else "a wheel would slip"
    )
    return [f"heading     a degree off {what}: a larger --margin leaves room for that"]


def check_lines(model: Model, c: Check) -> list[str]:
    """Verdict, worst point, motors, wheels and the cure; the first line is the verdict."""
    names = model.geometry.names
    t, x, y, k = c.worst
    lines = [
        _verdict(names, c),
        f"worst       wheel {names[k]} at t = {t:.3f} s (x {x:.4g} m, y {y:.4g} m)",
    ]
    if model.drives.weakest_N_m is not None:
        most = float(np.max(c.torque))
        if math.isinf(most):
            lines.append(f"motors      have no torque left at their top speed: {_at(names, c, c.torque)}")
        else:
            lines.append(
                f"motors      at most {most:.4f} of the torque they have"
                f"{_excess(names, c, c.torque, c.share)}"
            )
    if model.drives.max_speed_rad_s is not None:
        lines.append(
            f"wheels      at most {np.max(c.speed):.4f} of their top speed{_excess(names, c, c.speed, 1.0)}"
        )
    if model.loads.follow_acceleration:
        lines.append(_tipping(names, c))
    if math.isinf(c.time_scale_needed):
        lines.append("cure        none by slowing down: constant speed itself needs too much grip somewhere")
    elif not c.admissible:
        lines.append(f"cure        stretch time by {c.time_scale_needed:.4f}")
    if c.unsmoothed is not None:
        lines.append(f"smoothing   {turned(names, c, c.unsmoothed)}")
    return lines


def _verdict(names: Sequence[str], c: Check) -> str:
    """The verdict, the share of the grip, and what breaks a limit: value, limit, wheel and time."""
    grip = f"uses at most {c.max_use:.4f} of a wheel's grip, {c.share:g} allowed"
    if c.admissible:
        return f"admissible: {grip}"
    over, others = _excess(names, c, c.use, c.share), broken(names, c)
    joined = "; " if over else ", but "
    return f"not admissible: {grip}{over}{joined if others else ''}{'; '.join(others)}"


def broken(names: Sequence[str], c: Check) -> list[str]:
    """Each limit beside grip that is broken: value, what is allowed, wheel and time."""
    limits = (
        ("of a motor's torque", c.torque, c.share),
        ("of a wheel's top speed", c.speed, 1.0),
        ("of what lifts a wheel", c.tipping, c.share),
    )
    return [
        f"{f'{most:.4f}' if math.isfinite(most := float(np.max(share))) else 'more than all'} {what}, "
        f"{allowed:g} allowed{at}"
        for what, share, allowed in limits
        if (at := _excess(names, c, share, allowed))
    ]


def turned(names: Sequence[str], c: Check, unsmoothed: Check) -> str:
    """That the window of the derivatives decides the verdict."""
    return f"over {c.smooth_s:g} s decides: without it {_verdict(names, unsmoothed)}"


def _tipping(names: Sequence[str], c: Check) -> str:
    """The share of its load that a wheel loses; where that is all of it, that it lifts off."""
    most = f"{np.max(c.tipping):.4f} of what lifts a wheel, {c.share:g} allowed"
    if np.min(c.load_N) < 0.0:
        return f"tips        {most}; {_at(names, c, -c.load_N)}: it lifts off"
    return f"tipping     at most {most}{_excess(names, c, c.tipping, c.share)}"


def _excess(names: Sequence[str], c: Check, share: Array, allowed: float) -> str:
    """Which wheel has the largest share (T, N), and when, where it is more than what is allowed."""
    return f": {_at(names, c, share)}" if np.max(share) > allowed * (1.0 + 1e-6) else ""


def _at(names: Sequence[str], c: Check, values: Array) -> str:
    """The wheel and the time of the largest of values (T, N)."""
    i, k = np.unravel_index(int(np.argmax(values)), values.shape)
    return f"wheel {names[int(k)]} at t = {c.t_s[i]:.3f} s"
