"""Every constant by which data are read and diagnosed stands in its room's settings, with unit and reason."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2] / "slipmargin"
ROOMS = ("data", "diagnosis")
#: What stands elsewhere decides nothing: steps and tolerances of a solver, grids and numbers of draws, the
#: ranges of what can be told, priors that matter only where no run has been.
NUMERICS = {
    "data/data_set.py": {"LEAST_NOISE", "MOST_NOISE"},
    "data/delay.py": {"_GRID_S"},
    "data/jitter.py": {"_NEIGHBOURS"},
    "data/noise.py": {"_LINE", "_CUBIC", "_WINDOWS", "_TIMES", "_SHARES"},
    "data/wheel_signals.py": {"_TURN"},
    "diagnosis/crossings.py": {"_EDGES", "_FLAT", "_DIRECTIONS", "_MOST"},
    "diagnosis/evidence.py": {"_UNKNOWN"},
    "diagnosis/patches.py": {"_SAMPLES", "_WIDER", "_WITHIN"},
    "diagnosis/other_floor.py": {"_FRICTIONS", "_NEAREST"},
    "diagnosis/fit.py": {
        "STEP",
        "ENOUGH",
        "_SMALL",
        "_ITERATIONS",
        "_FAIR",
        "_FORETOLD",
        "_LADDER",
        "_SHORTENED",
        "_USUAL",
    },
    "diagnosis/forms.py": {"_NEIGHBOURS", "_LARGEST"},
    "diagnosis/left_out.py": {"_HALF"},
    "diagnosis/limits_change.py": {"_FLOORS", "_ORIENTATIONS", "_DIRECTIONS"},
    "diagnosis/loop.py": {"_FINAL_STEPS", "_FINE_STEPS"},
    "diagnosis/near.py": {"_SEVERAL", "_PART", "_FARTHEST"},
    "diagnosis/order_analysis.py": {"_DRAWS", "_HALVES"},
    "diagnosis/plan_change.py": {"MOVE", "MARGIN", "_POINTS"},
    "diagnosis/probes.py": {"_STEP", "_PRIOR"},
    "diagnosis/start_pose.py": {"_HELD", "_LEAST"},
    "diagnosis/problem.py": {
        "_RTOL_PER_M",
        "_RTOL",
        "FINE_RTOL",
        "_MUCH_FEWER",
        "_MOST_STEPS",
    },
    "diagnosis/tolerance.py": {"_RTOLS", "_ERROR", "_SHARE"},
    "diagnosis/pull_instrument.py": {"_FARTHEST"},
    "diagnosis/pull_next.py": {"_ORIENTATIONS", "_DIRECTIONS", "_MANY", "_APART_RAD"},
    "diagnosis/pull_search.py": {"_SURROGATES"},
    "diagnosis/pull_unseen.py": {"_FLIPS"},
    "diagnosis/ranges.py": {"_MOST", "_SPAN_S"},
    "diagnosis/residual_diagnostics.py": {"_BINS", "_SHIFTS", "_SPAN_S"},
    "diagnosis/run_order.py": {"_STEPS", "_APART", "_PERMUTATIONS"},
    "diagnosis/sense.py": {"_STEPS", "_MISSED_M"},
    "diagnosis/signals.py": {"_ROUGHLY", "_SAME", "_LOOSEST", "_LONGEST"},
    "diagnosis/tangents.py": {"_AT_ONCE"},
    "diagnosis/verdict.py": {"_EXACT", "_DRAWN", "_POSITION", "_HEADING"},
    "diagnosis/wheel_phase.py": {"_AROUND", "_CLOSE", "_FINER", "_GUESS"},
}


def numbers(path: Path) -> set[str]:
    """The names that a module gives to numbers at its top (tables of words, and of units, are none)."""
    found: set[str] = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        constants = [n.value for n in ast.walk(node.value) if isinstance(n, ast.Constant)]
        if any(isinstance(c, str) for c in constants) or not any(type(c) in (int, float) for c in constants):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        found |= {n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)}
    return found


@pytest.mark.parametrize("room", ROOMS)
def test_no_module_decides_by_a_constant_of_its_own(room: str) -> None:
    for path in sorted((ROOT / room).glob("*.py")):
        name = f"{room}/{path.name}"
        assert numbers(path) == NUMERICS.get(name, set()), f"{name}: constants stand in {room}/settings.py"


@pytest.mark.parametrize("room", ROOMS)
def test_every_setting_has_its_unit_and_is_used(room: str) -> None:
    text = (ROOT / room / "settings.py").read_text(encoding="utf-8")
    used = "\n".join(p.read_text(encoding="utf-8") for p in ROOT.rglob("*.py") if p.name != "settings.py")
    found = re.findall(r"((?:    #.*\n)*)    (\w+): (?:float|int|tuple\[float, \.\.\.\]) = ", text)
    assert len(found) > 50
    for comment, name in found:
        assert re.search(r"^    #: \[[^]]+\] ", comment, flags=re.MULTILINE), f"{name} has no unit"
        assert re.search(rf"\.{name}\b", used), f"{name} decides nothing"
