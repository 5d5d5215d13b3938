"""`python -m stepwell.paper.any_cycle FILE [PAGE.md …]`: yields of chains for any cycle.

The counts of cells in the claims are for one cycle, with unloading in the reverse of the loading
order. Here chains of the same lengths are designed for all cycles, or for a sample of them. A cycle
takes a second, so results in FILE are kept, and only missing ones are computed.
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
# Tolerance of the anchors [m], and the cells for the cycle with reversed unloading order.
LENGTHS = ((0.001, 6), (0.0003, 10), (0.0001, 12))
SAMPLE = 1000  # largest number of cycles
MADE = 20_000  # Monte Carlo samples of each design
_SAVED = 20  # cycles between two writes


def cycles(cells: int) -> int:
    """Number of cycles evaluated; cycles that differ by the names of cells count once."""
    return min(math.factorial(cells), SAMPLE)


def cycle_of(cells: int, number: int) -> str:
    """Cycle `number`: one of all cycles, or of a random sample."""
    loading = range(cells)
    if cycles(cells) == math.factorial(cells):
        unloading = next(islice(permutations(loading), number, None))
    else:
        unloading = tuple(np.random.default_rng([cells, number]).permutation(cells).tolist())
    return str(Sequence.full_cycle(loading, unloading))


def fraction(anchor: float, cells: int, number: int) -> float:
    """Yield of the chain that `design` returns for a cycle."""
    tolerances = Tolerances(anchor=anchor, stiffness=SPREAD)
    return design(cycle_of(cells, number), tolerances=tolerances, samples=MADE).yield_.fraction


def table(rows: list[dict[str, Any]]) -> str:
    """The yields as a table in Markdown."""
    lines = [
        "| anchors | cells | cycles | best | median | worst | make it in 99 % |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in (row for row in rows if row["fractions"]):
        fractions, cells = np.array(row["fractions"]), row["cells"]
        whole = len(fractions) == math.factorial(cells)
        count = f"all {len(fractions)}" if whole else f"a sample of {len(fractions)}"
        yields = [
            f"{100 * x:.1f} %" for x in (fractions.max(), np.median(fractions), fractions.min())
        ]
        works = f"{int(np.sum(fractions >= WANTED))} of {len(fractions)}"
        lines.append(
            f"| ±{row['anchor_mm']:g} mm | {cells} | {count} | {' | '.join(yields)} | {works} |"
        )
    return "\n".join(lines)


def main(file: Path, pages: list[Path]) -> None:
    """Add missing yields to the file, and write its table into the pages."""
    known = json.loads(file.read_text("utf-8")) if file.exists() else []
    rows = [
        next(
            (r for r in known if (r["anchor_mm"], r["cells"]) == (to_unit(anchor, "mm"), cells)),
            {"anchor_mm": to_unit(anchor, "mm"), "cells": cells, "fractions": []},
        )
        for anchor, cells in LENGTHS
    ]
    for (anchor, cells), row in zip(LENGTHS, rows, strict=True):
        fractions = row["fractions"]
        while len(fractions) < cycles(cells):
            fractions.append(fraction(anchor, cells, len(fractions)))
            if len(fractions) % _SAVED == 0 or len(fractions) == cycles(cells):
                write_atomic(file, json.dumps(rows) + "\n")
    for page in pages:
        text = replaced(page.read_text("utf-8"), table(rows), BEGIN, END, "table")
        write_atomic(page, text)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        raise SystemExit("usage: python -m stepwell.paper.any_cycle FILE [PAGE.md ...]")
    main(Path(sys.argv[1]), [Path(page) for page in sys.argv[2:]])
