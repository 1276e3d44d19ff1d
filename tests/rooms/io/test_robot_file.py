"""Robot files: what is read is what was written, and only InputError ever escapes."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from robot_files import GOOD
from strategies import robots

from slipmargin.effects import Effect, GeneralEffect, Part, Recipe, Trace, WheelEffect
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.errors import InputError
from slipmargin.io.calibration_file import read_calibration
from slipmargin.io.campaign_file import read_joined
from slipmargin.io.data_set import read_data_set
from slipmargin.io.importers.csv_map import read_map
from slipmargin.io.robot_file import built_in_names, read_recipe, recipe_from_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.physics.friction_laws import LAWS
from slipmargin.physics.terms import ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import Coefficients, GripShape, LoadRule, Robot, Surface, Uncertain
from slipmargin.robot.fields import Key, Kind, keys, printable
from slipmargin.robot.sections import SECTIONS, Section

SHAPES = tuple(GripShape)


def same(a: object, b: object) -> bool:
    """Equal values, field by field; arrays element by element."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and np.array_equal(a, b)
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(same, a, b))
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return a == b


@st.composite
def effects(draw: st.DrawFn, names: tuple[str, ...]) -> Effect:
    kind = draw(st.sampled_from(CATALOGUE))
    values = [draw(st.floats(p.low, p.high)) for p in kind.parameters]
    if not issubclass(kind, WheelEffect):
        return kind.of(np.array(values))
    wheels = draw(st.lists(st.sampled_from(names), unique=True, max_size=len(names)))
    if wheels and kind is MotorLag:  # a dead time is that of every wheel
        values[-1] = 0.0
    return kind.of(np.array(values), tuple(wheels))


@given(st.data(), robots(shapes=SHAPES, motors=True))
@settings(max_examples=80, deadline=None)
def test_written_recipe_reads_back_the_same(data: st.DataObject, robot: Robot) -> None:
    effect = data.draw(effects(tuple(w.name for w in robot.wheels)))
    recipe = Recipe(robot=robot, effects=(effect,))
    try:
        effect.check_wheels(len(robot.wheels))
        recipe.build("floor")
    except InputError:
        recipe = Recipe(robot=robot)  # an effect this robot cannot have, a wheel lifted off for example
    back = recipe_from_text(write_recipe(recipe, "what it is\nand why"))
    assert same(recipe, back)


@given(robots(shapes=SHAPES, motors=True), st.sampled_from(LAWS), st.floats(1e-9, 1e6), st.floats(1e-9, 1e6))
@settings(max_examples=60, deadline=None)
def test_every_law_and_every_motor_key_reads_back(robot: Robot, law: str, k: float, inertia: float) -> None:
    motor = robot.motor and replace(robot.motor, reflected_inertia_kg_m2=inertia)
    friction = replace(robot.friction, name=law, k_s_per_m=k)
    recipe = Recipe(robot=replace(robot, friction=friction, motor=motor))
    back = recipe_from_text(write_recipe(recipe))
    assert same(recipe, back)
    model = back.build("floor")
    assert model.grip.law == LAWS.index(law) and model.grip.k_s_per_m == k
    assert model.drives.wheel_inertia_kg_m2 == (motor and inertia)


def test_the_law_of_the_file_reaches_the_model_and_the_file_written_from_it() -> None:
    for law in LAWS:
        recipe = recipe_from_text(GOOD.replace('law = "atan"', f'law = "{law}"'))
        assert recipe.robot.friction.name == law
        assert recipe.build("paper").grip.law == LAWS.index(law)
        assert f'law = "{law}"' in write_recipe(recipe.with_effects(RollingResistance.null()))


#: Names that can stand on a line; others are refused (tests/rooms/cli/test_text_is_data.py).
NAMES = st.text(min_size=1, max_size=199).filter(lambda name: bool(name.strip()) and printable(name))


@given(st.text(), NAMES, NAMES)
@settings(max_examples=200, deadline=None)
def test_any_name_and_any_comment_read_back(comment: str, name: str, floor: str) -> None:
    robot = read_recipe("ohio-kiwi").robot
    wheels = (replace(robot.wheels[0], name=name + "1"), *robot.wheels[1:])
    surfaces = (replace(robot.surfaces[0], name=floor),)
    recipe = Recipe(robot=replace(robot, name=name, wheels=wheels, surfaces=surfaces))
    assert same(recipe, recipe_from_text(write_recipe(recipe, comment)))


