"""The table and the figure of docs/rates.md: the paper's pair from 0.01 to 100 Hz.

`python tests/docs/rates.py --integrate` integrates the inertial motions (a minute) and writes
docs/rates.json; without it the figure and the table are made of that file.
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
from stepwell.base import number
from stepwell.figures import svg
from stepwell.figures.common import legends
from stepwell.figures.common.sheet import blank, place
from stepwell.figures.common.style import BLUE, COLUMN, FAINT, GREEN, INK, VERMILLION, styled

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "rates.md", ROOT / "docs" / "rates.json"
PICTURE = ROOT / "docs" / "img" / "rates.svg"
PRESET, MASS = "paper-forward", 0.010
RATES = [float(f"{x:.3g}") for x in np.geomspace(0.01, 100.0, 33)]
# Rows of the table.
SHOWN = (0.01, 0.1, 1.0, 1.67, 5.62, 10.0, 31.6, 100.0)
# States after each arrival at a stop, of the quasi-static order and of the other one.
LANDINGS = "10, 11, 01, 00", "01, 11, 10, 00"


def pair() -> sw.Path:
    """The quasi-static cycle of the paper's pair."""
    return sw.load(f"preset:{PRESET}").cycle().path


def motion(path: sw.Path, rate: float) -> dict[str, Any]:
    """Order, strokes of the snaps and states after each stroke at a rate."""
    n = len(path.chain)
    row: dict[str, Any] = {"rate_Hz": rate}
    try:
        one = path.at_rate(rate, [MASS] * n, [0.0] * n)
    except sw.StepwellError as error:
        return row | {"stopped": str(error)}
    now, ends = ["0"] * n, list[str]()
    for cell, phase in one.changes:
        now[cell] = str(phase)
        ends.append("".join(now))
    snaps = [None if math.isnan(at) else round(1e3 * at, 4) for at in one.snap_drives]
    return row | {"keeps_order": one.keeps_order, "snaps_mm": snaps, "states": ends}


def integrated() -> dict[str, Any]:
    """Every rate, and the quasi-static path."""
    path = pair()
    snaps = [1e3 * event.drive for event in path.events if event.released > 0.0]
    safe = path.safe_rate([MASS] * 2, [0.0] * 2)
    rows = [motion(path, rate) for rate in sorted({*RATES, *SHOWN})]
    # The lowest of 100 rates per decade that changes the order.
    tried = np.geomspace(1.0, 100.0, 201).tolist()
    critical = next(rate for rate in tried if not motion(path, rate).get("keeps_order", True))
    return {
        "mass_g": 1e3 * MASS,
        "snaps_mm": snaps,
        "safe_rate_Hz": safe.rate,
        "critical_Hz": float(f"{critical:.3g}"),
        "motions": rows,
    }


def record() -> dict[str, Any]:
    """What was computed."""
    return json.loads(FILE.read_text("utf-8"))


def table() -> str:
    """Order, snaps and states at a few of the rates."""
    made = record()
    lines = [
        "| rate [Hz] | order kept | snap, loading [mm] | snap, unloading [mm] | states |",
        "|---" * 5 + "|",
    ]
    first, last = (number(at, 4) for at in made["snaps_mm"])
    lines.append(f"| quasi-static | yes | {first} | {last} | 10, 11, 01, 00 |")
    for row in made["motions"]:
        if row["rate_Hz"] not in SHOWN:
            continue
        if "stopped" in row:
            lines.append(f"| {row['rate_Hz']:g} | not followed | | | |")
            continue
        snaps = ("none" if at is None else number(at, 4) for at in row["snaps_mm"])
        kept = "yes" if row["keeps_order"] else "no"
        lines.append(
            f"| {row['rate_Hz']:g} | {kept} | {' | '.join(snaps)} | {_few(row['states'])} |"
        )
    return "\n".join(lines)


def _few(states: list[str], most: int = 6) -> str:
    more = f" and {len(states) - most} more" if len(states) > most else ""
    return ", ".join(states[:most]) + more


def written(text: str) -> str:
    """The page with its table as it should be."""
    begin, end = "<!-- rates: written by tests/docs/rates.py -->", "<!-- end of rates -->"
    new = f"{begin}\n\n{table()}\n\n{end}"
    return re.sub(f"{re.escape(begin)}.*?{end}", lambda _: new, text, flags=re.S)


@styled
def picture() -> Any:
    """Delay of both snaps against the rate, and below it the order and the landings."""
    made, left, foot, high, low = record(), 25.0, 22.0, 42.0, 12.0
    figure = blank(COLUMN, high + low + foot + 6.0)
    ax = place(figure, left, foot + low + 3.0, COLUMN - left - 5.0, high)
    order = place(figure, left, foot, COLUMN - left - 5.0, low)
    safe, critical = made["safe_rate_Hz"], made["critical_Hz"]
    for panel in (ax, order):
        panel.axvspan(0.01, safe, color=GREEN, alpha=0.12, linewidth=0)
        panel.axvline(safe, color=GREEN, linewidth=1.0)
        panel.axvline(critical, color=FAINT, linewidth=1.0, linestyle=(0, (4, 1.5)))
        panel.set_xscale("log")
        panel.set_xlim(0.01, 100.0)
        panel.xaxis.set_major_formatter(lambda at, _: f"{at:g}")
    for k, (colour, mark) in enumerate(((BLUE, "o"), (VERMILLION, "s"))):
        for row in made["motions"]:
            at = row.get("snaps_mm", (None, None))[k]
            if at is not None and row["keeps_order"]:
                # The drive goes on, forward while loading and backward while unloading.
                delay = (at - made["snaps_mm"][k]) * (1 - 2 * k)
                size = 4.5 if k == 0 else 2.5
                ax.plot(row["rate_Hz"], delay, mark, color=colour, markersize=size)
    for row in made["motions"]:
        ways = [_few(row.get("states", [])) == one for one in LANDINGS]
        for place_of, there in enumerate(ways):
            if there:
                order.plot(row["rate_Hz"], place_of, "o", color=INK, markersize=3.0)
    ax.set_ylim(0.0, 1.6)
    ax.set_ylabel("delay of the snap [mm]")
    ax.tick_params(labelbottom=False)
    order.set_ylim(-0.6, 1.6)
    order.set_yticks([0, 1], [one.replace(", ", ">") for one in LANDINGS])
    order.set_xlabel("rate [cycles/s]")
    handles = [
        legends.mark("loading", "o", color=BLUE),
        legends.mark("unloading", "s", 2.5, color=VERMILLION),
        legends.line("safe rate", GREEN, 1.0),
        legends.line("order changes", FAINT, 1.0, linestyle=(0, (4, 1.5))),
    ]
    legends.below(figure, handles, 2)
    return figure


def drawn() -> str:
    return svg(picture())


if __name__ == "__main__":
    if "--integrate" in sys.argv[1:]:
        FILE.write_text(json.dumps(integrated(), indent=1) + "\n", "utf-8")
    PICTURE.write_text(drawn(), "utf-8")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
