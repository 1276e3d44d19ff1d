"""The limiter: within the limits, its direction kept, and the same in C as in Python."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import c_limiter
import limiter as measured
import numpy as np
import pytest
from c_limiter import COMPILERS, STRICT, CompiledLimiter
from hypothesis import given, settings, strategies as st
from robot_files import GOOD
from slipmargin_cli.main import status
from strategies import four_wheels, robots

import slipmargin as sm
from slipmargin.effects import Recipe
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.errors import InputError
from slipmargin.io.robot_text import write_recipe
from slipmargin.limits.bias import bias
from slipmargin.limits.motion import acceleration_limit
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Motion
from slipmargin.model import nominal_model
from slipmargin.onboard.limiter import _wrench as external_wrench, limit_twist, utilisation
from slipmargin.onboard.table import limit_table
from slipmargin.physics.friction_laws import LAWS
from slipmargin.physics.grips import GripShape
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import Body, Coefficients, LoadRule, Robot, Surface, Wheel

BUILT_IN = (("ohio-kiwi", "paper"), ("mecanum4", "floor"), ("omni4", "floor"), ("robotino", "gray"))
#: Motors of a kiwi that limit it, most of all by what their own rotors take.
WEAK = "stall_torque_N_m = 0.1\nreflected_inertia_kg_m2 = 0.0005\n"
OF = {kind.name: kind for kind in CATALOGUE}


def sized(limiter: sm.Limiter) -> np.ndarray:
    """What makes twists comparable: turning counts at the wheels."""
    return np.array([1.0, 1.0, np.mean(np.abs(limiter.table.along[2]))])


def drawn(limiter: sm.Limiter, count: int, seed: int) -> list[np.ndarray]:
    """Twists now and wanted, time steps, headings, accelerations: small steps, large ones, stops."""
    rng, size = np.random.default_rng(seed), 1.0 / sized(limiter)
    now = rng.normal(size=(count, 3)) * size * rng.choice([0.02, 0.3, 1.0], size=(count, 1))
    step = rng.normal(size=(count, 3)) * size * rng.choice([0.01, 0.3, 2.0], size=(count, 1))
    wanted = np.where(rng.uniform(size=(count, 1)) < 0.2, 0.0, now + step)
    pull = rng.normal(size=(count, 3)) * size * limiter.table.pull_m_s2
    return [now, wanted, rng.choice([0.001, 0.01, 0.05], size=count), rng.uniform(-4.0, 4.0, count), pull]


def with_rotors(inertia: float | None) -> Recipe:
    """A mecanum robot whose weak motors turn wheels and rotors of an inertia [kg m²]."""
    recipe = sm.read_robot("mecanum4")
    assert recipe.robot.motor is not None
    motor = replace(recipe.robot.motor, stall_torque_N_m=0.4, reflected_inertia_kg_m2=inertia)
    return replace(recipe, robot=replace(recipe.robot, motor=motor))


def special() -> list[tuple[str, Robot | object, str]]:
    """Robots that use every part of the algorithm: slopes, coupled grips, other laws, an uneven floor."""
    kiwi, mecanum = sm.read_robot("ohio-kiwi"), sm.read_robot("mecanum4")
    slope = OF["floor_tilt"](tilt_x_rad=0.03, tilt_y_rad=-0.02)
    partly = OF["roller_coupling"](strength=0.5), OF["slip_ratio_friction"](share=1.0, steepness=10.0)
    stiff = replace(mecanum.robot, suspension_N_per_mm=20.0, unevenness_mm=0.5)
    out = [
        ("slope", mecanum.with_effects(slope), "floor"),
        ("uneven", replace(mecanum, robot=stiff), "floor"),
        ("disc-strip", sm.read_robot("mecanum4", grip="disc-strip"), "floor"),
        ("rotors", with_rotors(0.004), "floor"),
        ("partly coupled", mecanum.with_effects(*partly), "floor"),
        ("ellipse", sm.read_robot("omni4", grip="ellipse"), "floor"),
    ]
    for law in LAWS:
        friction = replace(kiwi.robot.friction, name=law)
        out.append((law, replace(kiwi, robot=replace(kiwi.robot, friction=friction)), "paper"))
    return out


def compiler() -> str:
    found = c_limiter.compilers()
    if not found:
        pytest.skip("no C compiler: install gcc or clang to compare the header with Python")
    return found[0]


def differences(limiter: sm.Limiter, compiled: CompiledLimiter, count: int, seed: int) -> list[float]:
    """Largest difference of the three functions, of the inputs' size (the share: of its own)."""
    states = [x.astype(compiled.dtype).astype(float) for x in drawn(limiter, count, seed)]
    now, wanted, dt, heading, pull = states
    size = sized(limiter)
    found = []
    for inputs, mine, theirs in (
        ((now, wanted), limiter.limit_twist(now, wanted, dt, heading), compiled.limit_twist(*states[:4])),
        (
            (pull,),
            limiter.limit_acceleration(now, pull, heading),
            compiled.limit_acceleration(now, pull, heading),
        ),
    ):
        scale = np.max(np.abs(np.stack(inputs) * size), axis=(0, 2))
        found.append(float(np.max(np.max(np.abs(mine[0] - theirs[0]) * size, axis=1) / scale)))
    share, other = limiter.margin(now, pull, heading)[0], compiled.margin(now, pull, heading)[0]
    found.append(float(np.max(np.abs(share - other) / np.maximum(share, 1e-3))))
    return found