@pytest.mark.parametrize(
    ("basis", "shape"),
    [
        ("hats", "1e-6, 1e-6"),
        ("hats", "1.0, -1.0"),
        ("window", "1.0, 1.0"),
        ("polynomial", "0.0, 1.0"),
        ("fourier", "0.0, 0.0"),
        ("odd", "0.0, 1.0"),
        ("decay", "-1.0, 2.0"),
        ("decay", "1.0, 0.0"),
        ("step", "1.0, 0.0"),
        ("lobe", "0.5, 0.0"),
    ],
)
@pytest.mark.parametrize("part", ["grip", "losses", "sensing"])
def test_constants_with_which_an_unnamed_effect_has_no_value_are_refused(
    basis: str, shape: str, part: str
) -> None:
    terms = {
        "grip": 'target = "both", coefficients = [0.1], wheel_weights = [1.0, 1.0, 1.0]',
        "losses": 'fx_N = [0.1], fy_N = [0.1], mz_N_m = [0.1], frame = "body"',
        "sensing": "dx_m = [0.1], dy_m = [0.1], dphi_rad = [0.1]",
    }
    text = write_recipe(read_recipe("ohio-kiwi"), "") + (
        f'\n[[effect]]\nname = "unnamed_time"\npart = "{part}"\n'
        f'term = [{{variable = "time", basis = "{basis}", shape = [{shape}], {terms[part]}}}]\n'
    )
    with pytest.raises(InputError, match=rf"term\[1\]\.shape: is \[.*\], with which {basis} has no value"):
        recipe_from_text(text)


def test_unnamed_effects_read_back_the_same() -> None:
    kiwi = read_recipe("ohio-kiwi").robot
    grip = GeneralEffect(
        traced_to=Trace.WHEEL_ANGLE,
        part=Part.GRIP,
        terms=(
            Multiplier(
                variable=Variable.WHEEL_ANGLE,
                basis=Basis.FOURIER,
                target=Target.BOTH,
                shape=np.array([math.pi / 4, 0.0]),
                coefficients=np.array([0.1, -0.2]),
                wheels=np.array([1.0, 0.0, 1.0]),
            ),
        ),
    )
    force = GeneralEffect(
        traced_to=Trace.POSITION,
        part=Part.LOSSES,
        terms=(
            ForceTerm(
                variable=Variable.POSITION_X,
                basis=Basis.POLYNOMIAL,
                shape=np.array([1.0, 0.0]),
                coefficients=np.array([[0.1], [0.2], [0.3]]),
                frame=Frame.FLOOR,
            ),
        ),
    )
    recipe = Recipe(robot=kiwi, effects=(grip, force))
    assert same(recipe, recipe_from_text(write_recipe(recipe)))


def test_names_that_need_quoting_read_back_the_same() -> None:
    text = GOOD.replace('"rear"', '"Räder \\"hinten\\" \\\\"')
    text = text.replace("surface.paper", 'surface."lino 3.5"')
    recipe = recipe_from_text(text)
    assert same(recipe, recipe_from_text(write_recipe(recipe)))
    assert recipe.robot.surfaces[0].name == "lino 3.5"


def test_a_byte_order_mark_and_windows_lines_are_no_fault(tmp_path: object) -> None:
    path = tmp_path / "robot.toml"  # type: ignore[operator]
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert same(read_recipe(path), recipe_from_text(GOOD))


def test_defaults_are_the_published_model() -> None:
    text = GOOD.replace('[loads]\nmodel = "equal"\n', "").replace(
        '[friction]\nlaw = "atan"\nk_s_per_m = 1000.0\ngrip = "box"\n', ""
    )
    robot = recipe_from_text(text).robot
    assert robot.load_rule is LoadRule.EQUAL and robot.friction.grip is GripShape.BOX
    assert robot.friction.k_s_per_m == 1000.0


