"""The tables of docs/as-cut.md, from walks, ranges and mazes of the robots as they can be cut.

docs/as-cut.json has what was computed. `python tests/docs/as_cut.py walks ranges mazes` computes
these parts again, minutes each, and of arenas the variants that are missing; without a part it only
writes the page.
"""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from stepwell import files
from stepwell.paper import assumed_ranges, steering
from stepwell.paper.buildable import VARIANTS, buildable
from stepwell.paper.walking import BACKWARD, FORWARD, STANDS_STILL, TURN_DEG
from stepwell.robot import Robot, other_start
from stepwell.simulation import Outcome, mazes, walk

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "as-cut.md", ROOT / "docs" / "as-cut.json"
CYCLES = 5
# Robots with the number of a cycle that counts, and its range in the paper.
WALKS = {
    "forward": ("d/u_max", FORWARD[0] - FORWARD[1], FORWARD[0] + FORWARD[1]),
    "backward": ("d/u_max", -BACKWARD[0] - BACKWARD[1], -BACKWARD[0] + BACKWARD[1]),
    "left": ("turn [°]", TURN_DEG[0] - TURN_DEG[1], TURN_DEG[0] + TURN_DEG[1]),
    "15": ("d/u_max", -math.inf, STANDS_STILL),
}
# Of the sets of the claims about antennas, in cycles of 2 s.
OFFSETS_MM, WALLS_DEG, SEED = steering.OFFSETS_MM[2:8:2], steering.WALLS_DEG[2:7:4], 100
LIMITS = {"cylinders": 80, "walls": 100, "three-walls": 350}


def walks() -> dict[str, Any]:
    """Advance, turn and gait of every robot in every variant."""
    found: dict[str, Any] = {}
    for variant in VARIANTS:
        for name in WALKS:
            one = walk(buildable(name, variant), CYCLES)
            found.setdefault(variant, {})[name] = {
                "advance": round(float(one.advance[1:].mean()), 3),
                "turn_deg": round(float(np.degrees(one.turn[1:].mean())), 2),
                "gaits": sorted({gaits[-1] for gaits in one.gaits.values()}),
            }
    return found


def ranges() -> dict[str, Any]:
    """Ranges of all assumed numbers for the robots that step, where they keep the paper's gaits."""
    found: dict[str, Any] = {}
    for variant in ("idealised", "rollers-firm", "dry-stiff"):
        for name in ("forward", "backward", "left"):
            one = assumed_ranges(buildable(name, variant))
            found.setdefault(variant, {})[name] = [
                {
                    "number": each.label,
                    "value": each.value,
                    "low": round(each.low, 4),
                    "high": round(each.high, 4),
                    "below": each.below,
                    "above": each.above,
                }
                for each in one.ranges
            ]
            print(variant, name, flush=True)
            save("ranges", found)
    return found


def arenas() -> dict[str, list[Any]]:
    """The arenas by kind."""
    three = files.load_arena("three-walls")
    return {
        "cylinders": [steering.cylinder_ahead(offset / 1e3) for offset in OFFSETS_MM],
        "walls": [steering.wall_ahead(math.radians(angle)) for angle in WALLS_DEG],
        "three-walls": [other_start(three, SEED)],
    }


def in_mazes() -> dict[str, Any]:
    """Arenas that each robot with antennas leaves behind, with the controls of three walls."""
    found: dict[str, Any] = {}
    done = record().get("mazes", {})
    found |= {variant: done[variant] for variant in VARIANTS if variant in done}
    for variant in (variant for variant in VARIANTS if variant not in found):
        one = buildable("antennas", variant)
        off = replace(one, antennas=[replace(each, connected=False) for each in one.antennas])
        for kind, every in arenas().items():
            robots = {kind: one}
            if kind == "three-walls" and "dry" not in variant:
                robots |= {f"{kind}, levers off": off, f"{kind}, no antennas": bare(one)}
            for label, each in robots.items():
                limit = LIMITS[kind] * one.drive.period
                ways = mazes([(each, arena) for arena in every], limit=limit)
                reached = [way.outcome is Outcome.REACHED for way in ways]
                left = [way.walks_on for way in ways]
                passed = sum(reached if kind == "three-walls" else left)
                found.setdefault(variant, {})[label] = [passed, len(ways)]
                print(variant, label, passed, len(ways), flush=True)
    return found


