"""How drawn tests are drawn, and which optional packages the tests need.

Continuous integration draws the same examples every time, so that a submission does not fail or pass by
chance; elsewhere every run draws new ones, and ``make test-seeds`` draws many.  A draw that fails is kept
as a test of its own.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from importlib.util import find_spec

import json_schemas
import pytest
from hypothesis import HealthCheck, settings

# No test may fail because the machine is busy: no deadline for an example, no complaint about slow draws.
# What a seed draws depends on which tests run with it: a failure prints what repeats it alone.
SLOW = (HealthCheck.too_slow,)
settings.register_profile("desk", deadline=None, print_blob=True, suppress_health_check=SLOW)
settings.register_profile("ci", settings.get_profile("desk"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "desk")

#: Packages of the extras ``test``, ``ros``, ``urdf``, ``frc`` and ``lerobot``; else tests are skipped.
NEEDED = ("mujoco", "toppra", "dask", "distributed", "jupytext", "nbclient", "ipykernel", "rosbags")
NEEDED += (
    "yourdfpy",
    "xacrodoc",
    "wpiutil",
    "pyarrow",
    "playwright",
    "pysbd",
    "vermin",
    "sklearn",
    "jsonschema",
)


def missing() -> list[str]:
    """The needed packages that are not installed."""
    return [name for name in NEEDED if find_spec(name) is None]


def pytest_configure(config: pytest.Config) -> None:
    """Continuous integration must skip nothing for want of a package."""
    if os.environ.get("CI") and missing():
        raise pytest.UsageError(
            f"not installed: {', '.join(missing())}; run pip install -e '.[test,ros,urdf,frc,lerobot]'"
        )


def pytest_report_header() -> str | None:
    """What is skipped at a desk, and how to change it."""
    if not missing():
        return None
    return f"skipped for want of {', '.join(missing())}: pip install -e '.[test,ros,urdf,frc,lerobot]'"


@pytest.fixture(autouse=True, scope="session")
def every_json_is_as_published() -> Iterator[None]:
    """Whatever JSON a test makes is checked against the schemas in docs/schemas."""
    if find_spec("jsonschema") is None:
        yield
        return
    with json_schemas.checked():
        yield
