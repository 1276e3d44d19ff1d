"""The verdict on constructed errors: what falls, what grows, what is chance, what only some runs show."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.remarks import of_the_draw
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.verdict import (
    Judgement,
    RunErrors,
    clearly_worse,
    explained_share,
    groups,
    judge,
    near_noise,
    sign_flip_p_value,
)
from slipmargin.errors import InputError

SAMPLES = 300.0
NONE = np.zeros(10, dtype=bool)
LAST_TWO = np.arange(10) >= 8


def errors(position: object, heading: object = None, runs: int = 10) -> RunErrors:
    """Runs with this chi in position and in heading (the same by default)."""
    place = np.broadcast_to(np.asarray(position, dtype=float), runs)
    turn = place if heading is None else np.broadcast_to(np.asarray(heading, dtype=float), runs)
    squares = SAMPLES * np.stack([place, place, turn], axis=1) ** 2
    return RunErrors(squares=squares, counts=np.full((runs, 3), SAMPLES))


def judged(before: RunErrors, after: RunErrors, unseen: object = LAST_TWO) -> Judgement:
    return judge(before, after, np.asarray(unseen))


def test_a_correction_that_brings_every_run_to_the_noise_holds() -> None:
    found = judged(errors(9.0), errors(1.05))
    assert found.holds and not found.partial
    assert found.p_value == pytest.approx(2.0**-10)
    assert found.explained == pytest.approx(1.0 - (1.05**2 - 1.0) / 80.0)
    assert (found.runs, found.better, found.worse) == (10, 10, 0)


@pytest.mark.parametrize(("before", "after"), [(29.8, 33.2), (2.8, 27.6), (52.0, 55.1), (184.0, 274.0)])
def test_nothing_is_found_where_the_error_on_held_out_runs_grows(before: float, after: float) -> None:
    seen_gets_better = np.where(LAST_TWO, after, 0.5 * before)
    found = judged(errors(before), errors(seen_gets_better))
    assert not found.holds
    assert f"chi goes from {before:.3g} to {after:.3g}" in found.failures[0]


def test_two_unseen_runs_do_not_decide_alone() -> None:
    """Chi of the last two falls by less than is asked, as that of two others does: all runs decide."""
    before, after = errors(10.0), errors([4.0] * 6 + [9.6, 9.2, 9.0, 9.0])
    assert judged(before, after).explained < 0.25 and judged(before, after).holds
    turned = errors(10.0, 9.6), errors([4.0] * 6 + [9.6, 9.2, 9.0, 9.0], [4.0] * 6 + [11.0, 11.0, 11.0, 9.6])
    assert judged(*turned).holds
    lowest = judged(before, errors([4.0] * 8 + [9.0, 9.0]))
    assert "19 % of the mean square beyond the noise" in lowest.failures[0]
    many = judged(before, errors([4.0] * 3 + [9.6, 9.2] + [9.0] * 5), np.arange(10) >= 5)
    assert "25 % are asked for" in many.failures[0], "five can rule out chance"
    assert not judged(before, errors([4.0] * 6 + [11.0, 11.0, 10.2, 9.9])).holds, "together they get worse"
    near = errors(3.0), errors(0.3 * np.array([4.0] * 6 + [9.6, 9.2, 9.0, 9.0]))
    assert not judged(*near).holds, "near the noise runs are alike"


def test_a_run_that_diverges_is_not_outweighed_by_the_others() -> None:
    after = np.ones(10)
    after[[2, 3]] = 1e4
    found = judged(errors(9.0), errors(after))
    assert any("2 of 10 runs get clearly worse" in f for f in found.failures)
    assert any("as a group" in f for f in found.failures)


def test_not_a_number_is_never_better() -> None:
    assert clearly_worse(2.0, float("nan"))
    with pytest.raises(InputError, match="not finite"):
        errors([1.0, np.inf, 1.0], runs=3)


def test_too_small_a_share_is_no_finding_however_significant() -> None:
    found = judged(errors(50.0), errors(47.0))
    assert found.p_value < 0.01 and not found.holds
    assert "12 % of the mean square beyond the noise" in found.failures[0]


def test_a_small_effect_near_the_noise_is_found() -> None:
    assert judged(errors(1.25), errors(1.03)).holds


def test_what_moves_within_the_reconstruction_is_no_finding() -> None:
    assert not judged(errors(1.05), errors(1.035)).holds


def test_heading_may_not_pay_for_position_nor_position_for_heading() -> None:
    worse = judged(errors(9.0, 2.0), errors(1.0, 3.0))
    assert len(worse.failures) == 1 and "the heading gets worse (chi 2 to 3)" in worse.failures[0]
    worse = judged(errors(2.0, 9.0), errors(3.0, 1.0))
    assert len(worse.failures) == 1 and "the position gets worse" in worse.failures[0]


def test_what_some_runs_gain_and_others_lose_is_chance() -> None:
    after = np.where(np.arange(10) % 2 == 0, 3.0, 5.2)
    found = judged(errors(5.0), errors(after), NONE)
    assert found.better == 5 and found.p_value > 0.01
    assert not judged(errors(5.0), errors(np.where(np.arange(10) % 3 == 0, 1.0, 5.3)), NONE).holds


def test_an_effect_that_only_few_runs_show_is_found_if_the_others_stay() -> None:
    before = np.ones(10)
    before[[1, 5, 9]] = 9.0
    found = judged(errors(before), errors(1.0))
    assert found.holds and found.runs == 3 and found.p_value == pytest.approx(0.125)
    before[1] = 1.0
    assert judged(errors(before), errors(1.0)).holds  # two that fall to the noise are enough
    after = np.where(before > 1.0, 3.0, 1.0)
    assert not judged(errors(before), errors(after)).holds  # two that fall a part of the way are not
    before[5] = 1.0
    assert not judged(errors(before), errors(1.0)).holds  # one run is too few


def test_parameters_from_one_run_need_not_explain_another_to_the_last_sample() -> None:
    """A load transfer that two runs of 14 show (one held out); a wrong effect took 91 % of the larger one."""
    ones, held = np.full(14, 0.9), np.isin(np.arange(14), [0, 1, 7])
    twos = ones.copy()
    ones[[1, 5]], twos[[1, 5]] = (3.94, 16.73), (0.90, 2.74)
    assert judged(errors(ones, runs=14), errors(twos, runs=14), held).holds
    twos[[1, 5]] = 1.39, 5.06
    assert not judged(errors(ones, runs=14), errors(twos, runs=14), held).holds


def test_where_nothing_but_noise_is_left_a_run_a_little_above_it_speaks_too() -> None:
    """Most of an effect in two runs, a little of it in others: each of these falls to the noise."""
    before = errors([0.95, 1.21, 3.46, 0.97, 8.61, 1.02, 0.94], runs=7)
    after = errors([0.95, 1.02, 0.95, 0.98, 1.84, 1.02, 0.94], runs=7)
    found = judged(before, after, NONE[:7])
    assert found.holds and (found.runs, found.better) == (3, 3)
    worse = errors([1.22, 1.02, 0.95, 0.98, 1.84, 1.02, 0.94], runs=7)
    assert not judged(before, worse, NONE[:7]).holds


def test_a_run_that_stays_at_the_noise_says_nothing() -> None:
    """Far above the noise, a run that goes from 1.03 to 1.28 is neither worse nor a vote against."""
    before = errors([1.43, 24.0, 1.03, 43.5, 37.8], runs=5)
    after = errors([1.10, 3.1, 1.28, 5.0, 2.4], runs=5)
    found = judge(before, after, np.zeros(5, dtype=bool))
    assert found.holds and (found.runs, found.better, found.worse) == (4, 4, 0)
    gone = errors([1.10, 3.1, 1.9, 5.0, 2.4], runs=5)
    assert not judge(before, gone, np.zeros(5, dtype=bool)).holds


def test_runs_on_another_floor_as_a_group_stop_it() -> None:
    after = np.ones(12)
    after[9:] = [4.0, 4.0, 4.0]
    found = judge(errors(3.0, runs=12), errors(after, runs=12), np.zeros(12, dtype=bool))
    assert any("runs 10 to 12 as a group get worse" in f for f in found.failures)


def test_three_runs_suffice_only_together() -> None:
    none = np.zeros(3, dtype=bool)
    assert judge(errors(9.0, runs=3), errors(1.0, runs=3), none).holds
    assert not judge(errors(9.0, runs=3), errors([1.0, 1.0, 12.0], runs=3), none).holds


def test_a_finding_that_leaves_much_is_in_part() -> None:
    found = judged(errors(15.7), errors(10.0))
    assert found.holds and found.partial


@pytest.mark.parametrize(("size", "said"), [(1.5, "NO_MISSING_EFFECT"), (3.3, "UNEXPLAINED")])
def test_errors_larger_than_the_noise_are_no_noise_however_slow(size: float, said: str) -> None:
    """Noise that lasts had taken up a lens of 11 mm where the noise is 2 mm: chi 1.29, nothing missing."""
    sigma = np.array([2e-3, 2e-3, 8e-3])
    slow = replace(errors(1.2), raw=SAMPLES * np.broadcast_to((size * sigma) ** 2, (10, 3)))
    assert slow.size(sigma) == pytest.approx(size)
    checked = Checked(
        state=None,
        before=slow,
        after=slow,
        judgement=None,
        problem=SimpleNamespace(sigma=sigma),  # type: ignore[arg-type]
        phased=False,
        rejected=(),
        near_noise=near_noise(slow, NONE, sigma),
    )
    assert checked.verdict.name == said


def test_where_the_runs_held_out_show_little_that_of_all_is_said() -> None:
    """One drawn run had a chi of 4 and all runs together 40, of which the page said nothing."""

    def checked(after: float | None) -> Checked:
        return Checked(
            state=None if after is None else SimpleNamespace(),  # type: ignore[arg-type]
            before=errors(40.1),
            after=errors(after or 40.1),
            judgement=None,
            problem=SimpleNamespace(),  # type: ignore[arg-type]
            phased=False,
            rejected=(),
        )

    (said,) = of_the_draw(checked(None), 4.07)
    assert said.endswith("over all runs chi is 40.1 with the model as it is.")
    (found,) = of_the_draw(checked(1.02), 4.07)
    assert "40.1 with the model as it is, and 1.02 with what was found" in found
    assert not of_the_draw(checked(None), 30.0)


def test_unseen_runs_that_are_off_are_no_noise_where_all_together_look_like_it() -> None:
    """A ramp that few runs crossed: chi 1.16 over all, 1.39 over the unseen ones, "no missing effect"."""
    chi = np.where(LAST_TWO, 1.39, 1.1)
    assert errors(chi).chi() < SETTINGS.noise_chi
    assert not near_noise(errors(chi), LAST_TWO, np.ones(3))
    assert near_noise(errors(chi), NONE, np.ones(3))


def test_beside_noise_stated_too_large_the_share_is_of_the_whole() -> None:
    """All of what is left may be noise: only the whole is there to take a share of."""
    assert explained_share(0.4, 0.3) == pytest.approx(1.0 - 0.75**2)
    assert explained_share(0.9, 0.85) < 0.25 and explained_share(0.9, 1.0) < 0.0
    assert explained_share(0.0, 0.0) == 0.0
    assert judged(errors(0.8), errors(0.6)).holds and not judged(errors(0.8), errors(0.75)).holds


def test_where_lasting_noise_takes_up_what_is_missing_the_share_is_that_of_the_errors() -> None:
    """A wheel 12 % too large, 7.2 mm where the noise is 2 mm: 14 % of what was whitened, chi 0.83."""
    sigma = np.array([2e-3, 2e-3, 8e-3])

    def as_large(found: RunErrors, size: float) -> RunErrors:
        return replace(found, raw=SAMPLES * np.broadcast_to((size * sigma) ** 2, (10, 3)))

    before, after = as_large(errors(0.83), 3.6), as_large(errors(0.77), 1.1)
    assert not judge(before, after, LAST_TWO).holds
    held = judge(before, after, LAST_TWO, sigma=sigma)
    assert held.holds and held.explained == pytest.approx(1.0 - (1.1**2 - 1.0) / (3.6**2 - 1.0))
    assert not judge(before, as_large(errors(0.77), 3.4), LAST_TWO, sigma=sigma).holds
    small = as_large(errors(0.83), 1.8)
    assert not judge(small, after, LAST_TWO, sigma=sigma).holds, "errors that noise may make"


def test_explained_share() -> None:
    assert explained_share(3.0, 1.0) == 1.0 and explained_share(3.0, 0.9) == 1.0
    assert explained_share(3.0, 2.0) == pytest.approx(1.0 - 3.0 / 8.0)
    assert explained_share(3.0, 4.0) < 0.0


def test_signs_are_tried_one_and_all_or_drawn() -> None:
    assert sign_flip_p_value(np.array([1.0, 2.0])) == 0.25
    assert sign_flip_p_value(np.zeros(0)) == 1.0
    assert sign_flip_p_value(np.ones(20)) == pytest.approx(1 / 4096)
    random = np.random.default_rng(3)
    p = [sign_flip_p_value(random.normal(size=9)) for _ in range(400)]
    assert np.mean(np.array(p) <= 0.05) == pytest.approx(0.05, abs=0.03)


def test_groups_hold_every_run_once() -> None:
    for count in (1, 2, 3, 5, 9, 10, 13, 36):
        found = groups(count)
        assert np.concatenate(found).tolist() == list(range(count))
        assert min(len(g) for g in found) >= min(2, count)


def test_a_run_may_pay_a_small_part_of_what_all_gain() -> None:
    before, after = np.full(10, 20.0), np.full(10, 1.05)
    before[4], after[4] = 1.0, 1.6
    assert judged(errors(before), errors(after)).worse == 0
    after[4] = 9.0
    assert judged(errors(before), errors(after)).worse == 1


def test_a_first_look_at_few_runs_leaves_chance_to_all_of_them() -> None:
    before, after = errors([9.0, 9.0, 1.5], runs=3), errors([3.0, 3.0, 1.6], runs=3)
    nobody = np.zeros(3, dtype=bool)
    assert any("chance" in f for f in judge(before, after, nobody).failures)
    assert judge(before, after, nobody, by_chance=False).holds


def test_one_run_bears_out_nothing() -> None:
    """It was called found from the run to which it was fitted."""
    found = judge(errors(9.0, runs=1), errors(1.0, runs=1), np.zeros(1, dtype=bool))
    assert found.failures[0].startswith("one run alone")


def test_runs_are_counted_as_the_files_are() -> None:
    after = np.ones(8)
    after[5:] = 9.0
    which = np.array([0, 1, 3, 4, 6, 7, 8, 9])
    found = judge(errors(4.0, runs=8), errors(after, runs=8), np.zeros(8, dtype=bool), numbers=which)
    assert any(f.startswith("runs 9 to 10 as a group") for f in found.failures)
    assert not any("nothing has seen" in f for f in found.failures), "all of them were seen, each fold apart"
