"""What grows or falls from run to run is said to do so, and what does not is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnoses import residual_map
from planting import Plant, planted, smooth_kiwi
from spoilt import each, good, other_floor

from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.leads import leads
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import LeadSource, Verdict
from slipmargin.diagnosis.run_order import Drift, drift_in
from slipmargin.effects import Trace

COUNT = 8


@pytest.fixture(scope="module")
def commanded() -> DataSet:
    """Runs whose wheels do what they are told, of which only that is known."""
    plant = Plant(name="none", traces=(Trace.ACTUATION,), commands=lambda t, omega: omega)
    return planted(smooth_kiwi(), plant, 3, count=COUNT, duration_s=2.0, rate_hz=80.0)


def slowed(data_set: DataSet, factors: np.ndarray) -> DataSet:
    """The wheels of run r turned this much slower than they were told: the log holds more than they did."""
    of = {t.name: f for t, f in zip(data_set.trials, factors.tolist(), strict=True)}

    def told(record: Record) -> Record:
        assert record.omega_cmd is not None
        return replace(record, omega_cmd=record.omega_cmd / of[record.name])

    return each(data_set, told)


def found_in(data_set: DataSet) -> Drift | None:
    return drift_in(problem_of(data_set), (), range(COUNT), seed=1)


def test_a_battery_that_empties_from_run_to_run_is_seen(commanded: DataSet) -> None:
    drift = found_in(slowed(commanded, np.linspace(1.0, 0.86, COUNT)))
    assert drift is not None
    assert drift.what == "The speed that a command makes"
    np.testing.assert_allclose(drift.ends, [1.0, 0.86], atol=0.01)
    assert drift.p_value <= 0.01 and drift.share > 0.9
    assert "falls from run to run, from 1 to 0.86" in drift.sentence


def test_speeds_that_differ_without_an_order_and_runs_in_which_nothing_changes_say_nothing(
    commanded: DataSet,
) -> None:
    assert found_in(commanded) is None
    mixed = np.linspace(1.0, 0.86, COUNT)[[3, 6, 1, 4, 0, 7, 2, 5]]
    assert found_in(slowed(commanded, mixed)) is None
    # The same speed too slow in all is no order either.
    assert found_in(slowed(commanded, np.full(COUNT, 0.9))) is None


def test_grip_that_grows_is_seen_and_five_runs_are_too_few() -> None:
    plain = good(3, count=COUNT)
    floors = [other_floor(plain, set(range(COUNT)), factor) for factor in np.linspace(0.7, 1.0, COUNT)]
    trials = tuple(floor.trials[i] for i, floor in enumerate(floors))
    drift = found_in(replace(plain, trials=trials))
    assert drift is not None
    assert drift.what == "The grip" and "grows from run to run" in drift.sentence
    np.testing.assert_allclose(drift.ends, [0.7, 1.0], atol=0.03)
    five = replace(plain, trials=trials[:5])
    assert drift_in(problem_of(five), (), range(5), seed=1) is None


def test_parts_of_a_run_have_one_factor(commanded: DataSet) -> None:
    """A run that was cut at an event is one run of the order still."""
    data = slowed(commanded, np.linspace(1.0, 0.86, COUNT))
    half = [t.part(slice(None, len(t.t_s) // 2)) for t in data.trials]
    rest = [t.part(slice(len(t.t_s) // 2, None)) for t in data.trials]
    parts = [r for pair in zip(half, rest, strict=True) for r in pair]
    own = np.repeat(np.arange(COUNT), 2).tolist()
    drift = drift_in(problem_of(data, tuple(parts), own), (), own, seed=1)
    assert drift is not None
    np.testing.assert_allclose(drift.ends, [1.0, 0.86], atol=0.02)


def test_it_leads_where_nothing_on_the_map_takes_off_more() -> None:
    entries = residual_map()
    most = max(e.share for e in entries if e.supported)
    drift = Drift(what="The grip", cause="dust", ends=np.array([1.0, 0.7]), share=most + 0.1, p_value=0.002)
    first = leads(entries, (), None, (), (), drift)[0]
    assert first.traced_to is Trace.TIME and first.source is LeadSource.RUN_ORDER and first.follows
    assert "first, in the middle and last" in first.next_run
    less = replace(drift, share=most - 0.1)
    made = leads(entries, (), None, (), (), less)
    assert [x.source for x in made] == [LeadSource.MAP, LeadSource.RUN_ORDER]
    assert leads((), (), None, (), [Trace.TIME], drift) == ()


def test_a_diagnosis_of_such_runs_says_so(commanded: DataSet) -> None:
    """It was unexplained, and led to a speed that droops under load; so it is if the search is cut short."""
    found = diagnose(slowed(commanded, np.linspace(1.0, 0.86, COUNT)), seed=1, budget_s=0.1)
    assert found.verdict is Verdict.UNEXPLAINED
    assert found.leads[0].source is LeadSource.RUN_ORDER
