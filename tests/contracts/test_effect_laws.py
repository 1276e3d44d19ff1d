"""The laws that every effect of the catalogue obeys (a new effect is tested by being listed).

1. Null is identity, in a recipe that already holds other effects.
2. Two effects on one part commute, or refuse each other by name.
3. MeasurementModel and transient effects move no static limit.
4. Every other effect moves something: a static limit, a motion bound, or the simulated motion.
6. Furnished: source, unit, bounds that contain null, a strategy (here: ``strategies.effects``).

(Law 5, recoverable, is in the rooms of the diagnosis.)
"""

from __future__ import annotations

import ast
import inspect
import itertools
from dataclasses import FrozenInstanceError, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from strategies import effects, four_wheels, kiwi, robots

from slipmargin.api.robots import model_of
from slipmargin.diagnosis.sense import measure
from slipmargin.diagnosis.wheel_phase import matters_to
from slipmargin.effects import Effect, GeneralEffect, Part, Recipe, Scope, WheelEffect
from slipmargin.effects.catalogue import CATALOGUE, effect_class
from slipmargin.effects.command_dead_band import CommandDeadBand
from slipmargin.effects.command_ramp import CommandRamp
from slipmargin.effects.command_saturation import CommandSaturation
from slipmargin.effects.effect import Trace
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.motor_torque import MotorTorque
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.tether import Tether
from slipmargin.errors import InputError, NoSolution
from slipmargin.io.robot_file import recipe_from_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.limits.band import band
from slipmargin.limits.bounds import directions
from slipmargin.limits.motion_state import Contact
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import GripShape, LoadRule, Robot
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear

#: What 1 s of simulated motion at a relative tolerance of 1e-8 a step may be off [m, rad].
RUN = 1e-6
#: What an interior-point solver leaves of a limit where the grip is coupled [1].
CONE = 1e-6
EVERY = pytest.mark.parametrize("kind", CATALOGUE, ids=lambda k: k.name)
PHI = np.deg2rad(np.arange(3.0, 360.0, 60.0))
#: How a unit is spelled in a key's ending where it is not plain (contract: `m_s2`, `s_per_m`).
UNIT_WORDS = {
    "m/s": "m_s",
    "s²/rad": "s2_per_rad",
    "rad/s": "rad_s",
    "s/rad": "s_per_rad",
    "1/m²": "per_m2",
    "rad/(s N m)": "rad_s_per_N_m",
    "N s/m": "N_s_per_m",
    "N m": "N_m",
}
UNSEEN = (Part.SENSING, Part.TRANSIENTS)
#: Effects that bound what is asked for, or cut it off: nothing feels a small one.
BOUNDS = (CommandDeadBand, CommandRamp, CommandSaturation, MotorTorque)
SLOW = settings(deadline=None, max_examples=4, suppress_health_check=[HealthCheck.too_slow])


def machine() -> Robot:
    """A kiwi with everything an effect may act on: height, rigid sectors, an off-centre centre of mass."""
    return replace(kiwi(com_m=(0.004, -0.006), com_height_m=0.03, load_rule=LoadRule.STATIC), name="machine")


def statics(model: Model) -> np.ndarray:
    """F_emax on rollers and its band, rows; NaN where the robot slips without a pull."""
    low, high = band(model, PHI, Pull())
    try:
        nominal = limit(model, PHI, Pull())
    except NoSolution as fault:
        assert isinstance(fault.evidence, np.ndarray)
        nominal = fault.evidence
    return np.array([nominal, low, high])


def bounds(model: Model) -> np.ndarray:
    found = [
        directions(model, PHI, contact=c, speed_m_s=v)
        for c, v in ((Contact.ROLLERS, None), (Contact.UNKNOWN, 0.2))
    ]
    return np.array([(d.starting_m_s2, d.turning_m_s2, d.braking_m_s2) for d in found])


def ran(model: Model, *, commanded: bool) -> np.ndarray:
    """Pose (T, 3) of a run that speeds up, turns and stops hard enough to slip, as a camera sees it."""
    n = model.count
    t = np.array([0.0, 0.3, 0.6, 0.9, 1.0])
    top = 14.0 * np.cos(1.0 + 2.1 * np.arange(n))
    along, extra = np.array([[0.0, 1.0, 1.0, -0.4, 0.0], [0.0, 2.0, -3.0, 1.0, 0.0]])
    omega = along[:, None] * top + extra[:, None]
    clock = np.linspace(0.0, 1.0, 41)
    start = np.array([0.1, -0.2, 0.4])
    batch = Batch([linear(t, omega)], [clock], commanded=commanded).at_clock(model.measurement.clock)
    pose = batch.run(pack(model), start, rtol=1e-8).pose[0]
    return measure(model.measurement, [clock], pose[None])[0]


