"""Studies: the best design, why, the front, robustness, the optimum between the grid's points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits import Pull
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.sweep import limit
from slipmargin.robot import Coefficients, LoadRule, Surface
from slipmargin.study.columns import moving_columns
from slipmargin.study.evaluate import evaluate
from slipmargin.study.influence import influences
from slipmargin.study.laps import benchmark_paths, lap_times
from slipmargin.study.objectives import BY_NAME, OBJECTIVES, Kind, objective
from slipmargin.study.optimum import optimum
from slipmargin.study.pareto import front
from slipmargin.study.reason import reason
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.robust import parse_interval, robust
from slipmargin.study.study import DesignProblem, Study, study
from slipmargin.study.table import study_data, table_text
from slipmargin.study.vary import applied, parse_vary, quantity_of


def design(**changes: object) -> RobotOnSurface:
    return RobotOnSurface(recipe=Recipe(robot=kiwi(**changes)), surface="paper")  # type: ignore[arg-type]


def ask(
    texts: Sequence[str],
    kinds: tuple[Kind, ...] = (Kind.STATIC,),
    name: str = "f_worst",
    start: RobotOnSurface | None = None,
) -> Study:
    return study(
        DesignProblem(
            base=start or design(),
            grids=tuple(parse_vary(t) for t in texts),
            kinds=kinds,
            objective=objective(name),
        )
    )


@pytest.fixture(scope="module")
def angles() -> Study:
    return ask(["delta_deg=0:60:5"], (Kind.STATIC, Kind.MOTION))


def test_thirty_degrees_is_best_where_the_paper_says_and_only_there(angles: Study) -> None:
    """The claim "30° is preferable": so for every limit in motion, not for the pull under equal loads."""
    at = {name: angles.values[angles.best(name)][0] for name in angles.columns if name in BY_NAME}
    for name in ("start_worst_m_s2", "brake_worst_m_s2", "corner_m_s", "spin_rad_s2", "f_worst_static"):
        assert at[name] == 30.0
    assert at["f_worst"] == 35.0 and at["f_mean"] == 40.0 and at["f_rigid_worst"] == 25.0
    assert at["slip_share_rigid"] == 20.0
    gain = angles.columns["start_worst_m_s2"][6] / angles.own["start_worst_m_s2"]
    assert gain == pytest.approx(1.526, abs=1e-3)


def test_the_file_s_own_design_stands_beside(angles: Study) -> None:
    assert angles.own_values == (pytest.approx(15.0),)
    for name, column in angles.columns.items():
        assert column[3] == pytest.approx(angles.own[name], rel=1e-9, abs=1e-12), name


def test_every_objective_has_a_reason(angles: Study) -> None:
    for goal in OBJECTIVES:
        if goal.kind is not Kind.LAPS:
            assert str(reason(angles.design(angles.best(goal.name)), goal))


def test_reasons_name_the_wheels_that_a_model_names(angles: Study) -> None:
    """At δ = 15° along +x the rear wheel's drive force saturates (docs/theory.md, section 4: 0.531)."""
    own = angles.problem.base
    assert reason(own, BY_NAME["f_worst"]).what == ("right transverse", "left transverse", "rear drive")
    assert reason(own, BY_NAME["start_worst_m_s2"]).what == ("rear",)
    assert reason(own, BY_NAME["f_worst"]).where.startswith("weakest at φ = 0°")
    assert reason(own, BY_NAME["f_best"]).where.startswith("strongest at φ = 90°")  # section 2: 0.21296
    static = reason(design(load_rule=LoadRule.STATIC), BY_NAME["load_least"])
    assert static.what == ("rear",)
    assert "every wheel on rigid" in reason(own, BY_NAME["f_rigid_worst"]).where


def test_ties_go_to_the_greater_mean() -> None:
    found = ask(["mass_kg=1,2,3", "delta_deg=10,20"], name="load_least")
    assert len(found.ties("load_least")) == 6
    assert found.values[found.best()][1] == 20.0


def test_an_impossible_design_is_a_row_with_a_reason() -> None:
    found = ask(["com_y_m=-0.2,0", "delta_deg=10,20,90"])
    assert sorted(found.impossible) == [0, 1, 2, 5]
    assert "falls over" in found.impossible[0] and "delta_deg" in found.impossible[5]
    assert np.isnan(found.columns["f_worst"][[0, 1, 2, 5]]).all()
    assert found.best() in (3, 4)
    rows = table_text(found, ("f_worst", "f_mean")).splitlines()
    assert len(rows) == 7 and len({row.count(",") for row in rows}) == 1
    with pytest.raises(InputError, match="holds no possible design; the first"):
        ask(["com_y_m=-0.3,-0.2"]).best()


def test_the_file_s_own_design_may_be_impossible() -> None:
    found = ask(["com_y_m=0,0.01"], start=design(com_m=(0.0, 0.5)))
    assert found.own_problem is not None and "falls over" in found.own_problem
    assert math.isnan(found.own["f_worst"]) and not found.impossible


