"""The table of docs/jump-scaling.md: the best snap found for each number of cells.

`python tests/docs/snap_cells.py --search` searches again (two minutes) and writes
docs/snap-cells.json; without it the table is made of that file.
"""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.statics import EventKind

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "jump-scaling.md", ROOT / "docs" / "snap-cells.json"
STIFFNESS, REST = 28.5, 0.010
# Area of d = q - p [m], the differences of the paper's anchors.
AREA = (0.0, 0.040), (-0.030, 0.030)
COUNTS, STARTS, STEPS = (2, 3, 4, 6, 8), 300, 700


def chain(anchors: Any) -> sw.Chain:
    """The paper's cells with these d = q - p [m]."""
    cells = (
        sw.Cell(sw.Band((0.0, 0.0), (float(x), float(y)), STIFFNESS, REST), unusual=True)
        for x, y in anchors
    )
    return sw.Chain([*cells])


def energy(anchors: Any) -> tuple[float, float]:
    """Energy of the strongest snap of loading over k S², and over the bound for any cells."""
    one = chain(anchors)
    try:
        path = one.cycle().path
    except sw.StepwellError:
        return 0.0, 0.0
    snaps = [e.released for e in path.events if e.kind is EventKind.SNAP and e.direction > 0]
    full, travels = one.cells[0].full_travel, np.linspace(0.0, one.cells[0].full_travel, 201)
    forces = np.array([cell.force_at(travels) for cell in one.cells])
    best = max(snaps, default=0.0)
    bound = len(one) // 2 * full * float(np.ptp(forces))
    return best / (STIFFNESS * full**2), best / bound


def searched(count: int, first: Any, rng: np.random.Generator) -> dict[str, Any]:
    """The best of random chains, then of random changes of the best one."""
    low, high = np.array(AREA).T
    best, most = np.zeros((count, 2)), 0.0
    for _ in range(STARTS):
        one = rng.uniform(low, high, (count, 2))
        if first is not None and rng.random() < 0.5:
            # With the best pair among its cells.
            one[rng.permutation(count)[: len(first)]] = first
        value = energy(one)[0]
        if value > most:
            best, most = one, value
    for k in range(STEPS):
        size = 0.2 * 0.01 ** (k / STEPS)
        change = rng.normal(0.0, size, best.shape) * (rng.random((count, 1)) < 0.6)
        one = np.clip(best + change * (high - low), low, high)
        value = energy(one)[0]
        if value > most:
            best, most = one, value
    return {"cells": count, "tried": STARTS + STEPS, "d_mm": (1e3 * best).round(3).tolist()}


def record() -> list[dict[str, Any]]:
    """What was found."""
    return json.loads(FILE.read_text("utf-8"))


def table() -> str:
    """Energy of the best chain of each length, beside the bounds."""
    lines = [
        "| cells | chains tried | best found, E/(k S²) | over S (F_max - F_min) ⌊N/2⌋ |",
        "|---" * 4 + "|",
    ]
    for row in record():
        ratio, share = energy(1e-3 * np.array(row["d_mm"]))
        lines.append(f"| {row['cells']} | {row['tried']} | {ratio:.2f} | {share:.0%} |")
    return "\n".join(lines)


def written(text: str) -> str:
    """The page with its table as it should be."""
    begin, end = "<!-- cells: written by tests/docs/snap_cells.py -->", "<!-- end of cells -->"
    new = f"{begin}\n\n{table()}\n\n{end}"
    return re.sub(f"{re.escape(begin)}.*?{end}", lambda _: new, text, flags=re.S)


if __name__ == "__main__":
    if "--search" in sys.argv[1:]:
        rng, first, found = np.random.default_rng(39), None, list[dict[str, Any]]()
        for count in COUNTS:
            found.append(searched(count, first, rng))
            first = 1e-3 * np.array(found[0]["d_mm"])
            print(count, energy(1e-3 * np.array(found[-1]["d_mm"])), flush=True)
        assert all(math.isfinite(x) for row in found for one in row["d_mm"] for x in one)
        FILE.write_text(json.dumps(found) + "\n", "utf-8")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
