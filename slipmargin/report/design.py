"""The words of ``slipmargin design``: the best design and why, against the file's own, then tables."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

from slipmargin.report.text import ROWS, columns, left_out, thinned
from slipmargin.study.influence import Influence
from slipmargin.study.objectives import BY_NAME, Objective
from slipmargin.study.optimum import Optimum
from slipmargin.study.pareto import tolerance
from slipmargin.study.quantities import QUANTITIES
from slipmargin.study.reason import Reason
from slipmargin.study.robust import Robust
from slipmargin.study.study import Study

#: What a page says in words: ``key = value``, a key, the name of an objective.
#: Two ways to one number that differ by less than this share of it agree: more digits are rounding [1].
_SAME = 1e-9
_UNITS = {q.key: q.unit for q in QUANTITIES}
_ANY = "|".join(sorted(map(re.escape, _UNITS), key=len, reverse=True))
_SET, _KEY = re.compile(rf"\b({_ANY}) = ([^\s,;:()]+)"), re.compile(rf"\b({_ANY})\b")
_NAME = re.compile(r"\b({})\b".format("|".join(sorted(BY_NAME, key=len, reverse=True))))
#: Columns of the table of designs.
SHOWN = (
    "f_worst",
    "f_mean",
    "f_best",
    "f_worst_static",
    "yaw_moment_N_m",
    "start_worst_m_s2",
    "brake_worst_m_s2",
    "corner_m_s",
    "laps_s",
)


def best_sentence(study: Study) -> str:
    """``delta_deg = 35: f_worst 0.1829 (…)``."""
    goal, best = study.problem.objective, study.best()
    value = float(study.columns[goal.name][best])
    return f"{best_at(study, goal.name)}: {goal.name} {_with_unit(value, goal)} ({goal.meaning})"


def best_at(study: Study, name: str) -> str:
    """The best design for an objective, and how many others are as good: a tie is no winner."""
    equal = len(study.winners(name))
    if not equal:
        return "every design alike"
    others = "" if equal < 2 else f" ({equal - 1} {'other is' if equal == 2 else 'others are'} as good)"
    return named(study.keys, study.values[study.best(name)]) + others


def summary(
    study: Study,
    why: Reason,
    front: Sequence[str],
    optimum: Optimum | None,
    robust: Robust | None,
    influences: Sequence[Influence],
) -> list[tuple[str, str]]:
    """The answer as labelled sentences."""
    goal = study.problem.objective
    best = study.best()
    value = float(study.columns[goal.name][best])
    out = [
        ("best", best_sentence(study)),
        ("own", _own(study, goal, value)),
        ("why", str(why)),
        ("loads", _loads(study)),
    ]
    if optimum is not None:
        o = optimum
        agrees = "agrees" if o.check < _SAME else f"differs by {o.check:.0e} of it"
        proof = "" if math.isnan(o.check) else f"; a second method {agrees}"
        gain = (
            f"{o.gain:.2g} better than any of the grid"
            if o.gain > 0.0
            else "no better point between the grid's"
        )
        out.append(
            (
                "between",
                f"{named(study.keys, o.values)}: {_with_unit(o.value, goal)}, {gain} "
                f"({o.evaluations} evaluations{proof})",
            )
        )
    if robust is not None:
        r = robust
        corner = ", ".join(f"{k} = {v:g}" for k, v in r.corner)
        how = "exact" if r.exact else "corners only"
        out.append(
            (
                "robust",
                f"{named(study.keys, study.values[r.best])}: {r.goal.name} at least "
                f"{_with_unit(float(r.value[r.best]), r.goal)}, worst at {corner} ({how})",
            )
        )
    if influences:
        out.append(("influence", ", ".join(_influence(i) for i in influences[:4])))
    possible = len(study.values) - len(study.impossible)
    kept = f", {study.resumed} of {study.pieces} pieces from an earlier run" if study.resumed else ""
    on = int(study.front(front).sum())
    out.append(
        (
            "designs",
            f"{possible} possible of {len(study.values)}; {on} on the front of {' and '.join(front)}{kept}",
        )
    )
    return out


def best_by_objective(study: Study) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and rows: each objective's best design, beside the file's own."""
    rows: list[tuple[str, ...]] = []
    for name in study.objectives:
        own, goal = study.own[name], BY_NAME[name]
        value, at = float(study.columns[name][study.best(name)]), best_at(study, name)
        rows.append((name, goal.unit, at, _digits(value), _digits(own), change(value, own)))
    return ("objective", "unit", "best at", "value", "file's own", "change"), rows