@pytest.mark.parametrize("double", [False, True], ids=["float", "double"])
@pytest.mark.parametrize("name", COMPILERS)
def test_the_header_compiles_strictly_and_computes_the_same(name: str, double: bool, tmp_path: Path) -> None:
    if not shutil.which(name):
        pytest.skip(f"no {name} on this machine")
    limiter = sm.Limiter("mecanum4", "floor", margin=0.1)
    compiled = CompiledLimiter(limiter, tmp_path, name, double=double)
    assert max(differences(limiter, compiled, 2000, 0)) < (1e-12 if double else 1e-5)


@pytest.mark.parametrize("case", special(), ids=lambda case: case[0])
def test_every_part_of_the_algorithm_is_the_same_in_c(case: tuple[str, Robot, str], tmp_path: Path) -> None:
    _, robot, surface = case
    limiter = sm.Limiter(robot, surface, margin=0.2)
    compiled = CompiledLimiter(limiter, tmp_path, compiler(), double=True)
    assert max(differences(limiter, compiled, 1000, 1)) < 1e-12


@pytest.fixture(scope="module")
def machines() -> list[tuple[str, object]]:
    return measured.machines(16)


@pytest.mark.parametrize("place", [4, 8, 10, 15])
def test_single_precision_is_as_near_as_its_numbers_allow(
    place: int, machines: list[tuple[str, object]], tmp_path: Path
) -> None:
    """1e-5 of the inputs, or what half a digit of inputs and tables moves the exact answer by.

    A quarter more for the numbers in between, which are rounded too.  The inverse of a 3 × 3 matrix missed by
    6e-5 where half a digit moves the answer by 1e-6 (robot 15).
    """
    name, model = machines[place]
    limiter = measured.ModelLimiter(model, 0.2)
    compiled = CompiledLimiter(limiter, tmp_path, compiler(), double=False)
    states = measured.drawn_states(limiter, 5000, np.random.default_rng(1))
    states = [x.astype(np.float32).astype(float) for x in states]
    off = measured.compared(limiter, compiled, states)
    some = np.flatnonzero(off.max(axis=0) > measured.WORTH_SHAKING)
    moved = measured.conditioned(limiter, [x[some] for x in states])
    assert np.sum(off > 1e-5) <= 2, "of 15 000 answers"
    assert np.all(off[:, some] <= np.maximum(1.25 * moved, measured.WORTH_SHAKING)), name


