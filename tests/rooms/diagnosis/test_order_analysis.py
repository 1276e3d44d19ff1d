"""A residual that is periodic in a wheel angle is found whatever angle its encoder began at."""

import numpy as np
import pytest

from slipmargin.diagnosis.order_analysis import Periodicity, periodicities

CLOCK = np.arange(0.0, 12.0, 0.03)


def runs(count, ripples, seed, wander=0.0):
    """Residual rates and angles of ``count`` runs; ``ripples`` rows (wheel, times a turn, size)."""
    random = np.random.default_rng(seed)
    rates, angles = [], []
    for _ in range(count):
        angle = random.uniform(-3.0, 3.0, 3) * CLOCK[:, None]
        drift = wander * np.cumsum(random.normal(size=(len(CLOCK), 3)), axis=0)
        rate = random.normal(size=(len(CLOCK), 3)) + drift
        for wheel, per_turn, size in ripples:
            rate[:, wheel] += size * np.cos(per_turn * angle[:, wheel] + random.uniform(0.0, 2.0 * np.pi))
        rate[random.random(len(CLOCK)) < 0.02] = np.nan
        rates.append(rate)
        angles.append(angle)
    return [CLOCK] * count, rates, angles, ("1", "2", "3")


@pytest.mark.parametrize("per_turn", [1, 6, 11])
def test_a_ripple_is_found_with_its_count_and_its_wheels(per_turn):
    found = periodicities(*runs(16, [(0, per_turn, 0.5), (2, per_turn, 0.5)], 1), seed=0)
    assert [(r.per_turn, r.wheels) for r in found] == [(per_turn, ("1", "3"))]
    assert found[0].p_value <= 0.002


def test_a_second_count_is_named_beside_the_first():
    found = periodicities(*runs(24, [(1, 6, 0.7), (1, 3, 0.4)], 2), seed=0)
    assert [r.per_turn for r in found] == [6, 3]


def test_wheels_at_a_fixed_ratio_of_speeds_do_not_name_one_anothers_count():
    clock, rates, angles, names = runs(16, [(0, 6, 0.7)], 3)
    for angle in angles:
        angle[:, 1] = 2.0 * angle[:, 0]  # so 6 a turn of wheel 1 is 3 a turn of wheel 2
    for rate, angle in zip(rates, angles, strict=True):
        rate[:, 1] += 0.3 * np.cos(6 * angle[:, 0])
    found = periodicities(clock, rates, angles, names, seed=0)
    assert sum(len(r.wheels) for r in found) == len(found) <= 2


def test_a_ripple_between_whole_counts_is_none():
    assert not periodicities(*runs(16, [(0, 6.5, 0.7)], 4), seed=0)


def test_alarms_without_a_ripple_are_as_rare_as_promised():
    alarms = [bool(periodicities(*runs(8, [], seed, wander=0.1), seed=seed)) for seed in range(60)]
    assert sum(alarms) <= 4  # 1 % each: five or more of sixty come by chance once in 2900 times


def test_what_repeats_in_time_is_no_alarm_where_every_run_is_the_same_motion():
    random = np.random.default_rng(7)
    alarms = 0
    for seed in range(20):
        clock, rates, angles, names = runs(10, [], seed)
        hertz = random.uniform(0.2, 3.0)
        for rate in rates:
            rate += np.cos(2.0 * np.pi * hertz * CLOCK + random.uniform(0.0, 2.0 * np.pi))[:, None]
        alarms += bool(periodicities(clock, rates, [angles[0]] * 10, names, seed=seed))
    assert alarms == 0


def test_a_channel_that_nobody_measured_hides_nothing():
    clock, rates, angles, names = runs(16, [(0, 6, 0.7)], 9)
    for rate in rates:
        rate[:, 2] = np.nan
    assert [(r.per_turn, r.wheels) for r in periodicities(clock, rates, angles, names, seed=0)] == [
        (6, ("1",))
    ]


def test_runs_without_angles_or_with_hardly_a_turn_tell_nothing():
    clock, rates, angles, names = runs(8, [(0, 6, 1.0)], 5)
    assert periodicities(clock, rates, [None] * 8, names, seed=0) == ()
    assert periodicities(clock, rates, [0.02 * a for a in angles], names, seed=0) == ()


def test_it_is_told_in_a_sentence():
    once = Periodicity(per_turn=1, wheels=("left",), p_value=0.001).sentence
    often = Periodicity(per_turn=6, wheels=("1", "2"), p_value=0.004).sentence
    assert "once a turn of wheel left (permutation p ≤ 0.001), as a wheel out of round" in once
    assert "6 times a turn of wheels 1, 2 (permutation p ≤ 0.004), as rollers" in often
