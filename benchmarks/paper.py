"""The paper reproduced, and the study of what its printed results leave open; docs/paper.md quotes this.

python benchmarks/paper.py [--json FILE] [--seed N]
python benchmarks/paper.py --tables     the Markdown tables of docs/paper.md
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from slipmargin.io.json_text import json_text
from slipmargin.io.writes import write_text
from slipmargin.paper.identify import identifiability
from slipmargin.paper.reproduction import reproduce_paper
from slipmargin.report.reproduction import (
    closing_lines,
    markdown_tables,
    reproduction_report,
    studies_report,
    study_lines,
)


def main() -> None:
    """Print the closing lines of both; write JSON where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tables", action="store_true")
    words = parser.parse_args()
    if words.tables:
        print("\n".join(markdown_tables(reproduce_paper(seed=words.seed))))
        return
    start = time.perf_counter()
    done = reproduce_paper(seed=words.seed)
    between = time.perf_counter()
    studies = identifiability(seed=words.seed)
    end = time.perf_counter()
    for line in (*closing_lines(done), *study_lines(studies)):
        print(line)
    print(f"reproduction {between - start:.1f} s, study {end - between:.1f} s")
    if words.json is not None:
        report = reproduction_report(done, []) | {"identifiability": studies_report(studies)}
        del report["figures"]
        report |= {"reproduction_s": between - start, "study_s": end - between}
        write_text(words.json, json_text(report))


if __name__ == "__main__":
    main()