def test_wheels_whose_drag_uses_the_whole_grip_still_share(tmp_path: Path) -> None:
    """μ_T above μ_W on a disc-strip: no wheel had any grip left, and their shares were 0 over 0."""
    robot = four_wheels(grip=GripShape.DISC_STRIP)
    slick = replace(robot.surfaces[0], roller=Coefficients(drive=0.1, transverse=0.12))
    robot = replace(
        robot,
        surfaces=(slick,),
        load_rule=LoadRule.QUASI_STATIC,
        body=replace(robot.body, com_height_m=0.01),
    )
    limiter = sm.Limiter(robot, slick.name, margin=0.15)
    compiled = CompiledLimiter(limiter, tmp_path, compiler(), double=True)
    assert max(differences(limiter, compiled, 300, 0)) < 1e-11


@settings(max_examples=6)
@given(robots(motors=True, shapes=(GripShape.BOX, GripShape.DISC_STRIP)), st.integers(0, 1000))
def test_drawn_robots_are_the_same_in_c(
    tmp_path_factory: pytest.TempPathFactory, robot: Robot, seed: int
) -> None:
    limiter = sm.Limiter(robot, "floor", margin=0.15)
    compiled = CompiledLimiter(limiter, tmp_path_factory.mktemp("c"), compiler(), double=True)
    assert max(differences(limiter, compiled, 300, seed)) < 1e-11


@pytest.mark.parametrize("double", [False, True], ids=["float", "double"])
@pytest.mark.parametrize("named", BUILT_IN[:2], ids=lambda n: n[0])
def test_bad_numbers_give_finite_commands_within_the_limit(
    named: tuple[str, str], double: bool, tmp_path: Path
) -> None:
    limiter = sm.Limiter(*named, margin=0.1)
    compiled = CompiledLimiter(limiter, tmp_path, compiler(), double=double)
    rng, bad = np.random.default_rng(5), [np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0, 1e-300]
    now, wanted, dt, heading, pull = drawn(limiter, 4000, 2)
    for values in (now, wanted, dt, heading, pull):
        hit = rng.uniform(size=values.shape) < 0.15
        values[hit] = rng.choice(bad, size=int(hit.sum()))
    with np.errstate(over="ignore", invalid="ignore"):
        states = [x.astype(compiled.dtype).astype(float) for x in (now, wanted, dt, heading, pull)]
    now, wanted, dt, heading, pull = states
    for out, code in (
        compiled.limit_twist(now, wanted, dt, heading),
        compiled.limit_acceleration(now, pull, heading),
        limiter.limit_twist(now, wanted, dt, heading),
        limiter.limit_acceleration(now, pull, heading),
    ):
        assert np.all(np.isfinite(out)) and set(np.unique(code)) <= {0, 1, 2, 3, 4}
    share = compiled.margin(now, pull, heading)[0]
    assert np.all(np.isfinite(share))
    # whatever was wanted, for whatever time: a robot that keeps the margin is told a step that keeps it
    fine = (
        np.all(np.isfinite(now) & (np.abs(now) < 3.0), axis=1) & np.isfinite(dt) & (dt >= 1e-3) & (dt < 1.0)
    )
    out, code = compiled.limit_twist(now, wanted, dt, np.zeros(len(now)))
    kept = fine & np.isin(code, (0, 1, 2))
    kept[kept] = limiter.limit_twist(now[kept], now[kept], dt[kept])[1] == 0
    assert kept.sum() > 300
    # with load transfer the sharing of four wheels is that of an acceleration close by
    room = 0.02 if limiter.table.shares_by_load else 1e-4
    assert np.max(used(limiter, now[kept], out[kept], dt[kept])) <= 0.9 + room


def used(limiter: sm.Limiter, now: np.ndarray, end: np.ndarray, dt: np.ndarray) -> np.ndarray:
    """Largest share at the end of a step between two twists (its start may be anybody's)."""
    rate = (end - now) / dt[:, None]
    rate[:, 0] -= end[:, 2] * end[:, 1]
    rate[:, 1] += end[:, 2] * end[:, 0]
    return utilisation(limiter.table, end, rate, np.zeros(len(end))).max(axis=1)


