"""Leads: the map first, then what repeats with a wheel, then what fits; each once, with its evidence."""

from __future__ import annotations

from diagnoses import residual_map

from slipmargin.diagnosis.leads import leads
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.result import LeadSource
from slipmargin.effects import Trace

TURN = Periodicity(per_turn=1, wheels=("2",), p_value=0.003)


def test_the_map_leads_and_what_it_does_not_support_does_not() -> None:
    made = leads(residual_map(), [TURN], None, [], [])
    assert [x.traced_to for x in made] == [Trace.ACCELERATION, Trace.WHEEL_ANGLE]
    assert [x.source for x in made] == [LeadSource.MAP, LeadSource.ORDER]
    assert "40 % off the squared residual" in made[0].why and "p = 0.005" in made[0].why
    assert all(x.next_run for x in made)


def test_a_variable_is_listed_once_and_not_if_it_was_found() -> None:
    angle = MapEntry(traced_to=Trace.WHEEL_ANGLE, form="once a turn", share=0.1, p_value=0.005)
    assert [x.source for x in leads([angle], [TURN], None, [], [])] == [LeadSource.MAP]
    assert leads([angle], [TURN], None, [], [Trace.WHEEL_ANGLE]) == ()
    assert leads((), (), None, (), ()) == ()