def everything(model: Model) -> list[np.ndarray]:
    return [statics(model), bounds(model), ran(model, commanded=False), ran(model, commanded=True)]


def build(robot: Robot, *chosen: Effect) -> Model:
    return with_effects(nominal_model(robot, robot.surfaces[0].name), chosen)


def possible(robot: Robot, *chosen: Effect) -> Model | None:
    """The model, or None where such a machine cannot stand (a wheel would lift)."""
    try:
        return build(robot, *chosen)
    except InputError as fault:
        assert "loads" in str(fault) or "wheel" in str(fault)
        return None


def same(one: Any, two: Any) -> bool:
    """Whether two parts are equal, numbers to rounding, terms in any order, words left out."""
    if type(one) is not type(two):
        return False
    if isinstance(one, str):
        return True
    if isinstance(one, tuple):
        rest = list(two)
        for item in one:
            match = next((r for r in rest if same(item, r)), None)
            if match is None:
                return False
            rest.remove(match)
        return not rest
    if isinstance(one, np.ndarray):
        return one.shape == two.shape and bool(np.allclose(one, two, rtol=1e-12, atol=1e-14))
    if hasattr(type(one), "__dataclass_fields__"):
        return all(same(getattr(one, f.name), getattr(two, f.name)) for f in fields(one))
    if isinstance(one, float):
        return bool(np.isclose(one, two, rtol=1e-12, atol=1e-14))
    return bool(one == two)


# Law 1 ------------------------------------------------------------------------------------------------


@EVERY
@SLOW
@given(data=st.data())
def test_null_does_nothing_beside_other_effects(kind: type[Effect], data: st.DataObject) -> None:
    others = tuple(data.draw(effects(tuple(k for k in CATALOGUE if k is not kind))) for _ in range(2))
    model = possible(machine(), *others)
    if model is None:
        return
    coupled = model.grip.shape is not GripShape.BOX
    for with_null in (build(machine(), *others, kind.null()), build(machine(), kind.null(), *others)):
        before, after = everything(model), everything(with_null)
        for without, there in zip(before[:2], after[:2], strict=True):
            np.testing.assert_allclose(there, without, rtol=CONE if coupled else 1e-9, atol=1e-12)
        for without, there in zip(before[2:], after[2:], strict=True):  # steps may differ, within their error
            np.testing.assert_allclose(there, without, rtol=0.0, atol=RUN)


@EVERY
@settings(deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow])
@given(robot=robots(max_wheels=4, rules=tuple(LoadRule), shapes=tuple(GripShape)))
def test_null_does_nothing_on_any_robot(kind: type[Effect], robot: Robot) -> None:
    model = nominal_model(robot, "floor")
    null = with_effects(model, (kind.null(),))
    if not same(null, model):  # a term with coefficient zero is allowed
        for phi in (0.3, 2.0):
            at = np.array([phi])
            np.testing.assert_allclose(limit(null, at, Pull()), limit(model, at, Pull()), rtol=1e-7)


# Law 2 ------------------------------------------------------------------------------------------------


def pairs() -> list[Any]:
    found = [p for p in itertools.combinations(CATALOGUE, 2) if p[0].part is p[1].part]
    return [pytest.param(a, b, id=f"{a.name}-{b.name}") for a, b in found]


@pytest.mark.parametrize(("one", "two"), pairs())
@settings(deadline=None, max_examples=20)
@given(data=st.data())
def test_two_effects_on_one_part_commute_or_refuse(
    one: type[Effect], two: type[Effect], data: st.DataObject
) -> None:
    robot = machine()
    names = tuple(w.name for w in robot.wheels)
    a = data.draw(effects((one,), least=0.2, wheels=names))
    b = data.draw(effects((two,), least=0.2, wheels=names))
    nominal = nominal_model(robot, "paper")
    try:
        first = with_effects(nominal, (a, b))
    except InputError as fault:
        if "would carry" in str(fault):  # a wheel lifts: no machine to compare
            return
        assert one.name in str(fault) and two.name in str(fault)
        with pytest.raises(InputError):
            with_effects(nominal, (b, a))
        return
    assert same(first, with_effects(nominal, (b, a)))