@pytest.mark.parametrize("motor", ["", "stall_torque_N_m = 0.9\n", WEAK], ids=["none", "motor", "rotors"])
@pytest.mark.parametrize("speed", [0.05, 0.4])
def test_three_wheels_accelerate_exactly_to_the_limit_in_motion(speed: float, motor: str) -> None:
    """The limits' own road (facets of the zonotope, torque lines) ends where the limiter stops."""
    recipe = read(GOOD.split("[[effect]]")[0].replace("stall_torque_N_m = 0.9\n", motor))
    limiter, model = sm.Limiter(recipe, "paper", margin=0.2), recipe.build("paper")
    rng = np.random.default_rng(0)
    way = rng.normal(size=(200, 3)) * [1.0, 1.0, 8.0]
    now = way / np.linalg.norm(way * [1.0, 1.0, 0.1], axis=1, keepdims=True) * speed
    ask = rng.normal(size=(200, 3)) * [50.0, 50.0, 500.0]
    limit = acceleration_limit(model, Motion(velocity=now), ask, share=limiter.table.share)
    got, code = limiter.limit_acceleration(now, ask)
    inside = (limit.value > 0.0) & (limit.value < 1.0)
    assert inside.sum() > 50
    share = np.linalg.norm(got, axis=1) / np.linalg.norm(ask, axis=1)
    np.testing.assert_allclose(share[inside], limit.value[inside], rtol=2e-4)
    assert set(code[inside]) == {1}


def test_a_step_leaves_motors_what_heavy_rotors_take() -> None:
    """Both ends of steps from every twist that can be kept: motors gave up to 2.3 times what they may."""
    recipe = read(GOOD.split("[[effect]]")[0].replace("stall_torque_N_m = 0.9\n", WEAK))
    limiter, model = sm.Limiter(recipe, "paper", margin=0.2), recipe.build("paper")
    now, wanted, dt, heading, _ = drawn(limiter, 3000, 3)
    fine = limiter.limit_twist(now, now, dt, heading)[1] == 0
    now, wanted, dt, heading = (x[fine] for x in (now, wanted, dt, heading))
    end, code = limiter.limit_twist(now, wanted, dt, heading)
    some, share = code == 1, []
    rate = ((end - now) / dt[:, None])[some]
    for twist in (now[some], end[some]):
        a = rate + np.cross(twist * [0.0, 0.0, 1.0], twist * [1.0, 1.0, 0.0])
        torque = realised(model, Motion(velocity=twist, acceleration=a)).torque_N_m
        share.append(torque_use(model, torque, model.geometry.wheel_speeds(twist)).max(axis=1))
    over = np.max(share, axis=0) - limiter.table.share
    # a row whose drag on the way leaves no room at the start says nothing of the end: one step
    assert some.sum() > 300 and np.sum(over > 1e-3) <= 1 and np.max(over) < 0.02
    assert np.mean(over > -0.02) > 0.3, "and it is no coward"


def test_four_wheels_with_heavy_rotors_use_the_share_of_their_motors() -> None:
    """What it allows, realised, takes the share of the motors: it took 1.5 times as much."""
    recipe, ask = with_rotors(0.004), np.array([[0.0, 50.0, 0.0]])
    limiter = sm.Limiter(recipe, "floor", margin=0.1)
    model, still = recipe.build("floor"), np.zeros((1, 3))
    step = limiter.limit_twist(still, ask, 0.001)[0] / 0.001  # shares wrenches as harder pulls do
    for got, less in ((limiter.limit_acceleration(still, ask)[0], 0.01), (step, 0.06)):
        torque = realised(model, Motion(velocity=still, acceleration=got)).torque_N_m
        share = np.max(torque_use(model, torque, still @ limiter.table.rolling.T))
        assert limiter.table.share - less < share < limiter.table.share + 0.01