def test_a_file_that_gives_a_height_gets_load_transfer_unless_it_says_otherwise() -> None:
    tall = GOOD.replace("com_height_m = 0.0", "com_height_m = 0.05")
    silent = tall.replace('[loads]\nmodel = "equal"\n', "")
    recipe = recipe_from_text(silent)
    assert recipe.robot.load_rule is LoadRule.QUASI_STATIC
    assert recipe.build("paper").loads.follow_acceleration
    assert recipe_from_text(silent.replace("[friction]", "[loads]\n[friction]")).robot.load_rule is (
        LoadRule.QUASI_STATIC
    )
    assert recipe_from_text(tall).robot.load_rule is LoadRule.EQUAL
    assert recipe_from_text(silent.replace("com_height_m = 0.05\n", "")).robot.load_rule is LoadRule.EQUAL
    assert recipe_from_text(write_recipe(recipe)).robot.load_rule is LoadRule.QUASI_STATIC


@pytest.mark.parametrize("name", built_in_names())
def test_built_in_robots_build_on_every_surface(name: str) -> None:
    recipe = read_recipe(name)
    assert recipe.robot.name == name
    for surface in recipe.robot.surfaces:
        assert recipe.build(surface.name).count == len(recipe.robot.wheels)


def test_built_in_robots_of_the_contract() -> None:
    assert {"ohio-kiwi", "ohio-kiwi-symmetric", "robotino"} <= set(built_in_names())
    kiwi = read_recipe("ohio-kiwi").robot
    # docs/theory.md, sections 1 and 6: rho = 25.4 mm, Table I, 90 % rollers / 10 % rigid, n = 8, k = 1000.
    assert {w.radius_m for w in kiwi.wheels} == {0.0254} and {w.rigid_fraction for w in kiwi.wheels} == {0.10}
    assert {w.rollers for w in kiwi.wheels} == {8} and kiwi.friction.k_s_per_m == 1000.0
    table = {
        s.name: (s.roller.drive, s.roller.transverse, s.rigid.drive, s.rigid.transverse)
        for s in kiwi.surfaces
    }
    assert table == {"paper": (0.26, 0.09, 0.47, 0.47), "carpet": (0.25, 0.15, 0.56, 0.56)}
    # docs/theory.md, section 1: the printed no-slip wheel speeds for 0.4 m in 3.5 s along +X.
    from slipmargin.report.drawing import speeds

    printed = speeds(kiwi)[:, 0] * 0.4 / 3.5
    assert printed == pytest.approx([1.1645, 1.1645, -4.4994], abs=0.5e-4)


HUGE = "0x" + "f" * 5000  # Python reads it, and cannot write it into a message
KEYS = [(s, f, k) for s in SECTIONS for f, k in keys(s.kind, s.table).items() if k.kind is not Kind.TABLE]
KEYS += [(SECTIONS[-1], f, k) for f, k in keys(Coefficients).items()]


def with_value(section: Section, key: Key, value: str) -> tuple[str, str]:
    """The good file with one key set to a value, and the place that an error about it must name."""
    if section.kind is Surface:
        inner = {"drive": "0.26", "transverse": "0.09"} | {key.name: value}
        pair = "roller = { " + ", ".join(f"{k} = {v}" for k, v in inner.items()) + " }"
        text = GOOD.replace("roller = { drive = 0.26, transverse = 0.09 }", pair)
        return text, f"surface.paper.roller.{key.name}"
    place = section.heading.strip("[]").replace("wheel", "wheel[1]")
    head, table, rest = GOOD.partition(f"\n{section.heading}\n") if place else ("", "", GOOD)
    lines, gap, others = rest.partition("\n\n")
    kept = [line for line in lines.split("\n") if line.split(" =")[0] != key.name]
    text = head + table + "\n".join([*kept, f"{key.name} = {value}"]) + gap + others
    return text, f"{place}.{key.name}" if place else key.name


@pytest.mark.parametrize(("section", "field", "key"), KEYS, ids=lambda x: x if isinstance(x, str) else "")
def test_every_key_refuses_what_is_no_value_of_it(section: Section, field: str, key: Key) -> None:
    wrong = ["true", "{}", "[]", "[[1]]", "1979-05-27", '""', HUGE, f"[{HUGE}]", "nan", "-inf", "1e99999"]
    wrong += [] if key.kind is Kind.NAME else ['"x"', '"' + "x" * 5000 + '"']
    if math.isfinite(key.high):
        ends = [math.nextafter(key.low, -math.inf), math.nextafter(key.high, math.inf)]
        ends += [key.low] if key.above else []
        wrong += [f"[{end!r}, {end!r}]" if key.kind is Kind.LIST else repr(end) for end in ends]
    if key.kind is Kind.LIST:
        wrong += ["[0.0]", "[0.0, 0.0, 0.0, 0.0, 0.0]", "0.0", '[0.0, "x", 0.0]']
    if key.kind is Kind.WHOLE:
        wrong += ["8.0", "0", "1001", "9223372036854775808"]
    for value in wrong:
        text, place = with_value(section, key, value)
        with pytest.raises(InputError) as caught:
            recipe_from_text(text)
        assert caught.value.place.startswith(place), (value, str(caught.value))
        assert len(str(caught.value)) < 400 and "\n" not in str(caught.value)