# Law 3 ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [k for k in CATALOGUE if k.part in UNSEEN], ids=lambda k: k.name)
@SLOW
@given(data=st.data())
def test_sensing_and_transients_move_no_static_limit(kind: type[Effect], data: st.DataObject) -> None:
    effect = data.draw(effects((kind,), reach=10.0, least=0.5))
    model, changed = build(machine()), build(machine(), effect)
    np.testing.assert_array_equal(statics(changed), statics(model))
    np.testing.assert_array_equal(bounds(changed), bounds(model))
    # and every command says so: a motor's lag was in no plan and no stopping distance, without a word
    _, warnings = model_of(Recipe(robot=machine(), effects=(effect,)), "paper")
    assert any(said.startswith(f"effect {kind.name}: counts in ") for said in warnings)


# Law 4 ------------------------------------------------------------------------------------------------


@EVERY
@settings(deadline=None, max_examples=6, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_every_effect_moves_something(kind: type[Effect], data: st.DataObject) -> None:
    robot = data.draw(st.sampled_from((machine(), four_wheels())))
    least, reach = (25.0, 60.0) if kind in BOUNDS else (0.5, 2.0)
    effect = data.draw(effects((kind,), least=least, reach=reach))
    changed = possible(robot, effect)
    if changed is None:
        return
    moved = [
        not np.allclose(x, y, rtol=1e-5, atol=1e-7, equal_nan=True)
        for x, y in zip(everything(build(robot)), everything(changed), strict=True)
    ]
    assert any(moved[:3]) or (kind.part is Part.TRANSIENTS and moved[3])


# Law 6 ------------------------------------------------------------------------------------------------


@EVERY
def test_furnished(kind: type[Effect]) -> None:
    assert kind.name == kind.name.lower() and effect_class(kind.name) is kind
    assert len(kind.source) > 10 and len(kind.confirm) > 10
    assert isinstance(kind.traced_to, Trace) and isinstance(kind.part, Part)
    assert isinstance(vars(kind).get("scope"), Scope), "it does not say what it belongs to"
    law = inspect.getdoc(kind) or ""
    assert len(law) > 10 and len(kind.summary) > 10 and kind.summary.endswith((".", ".)"))
    assert kind.parameters
    for p in kind.parameters:
        assert p.unit and p.meaning and p.low <= p.null <= p.high and p.low < p.high and p.scale > 0.0
        assert all(p.low <= start <= p.high for start in p.starts)
        assert abs(p.null) + p.scale <= max(abs(p.low), abs(p.high)), "a scale beyond the bounds"
        if p.unit != "1":
            word = UNIT_WORDS.get(p.unit, p.unit.replace("/", "_per_"))
            assert p.name.endswith(f"_{word}"), f"{p.name} does not end in its unit {p.unit}"


def test_names_are_unique_and_one_file_holds_one_effect() -> None:
    assert len({k.name for k in CATALOGUE}) == len(CATALOGUE)
    assert len({k.__module__ for k in CATALOGUE}) == len(CATALOGUE)
    folder = Path(inspect.getfile(Effect)).parent
    listed = {Path(inspect.getfile(k)).name for k in CATALOGUE}
    others = {"__init__.py", "effect.py", "recipe.py", "catalogue.py", "general.py"}
    helpers = {p.name for p in folder.glob("*.py")} - listed - others
    for name in helpers:  # a helper holds no effect of its own that nobody listed
        tree = ast.parse((folder / name).read_text(encoding="utf-8"))
        classes = [c for c in tree.body if isinstance(c, ast.ClassDef)]
        bases = [b.id for c in classes for b in c.bases if isinstance(b, ast.Name)]
        assert "Effect" not in bases, f"{name} holds an effect that the catalogue does not list"


@EVERY
@settings(deadline=None, max_examples=10)
@given(data=st.data())
def test_a_robot_file_keeps_an_effect(kind: type[Effect], data: st.DataObject) -> None:
    robot = machine()
    effect = data.draw(effects((kind,), wheels=tuple(w.name for w in robot.wheels)))
    if possible(robot, effect) is None:
        return
    (read,) = recipe_from_text(write_recipe(Recipe(robot=robot, effects=(effect,)))).effects
    assert type(read) is kind and getattr(read, "wheels", ()) == getattr(effect, "wheels", ())
    np.testing.assert_array_equal(read.values(), effect.values())  # type: ignore[union-attr]


@EVERY
def test_values_outside_the_bounds_are_refused_by_name(kind: type[Effect]) -> None:
    null = np.array([p.null for p in kind.parameters])
    for i, p in enumerate(kind.parameters):
        for bad in (p.low - p.scale, p.high + p.scale, float("nan"), float("inf")):
            with pytest.raises(InputError, match=p.name):
                kind.of(np.where(np.arange(len(null)) == i, bad, null))
    with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
        setattr(kind.null(), kind.parameters[0].name, 1.0)


# Which wheels ------------------------------------------------------------------------------------------


def half_a_scale(kind: type[Effect]) -> np.ndarray:
    """Parameters that do something, in their bounds; a dead time is that of all wheels and stays 0."""
    inside = [p.starts[0] if p.starts else p.null + 0.5 * p.scale for p in kind.parameters]
    return np.array([min(max(v, p.low), p.high) for p, v in zip(kind.parameters, inside, strict=True)])


def per_wheel(part: Any, count: int, where: str = "") -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Numbers of a part that each wheel has for itself, wheel first, and everything else."""
    own: dict[str, np.ndarray] = {}
    shared: dict[str, Any] = {}
    for f in fields(part):
        value = getattr(part, f.name)
        if f.name == "multipliers":
            for k, m in enumerate(value):
                own[f"{where}multiplier {k}"] = m.wheels
                shared[f"{where}multiplier {k}"] = replace(m, wheels=np.ones(count))
        elif isinstance(value, np.ndarray) and value.ndim and len(value) == count:
            own[where + f.name] = value
        else:
            shared[where + f.name] = value
    return own, shared


@EVERY
def test_an_effect_acts_on_the_named_wheel_only_or_has_no_wheels(kind: type[Effect]) -> None:
    values = half_a_scale(kind)
    if not issubclass(kind, WheelEffect):
        assert "wheels" not in {f.name for f in fields(kind)}  # type: ignore[arg-type]
        assert not hasattr(kind, "mask") and "wheels" not in inspect.signature(kind.of).parameters
        with pytest.raises(TypeError):
            kind.of(values, ("rear",))  # type: ignore[call-arg]
        return
    robot, field = replace(machine(), load_rule=LoadRule.STATIC), kind.part.field
    nominal = nominal_model(robot, "paper")
    if kind.part is Part.LOSSES:  # a force on the body: what each wheel contributes adds up to that of all
        models = [build(robot, kind.of(values, of)) for of in (*((w,) for w in nominal.geometry.names), ())]
        *single, every = ([t.coefficients for t in m.external.terms] for m in models)
        assert all(np.any(np.abs(c) > 0.0) for one in single for c in one)
        for parts, whole in zip(zip(*single, strict=True), every, strict=True):
            np.testing.assert_allclose(sum(parts), whole, rtol=1e-12)
        return
    part, changed = (getattr(m, field) for m in (nominal, build(robot, kind.of(values, ("rear",)))))
    everywhere = getattr(build(robot, kind.of(values)), field)
    rear, others = nominal.geometry.names.index("rear"), [0, 1]
    assert nominal.geometry.names[rear] == "rear" and rear not in others
    (before, rest), (after, kept), (full, _) = (per_wheel(p, 3) for p in (part, changed, everywhere))
    moved = False
    for name, now in after.items():
        # a new multiplier has no weight on any wheel before; a torque that is not known bounds nothing
        old = before.get(name, np.full_like(now, np.inf if name == "stall_torque_N_m" else 0.0))
        np.testing.assert_array_equal(now[others], old[others], err_msg=f"{name} of wheels not named")
        np.testing.assert_allclose(now[rear], full[name][rear], rtol=1e-15, err_msg=name)
        moved = moved or not np.array_equal(now[rear], old[rear])
    assert moved, "the named wheel is as it was"
    for name, value in kept.items():
        if name in rest:
            assert same(value, rest[name]), f"{name} belongs to the whole robot"


@EVERY
def test_a_robot_file_names_wheels_only_where_they_mean_something(kind: type[Effect]) -> None:
    text = write_recipe(Recipe(robot=machine())) + f'\n[[effect]]\nname = "{kind.name}"\n'
    text += "".join(
        f"{p.name} = {v!r}\n" for p, v in zip(kind.parameters, half_a_scale(kind).tolist(), strict=True)
    )
    text += 'wheels = ["rear"]\n'
    if issubclass(kind, WheelEffect):
        (effect,) = recipe_from_text(text).effects
        assert isinstance(effect, WheelEffect) and effect.wheels == ("rear",)
        return
    with pytest.raises(InputError) as refusal:
        recipe_from_text(text)
    said = str(refusal.value)
    assert said.startswith("effect[1].wheels:") and "not a known key" in said and "remove it" in said
    assert "\n" not in said


def test_a_dead_time_on_one_wheel_is_refused_where_it_is_given() -> None:
    with pytest.raises(InputError, match="acts on every wheel"):
        MotorLag(lag_s=0.1, delay_s=0.01, wheels=("rear",))


@pytest.mark.parametrize("kind", [k for k in CATALOGUE if issubclass(k, WheelEffect)], ids=lambda k: k.name)
def test_an_unknown_wheel_is_refused(kind: type[WheelEffect]) -> None:
    with pytest.raises(InputError, match="'nobody' is not a wheel"):
        build(machine(), kind.of(half_a_scale(kind), ("nobody",)))


# What an effect says of itself ---------------------------------------------------------------------------


@EVERY
def test_what_an_effect_says_of_its_fits_is_about_its_own_parameters(kind: type[Effect]) -> None:
    known = {p.name: p for p in kind.parameters}
    assert len({v.label for v in kind.variants}) == len(kind.variants)
    for variant in kind.variants:
        assert variant.free and set(variant.free) <= set(known)
        assert set(variant.fixed) <= set(known) - set(variant.free)
        assert all(known[n].low <= v <= known[n].high for n, v in variant.fixed.items())
    for name, values in kind.scanned.items():
        assert all(known[name].low <= v <= known[name].high for v in values)
        assert all(name not in v.free for v in kind.variants)
    assert not kind.parameters[0].idle, "the first parameter is the size of the effect"


@EVERY
def test_an_effect_says_truly_whether_it_depends_on_wheel_angles(kind: type[Effect]) -> None:
    robot = replace(kiwi(rigid_fraction=0.0), surfaces=kiwi().surfaces)
    assert not matters_to(build(robot))
    assert matters_to(build(robot, kind.of(half_a_scale(kind)))) == kind.needs_wheel_phase


@EVERY
def test_an_effect_says_truly_whether_it_needs_commands(kind: type[Effect]) -> None:
    effect = kind.of(half_a_scale(kind))
    model, changed = build(machine()), build(machine(), effect)
    measured = np.array_equal(ran(changed, commanded=False), ran(model, commanded=False))
    assert measured == kind.needs_commands


def test_the_catalogue_refuses_a_name_twice_and_forgets_what_was_registered() -> None:
    before = tuple(CATALOGUE)
    with pytest.raises(InputError, match="in the catalogue already"):
        CATALOGUE.register(MotorLag)
    CATALOGUE.remove(MotorLag)
    assert effect_class("motor_lag") is None
    with CATALOGUE.registered(MotorLag):
        assert effect_class("motor_lag") is MotorLag and CATALOGUE[-1] is MotorLag
    assert effect_class("motor_lag") is None
    CATALOGUE._effects[:] = before


# Slopes and heights ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("tilt", [(0.07, 0.0), (-0.2, 0.2), (0.0, 0.0)])
def test_a_slope_pulls_with_the_sine_and_lightens_with_the_cosine(tilt: tuple[float, float]) -> None:
    model = build(machine(), FloorTilt(tilt_x_rad=tilt[0], tilt_y_rad=tilt[1]))
    (term,), weight, angle = model.external.terms, model.inertia.weight_N, float(np.hypot(*tilt))
    pull = term.coefficients[:2, 0]
    assert np.hypot(*pull) == pytest.approx(weight * np.sin(angle), rel=1e-14)
    assert pull[0] * tilt[1] == pytest.approx(pull[1] * tilt[0], abs=1e-15) and pull @ tilt >= 0.0
    assert term.lift_N == pytest.approx(weight * (1.0 - np.cos(angle)), rel=1e-12)
    assert term.height_m is None and term.coefficients[2, 0] == 0.0


def test_a_cable_pulls_at_its_height() -> None:
    cable = Tether(stiffness_N_per_m=2.0, anchor_x_m=0.5, anchor_y_m=-0.1, height_m=0.3)
    terms = build(machine(), cable).external.terms
    assert [t.height_m for t in terms] == [0.3] * 3 and all(t.lift_N == 0.0 for t in terms)
    low = Tether(stiffness_N_per_m=2.0, anchor_x_m=0.5, anchor_y_m=-0.1)
    assert [t.height_m for t in build(machine(), low).external.terms] == [0.0] * 3


def test_a_general_force_keeps_its_height_and_lift_in_a_robot_file() -> None:
    for height in (None, 0.25, 0.0):
        term = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            shape=np.ones(2),
            frame=Frame.FLOOR,
            coefficients=np.array([[0.1], [0.0], [0.0]]),
            height_m=height,
            lift_N=0.5,
        )
        effect = GeneralEffect(traced_to=Trace.CONSTANT_FORCE, part=Part.LOSSES, terms=(term,))
        (read,) = recipe_from_text(write_recipe(Recipe(robot=machine(), effects=(effect,)))).effects
        assert isinstance(read, GeneralEffect)
        assert same(read.terms[0], term) and read.terms[0].height_m == height  # type: ignore[union-attr]