def read(text: str) -> object:
    """A robot file's text as a recipe."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.toml"
        file.write_text(text, encoding="utf-8")
        return sm.read_robot(file)


@pytest.mark.parametrize("named", BUILT_IN, ids=lambda n: n[0])
def test_a_command_is_cut_back_along_its_own_line_and_can_be_kept(named: tuple[str, str]) -> None:
    limiter = sm.Limiter(*named, margin=0.1)
    now, wanted, dt, heading, _ = drawn(limiter, 3000, 4)
    if limiter.table.top_speed_rad_s is not None:
        fine = np.max(np.abs(wanted @ limiter.table.rolling.T), axis=1) < limiter.table.top_speed_rad_s
        now, wanted, dt, heading = (x[fine] for x in (now, wanted, dt, heading))
    keeps = limiter.limit_twist(now, now, dt, heading)[1] == 0  # the others turn too fast already
    now, wanted, dt, heading = (x[keeps] for x in (now, wanted, dt, heading))
    twist, code = limiter.limit_twist(now, wanted, dt, heading)
    cut = code == 1
    step, asked = (twist - now)[cut], (wanted - now)[cut]
    along = np.sum(step * asked, axis=1, keepdims=True) / np.sum(asked**2, axis=1, keepdims=True)
    assert cut.sum() > 300 and np.all((along >= 0.0) & (along <= 1.0))
    np.testing.assert_allclose(step, along * asked, atol=1e-12)
    again = limiter.limit_twist(twist[cut], twist[cut], dt[cut], heading[cut])
    assert np.all(again[1] == 0), "the twist it leads to can be kept"
    brake = limiter.limit_twist(twist[cut], np.zeros_like(twist[cut]), dt[cut], heading[cut])
    # loads that decide the sharing are known for an acceleration close by only: a few in a thousand
    assert np.mean(np.isin(brake[1], (0, 1))) > (0.995 if limiter.table.shares_by_load else 0.9999)


@settings(max_examples=25)
@given(robots(min_wheels=4, shapes=(GripShape.BOX,)), st.integers(0, 1000))
def test_more_than_three_wheels_use_no_more_than_it_counts(robot: Robot, seed: int) -> None:
    """The realised distribution, found by Newton's method, uses at most what the limiter counts on."""
    limiter, model = sm.Limiter(robot, "floor", margin=0.2), sm.read_robot(robot).build("floor")
    now, _, _, heading, pull = drawn(limiter, 60, seed)
    got, code = limiter.limit_acceleration(now, pull)
    fine = code <= 1
    if not np.any(fine):
        return
    real = realised(model, Motion(velocity=now[fine], acceleration=got[fine], heading=heading[fine] * 0.0))
    assert np.max(real.use) <= 0.8 + 0.02


def test_what_creep_shares_out_more_unevenly_than_grip_is_kept_back() -> None:
    """At the limit a wheel of this robot used 0.82003 where 0.82 is allowed."""
    places = (
        (0.0267302, -0.01361971, -180.0, -60.0),
        (-0.0007395, 0.02999088, -180.0, 45.0),
        (-0.0267302, 0.01361971, -180.0, -45.0),
        (0.00584003, -0.02942608, -179.9334, -45.0),
    )
    wheels = tuple(
        Wheel(
            name=f"w{k}",
            position_m=np.array([x, y]),
            drive_direction_deg=way,
            radius_m=0.02,
            roller_angle_deg=turn,
        )
        for k, (x, y, way, turn) in enumerate(places)
    )
    floor = Surface(
        name="floor",
        roller=Coefficients(drive=0.1, transverse=0.01268537),
        rigid=Coefficients(drive=0.1, transverse=0.05),
    )
    body = Body(mass_kg=0.5, inertia_kg_m2=2e-4, com_m=np.array([0.00127513, 0.0001412]))
    robot = Robot(name="odd", body=body, wheels=wheels, surfaces=(floor,), load_rule=LoadRule.EQUAL)
    limiter = sm.Limiter(robot, "floor", margin=0.2)
    now, _, _, heading, pull = drawn(limiter, 60, 168)
    got, code = limiter.limit_acceleration(now, pull)
    motion = Motion(velocity=now[code <= 1], acceleration=got[code <= 1], heading=heading[code <= 1] * 0.0)
    assert np.max(realised(sm.read_robot(robot).build("floor"), motion).use) <= 0.8 + 0.01
    table, text = limiter.table, limiter.c_header("make limit.h")
    assert table.uneven > 0.0 and f" *   {table.uneven:<8.4g} uneven creep" in text


