"""Cases: a command line and its files, drawn from the seed and the number of the case."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from pathlib import Path
from random import Random
from typing import Any

import tomllib
from robot_files import GOOD

from fuzz import foreign, mutate
from slipmargin.effects import WheelEffect
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.physics.variables import Basis, Frame, Target, Variable

DATA = Path(__file__).resolve().parents[1] / "data"
#: Families of functions with any number of coefficients.
_MANY = (Basis.POLYNOMIAL, Basis.FOURIER, Basis.HATS, Basis.ODD)
BUILT_IN = ("ohio-kiwi", "ohio-kiwi-symmetric", "robotino", "omni4", "mecanum4")


@dataclass(slots=True)
class Case:
    """One run: its words, and the files that it finds in its folder."""

    words: list[str]
    files: dict[str, bytes] = field(default_factory=dict)

    @property
    def command(self) -> str:
        """What is counted together."""
        return self.words[0] if self.words and self.words[0] in DRAWS else "other"


def draw(seed: int, number: int) -> Case:
    """The case of a number: the same on every machine."""
    random = Random(f"{seed}/{number}")
    names = list(DRAWS)
    command = random.choices(names, [DRAWS[n][0] for n in names])[0]
    case = DRAWS[command][1](random)
    if random.random() < 0.03:
        case.words = _words(random, case.words)
    return case


# --- robots ---------------------------------------------------------------------------------------------


@cache
def robots() -> tuple[dict[str, Any], ...]:
    """The good robots that are changed."""
    built_in = [
        resources.files("slipmargin.robots").joinpath(f"{n}.toml").read_text(encoding="utf-8")
        for n in BUILT_IN
    ]
    own = [file.read_text(encoding="utf-8") for file in sorted((DATA / "robots").glob("*.toml"))]
    return tuple(tomllib.loads(text) for text in (*built_in, *own, GOOD))


def drawn_robot(random: Random) -> dict[str, Any]:
    """A robot of 3 to 24 wheels that nobody has built."""
    size = 10.0 ** random.uniform(-1.5, 0.5)
    count = random.choice((3, 3, 3, 4, 4, 4, 4, 4, 5, 5, 6, 6, 8, 8, 12, 24))
    mecanum = random.random() < 0.4
    turn = random.uniform(0.0, 360.0)
    wheels = []
    for i in range(count):
        at = math.radians(turn + 360.0 * i / count + random.gauss(0.0, 5.0))
        reach = size * random.uniform(0.6, 1.4)
        wheel: dict[str, Any] = {
            "name": f"w{i}",
            "position_m": [reach * math.cos(at), reach * math.sin(at)],
            "drive_direction_deg": random.choice((0.0, 90.0)) if mecanum else math.degrees(at) + 90.0,
            "radius_m": size * random.uniform(0.1, 0.6),
            "roller_angle_deg": 45.0 * (-1) ** i if mecanum else 0.0,
            "rollers": random.choice((1, 6, 8, 30)),
            "rigid_fraction": random.choice((0.0, 0.0, 0.1, 0.5, 0.9)),
        }
        wheels.append(wheel)
    mass = 10.0 ** random.uniform(-1, 3)
    rules = ["equal", "static", "quasi-static"]
    robot: dict[str, Any] = {
        "schema": 1,
        "name": "drawn",
        "body": {
            "mass_kg": mass,
            "inertia_kg_m2": mass * (size * random.uniform(0.3, 1.5)) ** 2,
            "com_m": [size * random.gauss(0.0, 0.1), size * random.gauss(0.0, 0.1)],
            "com_height_m": random.choice((0.0, size * random.uniform(0.0, 2.0))),
        },
        "loads": {"model": random.choice(rules)},
        "friction": {
            "law": random.choice(("atan", "tanh")),
            "k_s_per_m": 10.0 ** random.uniform(0, 5),
            "grip": random.choice(("box", "disc-strip", "ellipse")),
        },
        "wheel": wheels,
        "surface": {
            "floor": {
                "roller": {"drive": random.uniform(0.02, 1.2), "transverse": _across(random)},
                "rigid": {"drive": random.uniform(0.02, 1.2), "transverse": random.uniform(0.0, 1.2)},
            }
        },
    }
    if random.random() < 0.4:
        speed, torque = 10.0 ** random.uniform(-1, 3), 10.0 ** random.uniform(-2, 2)
        robot["motor"] = {"max_speed_rad_s": speed, "stall_torque_N_m": torque}
    return robot


def _across(random: Random) -> float:
    """Mostly so little friction across that the wheels can roll that way."""
    return random.uniform(0.0, random.choice((0.02, 0.1, 0.8)))


def effect(random: Random, wheels: list[str]) -> dict[str, Any]:
    """An effect with parameters within their bounds."""
    if random.random() < 0.15:
        return _general(random, len(wheels))
    kind = random.choice(CATALOGUE)
    row: dict[str, Any] = {"name": kind.name}
    for p in kind.parameters:
        low, high = max(p.low, -1e3), min(p.high, 1e3)
        near = p.null + p.scale * random.gauss(0.0, 3.0)
        row[p.name] = random.choice((min(max(near, low), high), random.uniform(low, high), low, high))
    if random.random() < (0.3 if issubclass(kind, WheelEffect) else 0.02):
        row["wheels"] = [random.choice(wheels)]
    return row


def _general(random: Random, count: int) -> dict[str, Any]:
    trace = random.choice(
        ("wheel_angle", "position", "heading", "time", "velocity", "slip_speed", "wheel_load")
    )
    part = random.choice(("grip", "losses", "sensing", "transients"))
    terms = []
    for _ in range(random.choice((1, 1, 2, 20))):
        basis = random.choice(list(Basis))
        size = random.choice((1, 2, 3, 5)) if basis in _MANY or random.random() < 0.1 else 1
        term: dict[str, Any] = {
            "variable": random.choice(list(Variable)).name.lower(),
            "basis": basis.name.lower(),
            "shape": [
                random.choice((1.0, 2.0, 0.5, 8.0, 1e-6, -1.0))
                for _ in range(random.choice((2, 2, 2, 2, 1, 3)))
            ],
        }
        values = [random.gauss(0.0, random.choice((0.1, 0.1, 10.0))) for _ in range(size)]
        if part in ("grip", "transients"):
            term |= {"target": random.choice(list(Target)).name.lower(), "coefficients": values}
            term["wheel_weights"] = [1.0] * random.choice((count, count, count, 3))
        else:
            keys = ("fx_N", "fy_N", "mz_N_m") if part == "losses" else ("dx_m", "dy_m", "dphi_rad")
            term |= dict.fromkeys(keys, values)
            term |= {"frame": random.choice(list(Frame)).name.lower()} if part == "losses" else {}
        terms.append(term)
    return {"name": f"unnamed_{trace}", "part": part, "term": terms}


def robot_table(random: Random, count: int | None = None) -> dict[str, Any]:
    """A robot, mostly still a good one; of ``count`` wheels where that is asked for."""
    good = drawn_robot(random) if random.random() < 0.5 else random.choice(robots())
    if count is not None:
        good = random.choice([r for r in robots() if len(r["wheel"]) == count])
    good = json.loads(json.dumps(good))
    names = [w["name"] for w in good["wheel"]]
    if random.random() < 0.35:
        good.setdefault("effect", []).extend(
            effect(random, names) for _ in range(random.choice((1, 1, 2, 4)))
        )
    if random.random() < 0.1:
        good["body"]["mass_kg"] = f"{good['body']['mass_kg']} ± {0.05 * good['body']['mass_kg']}"
    if random.random() < 0.35:
        mutate.sizes(random, good, random.choice((1, 1, 2, 5)))
    changes = random.choice((0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 3))
    return mutate.tree(random, good, changes) if changes else good


def robot_file(
    random: Random, files: dict[str, bytes], name: str = "r.toml", count: int | None = None
) -> str:
    """Put a robot file among the files; the surface to ask for."""
    table = robot_table(random, count)
    data = mutate.toml(table).encode()
    if random.random() < 0.02:
        data = mutate.raw(random, data, random.choice((1, 3)))
    files[name] = data
    surfaces = table.get("surface")
    known = [s for s in surfaces if s and "\0" not in s] if isinstance(surfaces, dict) else []
    return random.choice(known) if known and random.random() < 0.98 else "floor"


# --- options --------------------------------------------------------------------------------------------


def outputs(random: Random, table: bool = True) -> list[str]:
    """Where to write: mostly JSON, which is judged."""
    words = ["--json", random.choice(("o.json", "o.json", "-"))] if random.random() < 0.8 else []
    if table and random.random() < 0.4:
        words += ["--out", "o.csv"]
    if random.random() < 0.04:
        words += ["--plot", random.choice(("o.svg", "o.png"))]
    return words


def option(random: Random, name: str, usual: tuple[Any, ...], share: float = 0.3) -> list[str]:
    """An option with a usual or a bad value, sometimes."""
    if random.random() > share:
        return []
    value = (
        random.choice(usual) if random.random() < 0.92 else random.choice((*mutate.NUMBERS, *mutate.WORDS))
    )
    return [name, str(value)[:400].replace("\0", "")]


def flag(random: Random, name: str, share: float = 0.2) -> list[str]:
    """A switch, sometimes."""
    return [name] if random.random() < share else []


def _words(random: Random, words: list[str]) -> list[str]:
    found = list(words)
    for _ in range(random.choice((1, 2))):
        at = random.randrange(len(found) + 1)
        way = random.random()
        if way < 0.3 and at < len(found):
            del found[at]
        elif way < 0.6:
            found.insert(at, random.choice(mutate.WORDS).replace("\0", "")[:500])
        elif way < 0.8 and at < len(found):
            found[at] = mutate.mixed(random, found[at]).replace("\0", "")[:500]
        elif at < len(found):
            found.insert(at, found[at])
    dangerous = ("--scheduler", "--jobs", "/", "..")
    return [w for w in found if not any(d in w for d in dangerous)]


# --- one draw a command ---------------------------------------------------------------------------------


def sweep(random: Random) -> Case:
    files: dict[str, bytes] = {}
    surface = robot_file(random, files)
    words = ["sweep", "r.toml", "--surface", surface, "--step", random.choice(("10", "30", "7.3"))]
    words += option(random, "--margin", (0, 0.1, 0.5, 0.99)) + option(
        random, "--grip", ("box", "ellipse", "disc-strip")
    )
    words += option(random, "--from", (0, -90, 720), 0.1) + option(random, "--to", (90, 360), 0.1)
    words += option(random, "--method", ("facets", "clarabel", "cvxpy"), 0.1) + option(
        random, "--delta-deg", (0, 30), 0.1
    )
    words += option(random, "--chance", (0.05, 0.5), 0.1)
    if random.random() < 0.2:
        files["p.csv"] = mutate.table(random, PULLS, random.choice((0, 1, 3))).encode()
        words += ["--measured", "p.csv"]
    return Case(words + outputs(random), files)


def polytope(random: Random) -> Case:
    files: dict[str, bytes] = {}
    words = ["polytope", "r.toml", "--surface", robot_file(random, files)]
    words += flag(random, "--rigid") + option(random, "--delta-deg", (0, 30), 0.1)
    return Case(words + outputs(random, table=False), files)


def bounds(random: Random) -> Case:
    files: dict[str, bytes] = {}
    words = ["bounds", "r.toml", "--surface", robot_file(random, files)]
    words += ["--step", random.choice(("15", "30", "45")), *option(random, "--margin", (0, 0.1, 0.5, 0.99))]
    words += flag(random, "--robust", 0.15) + option(random, "--yaw", (0, 0.1, 5), 0.1)
    words += option(random, "--grip", ("box", "ellipse", "disc-strip"), 0.1) + option(
        random, "--chance", (0.05,), 0.05
    )
    if random.random() < 0.1:
        words += ["--export", random.choice(("nav2", "roadrunner", "pathplanner", "choreo", "json")), "o.txt"]
    return Case(words + outputs(random), files)


def plan(random: Random) -> Case:
    files: dict[str, bytes] = {}
    surface = robot_file(random, files)
    rows = ["x_m,y_m,phi_rad"]
    x = y = phi = 0.0
    way, size = random.uniform(-3.0, 3.0), 10.0 ** random.uniform(-2, 1)
    for _ in range(random.choice((2, 3, 5, 9))):
        rows.append(f"{x:.6g},{y:.6g},{phi:.6g}")
        way += random.gauss(0.0, 0.5)
        x, y = x + size * math.cos(way), y + size * math.sin(way)
        phi += random.choice((0.0, random.gauss(0, 0.5)))
    text = "\n".join(rows) + "\n"
    files["w.csv"] = mutate.table(random, text, random.choice((0, 0, 0, 1, 2))).encode()
    words = ["plan", "r.toml", "w.csv", "--surface", surface, "--points", random.choice(("40", "80", "11"))]
    words += (
        ["--step", random.choice(("0.05", "0.02"))]
        if random.random() < 0.9
        else option(random, "--step", (0.005,), 1.0)
    )
    words += option(random, "--margin", (0, 0.1, 0.5, 0.99), 0.2) + flag(random, "--closed", 0.15)
    words += option(random, "--blend", (0.01, 0.1, 1), 0.2) if "--closed" not in words else []
    words += option(random, "--max-speed", (0.1, 1, 100), 0.2) + option(
        random, "--max-yaw-rate", (0.1, 1, 10), 0.1
    )
    words += option(random, "--start-speed", (0, 0.1, 2), 0.1) + option(
        random, "--end-speed", (0, 0.1, 2), 0.1
    )
    words += flag(random, "--robust", 0.1) + flag(random, "--verify", 0.1)
    if random.random() < 0.05:
        words += ["--export", random.choice(("choreo", "pathplanner")), "o.traj"]
    return Case(words + outputs(random), files)


def check(random: Random) -> Case:
    files: dict[str, bytes] = {}
    words = ["check", "r.toml", "t", "--surface", robot_file(random, files)]
    if random.random() < 0.7:
        count, step = random.choice((1, 2, 3, 10, 60)), random.choice((0.01, 0.1))
        a, b, c = (random.gauss(0.0, 1.0) for _ in range(3))
        rows = [f"{i * step:.6g},{a * (1 - math.cos(i * step)):.6g},{b * i:.6g},{c * math.sin(i * step):.6g}"
                for i in range(count)]  # fmt: skip
        text = "\n".join(["t_s,x_m,y_m,phi_rad", *rows]) + "\n"
        files["t"] = mutate.table(random, text, random.choice((0, 0, 1, 3))).encode()
    else:
        file = random.choice(
            sorted(p for p in (DATA / "trajectories").iterdir() if p.suffix in (".traj", ".json"))
        )
        found = mutate.tree(random, json.loads(file.read_text(encoding="utf-8")), random.choice((0, 1, 3)))
        files["t"] = json.dumps(found, allow_nan=True).encode()
    if random.random() < 0.03:
        files["t"] = mutate.raw(random, files["t"], 2)
    words += option(random, "--margin", (0, 0.1, 0.99), 0.2) + option(random, "--smooth", (0.05, 0.5, 5), 0.2)
    words += flag(random, "--robust", 0.1) + flag(random, "--strict", 0.1)
    return Case(words + outputs(random), files)


def simulate(random: Random) -> Case:
    files: dict[str, bytes] = {}
    surface = robot_file(random, files)
    count = len(tomllib.loads(GOOD)["wheel"])
    with suppress(ValueError, KeyError, TypeError):
        count = len(tomllib.loads(files["r.toml"].decode())["wheel"])
    names = ",".join(["t_s", *(f"omega{i + 1}_rad_s" for i in range(min(count, 40)))])
    rows = [",".join(f"{v:.6g}" for v in (0.05 * k, *(random.gauss(0.0, 5.0) for _ in range(min(count, 40)))))
            for k in range(random.choice((1, 2, 5)))]  # fmt: skip
    files["c.csv"] = mutate.table(
        random, "\n".join([names, *rows]) + "\n", random.choice((0, 0, 0, 1, 2))
    ).encode()
    words = ["simulate", "r.toml", "c.csv", "--surface", surface]
    words += option(random, "--step", (0.01, 0.1), 0.2) + option(random, "--until", (0.2, 0.5), 0.3)
    words += option(random, "--push", ("1,0,0", "0,5,0.1", "1e9,0,0", "1,2"), 0.2)
    words += option(random, "--theta0", ("0,0,0", "1,2,3", "0,0,0,0"), 0.1) + option(
        random, "--rtol", (1e-5, 1e-3), 0.1
    )
    if random.random() < 0.05:
        words += ["--export", random.choice(("choreo", "pathplanner")), "o.traj"]
    return Case(words + outputs(random), files)


def stop(random: Random) -> Case:
    """How soon it stands."""
    files: dict[str, bytes] = {}
    words = ["stop", "r.toml", "--surface", robot_file(random, files), "--step", random.choice(("45", "90"))]
    words += option(random, "--speed", (0.1, 1, 10), 0.5) + option(random, "--margin", (0, 0.1, 0.99), 0.2)
    return Case([*words, *flag(random, "--no-verify", 0.5), *outputs(random)], files)


def monitor(random: Random) -> Case:
    """A log, line by line."""
    files: dict[str, bytes] = {}
    surface = robot_file(random, files, count=random.choice((3, 4)))
    count = random.choice((3, 4))
    names = ["t_s", *(f"omega{i + 1}_rad_s" for i in range(count)), "gyro_rad_s"]
    rows = [
        ",".join(f"{v:.6g}" for v in (0.01 * k, *(random.gauss(0.0, 2.0) for _ in names[1:])))
        for k in range(60)
    ]
    text = "\n".join([",".join(names), *rows]) + "\n"
    files["l.csv"] = mutate.table(random, text, random.choice((0, 0, 1, 2))).encode()
    words = ["monitor", "r.toml", "l.csv", "--surface", surface]
    words += ["--false-alarms", "0.5"] if random.random() < 0.7 else option(random, "--false-alarms", (0.1,))
    if random.random() < 0.5:  # logged runs train in little time
        rig_data(random, files, trials=random.choice((1, 2)), rows=60)
        words += ["--train", random.choice(("d", "d", "d", "d", "d/trials", "no"))]
        if random.random() < 0.5:
            words[1], words[4] = "d/robot.toml", "floor"
    if random.random() < 0.4:
        words[2], files["stdin"] = "-", files.pop("l.csv")
        if random.random() < 0.1:
            files["stdin"] = mutate.raw(random, files["stdin"], 2)
    return Case([*words, *outputs(random)], files)


def explore(random: Random) -> Case:
    """The local page, and what is sent to it."""
    files: dict[str, bytes] = {}
    words = ["explore", "r.toml", "--no-browser"]
    surface = robot_file(random, files)
    words += ["--surface", surface] if random.random() < 0.8 else []
    words += option(random, "--port", (0, 0, -1, 70000), 0.1)
    if random.random() < 0.1:
        files["report.html"] = random.choice((b"<html>report</html>", b"\xff\xfe", b""))
        words += ["--report", "report.html"]
    foreign.requests(random, files)
    return Case(words, files)


def export(random: Random) -> Case:
    """The robot for another program."""
    files: dict[str, bytes] = {}
    form, ending = random.choice((("c", "h"), ("c", "h"), ("sdf", "sdf"), ("urdf", "urdf"), ("mjcf", "xml")))
    words = ["export", form, "r.toml", "--surface", robot_file(random, files), "--out", f"o.{ending}"]
    words += option(random, "--margin", (0, 0.1, 0.99), 0.2) if form == "c" else []
    return Case(words + (["--json", "o.json"] if random.random() < 0.5 else []), files)


def design(random: Random) -> Case:
    """Dimensions varied, or several robots side by side."""
    files: dict[str, bytes] = {}
    if random.random() < 0.4:
        return ideas(random, files)
    words = ["design", "r.toml", "--surface", robot_file(random, files, count=random.choice((3, 3, 4)))]
    keys = ("delta_deg=0:60:30", "mass_kg=1,5", "com_y_m=-0.01,0.01", "wheels=3,4", "circle_radius_m=0.1,0.2",
            "coefficient_ratio=0.1,1", "wheel_radius_m=0.02,0.05", "com_height_m=0,0.1")  # fmt: skip
    coupled = any(b'grip = "' + grip in files["r.toml"] for grip in (b"disc-strip", b"ellipse"))
    if coupled and random.random() < 0.8:
        for grip in (b"disc-strip", b"ellipse"):
            files["r.toml"] = files["r.toml"].replace(b'grip = "' + grip, b'grip = "box')
    elif coupled:  # a cone program a heading: a hundred times as long, so it is one design
        keys = ("mass_kg=2", "com_y_m=0.01", "circle_radius_m=0.1", "com_height_m=0.1")
    for _ in range(random.choice((1, 1, 1, 2))):
        words += [
            "--vary",
            random.choice(keys) if random.random() < 0.85 else mutate.mixed(random, random.choice(keys)),
        ]
    words += ["--static"] if len(keys) == 4 else flag(random, "--static", 0.8)
    words += option(random, "--uncertain", ("mass_kg=1:3", "com_y_m=-0.01:0.01"), 0.1)
    words += option(random, "--objective", ("f_worst", "start_worst_m_s2", "yaw_moment_N_m"), 0.1)
    words += ["--html", "o.html"] if random.random() < 0.05 else []
    return Case([w.replace("\0", "") for w in words] + outputs(random), files)


def ideas(random: Random, files: dict[str, bytes]) -> Case:
    """Two or three robots compared; mostly one robot with a few numbers changed."""
    surface = robot_file(random, files, count=random.choice((3, 4)))
    words = ["design", "r.toml"]
    for name in ("s.toml", "t.toml")[: random.choice((1, 1, 2))]:
        if random.random() < 0.7:
            with suppress(ValueError):
                other = tomllib.loads(files["r.toml"].decode())
                mutate.sizes(random, other, random.choice((1, 2, 4)))
                files[name] = mutate.toml(other).encode()
        else:
            robot_file(random, files, name, count=random.choice((3, 4)))
        words.append(name)
    words += [random.choice(("ohio-kiwi", "r.toml"))] if random.random() < 0.1 else []
    words += ["--html", "o.html"] if random.random() < 0.05 else []
    return Case([*words, "--surface", surface, *outputs(random)], files)


def reproduce(random: Random) -> Case:
    """The published numbers; what can be damaged is where they go and the words."""
    files = random.choice(({}, {"o": b"a file"}, {"o/reproduce.json": b"of another run"}, {"o.json": b"old"}))
    folders = ("o", "o", "o", "no/such", "", "o.json", "o/reproduce.json", ".", "o" * 300, "=1+1", "$x^2$")
    words = ["reproduce", "--out", random.choice(folders)]
    words += option(random, "--seed", (0, 1, -1, "x", 1e300), 0.8)
    words += ["--json", random.choice(("o.json", "-", "o", "o/reproduce.json", "no/o.json"))] * (
        random.random() < 0.6
    )
    return Case(_words(random, words) if random.random() < 0.7 else words, dict(files))


def measure(random: Random) -> Case:
    files: dict[str, bytes] = {}
    surface = robot_file(random, files, count=3)
    files["p.csv"] = mutate.table(random, PULLS, random.choice((0, 1, 1, 3))).encode()
    return Case(["measure", "p.csv", "r.toml", "--surface", surface, *outputs(random, table=False)], files)


def diagnose(random: Random) -> Case:
    way = random.random()
    if way < 0.35:
        return Case(*(foreign.campaign if way < 0.2 else foreign.pulls)(random))
    files: dict[str, bytes] = {}
    rig_data(random, files, trials=random.choice((0, 1, 2, 3, 3, 3, 3)), rows=random.choice((20, 40)))
    words = ["diagnose", "d", "--out", "o", "--budget", random.choice(("0.2", "0.2", "1"))]
    words += option(random, "--seed", (0, 1, 7), 0.2)
    return Case(words + (["--json", "o.json"] if random.random() < 0.3 else []), files)


def rig_data(random: Random, files: dict[str, bytes], trials: int, rows: int) -> None:
    """Put a data set of the rig among the files, in ``d``: short, and mostly with one file changed."""
    folder = DATA / "rig" / "a-null"
    logs = sorted((folder / "trials").glob("*.csv"))[:trials]
    names = [
        "robot",
        "head",
        *(["pulls"] if not logs or random.random() < 0.3 else []),
        *(p.name for p in logs),
    ]
    spoilt = set(random.sample(names, random.choice((0, 1, 1, 1, 2))))
    table = tomllib.loads((folder / "robot.toml").read_text(encoding="utf-8"))
    if "robot" in spoilt:
        if random.random() < 0.6:
            mutate.sizes(random, table, random.choice((1, 2)))
        else:
            table = mutate.tree(random, table, 1)
    files["d/robot.toml"] = mutate.toml(table).encode()
    head = tomllib.loads((folder / "dataset.toml").read_text(encoding="utf-8"))
    files["d/dataset.toml"] = mutate.toml(mutate.tree(random, head, int("head" in spoilt))).encode()
    if "pulls" in names:
        text = _short((folder / "pulls.csv").read_text(encoding="utf-8"), 30)
        files["d/pulls.csv"] = mutate.table(random, text, int("pulls" in spoilt)).encode()
    for file in logs:
        text = _short(file.read_text(encoding="utf-8"), rows)
        changes = random.choice((1, 1, 2)) if file.name in spoilt else 0
        files[f"d/trials/{file.name}"] = mutate.table(random, text, changes).encode()


def robotino(random: Random) -> Case:
    files: dict[str, bytes] = {}
    logs = sorted((DATA / "robotino_excerpt" / "gray_0.1").glob("*.csv"))
    names = []
    for k, file in enumerate(random.sample(logs, random.choice((1, 2)))):
        text = mutate.table(
            random, _short(file.read_text(encoding="utf-8"), 60), random.choice((0, 1, 2)), ";"
        )
        files[f"l{k}.csv"] = text.encode()
        names.append(f"l{k}.csv")
    words = ["import", "robotino", *names, "--out", "o", *flag(random, "--calibrate", 0.2)]
    words += option(random, "--smooth", (0, 0.2, 1), 0.3) + option(
        random, "--ticks-per-turn", (2000, 32000), 0.1
    )
    return Case(words + (["--json", "o.json"] if random.random() < 0.5 else []), files)


def csv(random: Random) -> Case:
    files: dict[str, bytes] = {}
    names = ["t", "px", "py", "h", "w1", "w2", "w3"]
    rows = [",".join(f"{v:.6g}" for v in (10 * k, k, -k, 0.1 * k, *(random.gauss(0, 50) for _ in range(3))))
            for k in range(random.choice((3, 30)))]  # fmt: skip
    files["l.csv"] = mutate.table(
        random, "\n".join([",".join(names), *rows]) + "\n", random.choice((0, 1, 2))
    ).encode()
    words = [
        "import",
        "csv",
        "l.csv",
        "--out",
        "o",
        "--robot",
        random.choice(("ohio-kiwi", "robotino", "mecanum4")),
    ]
    if random.random() < 0.5:
        words += ["--time", "t:ms", "--x", "px:mm", "--y", "-py:mm", "--heading", "h:deg"]
        words += [w for i in (1, 2, 3) for w in ("--wheel", f"w{i}:rpm")]
        if random.random() < 0.4:
            at = random.randrange(7, len(words))
            words[at] = mutate.mixed(random, words[at]).replace("\0", "")[:200]
    else:
        good = tomllib.loads(MAP)
        files["m.toml"] = mutate.toml(mutate.tree(random, good, random.choice((0, 1, 2)))).encode()
        words += ["--map", "m.toml"]
    return Case(words, files)


def imported(random: Random) -> Case:
    """A raw log of one of the formats."""
    return random.choice((robotino, csv, foreign_log))(random)


def foreign_log(random: Random) -> Case:
    """A log of another tool."""
    files: dict[str, bytes] = {}
    words = foreign.log_words(random, files)
    words += ["--out", "o", *flag(random, "--calibrate", 0.1), *flag(random, "--force", 0.1)]
    return Case(words + (["--json", "o.json"] if random.random() < 0.3 else []), files)


def robots_command(random: Random) -> Case:
    files: dict[str, bytes] = {}
    way = random.random()
    if way < 0.5:
        robot_file(random, files)
        words = ["robots", random.choice(("check", "show")), "r.toml"]
        words += ["--json", "o.json"] if words[1] == "check" and random.random() < 0.5 else []
        return Case(words + (["--plot", "o.svg"] if random.random() < 0.1 else []), files)
    if way < 0.7:
        kind = random.choice(("lekiwi", "kiwi", "xdrive", "mecanum", "ssl"))
        names = [w for w in mutate.WORDS if w not in ("nan", "inf")]  # a robot may be called so
        name = random.choice(("mine", *names)).replace("\0", "").replace("/", "")
        return Case(["robots", "new", name, *option(random, "--type", (kind,), 0.97)])
    text = URDF
    for _ in range(random.choice((0, 1, 2))):
        at = random.choice(tuple(_numbers_in(text)))
        text = text[: at[0]] + str(number_like(random)) + text[at[1] :]
    data = text.encode()
    if random.random() < 0.3:
        data = mutate.raw(random, data, random.choice((1, 2)))
    files["r.urdf"] = data
    return Case(["robots", "from-urdf", "r.urdf", "--out", "n.toml"], files)


def number_like(random: Random) -> str:
    """Something where a number is expected."""
    return str(random.choice((*mutate.NUMBERS, "x", "", "1 2")))[:60]


def _numbers_in(text: str) -> list[tuple[int, int]]:
    import re

    return [m.span() for m in re.finditer(r"-?\d+\.\d+", text)]


def other(random: Random) -> Case:
    """Commands that read no file of their own."""
    word = random.choice(("gravity", "rigid_sector", "stribeck", *mutate.WORDS)).replace("\0", "")
    words = random.choice(
        (
            ["effects", "show", word],
            ["effects", "list"],
            ["surfaces", "list", "--json", "-"],
            ["surfaces", "show", word, "--json", "o.json"],
            ["surfaces", "show", "carpet-omni-williams2002", "--json", "-"],
            [word],
            ["reproduce", "--out", "r.toml"],
            ["robots", "list"],
            ["robots", word],
        )
    )
    return Case(_words(random, words) if random.random() < 0.3 else words, {"r.toml": b""})


def _short(text: str, rows: int) -> str:
    return "\n".join(text.split("\n")[: rows + 3]) + "\n"


PULLS = "phi_rad,force_N\n" + "".join(
    f"{math.radians(a):.5f},{5.0 + math.sin(a) + 0.1 * k:.3f}\n" for a in range(0, 91, 15) for k in range(3)
)
MAP = """schema = 1
[time]
column = "t"
unit = "ms"
[pose]
x = { column = "px", unit = "mm" }
y = { column = "py", unit = "mm", scale = -1.0 }
heading = { column = "h", unit = "deg" }
[[wheel]]
speed = { column = "w1", unit = "rpm" }
[[wheel]]
speed = { column = "w2", unit = "rpm" }
[[wheel]]
speed = { column = "w3", unit = "rpm" }
"""
URDF = (
    '<robot name="u"><link name="base"><inertial><origin xyz="0.0 0.0 0.05"/><mass value="8.0"/>'
    '<inertia ixx="0.1" ixy="0.0" ixz="0.0" iyy="0.1" iyz="0.0" izz="0.15"/></inertial></link>'
) + "".join(
    f'<link name="wheel{i}"><inertial><mass value="0.3"/><inertia ixx="0.001" ixy="0.0" ixz="0.0" '
    f'iyy="0.001" iyz="0.0" izz="0.001"/></inertial><collision><geometry>'
    f'<cylinder radius="0.05" length="0.03"/></geometry></collision></link>'
    f'<joint name="wheel{i}_joint" type="continuous"><parent link="base"/><child link="wheel{i}"/>'
    f'<origin xyz="{0.2 * math.cos(2.1 * i):.4f} {0.2 * math.sin(2.1 * i):.4f} 0.05" rpy="0.0 0.0 0.0"/>'
    f'<axis xyz="{math.cos(2.1 * i):.4f} {math.sin(2.1 * i):.4f} 0.0"/></joint>'
    for i in range(3)
) + "</robot>"  # fmt: skip

#: Command → how often it is drawn, and how.
DRAWS: dict[str, tuple[float, Callable[[Random], Case]]] = {
    "sweep": (13, sweep),
    "polytope": (7, polytope),
    "bounds": (10, bounds),
    "plan": (12, plan),
    "check": (12, check),
    "simulate": (9, simulate),
    "stop": (5, stop),
    "monitor": (5, monitor),
    "export": (6, export),
    "design": (4, design),
    "measure": (4, measure),
    "diagnose": (5, diagnose),
    "import": (8, imported),
    "explore": (4, explore),
    "robots": (4, robots_command),
    "reproduce": (2, reproduce),
    "other": (3, other),
}
