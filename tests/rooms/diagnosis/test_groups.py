"""A campaign in one fit: what is shared, what each group has for itself, and what clocks and delays hide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnoses import diagnosis, wheel_loads
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Array
from slipmargin.data.campaign import Part, joined
from slipmargin.data.data_set import DataSet, Member
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis import campaign, patches, refits
from slipmargin.diagnosis.campaign import by_group, shown_in
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.events import cut_apart
from slipmargin.diagnosis.evidence import intervals
from slipmargin.diagnosis.fit import Fit, fit
from slipmargin.diagnosis.groups import groups_of, in_groups, scope_of
from slipmargin.diagnosis.result import Event, Verdict
from slipmargin.diagnosis.search import screened
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import AnyEffect, Scope, Trace
from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.clock_rate import ClockRate
from slipmargin.effects.confined import Confined, acting
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.wheel_radius import WheelRadius
from slipmargin.errors import NoSolution
from slipmargin.report import campaign as report


def data(seed: int, *effects: AnyEffect, count: int = 4) -> DataSet:
    plant = Plant(name="x", traces=(Trace.COEFFICIENT,), effects=effects)
    return planted(smooth_kiwi(), plant, seed, count=count, duration_s=2.5, rate_hz=200.0, lag_s=0.08)


def part(name: str, found: DataSet, floor: str = "a", loading: str = "bare") -> Part:
    return Part(data_set=replace(found, name=name), floor=floor, loading=loading, instrument="camera")


def candidates(members: tuple[Member, ...], timed: bool = True) -> dict[str, Candidate]:
    return {c.label: c for c in in_groups(named_candidates(("1", "2", "3"), False, (), timed=timed), members)}


def fitted(found: DataSet, structure: tuple[Candidate, ...]) -> Fit:
    problem = problem_of(found)
    start = np.concatenate([c.starts[0] for c in structure])
    return fit(problem, structure, start, np.arange(len(problem.trials), dtype=np.int64))


def within(made: Fit, key: str, truth: float) -> tuple[float, float]:
    """Low and high of a parameter (95 %); fails where the truth is twice as far off as they reach."""
    keys = [k for c in made.structure for k in c.keys]
    spread = intervals(made)
    at = keys.index(key)
    middle, half = 0.5 * (spread.low[at] + spread.high[at]), 0.5 * (spread.high[at] - spread.low[at])
    assert abs(truth - middle) <= 2.0 * half, f"{key}: {spread.low[at]} … {spread.high[at]}"
    return float(spread.low[at]), float(spread.high[at])


def test_what_an_effect_belongs_to_decides_who_shares_it() -> None:
    whole = joined(
        "x",
        [part("one", data(1)), part("two", data(2), loading="full"), part("three", data(3), floor="b")],
    )
    assert groups_of(Scope.FLOOR, whole.members) == {"a": frozenset({0, 1}), "b": frozenset({2})}
    found = candidates(whole.members)
    assert "wheel_radius[1]" in found, "the machine's: shared"
    assert found["camera_delay"].keys == ("delay_s",), "one instrument: shared"
    assert {"floor_nap in floor a", "floor_nap in floor b"} <= set(found)
    loads = found["wheel_loads in loading each"]
    assert loads.size == 4 and loads.keys[0] == "shift_x_m (loading bare)"
    effect = loads.build(np.array([0.01, 0.0, 0.02, 0.0]))
    assert isinstance(effect, Confined)
    shifts = [e.shift_x_m for m in range(3) for e in acting((effect,), m) if isinstance(e, WheelLoads)]
    assert shifts == [0.01, 0.02, 0.01]
    assert all(scope_of(c) in Scope for c in found.values())
    transfer = found["load_transfer in loading each"]
    assert len(transfer.idle) == transfer.size, (
        "a campaign stopped at its first round: half of them were missing"
    )
    alone = in_groups(named_candidates(("1", "2", "3"), False, ()), ())
    assert [c.label for c in alone] == [c.label for c in named_candidates(("1", "2", "3"), False, ())]


def test_a_floor_a_loading_and_a_wheel_are_told_apart_by_a_campaign() -> None:
    slick, shifted = FrictionCoefficients(drive_factor=0.6, transverse_factor=0.8), 0.012
    worn = WheelRadius(radius_factor=1.02, wheels=("2",))
    whole = joined(
        "x",
        [
            part("plain", data(11, worn)),
            part("slick", data(12, worn, slick), floor="b"),
            part("payload", data(13, worn, slick, WheelLoads(shift_x_m=shifted, shift_y_m=0.0)), "b", "full"),
        ],
    )
    known = candidates(whole.members)
    made = fitted(
        whole,
        (
            known["friction_coefficients in floor b"],
            known["wheel_loads with the centre of mass where stated in loading each"],
            known["wheel_radius[2]"],
        ),
    )
    within(made, "drive_factor", 0.6)
    within(made, "radius_factor", 1.02)
    low, _ = within(made, "shift_x_m (loading full)", shifted)
    assert low > 0.0
    low, high = within(made, "shift_x_m (loading bare)", 0.0)
    assert high - low < 0.01
    assert made.cost < 1.1 * np.count_nonzero(made.residual)


def test_a_patch_of_one_floor_is_sought_in_its_own_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = joined("x", [part("one", data(4, count=2)), part("two", data(5, count=3), floor="b")])
    problem, runs = problem_of(whole), np.arange(5)
    before = refits.fitted(problem, (), np.zeros(0), runs, runs.tolist())
    looked_at = []

    def looked(state: State, radii_m: Array, own: Array, overdue: object) -> list[object]:
        looked_at.append(own.tolist())
        return []

    monkeypatch.setattr(patches, "patches", looked)
    known = candidates(whole.members)
    for label in ("floor_patch in floor a", "floor_patch in floor b"):
        listed = screened(before, runs.tolist(), [known[label]], 0, Watch(report=no_progress))
        patches.at_patches(before, listed)
    assert looked_at == [[0, 1], [2, 3, 4]]


def test_equal_cases_are_simulated_once_and_give_the_same_residual() -> None:
    problem = problem_of(data(4, count=3))
    trials = np.arange(3, dtype=np.int64)
    one = problem.residuals([()], [trials])[0]
    same: list[Array] = problem.residuals([(), (), (CameraDelay(delay_s=0.0),)], [trials, trials[1:], trials])
    assert np.array_equal(same[0], one) and np.array_equal(same[1], one[1:]) and np.array_equal(same[2], one)


def blind(found: DataSet) -> DataSet:
    """The same without time stamps and speeds, either of which would tell the clock."""
    trials = tuple(replace(t, omega=None) for t in found.trials)
    return replace(found, trials=trials, nominal_rate_Hz=200.0)


@pytest.mark.parametrize(("delay_s", "clock"), [(0.0, 1.02), (0.06, 1.0), (0.15, 0.98)])
def test_effects_survive_an_unknown_delay_and_a_wrong_clock(delay_s: float, clock: float) -> None:
    heavy = WheelLoads(shift_x_m=0.012, shift_y_m=-0.006)
    found = blind(data(21, heavy, CameraDelay(delay_s=delay_s), ClockRate(period_factor=clock), count=8))
    known = candidates(found.members, timed=False)
    loads = "wheel_loads with the centre of mass where stated"
    made = fitted(found, tuple(known[k] for k in (loads, "camera_delay", "clock_rate")))
    low, high = within(made, "shift_x_m", 0.012)
    assert low > 0.009 and high < 0.015
    low, high = within(made, "delay_s", delay_s)
    assert high - low < 0.01
    low, high = within(made, "period_factor", clock)
    assert high - low < 0.04, "known friction tells the clock"
    assert made.cost < 1.2 * np.count_nonzero(made.residual)


def test_friction_and_an_unknown_clock_cannot_be_told_apart_and_the_intervals_say_so() -> None:
    # A path by wheel angles is the same at half the friction and √2 times the period: m x″ / c² = μ m g.
    slick = FrictionCoefficients(drive_factor=0.7, transverse_factor=0.7)
    found = blind(data(22, slick, count=8))
    known = candidates(found.members, timed=False)
    alone = fitted(found, (known["friction_coefficients"],))
    low, high = within(alone, "drive_factor", 0.7)
    both = fitted(found, (known["friction_coefficients"], known["clock_rate"]))
    spread = intervals(both)
    assert spread.high[0] - spread.low[0] > 20.0 * (high - low)
    drive, _, period = both.x
    assert drive * period**2 == pytest.approx(0.7, abs=0.005), "this much is known"


def test_time_stamps_leave_a_clock_less_room_than_a_nominal_rate() -> None:
    stamped, nominal = candidates(())["clock_rate"], candidates((), timed=False)["clock_rate"]
    assert (stamped.low[0], stamped.high[0]) == (0.95, 1.05)
    assert (nominal.low[0], nominal.high[0]) == (0.9, 1.1)


@pytest.mark.parametrize(("factor", "makes_sense"), [(1.0016, False), (0.996, False), (1.02, True)])
def test_a_stamped_clock_that_is_hardly_off_is_friction_that_is_off(factor: float, makes_sense: bool) -> None:
    """Friction that wears off in the first decimetre was called a clock that is 0.16 % off."""
    nothing = np.zeros((2, 30))
    for timed in (True, False):
        clock = candidates((), timed=timed)["clock_rate"]
        found = Fit(
            structure=(clock,),
            x=np.array([factor]),
            trials=np.arange(2),
            residual=nothing,
            jacobian=nothing[..., None],
            evaluations=0,
        )
        assert (not found.at_bound()) is (makes_sense or not timed)


def test_the_evidence_of_a_data_set_is_that_of_its_runs_cut_at_events() -> None:
    """A camera that jumped by 80 mm made chi 27 with an effect that explains all but the jump."""
    slick = FrictionCoefficients(drive_factor=0.6, transverse_factor=0.6)
    whole = joined("both", [part(n, data(k, slick, count=2)) for k, n in enumerate(("one", "two"), 5)])
    last = whole.trials[-1]
    pose = np.array(last.pose)
    pose[250:, 0] += 0.08
    whole = replace(whole, trials=(*whole.trials[:-1], replace(last, pose=pose)))
    jump = Event(trial=last.name, t_s=float(last.t_s[250]), channel="x", size_sigma=100.0)
    records, runs = cut_apart(whole.trials, [jump])
    assert len(records) == 5
    problem = problem_of(whole, records, runs)
    (found,) = shown_in(problem, runs, whole.members, (wheel_loads(effect=slick),))
    assert [(s.data_set, s.runs) for s in found.shown_by] == [("one", 2), ("two", 2)]
    assert all(s.chi_with < 1.5 < 3.0 < s.chi_without for s in found.shown_by)
    assert shown_in(problem, runs, (), (found,)) == (found,), "no campaign"


def test_runs_that_were_searched_are_not_called_held_out_and_pulls_are_compared() -> None:
    drawn = diagnosis(Verdict.UNEXPLAINED)
    names = ("one/a", "one/b (0.00–1.00 s)", "one/b (1.20–3.00 s)", "two/a", "two/b", "two/c")
    trials = tuple(
        replace(t, name=n, run=r) for t, n, r in zip(drawn.trials, names, (0, 1, 1, 2, 3, 4), strict=True)
    )
    pulls = Pulls(phi_rad=np.array([0.0, 1.0]), force_N=np.array([5.0, 5.2]))
    sets = [part("one", replace(data(5, count=2), pulls=pulls)), part("two", data(6, count=3))]
    one, two = by_group(joined("both", sets).members, replace(drawn, trials=trials))[1]
    assert (one.runs, one.judged, two.runs, two.judged) == (2, 0, 3, 3)
    assert one.before.chi > 1.0, "errors of the runs that were searched"
    assert one.pulls is not None and one.pulls.count == 2 and two.pulls is None
    said = report.lines(drawn, (one, two))
    assert "no run held out, errors of 2 searched" in said[0] and "one: 2 pull tests" in said[1]
    assert "; 3 runs held out: " in said[2]
    rows = report.as_json(drawn, (one, two))["data_sets"]
    assert [r["errors_of"] for r in rows] == ["searched runs", "held-out runs"]
    assert rows[0]["judged"] == 0 and rows[0]["pulls"]["count"] == 2 and "pulls" not in rows[1]
    page = str(report.section(drawn, (one, two)))
    assert "no run held out, errors of 2 searched" in page and "2 pull tests" in page


def test_a_run_that_ends_where_it_began_counts_by_the_distance_that_it_drove() -> None:
    """5 mm after 2 m out and back were thousands of percent, and outweighed every other run."""
    drawn = diagnosis(Verdict.UNEXPLAINED)
    s, random = np.linspace(0.0, 1.0, 401), np.random.default_rng(3)
    ahead, turned = 2.0 * s, 2.0 * np.pi * s
    ways = [
        (ahead, 0.0 * s),
        (1.0 - np.abs(1.0 - ahead), 0.0 * s),
        (0.3 * np.cos(turned), 0.3 * np.sin(turned)),
    ]
    trials = []
    for way in ways:
        true = np.stack([*way, 0.0 * s], axis=1)
        measured = true + drawn.noise * random.standard_normal(true.shape)
        off = true + 0.02 * s[:, None] * [1.0, 0.0, 0.0]
        trials.append(replace(drawn.trials[-1], name="one/a", measured=measured, before=off, after=true))
    spot = replace(
        trials[0], measured=trials[0].measured - trials[0].after, before=0.0 * off, after=0.0 * off
    )
    members = joined("x", [part("one", data(5, count=1))]).members
    (one,) = by_group(members, replace(drawn, trials=(*trials, spot)))[1]
    assert one.drift_before.displacement == pytest.approx(0.0102, rel=0.1)
    assert one.drift_after.displacement < 1e-3


def test_where_no_pose_was_measured_a_model_has_no_error() -> None:
    """A lead-in without poses: the measured path stood still there, and the predicted one drove on."""
    drawn = diagnosis(Verdict.UNEXPLAINED)
    s = np.linspace(0.0, 1.0, 401)
    true = np.stack([2.0 * s, 0.0 * s, 0.5 * s], axis=1)
    measured = np.where(s[:, None] < 0.2, np.nan, true)
    trial = replace(drawn.trials[-1], name="one/a", measured=measured, before=true, after=true)
    members = joined("x", [part("one", data(5, count=1))]).members
    (one,) = by_group(members, replace(drawn, trials=(trial,)))[1]
    assert one.drift_after.displacement < 1e-9 and abs(one.drift_after.heading_rad) < 1e-9


def test_pulls_of_a_member_that_cannot_be_compared_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise NoSolution("pull", "none", "none")

    monkeypatch.setattr(campaign, "pull_check", fails)
    pulls = Pulls(phi_rad=np.zeros(1), force_N=np.ones(1))
    members = joined("x", [part("one", replace(data(5, count=1), pulls=pulls))]).members
    drawn = diagnosis(Verdict.UNEXPLAINED)
    trials = tuple(replace(t, name=f"one/{t.name}") for t in drawn.trials)
    (one,) = by_group(members, replace(drawn, trials=trials))[1]
    assert "the comparison with pulls of one" in report.lines(drawn, (one,))[1]