def test_counted_operations_stay_below_those_the_header_states(tmp_path: Path) -> None:
    """A number type that counts, in place of float, in the compiled header."""
    from slipmargin.onboard.c_header import operations

    if not shutil.which("g++"):
        pytest.skip("no g++ on this machine")
    for k, (_, robot, surface) in enumerate([*special(), *((n, n, s) for n, s in BUILT_IN)]):
        limiter = sm.Limiter(robot, surface, margin=0.1)
        (tmp_path / "limit.h").write_text(limiter.c_header(), encoding="utf-8")
        (tmp_path / "count.cpp").write_text(COUNTING, encoding="utf-8")
        build = ["g++", "-std=c++17", "-O1", "-w", str(tmp_path / "count.cpp"), "-o", str(tmp_path / f"c{k}")]
        subprocess.run(build, check=True)
        done = subprocess.run([str(tmp_path / f"c{k}")], check=True, capture_output=True, text=True)
        twist, acceleration, share = (int(word) for word in done.stdout.split())
        stated = operations(limiter.table)
        assert 0.15 * stated["sm_limit_twist"] < twist <= stated["sm_limit_twist"]
        assert 0.2 * stated["sm_limit_acceleration"] < acceleration <= stated["sm_limit_acceleration"]
        assert 0.2 * stated["sm_margin"] < share <= stated["sm_margin"]


COUNTING = """
#include <cmath>
#include <cstdio>
#include <random>
static long counted;
struct Real {
  double x;
  Real() = default;
  constexpr Real(double v) : x(v) {}
  explicit operator long() const { return (long)x; }
};
#define OP(o) inline Real operator o(Real a, Real b) { ++counted; return Real(a.x o b.x); }
OP(+) OP(-) OP(*) OP(/)
#define IN(o) inline Real &operator o(Real &a, Real b) { ++counted; a.x o b.x; return a; }
IN(+=) IN(-=) IN(*=)
#define CMP(o) inline bool operator o(Real a, Real b) { ++counted; return a.x o b.x; }
CMP(<) CMP(>) CMP(<=) CMP(>=) CMP(==)
inline Real operator-(Real a) { ++counted; return Real(-a.x); }
inline Real root(Real a) { ++counted; return Real(std::sqrt(a.x)); }
#define SM_REAL Real
#define SM_SQRT(x) root(x)
#include "limit.h"
int main() {
  std::mt19937 draw(1);
  std::normal_distribution<double> n(0, 1);
  const double size[3] = {0.02, 0.3, 1.5};
  long most[3] = {0, 0, 0};
  for (int k = 0; k < 20000; ++k) {
    const double s = size[k % 3], r = size[(k / 3) % 3];
    sm_twist now = {Real(s * n(draw)), Real(s * n(draw)), Real(3 * s * n(draw))}, next;
    sm_twist to = {Real(r * n(draw)), Real(r * n(draw)), Real(3 * r * n(draw))};
    sm_acceleration a = {Real(n(draw)), Real(n(draw)), Real(3 * n(draw))}, b;
    counted = 0; sm_limit_twist(now, to, Real(0.01), Real(1.0), &next);
    if (counted > most[0]) most[0] = counted;
    counted = 0; sm_limit_acceleration(now, Real(1.0), a, &b);
    if (counted > most[1]) most[1] = counted;
    counted = 0; sm_margin(now, a, Real(1.0), nullptr);
    if (counted > most[2]) most[2] = counted;
  }
  std::printf("%ld %ld %ld", most[0], most[1], most[2]);
}
"""


def test_a_slope_makes_the_heading_matter() -> None:
    recipe = sm.read_robot("mecanum4").with_effects(OF["floor_tilt"](tilt_x_rad=0.1, tilt_y_rad=0.0))
    limiter = sm.Limiter(recipe, "floor")
    uphill = limiter.limit_acceleration([0, 0.2, 0], [0.0, 20.0, 0.0], -np.pi / 2 + np.pi)[0][1]
    downhill = limiter.limit_acceleration([0, 0.2, 0], [0.0, 20.0, 0.0], -np.pi / 2)[0][1]
    assert downhill > uphill + 0.5
    model = recipe.build("floor")
    for heading, mine in ((np.pi / 2, uphill), (-np.pi / 2, downhill)):
        motion = Motion(velocity=np.array([[0.0, 0.2, 0.0]]), heading=np.array([heading]))
        limit = acceleration_limit(
            model, motion, np.array([[0.0, 1.0, 0.0]]), share=limiter.table.share
        ).value[0]
        assert limit * 0.93 <= mine <= limit * (1.0 + 1e-4)


