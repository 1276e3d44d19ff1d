"""Bad input: exit status 2, one line that names the place, no traceback, no output file touched."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st
from robot_files import GOOD, broken
from slipmargin_cli.main import status

WHEELS = GOOD.split("[[wheel]]")
TWO_WHEELS = "[[wheel]]".join(WHEELS[:3]) + "\n[surface" + GOOD.split("[surface")[1]

SWEEP = ["sweep", "ohio-kiwi", "--surface", "paper"]

#: What is wrong → (file text or bytes, the place the one line must name).
FILES: dict[str, tuple[str | bytes, str]] = {
    "no TOML": (broken("mass_kg = 3.0", "mass_kg = = 3.0"), "5:11"),
    "cut off": (GOOD[: GOOD.index("[0.0, 0.0]") + 5], "7:14"),
    "empty file": (
        "",
        "robot.toml: is empty: it holds no key, `slipmargin robots new NAME --type T` writes one",
    ),
    "comments alone": ("# a robot\n", "robot.toml: is empty"),
    "not UTF-8": (GOOD.encode() + b"# caf\xe9\n", "58:6"),
    "schema of tomorrow": (broken("schema = 1", "schema = 2"), "schema"),
    "schema as a boolean": (broken("schema = 1", "schema = true"), "schema"),
    "no schema": (broken("schema = 1\n", ""), "schema: is missing, write schema = 1"),
    "unknown top key": (broken("[body]", "[bdy]"), "body"),
    "unknown section": (GOOD + "\n[wheels]\nn = 3\n", "wheels"),
    "unknown key": (broken("rollers = 8", "rollers = 8\ncolour = 1"), "wheel[1].colour"),
    "unit-less key": (broken("radius_m = 0.0254", "radius = 0.0254"), "wheel[1].radius_m"),
    "missing mass": (broken("mass_kg = 3.0\n", ""), "body.mass_kg"),
    "text for a number": (broken("mass_kg = 3.0", 'mass_kg = "3.0"'), "body.mass_kg"),
    "boolean for a number": (broken("mass_kg = 3.0", "mass_kg = true"), "body.mass_kg"),
    "negative mass": (broken("mass_kg = 3.0", "mass_kg = -3.0"), "body.mass_kg"),
    "negative radius": (broken("radius_m = 0.0254", "radius_m = -0.0254"), "wheel[1].radius_m"),
    "zero radius": (broken("radius_m = 0.0254", "radius_m = 0"), "wheel[1].radius_m"),
    "NaN": (broken("inertia_kg_m2 = 0.027", "inertia_kg_m2 = nan"), "body.inertia_kg_m2"),
    "infinite": (
        broken("drive_direction_deg = 105.0", "drive_direction_deg = inf"),
        "wheel[1].drive_direction_deg",
    ),
    "huge whole number": (broken("mass_kg = 3.0", "mass_kg = 1" + "0" * 400), "body.mass_kg"),
    "fraction above one": (broken("rigid_fraction = 0.1", "rigid_fraction = 1.1"), "wheel[1].rigid_fraction"),
    "half a roller": (broken("rollers = 8", "rollers = 8.5"), "wheel[1].rollers"),
    "no roller": (broken("rollers = 8", "rollers = 0"), "wheel[1].rollers"),
    "roller angle": (
        broken("roller_angle_deg = 0.0", "roller_angle_deg = 90.0"),
        "wheel[1].roller_angle_deg",
    ),
    "position of one number": (broken("[0.091763, 0.024588]", "[0.091763]"), "wheel[1].position_m"),
    "position of words": (broken("[0.091763, 0.024588]", '["a", "b"]'), "wheel[1].position_m[1]"),
    "two wheels": (TWO_WHEELS, "wheel: there are 2 wheels"),
    "no wheel": (
        GOOD.split("[[wheel]]")[0] + "[surface" + GOOD.split("[surface")[1].split("[[effect]]")[0],
        "wheel: there are 0 wheels",
    ),
    "single brackets": (TWO_WHEELS.replace("[[wheel]]", "[wheel]", 1).split("[[wheel]]")[0], "wheel:"),
    "a name twice": (broken('name = "left"', 'name = "right"'), "wheel[2].name"),
    "wheels all alike": (
        GOOD.replace("drive_direction_deg = 105.0", "drive_direction_deg = 0.0").replace(
            "drive_direction_deg = -105.0", "drive_direction_deg = 0.0"
        ),
        "wheel:",
    ),
    "wheels on one line": (GOOD.replace("0.024588", "-0.095"), "wheel:"),
    "centre of mass outside": (broken("com_m = [0.0, 0.0]", "com_m = [0.0, 0.2]"), "body.com_m"),
    "load model": (broken('model = "equal"', 'model = "eqal"'), "loads.model"),
    "fractions without fixed": (
        broken('model = "equal"', 'model = "equal"\nfractions = [0.3, 0.3, 0.4]'),
        "loads.fractions",
    ),
    "fractions of more than all": (
        broken('model = "equal"', 'model = "fixed"\nfractions = [0.5, 0.5, 0.5]'),
        "loads.fractions",
    ),
    "two fractions": (
        broken('model = "equal"', 'model = "fixed"\nfractions = [0.5, 0.5]'),
        "loads.fractions",
    ),
    "friction law": (broken('law = "atan"', 'law = "coulomb"'), "friction.law"),
    "grip set": (broken('grip = "box"', 'grip = "circle"'), "friction.grip"),
    "steepness": (broken("k_s_per_m = 1000.0", "k_s_per_m = 0.0"), "friction.k_s_per_m"),
    "motor without speed": (broken("max_speed_rad_s = 60.0\n", ""), "motor.max_speed_rad_s"),
    "no stall torque": (broken("stall_torque_N_m = 0.9", "stall_torque_N_m = 0.0"), "motor.stall_torque_N_m"),
    "no surface": (broken(GOOD[GOOD.index("[surface") :], ""), "surface"),
    "surface without rigid": (
        broken("rigid = { drive = 0.47, transverse = 0.47 }\n", ""),
        "surface.paper.rigid",
    ),
    "negative friction": (broken("drive = 0.26", "drive = -0.26"), "surface.paper.roller.drive"),
    "friction as a number": (
        broken("roller = { drive = 0.26, transverse = 0.09 }", "roller = 0.26"),
        "surface.paper.roller",
    ),
    "unknown effect": (broken('name = "stribeck"', 'name = "strbeck"'), "effect[1].name"),
    "effect out of bounds": (broken("dynamic_ratio = 0.8", "dynamic_ratio = -1"), "effect[1].dynamic_ratio"),
    "effect's unknown key": (broken("dynamic_ratio = 0.8", "dynamic_ratio = 0.8\nfoo = 1"), "effect[1].foo"),
    "effect without a parameter": (broken("dynamic_ratio = 0.8\n", ""), "effect[1].dynamic_ratio"),
    "effect on no such wheel": (broken('wheels = ["rear"]', 'wheels = ["raer"]'), "effect[1].wheels"),
    "unnamed effect of nothing": (
        GOOD + '\n[[effect]]\nname = "unnamed_heading"\npart = "grip"\n',
        "effect[2].term",
    ),
    "deeply nested": ("a = " + "[" * 4000, ":"),
}

#: What is wrong → (arguments after the sub-command, the place the one line must name).
LINES: dict[str, tuple[list[str], str]] = {
    "no command of that name": (["swep"], "swep"),
    "no such option": (["sweep", "ohio-kiwi", "--surfce", "paper"], "--surfce"),
    "no robot": (["sweep", "--surface", "paper"], "ROBOT"),
    "no surface": (["sweep", "ohio-kiwi"], "--surface"),
    "no such surface": (["sweep", "ohio-kiwi", "--surface", "ice"], "--surface: is 'ice'"),
    "no such robot": (["sweep", "ohio-kiwy", "--surface", "paper"], "ohio-kiwy"),
    "no such file": (["sweep", "nowhere/robot.toml", "--surface", "paper"], "nowhere/robot.toml"),
    "a folder as robot": (["sweep", ".", "--surface", "paper"], ".: is a folder"),
    "a null character": (["sweep", "a\0b", "--surface", "paper"], "is not a possible path"),
    "step in words": ([*SWEEP, "--step", "one"], "--step"),
    "step of nothing": ([*SWEEP, "--step", "0"], "--step"),
    "step NaN": ([*SWEEP, "--step", "nan"], "--step"),
    "far too many": ([*SWEEP, "--step", "1e-9"], "--step"),
    "backwards": ([*SWEEP, "--from", "9", "--to", "3"], "--to"),
    "infinite end": ([*SWEEP, "--to", "inf"], "--to"),
    "margin of one": ([*SWEEP, "--margin", "1"], "--margin"),
    "grip of no kind": ([*SWEEP, "--grip", "circle"], "--grip"),
    "method of no kind": ([*SWEEP, "--method", "magic"], "--method"),
    "δ too large": ([*SWEEP, "--delta-deg", "89"], "--delta-deg"),
    "δ of four wheels": (["sweep", "mecanum4", "--surface", "floor", "--delta-deg", "15"], "--delta-deg"),
    "no file of pulls": ([*SWEEP, "--measured", "none.csv"], "none.csv"),
    "out into no folder": ([*SWEEP, "--out", "no/where.csv"], "no/where.csv"),
    "out onto a folder": ([*SWEEP, "--out", "."], ".: is a folder"),
    "picture of no kind": ([*SWEEP, "--plot", "f.bmp"], "f.bmp"),
    "page as a picture": (
        [*SWEEP, "--report", "f.pdf"],
        "f.pdf: ends in '.pdf', which is no page, use one of: .html, .htm",
    ),
    "page without an ending": (["next-run", "d", "--space", "3x2", "--report", "f"], "f: ends in ''"),
    "page of designs": (["design", "ohio-kiwi", "--surface", "paper", "--html", "f.png"], "f.png"),
    "table as a workbook": ([*SWEEP, "--out", "f.xlsx"], "f.xlsx: ends in '.xlsx', which is no CSV table"),
    "JSON as a table": ([*SWEEP, "--json", "f.csv"], "f.csv: ends in '.csv', which is no JSON text"),
    "yaw beyond all grip": (
        ["bounds", "mecanum4", "--surface", "floor", "--yaw", "1000", "--export", "nav2", "f.yaml"],
        "rad/s² (--yaw)\n",
    ),
    "JSON into no folder": (["polytope", *SWEEP[1:], "--json", "no/f.json"], "no/f.json"),
    "argument too many": (["polytope", "ohio-kiwi", "two", "--surface", "paper"], "two"),
    "robots what": (["robots", "shw"], "shw"),
    "robot to show": (["robots", "show", "ohio"], "ohio"),
    "effect to show": (["effects", "show", "gravity"], "gravity"),
}

#: What is wrong → (text of a file of pulls, the place the one line must name).
PULLS = {
    "no force": ("phi_rad\n0.1\n", "force_N"),
    "no number": ("phi_rad,force_N\n0.1,five\n", "2:2"),
    "empty cell": ("phi_rad,force_N\n0.1,\n", "force_N"),
    "ragged": ("phi_rad,force_N\n0.1,5.0\n0.2,5.1,7\n", "3:3"),
    "no rows": ("phi_rad,force_N\n", "2:1"),
    "column twice": ("phi_rad,force_N,force_N\n0,1,1\n", "1:3"),
    "unknown column": ("phi_rad,force_N,colour\n0,1,1\n", "colour"),
    "infinite": ("phi_rad,force_N\n0,inf\n", "2:2"),
    "elsewhere": ("phi_rad,force_N\n3.0,5.0\n", "--measured"),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("out.csv", "out.png", "out.json"):
        (tmp_path / name).write_text("as it was", encoding="utf-8")
    return tmp_path


def refused(folder: Path, arguments: list[str], place: str, capfd: pytest.CaptureFixture[str]) -> str:
    before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    code = status(arguments)
    said = capfd.readouterr()
    assert code == 2
    assert said.out == ""
    assert said.err.count("\n") == 1 and said.err.startswith("error: "), said.err
    assert place in said.err and "Traceback" not in said.err, said.err
    assert len(said.err) < 600
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before
    return said.err


@pytest.mark.parametrize("what", FILES)
def test_broken_robot_file(what: str, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    content, place = FILES[what]
    (folder / "robot.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
    outputs = ["--out", "out.csv", "--plot", "out.png", "--json", "out.json"]
    line = refused(folder, ["sweep", "robot.toml", "--surface", "paper", *outputs], place, capfd)
    assert line.startswith("error: robot.toml: ")


@pytest.mark.parametrize("what", LINES)
def test_broken_command_line(what: str, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    refused(folder, *LINES[what], capfd)


@pytest.mark.parametrize("what", PULLS)
def test_broken_pulls(what: str, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text, place = PULLS[what]
    (folder / "pulls.csv").write_text(text, encoding="utf-8")
    refused(folder, [*SWEEP, "--measured", "pulls.csv", "--out", "out.csv"], place, capfd)


WILD = (
    "1e300",
    "1e-300",
    "-1e300",
    "1e-12",
    "0",
    "-0.0",
    "1e6",
    "[1e300, 0]",
    "[1e-200, 0.0]",
    "[0.0, 0.0]",
    "9223372036854775808",
    "90",
    "45",
    '"ellipse"',
    '"disc-strip"',
    '"static"',
    '"quasi-static"',
    "{ drive = 1e-300, transverse = 10 }",
    "{ drive = 10, transverse = 0 }",
)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_no_value_makes_it_crash(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    lines = GOOD.split("\n")
    keys = [i for i, line in enumerate(lines) if "=" in line]
    for at in data.draw(st.lists(st.sampled_from(keys), min_size=1, max_size=3)):
        lines[at] = lines[at].split("=")[0] + "= " + data.draw(st.sampled_from(WILD))
    path = tmp_path_factory.getbasetemp() / "wild.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    assert status(["sweep", str(path), "--surface", "paper", "--step", "30"]) in (0, 2)
    assert status(["polytope", str(path), "--surface", "paper"]) in (0, 2)


def test_the_good_file_is_good(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (folder / "robot.toml").write_text(GOOD, encoding="utf-8")
    assert status(["sweep", "robot.toml", "--surface", "paper", "--out", "out.csv"]) == 0
    assert (
        (folder / "out.csv")
        .read_text(encoding="utf-8")
        .startswith("phi_rad,f_max_N,f_low_N,f_high_N,limiting\n")
    )


def test_a_key_without_its_unit_is_told(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (folder / "robot.toml").write_text(broken("radius_m = 0.0254", "radius = 0.0254"), encoding="utf-8")
    line = refused(folder, ["sweep", "robot.toml", "--surface", "paper"], "radius_m", capfd)
    assert "rename 'radius' to 'radius_m'" in line
