"""The package as a stranger gets it: source archive and wheel are built, installed elsewhere, and work."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: What must be inside besides the modules.
DATA = ("slipmargin/live/page/page.html", "slipmargin/live/page/page.js", "slipmargin/robots/mecanum4.toml")


def run(*words: str, cwd: Path, **environment: str) -> str:
    env = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | environment
    done = subprocess.run(words, cwd=cwd, env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The source archive, and the wheel that is built from it and not from this folder."""
    pytest.importorskip("build")
    folder = tmp_path_factory.mktemp("dist")
    copy = tmp_path_factory.mktemp("copy")
    try:
        files = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.split("\0")
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    for name in filter(None, files):  # building writes beside the source: never in the source itself
        if (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes((ROOT / name).read_bytes())
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), ".", cwd=copy)
    return next(folder.glob("*.tar.gz")), next(folder.glob("*.whl"))


def test_archive_and_wheel_hold_what_is_needed(built: tuple[Path, Path]) -> None:
    archive, wheel = built
    with tarfile.open(archive) as tar:
        names = {name.partition("/")[2] for name in tar.getnames()}
    assert set(DATA) <= names and {"LICENSE", "README.md", "pyproject.toml"} <= names
    with zipfile.ZipFile(wheel) as packed:
        inside = set(packed.namelist())
    assert set(DATA) <= inside
    modules = {str(p.relative_to(ROOT)) for p in (ROOT / "slipmargin").rglob("*.py")}
    assert modules <= inside
    assert {f"slipmargin_cli/{p.name}" for p in (ROOT / "cli").glob("*.py")} <= inside
    assert not [name for name in inside if name.startswith(("tests", "benchmarks", "docs"))]


def test_the_installed_wheel_works_elsewhere(built: tuple[Path, Path], tmp_path: Path) -> None:
    """Installed into a folder of its own, from the wheel alone, with this environment's libraries."""
    target = tmp_path / "installed"
    install = ("-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target", str(target))
    run(sys.executable, *install, str(built[1]), cwd=tmp_path)
    code = "import slipmargin, slipmargin_cli; print(slipmargin.__file__, slipmargin_cli.__file__)"
    where = run(sys.executable, "-c", code, cwd=tmp_path, PYTHONPATH=str(target)).split()
    assert all(Path(file).is_relative_to(target) for file in where)
    words = ("bounds", "mecanum4", "--surface", "floor", "--export", "nav2", "limits.yaml")
    out = run(sys.executable, "-m", "slipmargin", *words, cwd=tmp_path, PYTHONPATH=str(target))
    assert "written: limits.yaml" in out and (tmp_path / "limits.yaml").stat().st_size > 100
    page = "from slipmargin.io.assets import asset; print(len(asset('page.js')))"
    assert int(run(sys.executable, "-c", page, cwd=tmp_path, PYTHONPATH=str(target))) > 1000


def test_the_oldest_python_is_the_one_that_is_promised() -> None:
    """Syntax and standard library of the package need no newer Python than its metadata say (by vermin)."""
    vermin = pytest.importorskip("vermin")
    promised = (3, 10)
    assert f'requires-python = ">={promised[0]}.{promised[1]}"' in (ROOT / "pyproject.toml").read_text(
        encoding="utf-8"
    )
    config = vermin.Config()
    config.set_eval_annotations(False)
    newer = {}
    for folder in ("slipmargin", "cli"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            if file.name == "toml_table.py":  # asks for the version itself
                continue
            least = vermin.visit(file.read_text(encoding="utf-8"), config).minimum_versions()[1]
            if least is not None and least != (0, 0) and tuple(least) > promised:
                newer[str(file.relative_to(ROOT))] = least
    assert not newer


def test_nothing_is_installed_that_the_package_does_not_use() -> None:
    """Each required distribution is imported by the package; what only a part needs is an extra."""
    try:
        import tomllib
    except ImportError:
        pytest.skip("tomllib is in Python 3.11 and newer")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = {re.split(r"[ <>=;\[]", text)[0] for text in project["dependencies"]}
    source = "\n".join(
        file.read_text(encoding="utf-8")
        for folder in ("slipmargin", "cli")
        for file in (ROOT / folder).rglob("*.py")
    )
    unused = {n for n in required if not re.search(rf"^\s*(import|from) {n}\b", source, re.MULTILINE)}
    extras = {
        re.split(r"[ <>=;\[]", text)[0]
        for texts in project["optional-dependencies"].values()
        for text in texts
    }
    assert not unused and not required & extras