def bare(one: Robot) -> Robot:
    """A robot without antennas, whose parts are left out."""
    return replace(one, antennas=(), made=None)


PARTS = {"walks": walks, "ranges": ranges, "mazes": in_mazes}


def save(part: str, found: dict[str, Any]) -> None:
    """Write what was computed so far."""
    FILE.write_text(json.dumps(record() | {part: found}, indent=1) + "\n", "utf-8")


def record() -> dict[str, Any]:
    """What was computed."""
    return json.loads(FILE.read_text("utf-8")) if FILE.exists() else {}


def inside(name: str, of: dict[str, Any]) -> bool:
    """Whether a walk is within the claim's tolerance of the paper's number."""
    what, low, high = WALKS[name]
    return low <= (of["turn_deg"] if what.startswith("turn") else of["advance"]) <= high


def walks_table() -> str:
    """One row for each robot, one column for each variant."""
    lines = [
        "| robot | paper | " + " | ".join(one.label for one in VARIANTS.values()) + " |",
        "|---|---" * 1 + "|---" * len(VARIANTS) + "|",
    ]
    for name, (what, low, high) in WALKS.items():
        target = f"below {high:g}" if math.isinf(low) else f"{low:.2f} to {high:.2f}"
        cells = []
        for variant in VARIANTS:
            one = record()["walks"][variant][name]
            value = one["turn_deg"] if what.startswith("turn") else one["advance"]
            shown = f"{value:z.1f}" if what.startswith("turn") else f"{value:z.2f}"
            cells.append(shown if inside(name, one) else f"**{shown}**")
        lines.append(f"| {name}: {what} | {target} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def mazes_table() -> str:
    """One row for each kind of arena, one column for each variant."""
    found = record()["mazes"]
    lines = [
        "| robot and arenas | " + " | ".join(one.label for one in VARIANTS.values()) + " |",
        "|---" * (len(VARIANTS) + 1) + "|",
    ]
    for row in found["idealised"]:
        each = (found[variant].get(row) for variant in VARIANTS)
        counts = (f"{one[0]} of {one[1]}" if one else "not run" for one in each)
        lines.append(f"| {row} | " + " | ".join(counts) + " |")
    return "\n".join(lines)


def ranges_table() -> str:
    """The common range of every assumed number, of all robots of a variant."""
    found = record()["ranges"]
    names = dict.fromkeys(
        each["number"] for one in found.values() for rows in one.values() for each in rows
    )
    lines = [
        "| number | " + " | ".join(VARIANTS[variant].label for variant in found) + " |",
        "|---" * (len(found) + 1) + "|",
    ]
    for name in names:
        cells = []
        for variant in found:
            rows = [
                each for rows in found[variant].values() for each in rows if each["number"] == name
            ]
            cells.append(_common(rows))
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _common(rows: list[dict[str, Any]]) -> str:
    if not rows:
        return "not assumed"
    low, high = max(one["low"] for one in rows), min(one["high"] for one in rows)
    ends = (
        f"{value:.4g}" if any(one[end] for one in rows if one[key] == value) else f"({value:.4g})"
        for value, key, end in ((low, "low", "below"), (high, "high", "above"))
    )
    return " to ".join(ends).replace("-", "−")


TABLES = {"walks": walks_table, "mazes": mazes_table, "ranges": ranges_table}


def written(text: str) -> str:
    """The page with its tables as they should be."""
    for name, table in TABLES.items():
        begin, end = f"<!-- {name}: written by tests/docs/as_cut.py -->", "<!-- end -->"
        new = f"{begin}\n\n{table()}\n\n{end}"
        text = re.sub(f"{re.escape(begin)}.*?{end}", lambda _, new=new: new, text, flags=re.DOTALL)
    return text


if __name__ == "__main__":
    for part in sys.argv[1:]:
        save(part, PARTS[part]())
    if PAGE.exists():
        PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
