"""Sentences of a diagnosis that are neither findings nor leads: how it was made, and what limits it."""

from __future__ import annotations

from collections.abc import Sequence

from slipmargin.data.data_set import DataSet, Member
from slipmargin.data.jitter import jitter
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.mimics import mimics
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.result import Event, Finding
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State


def of_the_clock(
    data_set: DataSet, checked: Checked, final: Fit | None, candidates: list[Candidate]
) -> tuple[str, ...]:
    """What is known of the times of a log without time stamps, and what cannot be known without them."""
    said = of_nominal_rates(data_set)
    if not said:
        return ()
    found = jitter(data_set.trials)
    if final is not None and checked.state is not None:
        said += mimics(checked.problem.as_seen_in(checked.state.view), final, candidates)
    return said if found is None else (*said, found.sentence)


def of_nominal_rates(data_set: DataSet) -> tuple[str, ...]:
    """Whose rows have no time stamps, and what cannot be told apart then."""
    if data_set.nominal_rate_Hz is None:
        return ()
    rates = {m.name: m.nominal_rate_Hz for m in data_set.members} or {"": data_set.nominal_rate_Hz}
    without, stamped = (
        [name for name, rate in rates.items() if (rate is None) is some] for some in (False, True)
    )
    whose = f" of {' and '.join(without)}" if stamped else ""
    nominal = " and ".join(f"{rate:g}" for rate in dict.fromkeys(rates.values()) if rate is not None)
    said = (
        f"Rows{whose} have no time stamps, only a nominal rate of {nominal} Hz: friction "
        "coefficients times the square of the sampling period are known, not both; slip ratios do not depend "
        "on it."
    )
    free = f"The clock of {' and '.join(stamped)}, whose rows are stamped, was as free as theirs."
    return (said, free) if stamped else (said,)


def of_noise(members: Sequence[Member]) -> tuple[str, ...]:
    """That noise which only some data sets of a campaign state was not used."""
    stated, others = ([m.name for m in members if m.noise_stated is some] for some in (True, False))
    if not stated or not others:
        return ()
    return (
        f"The noise that [sigma] states in {' and '.join(stated)} was not used: none is stated in "
        f"{' and '.join(others)}, so that of all runs was estimated. State it in each data set.",
    )


def of_one_run(runs: int) -> tuple[str, ...]:
    """That nothing could be left out of one run."""
    if runs > 1:
        return ()
    return (
        "There is one run, and none could be left out: shares and probabilities are those of the run itself. "
        "They may lead somewhere and bear out nothing; drive another run.",
    )


def of_the_draw(checked: Checked, held_chi: float) -> tuple[str, ...]:
    """That the runs held out, whose ``held_chi`` is reported, show little of what all show together.

    Little is a smaller share of the mean square than a correction must explain.
    """
    before = checked.before.chi()
    if held_chi**2 >= SETTINGS.explained_share * before**2:
        return ()
    after = ""
    if checked.state is not None:
        after = f", and {checked.after.chi():.3g} with what was found, each run predicted by fits to others"
    return (
        "The runs held out show little of what is missing: "
        f"over all runs chi is {before:.3g} with the model as it is{after}.",
    )


def of_pieces(state: State | None) -> tuple[str, ...]:
    """That runs were judged in pieces, and how long these are."""
    if state is None or state.view.piece is None:
        return ()
    return (
        f"The model is so far off that runs were searched and judged in pieces of "
        f"{state.view.piece * state.view.step_s:.2g} s, each begun where it was measured; reported "
        "errors are those of whole runs, which must fall too.",
    )


def of_small_shares(found: Sequence[Finding], state: State | None, held_chi: float) -> tuple[str, ...]:
    """Which names take off less than what stays unexplained: what that is may be behind them.

    By mean squares beyond the noise: what is left is that of the runs that nothing has seen (``held_chi``),
    where they were judged whole, else that of those left out of a fit.
    """
    whole = state is not None and state.view.piece is None
    small = [
        f"`{f.label}`"
        for f in found
        if not f.doubts
        and (left := max(f.chi_with, held_chi) if whole else f.chi_with) > SETTINGS.noise_chi
        and f.chi_without**2 - f.chi_with**2 < left**2 - 1.0
    ]
    if not small:
        return ()
    takes = "takes" if len(small) == 1 else "each take"
    return (
        f"{', '.join(small)} {takes} off less than what is still left: something that is not in the model "
        "yet may be behind it, whatever its name says.",
    )


def of_the_fit(
    final: Fit | None,
    events: tuple[Event, ...],
    turns: tuple[Periodicity, ...],
    *,
    phased: bool,
    held: bool,
) -> tuple[str, ...]:
    """How held-out runs were judged, what stands at an edge, what happened once and what repeats."""
    said = []
    if phased:
        which = "held-out run" if held else "run"
        said.append(
            f"No log holds the wheel angles.  On each {which} the start angles of the wheels were estimated "
            "from the first half of the way they turn, with parameters fitted to other runs; the errors "
            "reported are those of the rest of the run."
        )
    if final is not None and final.at_bound():
        said.append("Stuck at the edge of its range: " + ", ".join(final.at_bound()) + ".")
    if events:
        said.append(
            "Something happened once in a trial; it is listed under events, not explained by physics."
        )
    said += [r.sentence for r in turns]
    return tuple(said)