def named(keys: Sequence[str], values: Sequence[Any]) -> str:
    """``delta_deg = 30, wheels = 3``."""
    return ", ".join(f"{k} = {_plain(v)}" for k, v in zip(keys, values, strict=True))


def in_words(text: str) -> str:
    """A sentence about a study for a page: ``wheel angle δ 30°``, and an objective by what it means."""
    text = _SET.sub(lambda found: f"{label(found[1])} {_of_unit(found[2], _UNITS[found[1]])}", text)
    text = _KEY.sub(lambda found: label(found[0]), text)
    for name in _NAME.findall(text):  # its meaning stands in its place, not behind it as well
        text = text.replace(f" ({BY_NAME[name].meaning})", "")
    return _NAME.sub(lambda found: BY_NAME[found[0]].meaning, text)


def label(key: str) -> str:
    """What a quantity is called where nobody types it: its key without the unit, in words."""
    unit = _UNITS[key].replace(" ", "_").replace("²", "2")
    plain = key.removesuffix("_" + unit.replace("/", "_")).removesuffix("_" + unit.replace("/", "_per_"))
    if plain.startswith("mu_"):
        return f"{plain[3:]} coefficient"
    plain = plain.replace("com_", "centre of mass ").replace("_", " ")
    return "wheel angle δ" if plain == "delta" else plain


def _of_unit(value: str, unit: str) -> str:
    if unit in ("", "1") or not value[-1].isdigit():
        return value
    return f"{value}°" if unit == "deg" else f"{value} {unit}"


def _own(study: Study, goal: Objective, best: float) -> str:
    if study.own_problem is not None:
        return f"the file's design is impossible: {study.own_problem}"
    own = study.own[goal.name]
    if math.isnan(own):
        return f"the file's design has no {goal.name}"
    here = named(study.keys, study.own_values)
    return f"the file's design ({here}): {_with_unit(own, goal)}; {change(best, own)} with the best"


def _loads(study: Study) -> str:
    parts = []
    for name, word in (("f_worst_equal", "equal"), ("f_worst_static", "static")):
        row = study.best(name)
        parts.append(
            f"{word} loads: best at {best_at(study, name)}, f_worst "
            f"{_digits(float(study.columns[name][row]))} m g"
        )
    return "; ".join(parts)


def _influence(i: Influence) -> str:
    if i.peak:
        return f"{'less' if i.below < i.here else 'more'} with any other {i.key}"
    if i.value:
        return f"1 % more {i.key}: {100.0 * i.slope * 0.01 * abs(i.value) / abs(i.here):+.2g} %"
    return f"{i.step:g} {i.unit} more {i.key}: {100.0 * i.slope * i.step / abs(i.here):+.2g} %"


def designs(study: Study, front: Sequence[str]) -> list[str]:
    """A row a design, the best among them, as many as a terminal shows."""
    shown = [name for name in SHOWN if name in study.columns]
    on = study.front(front)
    head = [*study.keys, *shown, "front"]
    rows = [
        [
            *(_plain(v) for v in values),
            *(_digits(float(study.columns[n][i])) for n in shown),
            study.impossible.get(i, "*" if on[i] else ""),
        ]
        for i, values in enumerate(study.values)
    ]
    pick = thinned(len(rows), ROWS, [study.best()])
    return [*columns(head, [rows[k] for k in pick]), *left_out(len(pick), len(rows))]


def _plain(value: Any) -> str:
    return "none" if value is None else value if isinstance(value, str) else f"{value + 0.0:.6g}"


def _digits(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.5g}" if abs(value) < 1e5 else f"{value:.3e}"


def _with_unit(value: float, goal: Objective) -> str:
    return _digits(value) + ("" if goal.unit == "1" else f" {goal.unit}")


def change(value: float, own: float) -> str:
    """By how much a value differs from the file's own."""
    if math.isnan(own) or math.isnan(value):
        return ""
    if own <= 0.0:
        return f"{value - own:+.3g}" if abs(value - own) > tolerance(own) else "0"
    percent = round(100.0 * (value / own - 1.0), 1)
    return f"{percent:+.1f} %" if percent else "0.0 %"
