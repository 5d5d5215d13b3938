"""`python -m stepwell.paper.any_cycle FILE [PAGE.md …]`: how surely chains make any cycle.

The counts of cells in the claims are those of one cycle, the one that goes back the way it came.
Here chains of the same lengths are designed for all cycles, or for a sample of too many.
It takes a second a cycle, so what FILE holds already is kept, and what is missing is added.
"""

import json
import math
import sys
from itertools import islice, permutations
from pathlib import Path
from typing import Any

import numpy as np

from stepwell.base import to_unit, write_atomic
from stepwell.design import Tolerances, design
from stepwell.paper.claims import replaced
from stepwell.paper.order import SPREAD, WANTED
from stepwell.sequences import Sequence

BEGIN = "<!-- any cycle: written by `python -m stepwell.paper.any_cycle`, not by hand -->"
END = "<!-- end of any cycle -->"
# Tolerance of the anchors [m], and the cells that make the cycle that goes back the way it came.
LENGTHS = ((0.001, 6), (0.0003, 10), (0.0001, 12))
SAMPLE = 1000  # cycles, where there are more
MADE = 20_000  # mechanisms of each design
_SAVED = 20  # cycles between two writings


def cycles(cells: int) -> int:
    """How many cycles are looked at; which cell is called which makes no other one."""
    return min(math.factorial(cells), SAMPLE)


def cycle_of(cells: int, number: int) -> str:
    """One of them: each of few, or one at random."""
    loading = range(cells)
    if cycles(cells) == math.factorial(cells):
        unloading = next(islice(permutations(loading), number, None))
    else:
        unloading = tuple(np.random.default_rng([cells, number]).permutation(cells).tolist())
    return str(Sequence.full_cycle(loading, unloading))


def share(anchor: float, cells: int, number: int) -> float:
    """The share that works of the chain that `design` finds for that cycle."""
    tolerances = Tolerances(anchor=anchor, stiffness=SPREAD)
    return design(cycle_of(cells, number), tolerances=tolerances, samples=MADE).yield_.share


def table(rows: list[dict[str, Any]]) -> str:
    """The shares as a table in Markdown."""
    lines = [
        "| anchors | cells | cycles | best | median | worst | make it in 99 % |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in (row for row in rows if row["shares"]):
        shares, cells = np.array(row["shares"]), row["cells"]
        whole = len(shares) == math.factorial(cells)
        looked = f"all {len(shares)}" if whole else f"a sample of {len(shares)}"
        yields = [f"{100 * x:.1f} %" for x in (shares.max(), np.median(shares), shares.min())]
        many = f"{int(np.sum(shares >= WANTED))} of {len(shares)}"
        lines.append(
            f"| ±{row['anchor_mm']:g} mm | {cells} | {looked} | {' | '.join(yields)} | {many} |"
        )
    return "\n".join(lines)


def main(file: Path, pages: list[Path]) -> None:
    """Add what is missing to the file, and write its table into the pages."""
    known = json.loads(file.read_text("utf-8")) if file.exists() else []
    rows = [
        next(
            (r for r in known if (r["anchor_mm"], r["cells"]) == (to_unit(anchor, "mm"), cells)),
            {"anchor_mm": to_unit(anchor, "mm"), "cells": cells, "shares": []},
        )
        for anchor, cells in LENGTHS
    ]
    for (anchor, cells), row in zip(LENGTHS, rows, strict=True):
        shares = row["shares"]
        while len(shares) < cycles(cells):
            shares.append(share(anchor, cells, len(shares)))
            if len(shares) % _SAVED == 0 or len(shares) == cycles(cells):
                write_atomic(file, json.dumps(rows) + "\n")
    for page in pages:
        text = replaced(page.read_text("utf-8"), table(rows), BEGIN, END, "table")
        write_atomic(page, text)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        raise SystemExit("usage: python -m stepwell.paper.any_cycle FILE [PAGE.md ...]")
    main(Path(sys.argv[1]), [Path(page) for page in sys.argv[2:]])