def test_uncertain_coefficients_read_back_and_count_with_their_middle() -> None:
    for spelt, sd, ends in (
        ('"0.26 ± 0.02"', 0.02, (0.26, 0.26)),
        ('"0.26+-0.02"', 0.02, (0.26, 0.26)),
        ('"0.26 +/- 2e-2"', 0.02, (0.26, 0.26)),
        ("[0.25, 0.27]", None, (0.25, 0.27)),
    ):
        recipe = recipe_from_text(GOOD.replace("drive = 0.26", f"drive = {spelt}"))
        for one in (recipe, recipe_from_text(write_recipe(recipe)), pickle.loads(pickle.dumps(recipe))):
            found = one.robot.surfaces[0].roller.drive
            assert isinstance(found, Uncertain) and found == pytest.approx(0.26, rel=1e-15)
            assert found.sd == sd and found.ends == ends
            assert one.build("paper").grip.roller[0, 0] == float(found)
    for wrong in (
        '"0.26 ± 0"',
        '"0.26 ± 0.3"',
        '"0 ± 0.1"',
        '"± 0.1"',
        '"0.26 ± x"',
        "[0.3, 0.2]",
        "[0.1]",
        '"11 ± 1"',
    ):
        with pytest.raises(InputError) as caught:
            recipe_from_text(GOOD.replace("drive = 0.26", f"drive = {wrong}"))
        assert caught.value.place.startswith("surface.paper.roller.drive")


def test_gear_and_supply_reach_the_model_at_the_wheel() -> None:
    more = "gear_ratio = 19.2\nrotor_inertia_kg_m2 = 2e-6\nnominal_voltage_V = 12.0\nsupply_voltage_V = 10.8"
    recipe = recipe_from_text(GOOD.replace("stall_torque_N_m = 0.9", f"stall_torque_N_m = 0.9\n{more}"))
    drives = recipe.build("paper").drives
    # 10.8 V of 12 V: nine tenths of speed and torque; the rotor turns 19.2 times as fast.
    assert drives.max_speed_rad_s == pytest.approx(54.0, rel=1e-12)
    assert drives.stall_torque_N_m == pytest.approx(0.81, rel=1e-12)
    assert drives.wheel_inertia_kg_m2 == pytest.approx(2e-6 * 19.2**2, rel=1e-12)
    assert same(recipe, recipe_from_text(write_recipe(recipe)))


def test_a_key_without_effect_is_refused() -> None:
    stall, rotor = "stall_torque_N_m = 0.9", "gear_ratio = 9.0\nrotor_inertia_kg_m2 = 1e-6"
    for old, new, says in (
        (stall, f"{stall}\ngear_ratio = 9.0", "add rotor_inertia_kg_m2, or leave gear_ratio out"),
        (stall, f"{stall}\nrotor_inertia_kg_m2 = 1e-6", "add gear_ratio, or leave"),
        (stall, rotor, "add stall_torque_N_m, or leave"),
        (stall, f"{stall}\n{rotor}\nreflected_inertia_kg_m2 = 1e-4", "leave one of the two out"),
        (stall, f"{stall}\nsupply_voltage_V = 11.0", "add nominal_voltage_V, or leave"),
        (stall, f"{stall}\nnominal_voltage_V = 11.0", "add supply_voltage_V, or leave"),
        ('model = "equal"', 'model = "static"\nfractions = [0.3, 0.3, 0.4]', 'add model = "fixed", or leave'),
        ('model = "equal"', 'model = "fixed"', "loads.fractions: is missing"),
        ("stall_torque_N_m = 0.9", "reflected_inertia_kg_m2 = 1e-4", "add stall_torque_N_m, or leave"),
    ):
        with pytest.raises(InputError, match=re.escape(says)):
            recipe_from_text(GOOD.replace(old, new))


