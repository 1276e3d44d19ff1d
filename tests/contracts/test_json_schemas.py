"""Every JSON has a published schema, which says what is written; no number in it is NaN or infinite."""

from __future__ import annotations

import importlib
import json
import pkgutil
from pathlib import Path

import pytest

pytest.importorskip("jsonschema", reason="jsonschema is not installed (extra [test])")

from json_schemas import FOLDER, SCHEMAS, faults, validator
from slipmargin_cli.main import status

import slipmargin.api
from slipmargin.api.result import Result

DATA = Path(__file__).resolve().parents[1] / "data"


def results() -> dict[str, type[Result]]:
    for module in pkgutil.iter_modules(slipmargin.api.__path__):
        importlib.import_module(f"slipmargin.api.{module.name}")
    found, todo = {}, [Result]
    while todo:
        one = todo.pop()
        todo += one.__subclasses__()
        if one.to_dict is not Result.to_dict and one.__module__.startswith("slipmargin."):
            found[one.__name__] = one
    return found


def test_every_result_has_its_schema_and_every_schema_its_result() -> None:
    assert set(SCHEMAS) == set(results())
    assert {f"{name}.json" for name in SCHEMAS.values() if name} == {p.name for p in FOLDER.iterdir()}


@pytest.mark.parametrize("name", sorted(filter(None, SCHEMAS.values())))
def test_schemas_are_schemas_and_linked(name: str) -> None:
    validator(name)
    page = (FOLDER.parent / "reference" / "json.md").read_text(encoding="utf-8")
    assert f"(../schemas/{name}.json)" in page


@pytest.mark.parametrize(
    "words",
    [
        "sweep ohio-kiwi --surface paper --step 45",
        "sweep ohio-kiwi --surface paper --step 45 --grip ellipse --measured pulls.csv",
        "sweep spread.toml --surface paper --step 45 --chance 0.05",
        "polytope mecanum4 --surface floor --rigid",
        "polytope ohio-kiwi --surface paper",
        "bounds ohio-kiwi --surface paper --step 45",
        "bounds robotino --surface gray --step 90 --robust --margin 0.3",
        "bounds uneven.toml --surface floor --step 90",
        "plan ohio-kiwi way.csv --surface paper --points 40 --verify --out t.csv",
        "check ohio-kiwi t.csv --surface paper",
        "simulate ohio-kiwi t.csv --surface paper --step 0.1",
        "stop omni4 --surface floor --step 90",
        "monitor ohio-kiwi wheels.csv --surface paper --false-alarms 0.1",
        "stop omni4 --surface floor --step 90 --no-verify",
        "design ohio-kiwi --surface paper --vary delta_deg=0:40:20 --uncertain com_y_m=-0.01:0.01",
        "design omni4 --surface floor --vary mass_kg=1,2 --static",
        "design mecanum4 omni4 --surface floor",
        "design ohio-kiwi ohio-kiwi-symmetric --surface paper",
        "measure pulls.csv ohio-kiwi --surface paper",
        "export c omni4 --surface floor --out o.h",
        "export sdf mecanum4 --out o.sdf",
        "robots check mecanum4",
        "surfaces list",
        "surfaces show carpet-omni-williams2002",
        "import csv log.csv --robot ohio-kiwi --time t:s --x x --y y --heading h --wheel a:rpm --wheel b:rpm "
        "--wheel c:rpm --out set",
    ],
)
def test_what_commands_write_is_what_the_schema_says(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("way.csv").write_text("x_m,y_m,phi_rad\n0,0,0\n1,0,0.5\n", encoding="utf-8")
    Path("pulls.csv").write_text(
        "phi_rad,force_N\n" + "".join(f"{0.26 * k:.2f},{5 + 0.3 * k % 2:.2f}\n" for k in range(7)),
        encoding="utf-8",
    )
    rows = [f"{0.1 * k:.1f},{0.01 * k:.2f},0,0.1,10,-10,5" for k in range(30)]
    Path("log.csv").write_text("\n".join(["t,x,y,h,a,b,c", *rows]) + "\n", encoding="utf-8")
    speeds = [f"{0.01 * k:.2f},{9 * k},{-9 * k},0" for k in range(30)]
    Path("wheels.csv").write_text(
        "\n".join(["t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s", *speeds]) + "\n", encoding="utf-8"
    )
    robot = Path(slipmargin.__file__).parent.joinpath("robots", "ohio-kiwi.toml").read_text(encoding="utf-8")
    Path("spread.toml").write_text(robot.replace("drive = 0.26", 'drive = "0.26 ± 0.02"'), encoding="utf-8")
    Path("uneven.toml").write_text(UNEVEN, encoding="utf-8")
    if "t.csv" in words and not words.startswith("plan"):
        assert (
            status(["plan", "ohio-kiwi", "way.csv", "--surface", "paper", "--points", "40", "--out", "t.csv"])
            == 0
        )
    command = words.split()
    assert status([*command, "--json", "o.json"]) == 0
    kind = "-".join(command[:2]) if command[0] in ("export", "robots", "surfaces") else command[0]
    kind = "design-ideas" if kind == "design" and "--vary" not in command else kind
    assert (
        faults({"export-sdf": "export-simulator"}.get(kind, kind), Path("o.json").read_text(encoding="utf-8"))
        == []
    )


def test_a_key_that_is_not_published_is_a_fault() -> None:
    text = json.dumps(
        {"schema": 1, "surface": "x", "types": [], "residual_N": 0.1, "left_out": 0, "draws": 9}
    )
    assert any("'seed' is a required property" in f for f in faults("measure", text))
    assert any("'new' was unexpected" in f for f in faults("measure", text[:-1] + ', "seed": 0, "new": 1}'))
    with pytest.raises(ValueError, match="NaN is no JSON"):
        faults("measure", text.replace("0.1", "NaN"))


UNEVEN = (
    """schema = 1
name = "uneven"
[body]
mass_kg = 5.0
inertia_kg_m2 = 0.2
[loads]
model = "static"
unevenness_mm = 1.0
suspension_N_per_mm = 20.0
[friction]
grip = "box"
"""
    + "".join(
        f"""[[wheel]]
name = "w{k}"
position_m = [{x}, {y}]
drive_direction_deg = {135 + 90 * k}
radius_m = 0.05
"""
        for k, (x, y) in enumerate(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
    )
    + """[surface.floor]
roller = { drive = 0.5, transverse = 0.1 }
rigid = { drive = 0.6, transverse = 0.6 }
"""
)
