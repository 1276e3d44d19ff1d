"""What is asked again in all runs: forms that few runs do not tell apart, faults of single instruments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.campaign import Part, joined
from slipmargin.diagnosis import all_runs
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.court import Court, put
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import AnyEffect
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.wheel_radius import WheelRadius

COUNT = 6  #: runs of each of two recordings, of which the last two together are held out
SEEN = np.arange(2 * COUNT - 2)
WATCH = Watch(report=no_progress)
LACKING = WheelLoads(shift_x_m=0.012, shift_y_m=-0.008, com_share=1.0)


def bench(*effects: AnyEffect, turned_rad: float = 0.0) -> tuple[Court, dict[str, Candidate]]:
    """Two recordings of a robot with these effects; before the second one somebody turned the marker."""
    turned = (CameraRotation(rotation_rad=turned_rad),) if turned_rad else ()
    parts = []
    for seed, word, own in ((3, "one", ()), (3, "two", turned)):
        plant = Plant(name=word, traces=(), effects=(*effects, *own))
        data = planted(smooth_kiwi(), plant, seed, count=COUNT, duration_s=2.0, rate_hz=50.0)
        parts.append(Part(data_set=replace(data, name=word), floor="a", loading="bare", instrument=word))
    whole = joined("x", parts)
    court = Court(
        problem=problem_of(whole),
        runs=tuple(range(2 * COUNT)),
        held=np.array([2 * COUNT - 2, 2 * COUNT - 1]),
        seen=SEEN,
        records=whole.trials,
        seed=0,
    )
    names = in_groups(named_candidates(("1", "2", "3"), False, ()), whole.members)
    return court, {c.label: c for c in names}


def known(court: Court, *structure: Candidate) -> State:
    """What the search knows: these effects, fitted to all runs that are not held out."""
    start = np.concatenate([np.zeros(0), *(c.starts[0] for c in structure)])
    return fitted(court.problem, structure, start, SEEN, court.seen_runs)


@pytest.mark.parametrize(("turned_rad", "found"), [(0.0, []), (0.015, ["camera_rotation in instrument two"])])
def test_a_marker_turned_between_two_recordings_is_found_where_something_else_is_missing(
    turned_rad: float, found: list[str]
) -> None:
    """On the robot's second recording on a thick carpet, by 2 degrees: less than a law must take off."""
    court, names = bench(WheelRadius(radius_factor=1.02, wheels=("1",)), turned_rad=turned_rad)
    state = known(court)
    assert state.chi > 1.2 * SETTINGS.noise_chi
    after = all_runs._calibrated(court, state, list(names.values()), WATCH)
    assert [c.label for c in after.structure] == found
    assert all(0.5 * turned_rad < x < 2.0 * turned_rad for x in after.fit.x)


def test_one_instrument_is_calibrated_with_everything_else() -> None:
    court, _ = bench(LACKING)
    alone = named_candidates(("1", "2", "3"), False, ())
    state = known(court)
    assert all_runs._calibrated(court, state, alone, WATCH) is state


def test_forms_that_few_runs_do_not_tell_apart_are_asked_again_in_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    law = SlipRatioFriction(share=1.0, steepness=2.0, transverse_factor=3.0)
    court, names = bench(law)
    forms = [c for c in names.values() if c.name == "slip_ratio_friction"]
    state = known(court, next(c for c in forms if c.label == "slip_ratio_friction"))
    held = put(court, state, [])
    assert held is not None and held.after.chi() > SETTINGS.noise_chi
    few = fitted(court.problem, (), np.zeros(0), SEEN[:4], court.seen_runs[:4])
    nothing = Screening(entries=(), total=1.0, chance=np.zeros(0))
    stood = Round(before=few, screening=nothing, tried=(), best=None, taken=False)
    monkeypatch.setattr(all_runs, "candidates_of", lambda rounds: forms)
    monkeypatch.setattr(all_runs, "take_step", lambda before, *_: replace(stood, before=before))
    after = all_runs.in_all_runs(court, held, [stood], [], WATCH)
    assert after.state is not None and after.state.last.label.startswith("slip_ratio_friction with its own")
    assert after.after.chi() < held.after.chi()