@given(st.text(max_size=300))
@example("[" * 5000)
@example("schema = " + HUGE)
@example(GOOD.replace('wheels = ["rear"]', f"wheels = [{HUGE}]"))
@example(GOOD.replace("[surface.paper]", '[surface.""]'))
@example("schema = " + "9" * 5000)
@example("schema = 1\nwheel = 1\nsurface = []\nbody = 3\neffect = 'x'\nname = 'a'")
@settings(max_examples=300, deadline=None)
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        recipe_from_text(text)
    except InputError as fault:
        assert "\n" not in str(fault)


@given(st.data())
@settings(max_examples=500, deadline=None)
def test_a_good_file_with_a_wound_is_read_or_refused(data: st.DataObject) -> None:
    lines = GOOD.split("\n")
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        wound = data.draw(st.sampled_from(("drop", "twice", "value", "letter", "swap")))
        if wound == "drop":
            lines[at] = ""
        elif wound == "twice":
            lines[at] += "\n" + lines[at]
        elif wound == "value" and "=" in lines[at]:
            value = data.draw(
                st.sampled_from(
                    (
                        "nan",
                        "-inf",
                        "true",
                        '""',
                        '"x"',
                        "[]",
                        "{}",
                        "[[1]]",
                        "-1",
                        "0",
                        "1e400",
                        "2026-01-01",
                        "{ drive = 1 }",
                        "[nan, 1]",
                        "[true, 1]",
                        "0x10",
                        "9" * 5000,
                        HUGE,
                        f"[0.0, {HUGE}]",
                        "1e99999",
                        "0.1e-99999",
                        '"\\u001b[31m\\u0000"',
                        "[0.0, 0.0, 0.0]",
                        "{ a = [{}] }",
                    )
                )
            )
            lines[at] = lines[at].split("=")[0] + "= " + value
        elif wound == "letter":
            cut = data.draw(st.integers(0, len(lines[at])))
            lines[at] = lines[at][:cut] + data.draw(st.characters()) + lines[at][cut:]
        else:
            other = data.draw(st.integers(0, len(lines) - 1))
            lines[at], lines[other] = lines[other], lines[at]
    try:
        recipe_from_text("\n".join(lines))
    except InputError as fault:
        assert "\n" not in str(fault)


@given(st.binary(max_size=200))
@settings(max_examples=100, deadline=None)
def test_any_bytes_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "bytes.toml"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_recipe(path)
    assert caught.value.source == str(path)


@pytest.mark.parametrize(
    ("name", "read", "start"),
    [
        ("robot.toml", read_recipe, "robots new NAME --type T"),
        ("dataset.toml", lambda file: read_data_set(file.parent), "docs/reference/data-set.md"),
        ("campaign.toml", read_joined, "docs/how-to/diagnose-a-campaign.md"),
        ("calibration.toml", read_calibration, "--calibrate"),
        ("map.toml", read_map, "--time"),
    ],
)
def test_every_kind_of_file_says_its_schema(
    tmp_path: Path, name: str, read: Callable[[Path], object], start: str
) -> None:
    for text, told in (
        ("", f"is empty: it holds no key, .*{re.escape(start)}"),
        ('name = "a"\n', "schema: is missing, write schema = 1$"),
        ("schema = 2\n", "schema: is 2, this program reads schema = 1$"),
        ("schema = 1.0\n", "schema: is 1.0, this program reads schema = 1$"),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=f"{name}: {told}"):
            read(tmp_path / name)


@pytest.mark.parametrize("key", ["scale_sd", "rotation_sd_rad", "delay_sd_s", "spread"])
def test_a_deviation_of_a_calibration_is_not_negative(tmp_path: Path, key: str) -> None:
    """−0.01 was taken, and squared on the way to an interval."""
    path = tmp_path / "calibration.toml"
    path.write_text(
        f"schema = 1\nscale = 1.0\nrotation_rad = 0.0\ndelay_s = 0.0\n{key} = -0.01\n", encoding="utf-8"
    )
    with pytest.raises(InputError, match="give 0 or a positive number") as told:
        read_calibration(path)
    assert told.value.place == key


def test_a_path_is_a_file_and_no_name_of_a_built_in_robot(tmp_path: Path) -> None:
    """A data set that named mecanum4 was asked whether it had meant mecanum4."""
    with pytest.raises(InputError, match="there is no such file, check the path"):
        read_recipe(tmp_path / "mecanum4")
