"""The published schemas of what ``--json`` writes, and a check of every JSON that tests make."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from slipmargin.api.result import Result

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "schemas"
#: Class of a result → its schema; None where no command writes it as JSON.
SCHEMAS = {
    "BoundsResult": "bounds",
    "CheckResult": "check",
    "CompareResult": "design-ideas",
    "DesignResult": "design",
    "DiagnosisResult": "diagnose",
    "EffectCatalogue": None,
    "EffectDescription": None,
    "ImportResult": "import",
    "Limiter": "export-c",
    "MeasureResult": "measure",
    "MonitoredLog": "monitor",
    "NextRunResult": "next-run",
    "PlanResult": "plan",
    "PolytopeResult": "polytope",
    "PullDiagnosisResult": "diagnose-pulls",
    "ReproductionResult": "reproduce",
    "RobotCheck": "robots-check",
    "RobotDescription": None,
    "RobotFile": None,
    "SimulationResult": "simulate",
    "SimulatorModel": "export-simulator",
    "StopResult": "stop",
    "SurfaceDescription": "surfaces-show",
    "SurfaceLibrary": "surfaces-list",
    "SweepResult": "sweep",
}
#: Items at both ends of a long list that are looked at.
ENDS = 20


@cache
def validator(name: str) -> Any:
    """What checks data against a published schema."""
    from jsonschema import Draft202012Validator

    schema = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def faults(name: str, text: str) -> list[str]:
    """What a JSON text does not keep of a schema; at most five places."""

    def refuse(word: str) -> None:
        raise ValueError(f"{word} is no JSON")

    found = json.loads(text, parse_constant=refuse)
    wrong = validator(name).iter_errors(_thinned(found))
    return [
        f"{'/'.join(map(str, w.absolute_path))}: {w.message[:200]}"
        for _, w in zip(range(5), wrong, strict=False)
    ]


def _thinned(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _thinned(item) for key, item in value.items()}
    if isinstance(value, list):
        kept = value if len(value) <= 2 * ENDS else [*value[:ENDS], *value[-ENDS:]]
        return [_thinned(item) for item in kept]
    return value


@contextlib.contextmanager
def checked() -> Iterator[None]:
    """Every result that becomes JSON is checked against its schema."""
    written = Result.to_json

    def to_json(self: Result) -> str:
        text = written(self)
        name = SCHEMAS.get(type(self).__name__)
        wrong = faults(name, text) if name else []
        assert not wrong, f"docs/schemas/{name}.json does not say what is written: {'; '.join(wrong)}"
        return text

    Result.to_json = to_json  # type: ignore[method-assign]
    try:
        yield
    finally:
        Result.to_json = written  # type: ignore[method-assign]