def test_an_objective_that_is_none_lists_the_known() -> None:
    with pytest.raises(InputError, match="did you mean 'f_worst'"):
        objective("f_wurst")
    with pytest.raises(InputError, match="use one of: f_worst, f_mean"):
        objective("beauty")


def test_less_is_better_where_it_is() -> None:
    found = ask(["mu_transverse=0.05,0.1,0.2"], (Kind.MOTION,), "slip_share_rigid")
    assert found.columns["slip_share_rigid"][found.best()] == np.min(found.columns["slip_share_rigid"])


def test_plain_data_of_a_study(angles: Study) -> None:
    data = study_data(angles)
    assert data["best"] == {"row": 7, "design": {"delta_deg": 35.0}, "value": angles.columns["f_worst"][7]}
    assert data["own"]["design"] == {"delta_deg": pytest.approx(15.0)}


@given(st.lists(st.tuples(*[st.sampled_from([0.0, 1.0, 2.0, 3.0, math.nan])] * 3), max_size=14))
def test_front_by_definition(rows: list[tuple[float, ...]]) -> None:
    values = np.array(rows).reshape(len(rows), 3)
    wanted = [
        not np.any(np.isnan(v)) and not any(np.all(w >= v) and np.any(w > v) for w in values) for v in values
    ]
    assert front(values).tolist() == wanted


def test_designs_that_differ_by_rounding_are_on_the_front_together() -> None:
    """Of nine equal designs one had a star."""
    up = float(np.nextafter(0.225, 1.0))
    values = np.array([[0.225, 1.7], [up, 1.7], [0.225, 1.6], [-math.inf, 1.8], [up, 1.0]])
    assert front(values).tolist() == [True, True, False, True, False]
    design = RobotOnSurface(recipe=read_recipe("mecanum4"), surface="floor")
    grids = (parse_vary("com_x_m=-0.02,0,0.02"), parse_vary("com_y_m=-0.02,0,0.02"))
    found = study(DesignProblem(base=design, grids=grids, kinds=()))
    names = ("f_worst", "f_rigid_worst")
    assert len(found.ties("f_worst")) == 9 and len(found.winners("f_worst")) == 0
    assert np.all(found.front(names))


def test_an_interval_given_twice_is_named() -> None:
    one, two = parse_interval("mu_drive=0.2:0.3"), parse_interval("mass_kg=1:2")
    with pytest.raises(InputError, match="mass_kg: is given twice"):
        robust([], BY_NAME["f_worst"], [one, two, two])


def test_the_robust_design_is_the_best_of_the_worst() -> None:
    """Against brute force over a fine grid of coefficients and all 2^N contact states, model by model."""
    found = ask(["delta_deg=10,25,30,45"])
    sure = robust(
        found.designs,
        found.problem.objective,
        [parse_interval("mu_drive=0.2:0.3"), parse_interval("mu_transverse=0.05:0.2")],
    )
    assert sure.exact and sure.goal.name == "f_low_worst"
    phi, brute = np.linspace(0.0, 2.0 * np.pi, 73), []
    for values in found.values:
        worst = math.inf
        for drive in np.linspace(0.2, 0.3, 4):
            for across in np.linspace(0.05, 0.2, 4):
                keys = [quantity_of(k) for k in ("delta_deg", "mu_drive", "mu_transverse")]
                model = applied(design(), keys, (values[0], drive, across)).build()
                for state in np.ndindex(2, 2, 2):
                    force = limit(model, phi, Pull(), np.array(state, dtype=bool))
                    worst = min(worst, float(np.min(force)) / model.inertia.weight_N)
        brute.append(worst)
    assert np.all(sure.value <= np.array(brute) * (1.0 + 1e-12))
    np.testing.assert_allclose(sure.value, brute, rtol=2e-3)  # headings 5° apart against 0.5°
    assert sure.best == int(np.argmax(sure.value))


def test_starting_is_concave_in_the_coefficients() -> None:
    """The claim that makes trying corners exact: inside the box no value is below the worst corner."""
    sure = robust(
        [design()],
        BY_NAME["start_mean_m_s2"],
        [parse_interval("mu_drive=0.2:0.3"), parse_interval("mu_transverse=0.02:0.2")],
    )
    inside = []
    rng = np.random.default_rng(5)
    for drive, across in zip(rng.uniform(0.2, 0.3, 12), rng.uniform(0.02, 0.2, 12), strict=True):
        model = applied(
            design(), [quantity_of("mu_drive"), quantity_of("mu_transverse")], (drive, across)
        ).build()
        inside.append(np.mean(directions(model, headings(1.0)).starting_m_s2))
    assert float(sure.value[0]) <= min(inside) + 1e-12


def test_robustness_refuses_nonsense() -> None:
    one = parse_interval("mu_drive=0.2:0.3")
    with pytest.raises(InputError, match="given twice"):
        robust([design()], BY_NAME["f_worst"], [one, one])
    with pytest.raises(InputError, match="no design that is possible"):
        robust([design()], BY_NAME["f_worst"], [parse_interval("com_y_m=0:0.5")])