def test_refusals_name_the_argument() -> None:
    limiter = sm.Limiter("ohio-kiwi", "paper")
    with pytest.raises(InputError, match="now: has the shape"):
        limiter.limit_twist([0.0, 0.0], [1.0, 0.0], 0.01)
    with pytest.raises(InputError, match="dt_s: has the shape"):
        limiter.limit_twist([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], np.ones(3))
    with pytest.raises(InputError, match=r"margin: is 1\.5"):
        sm.Limiter("ohio-kiwi", "paper", margin=1.5)


def test_a_margin_that_constant_speed_uses_up_is_a_warning() -> None:
    assert any("constant speed" in w for w in sm.Limiter("ohio-kiwi", "paper", margin=0.6).warnings)
    assert not any("constant speed" in w for w in sm.Limiter("ohio-kiwi", "paper", margin=0.2).warnings)


def test_what_the_header_says_of_itself() -> None:
    text = sm.Limiter("ohio-kiwi", "paper", margin=0.1).c_header("make limit.h")
    assert "make limit.h" in text and sm.__version__ in text and "right, 1: left, 2: rear" in text
    assert "Share of the grip that may be used: 0.885.  What is kept back of the whole:" in text
    assert (
        " *   0.1      the margin\n *   0.015    creep, which overshoots" in text
        and "uneven creep" not in text
    )
    assert "malloc" not in text and text.count("#include") == 1 and STRICT


@pytest.mark.parametrize("of", [str, Path])
def test_the_command_in_a_header_makes_the_same_header(of: type, tmp_path: Path) -> None:
    """Python left the margin out, and a path was ROBOT."""
    robot, made, again = tmp_path / "my robot.toml", tmp_path / "made.h", tmp_path / "again.h"
    robot.write_text(write_recipe(sm.read_robot("mecanum4")), encoding="utf-8")
    margin = 0.1 + 0.2  # 0.30000000000000004
    sm.export_c(of(robot), "floor", made, margin=margin)
    said = re.search("with: slipmargin (.*)", made.read_text(encoding="utf-8"))
    assert said is not None
    words = shlex.split(said[1])
    assert words == ["export", "c", str(robot), "--surface", "floor", "--margin", str(margin)]
    assert status([*words, "--out", str(again)]) == 0
    assert again.read_text(encoding="utf-8") == made.read_text(encoding="utf-8")


def test_the_page_quotes_what_was_measured() -> None:
    root = Path(__file__).resolve().parents[3]
    found = json.loads((root / "benchmarks/results/limiter.json").read_text(encoding="utf-8"))
    page = (root / "docs/how-to/limiter.md").read_text(encoding="utf-8")
    for name, rows in found["ten manoeuvres"].items():
        for kind, row in rows.items():
            shown = (
                f"| {name} | {kind} | {row['distance lost [m]']:.2f} | "
                f"{row['largest share of the grip']:.3f} | "
                f"{row['manoeuvres over the margin']} | {row['largest turn of the direction [deg]']:.0f} |"
            )
            assert shown in page
    loop = found["closed loop"]
    assert loop["robots"] == 50 and loop["robots over the margin by 0.02, limiter"] == 0
    for kind in ("limiter", "per axis"):
        assert f"{loop[f'largest share, {kind}']:.3f}" in page
        assert f"{loop[f'robots over the margin by 0.02, {kind}']} of 50" in page
    for rows in found["cortex-m4, instructions a call"].values():
        assert f"{rows['sm_limit_twist']['most']:.0f}" in page
    against = found["against python"]
    single, cost = against["single precision"], against["microseconds a call"]
    assert against["states"] == 100_000 and against["largest difference"]["double"] < 1e-12
    assert f"{against['largest difference']['double']:.1e} of the inputs" in page
    assert f"{single['over 1e-5']} are not, the worst is {against['largest difference']['float']:.1e}" in page
    assert single["of them where half a digit of inputs and tables moves the exact answer by less"] == 0
    assert single["over 1e-5"] <= 5 and single["largest, in such movements"] < 1.25
    assert f"{single['largest, in such movements']:.2f} times such a movement" in page
    for kind in ("float", "double"):
        for name in ("ohio-kiwi", "mecanum4"):
            assert f"{cost[f'{name}, {kind}']['sm_limit_twist']:.2f}" in page
    assert max(row["sm_limit_twist"] for row in cost.values()) <= 1.0


