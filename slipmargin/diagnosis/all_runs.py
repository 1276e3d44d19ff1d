"""What holds, asked again in all runs: the search itself looks at few of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.diagnosis.court import Checked, Court, better
from slipmargin.diagnosis.finalists import other_names
from slipmargin.diagnosis.refits import longer
from slipmargin.diagnosis.restated import redefined, simplified, unstuck
from slipmargin.diagnosis.result import Rejected
from slipmargin.diagnosis.rounds import Round, candidates_of
from slipmargin.diagnosis.search import take_step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch


def in_all_runs(
    court: Court, held: Checked, rounds: list[Round], rejected: list[Rejected], progress: Watch
) -> Checked:
    """What holds, with names that show in all runs and not in the few that were searched.

    It is asked where much is left.  Simulating all runs takes long: beside each effect in its simplest form
    that is as good, every name is put on a list, whose first is fitted, and those that stand next on another.
    """
    runs, candidates = court.seen_runs, candidates_of(rounds)
    names = [c for c in candidates if c.named]
    in_few = bool(rounds) and len(rounds[0].before.fit.trials) < len(court.seen)
    while in_few and held.state is not None and held.after.chi() > SETTINGS.noise_chi:
        if progress.expired:
            break
        start = simplified(longer(court.problem, held.state, runs, np.inf), runs, candidates, progress)
        start = redefined(start, runs, progress)
        step = take_step(start, runs, names, court.seed, progress.staged("in all runs"), 1)
        rounds.append(replace(step, names_only=True))
        best = step.best if step.taken and step.best is not None else start
        if best.structure == held.state.structure:
            break
        found = better(court, held, unstuck(best, runs, candidates, progress), rejected)
        held = found or held
        if found is None or not step.taken:
            break
        names = [e.structure[0] for e in other_names(step.screening, (), SETTINGS.contenders)]
    return held
