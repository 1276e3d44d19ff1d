"""Each notebook runs from top to bottom as a notebook, and ends in an assert.

It takes less than a minute; how fast the machine is and what else it does is not tested.
"""

from __future__ import annotations

import ast
import os
import subprocess
import warnings
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.py"))
#: A cell that takes longer hangs [s].
HUNG_S = 600


def read(path: Path):
    """The notebook, in jupytext's percent format."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # jupytext's and nbformat's own
        jupytext = pytest.importorskip("jupytext")
        return jupytext.read(path, fmt="py:percent")


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) >= 5


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_the_last_cell_asserts(path: Path) -> None:
    cells = [c for c in read(path).cells if c.cell_type == "code"]
    last = ast.parse(cells[-1].source).body[-1]
    inner = last.body[-1] if isinstance(last, ast.For | ast.If) else last
    assert isinstance(inner, ast.Assert), f"{path.name} ends in {type(last).__name__}"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_make_docs_runs_it_where_it_stands(path: Path) -> None:
    """Else jupytext finds no kernel, or starts it in the folder of the output."""
    assert read(path).metadata["kernelspec"]["name"] == "python3"
    said = subprocess.run(
        ["make", "--dry-run", "--always-make", f"docs/notebooks/{path.stem}.ipynb"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    (line,) = (one for one in said.stdout.splitlines() if "jupytext" in one)
    assert "--run-path notebooks " in line and line.endswith(f"notebooks/{path.name}")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_the_notebook_runs(path: Path) -> None:
    book = read(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the kernel's client's own
        pytest.importorskip("ipykernel")
        nbclient = pytest.importorskip("nbclient")
        os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"
        runner = nbclient.NotebookClient(
            book,
            timeout=HUNG_S,
            kernel_name="python3",
            resources={"metadata": {"path": str(path.parent)}},
        )
        runner.execute()
    shown = [o for c in book.cells if c.cell_type == "code" for o in c.outputs]
    assert any("image/png" in o.get("data", {}) for o in shown), "a notebook shows a picture"
    complaints = [o["text"] for o in shown if o.get("name") == "stderr"]
    assert not complaints, complaints