def test_other_intervals_claim_corners_only() -> None:
    sure = robust([design(), None], BY_NAME["f_worst"], [parse_interval("com_y_m=-0.01:0.01")])
    assert not sure.exact and math.isnan(sure.value[1]) and sure.best == 0


def test_no_point_of_the_grid_beats_the_optimum(angles: Study) -> None:
    for name in ("f_worst", "isotropy", "start_worst_m_s2"):
        best = optimum(angles, objective(name))
        assert best.gain >= 0.0
        again = evaluate([best.design], objective(name))[0]
        assert again == pytest.approx(best.value, rel=1e-12)
    worst = optimum(angles, objective("f_worst"))
    assert worst.gain > 1e-5 and worst.values[0] == pytest.approx(35.72, abs=0.01) and worst.check < 1e-9
    start = optimum(angles, objective("start_worst_m_s2"))
    assert start.values == (30.0,) and start.check < 1e-9


def test_the_optimum_in_two_variables_beats_a_finer_grid() -> None:
    coarse = ask(["delta_deg=30:60:10", "com_y_m=-0.02:0.04:0.02"], name="f_worst_static")
    fine = ask(["delta_deg=30:60:1", "com_y_m=-0.02:0.04:0.002"], name="f_worst_static")
    best = optimum(coarse)
    assert best.value >= fine.columns["f_worst_static"][fine.best()] - 1e-5
    assert math.isnan(best.check)


def test_rounding_is_no_improvement() -> None:
    """At δ = 30° the centre of mass belongs at the centre, exactly: the grid's point is the answer."""
    best = optimum(ask(["com_y_m=-0.05:0.05:0.025", "com_height_m=0,0.1"], start=design(delta_deg=30.0)))
    assert best.values[0] == 0.0 and best.gain == 0.0


def test_an_optimum_needs_something_continuous() -> None:
    with pytest.raises(InputError, match="vary a number over a range"):
        optimum(ask(["wheels=3,4", "load_model=equal,static"]))


def test_an_optimum_steps_round_impossible_designs() -> None:
    found = ask(["com_y_m=-0.09:0.03:0.06", "com_x_m=-0.08:0.08:0.08"])
    assert found.impossible and optimum(found).gain >= 0.0


def test_influence_is_the_derivative() -> None:
    """More μ by 1 % on both coefficients is 1 % more pull: the shares add up to one (Euler)."""
    rows = {i.key: i for i in influences(design(), BY_NAME["f_worst"])}
    shares = [rows[k].slope * rows[k].value / rows[k].here for k in ("mu_drive", "mu_transverse")]
    assert sum(shares) == pytest.approx(1.0, rel=1e-6)
    assert "mass_kg" not in rows and "inertia_kg_m2" not in rows
    assert not rows["mu_drive"].peak
    assert next(i for i in influences(design(delta_deg=35.0), BY_NAME["f_worst"]) if i.key == "com_x_m").peak


def test_influence_at_the_edge_is_one_sided() -> None:
    rows = {i.key: i for i in influences(design(rigid_fraction=0.0), BY_NAME["slip_share_unknown"])}
    assert math.isnan(rows["rigid_fraction"].below) and math.isfinite(rows["rigid_fraction"].slope)


def test_laps_take_longest_where_grip_is_least() -> None:
    paths = {name: path for name, path in benchmark_paths().items() if name in ("forwards", "right")}
    fifteen, thirty = (lap_times(design(delta_deg=d).build(), paths) for d in (15.0, 30.0))
    assert fifteen["right"] > thirty["right"] and fifteen["forwards"] < thirty["forwards"]
    slips = applied(design(), [quantity_of("mu_transverse")], (0.26,)).build()
    assert math.isinf(lap_times(slips, paths)["right"])
    assert "no admissible motion" in str(
        reason(applied(design(), [quantity_of("mu_transverse")], (0.26,)), BY_NAME["laps_s"])
    )


def test_laps_are_a_column() -> None:
    found = ask(["mu_transverse=0.09,0.26"], (Kind.LAPS,), "laps_s")
    assert np.isnan(found.columns["laps_s"]).tolist() == [False, True] and found.best() == 0
    assert "seconds by path" in str(reason(found.design(0), BY_NAME["laps_s"]))


def test_a_design_that_cannot_brake_has_no_braking() -> None:
    """Wheels in line hold nothing across: −1 500 m/s² stood in the table, and flattened the picture."""
    same = Coefficients(drive=0.4, transverse=0.4)
    heavy = Surface(name="heavy", roller=same, rigid=same)
    robot = replace(kiwi(0.0), surfaces=(heavy,))
    found = moving_columns(RobotOnSurface(recipe=Recipe(robot=robot), surface="heavy"))
    for name in ("brake_worst_m_s2", "brake_mean_m_s2"):
        assert np.isnan(found[name]) or 0.0 <= found[name] < 100.0