def test_a_slope_and_a_force_at_another_height_shift_the_loads_as_they_do_at_rest() -> None:
    """Their moments need not point where their sum does, nor vanish with it."""
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.1)
    model = nominal_model(robot, "paper")

    def constant(x: float, y: float, height_m: float) -> ForceTerm:
        return ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            shape=np.array([1.0, 0.0]),
            coefficients=np.array([[x], [y], [0.0]]),
            frame=Frame.FLOOR,
            height_m=height_m,
        )

    for forces in (
        (constant(3.0, 0.0, 0.1), constant(-5.0, 1.0, 0.0)),
        (constant(2.0, 1.0, 0.1), constant(-2.0, -1.0, 0.0)),
    ):
        pushed = replace(model, external=replace(model.external, terms=forces))
        table = limit_table(pushed, 0.1)
        for phi in (0.0, 0.7, -2.4):
            _, _, shift = external_wrench(table, np.zeros((1, 3)), np.array([phi]))
            want = bias(pushed, np.array([phi])).load_N - bias(model, np.array([phi])).load_N
            np.testing.assert_allclose(shift, want, atol=1e-12 * model.inertia.weight_N)
            assert np.ptp(want) > 0.1 and table.turned


def test_a_command_cut_by_the_top_speed_is_not_reached() -> None:
    """A wish of 5 m/s ended at 0.59 m/s with the code of all that was wanted."""
    limiter = sm.Limiter("ohio-kiwi", "paper", margin=0.1)
    table = replace(limiter.table, top_speed_rad_s=20.0)
    wanted, now = np.array([[0.0, 5.0, 0.0]]), np.zeros((1, 3))
    for _ in range(4000):
        now, code = limit_twist(table, now, wanted, np.array([0.01]), np.zeros(1))
    assert np.max(np.abs(now @ table.rolling.T)) == pytest.approx(20.0) and code[0] == 1
    assert limit_twist(table, now, now * (1.0 - 1e-9), np.array([0.01]), np.zeros(1))[1][0] == 0


@pytest.mark.parametrize("margin", [0.986, 0.99])
def test_a_margin_that_leaves_nothing_beside_creep_is_refused(margin: float) -> None:
    """The share was negative, every command from rest refused, and the C file divided by it."""
    with pytest.raises(InputError, match="creep takes the rest") as told:
        sm.Limiter("ohio-kiwi", "paper", margin=margin)
    assert told.value.place == "margin"


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4"])
def test_what_grows_with_the_speed_counts_at_the_top_speed(name: str) -> None:
    """No state that was tried moved straight along an axis: 130 N counted for 150 N."""
    effect = OF["rolling_resistance"](coefficient=0.0, viscous_N_s_per_m=50.0)
    model = sm.read_robot(name).with_effects(effect).build("paper" if name == "ohio-kiwi" else "floor")
    table, arm, top = limit_table(model, 0.1), model.geometry.reach_m, model.drives.max_speed_rad_s
    way = np.diag([1.0, 1.0, 1.0 / arm])
    fastest = 3.0 if top is None else top / np.max(np.abs(way @ table.rolling.T), axis=1, keepdims=True)
    seen = external_in_motion(model, Motion(velocity=way * fastest))
    most = np.abs(np.diag(seen.low.sum(axis=0)))
    np.testing.assert_array_less(most * (1.0 - 1e-9), np.minimum(table.wrench_high, -table.wrench_low))
