"""What the installed package weighs: itself and everything that it needs, without extras.

    python benchmarks/environment.py [FILE]    (default: benchmarks/results/environment.json)

It follows the requirements that each installed distribution states, and adds up the sizes of its files.
Other packages of the environment do not count.  What only cvxpy needs is weighed apart.
"""

from __future__ import annotations

import json
import platform
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from kept import with_file, write_figures
from packaging.requirements import Requirement

FILE = Path(__file__).resolve().parent / "results" / "environment.json"
MB = 1e6


def needed(
    name: str, without: str = "", found: dict[str, Distribution] | None = None
) -> dict[str, Distribution]:
    """A distribution and all that it requires here, by name, but for what ``without`` requires."""
    found = {} if found is None else found
    try:
        one = distribution(name)
    except PackageNotFoundError as fault:
        raise SystemExit(f"{name} is not installed: {fault}") from None
    found[name] = one
    for text in one.requires or ():
        asked = Requirement(text)
        wanted = asked.marker is None or asked.marker.evaluate({"extra": ""})
        if wanted and asked.name.lower() not in (*found, without):
            needed(asked.name.lower(), without, found)
    return found


def megabytes(one: Distribution) -> float:
    """Size of the files of a distribution [MB]."""
    paths = [Path(str(one.locate_file(file))) for file in one.files or ()]
    return sum(path.stat().st_size for path in paths if path.is_file()) / MB


def main() -> None:
    """Weigh and write."""
    file = with_file(__doc__).parse_args().file or FILE
    own = needed("slipmargin")
    sizes = {name: round(megabytes(one), 1) for name, one in own.items()}
    without = sum(sizes[name] for name in needed("slipmargin", "cvxpy"))
    result = {
        "python": platform.python_version(),
        "total_MB": round(sum(sizes.values())),
        "packages": len(sizes),
        "largest_MB": dict(sorted(sizes.items(), key=lambda pair: -pair[1])[:8]),
        "by_cvxpy_MB": round(sum(sizes.values()) - without),
    }
    write_figures(file, result)
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
