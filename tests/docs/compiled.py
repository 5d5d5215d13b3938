"""The numbers of docs/compiled.md: compiled robots in arenas, as copies, and as made.

`python tests/docs/compiled.py` compiles the tables, simulates all runs (about 20 minutes of one
core) and writes docs/compiled.json; `python tests/docs/compiled.py --page` writes the tables of the
page from that file. No arena was used to choose a design. The criteria are those of `CRITERIA`.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import stepwell as sw
from stepwell.design import DEFAULT_TOLERANCES, Draws
from stepwell.robot import Robot, compile_behaviour, other_start
from stepwell.simulation import behaviour_trials, mazes, verified

ROOT = Path(__file__).parents[2]
FILE, PAGE = ROOT / "docs" / "compiled.json", ROOT / "docs" / "compiled.md"
ARENAS = "wall", "cylinder", "three-walls", "corridor"
STARTS, COPIES = 20, 24
LIMITS = {"wall": 120.0, "cylinder": 120.0}
LIMIT = 600.0
CRITERIA = (
    "An arena with a goal is passed if the robot reaches the goal within 600 s. An arena without "
    "one is passed if the robot ends free: no antenna pressed, a steady heading, and an advance of "
    "0.4 u_max per cycle over the last ten cycles of 120 s. A copy has the behaviour if all four "
    "rows are right in the simulation."
)


def passed(run: sw.simulation.Maze) -> bool:
    """Whether a run passed its arena."""
    return run.outcome.name == "REACHED" if run.arena.goal is not None else run.walks_on


def in_arena(robot: Robot, name: str, starts: int = STARTS) -> dict[str, Any]:
    """How often a robot passes an arena, from `starts` random starts."""
    arena, limit = sw.load_arena(name), LIMITS.get(name, LIMIT)
    entries = [(robot, other_start(arena, seed)) for seed in range(starts)]
    runs = mazes(entries, limit=limit)
    return {"arena": name, "starts": starts, "passed": sum(map(passed, runs))}


def copies(robot: Robot, count: int = COPIES) -> list[Robot]:
    """Random copies of a robot within the default tolerances of all its bands and anchors."""
    made = []
    for seed in range(count):
        legs = [
            replace(leg, chain=Draws(leg.chain, DEFAULT_TOLERANCES, 2 * seed + i).sample(0))
            for i, leg in enumerate(robot.legs)
        ]
        made.append(replace(robot, legs=legs))
    return made


def study(name: str, moves: tuple[float, ...], starts: int = STARTS) -> dict[str, Any]:
    """One table with one choice of displacements: the robot, its rows, arenas and copies."""
    table = sw.files.load_behaviour("turn-away")
    table = replace(table, choice=replace(table.choice, moves=moves))
    result = verified(compile_behaviour(table))
    design, robot = result.design, result.robot
    assert design is not None
    trials = behaviour_trials(table, copies(robot))
    right = sum(all(row.right for row in rows) for rows in trials)
    made = result.with_parts(sw.build(robot, "acrylic-3mm").robot)
    return {
        "name": name,
        "inner_mm": [round(1e3 * x, 6) for x in design.places.inner],
        "outer_mm": [round(1e3 * x, 6) for x in design.places.outer],
        "moves_mm": [round(1e3 * x, 6) for x in design.places.moves],
        "bands": [design.places.inner_bands, design.places.outer_bands],
        "below_mm": round(1e3 * design.places.below, 6),
        "margin_mN": round(1e3 * design.margin, 3),
        "yield": design.built.estimate,
        "verified": result.verified,
        "advance": round(result.walked[0].trial.advance, 3),
        "copies": COPIES,
        "right_copies": right,
        "made_advance": round(made.made_trials[0].trial.advance, 3),
        "made_margin_mN": round(1e3 * min(row.force for row in made.made_rows), 3),
        "made_verified": all(row.right for row in made.made_trials),
        "arenas": [in_arena(robot, arena, starts) for arena in ARENAS],
    }


def lines(records: list[dict[str, Any]]) -> list[str]:
    """The tables of the page."""
    head = "| design | " + " | ".join(ARENAS) + " | copies with all rows |"
    rows = [head, "|---" * (len(ARENAS) + 2) + "|"]
    for one in records:
        each = [f"{run['passed']} of {run['starts']}" for run in one["arenas"]]
        rows.append(
            f"| {one['name']} | {' | '.join(each)} | {one['right_copies']} of {one['copies']} |"
        )
    rows += ["", "| design | margin [mN] | d/u_max, free | as cut: margin [mN] | as cut: d/u_max |"]
    rows += ["|---|---|---|---|---|"]
    rows += [
        f"| {one['name']} | {one['margin_mN']:.0f} | {one['advance']:.2f} | "
        f"{one['made_margin_mN']:.0f} | {one['made_advance']:.2f} |"
        for one in records
    ]
    return rows


def main(arguments: list[str]) -> None:
    if "--page" not in arguments:
        records = []
        for name, moves in (("4 mm", (0.004,)), ("6 mm", (0.006,))):
            records.append(study(name, moves))
            print(json.dumps(records[-1]), flush=True)
        FILE.write_text(json.dumps(records, indent=1) + "\n", "utf-8")
    begin, end = "<!-- runs: written by tests/docs/compiled.py -->", "<!-- end of runs -->"
    text = PAGE.read_text("utf-8")
    before, rest = text.split(begin)
    table = "\n".join(lines(json.loads(FILE.read_text("utf-8"))))
    PAGE.write_text(f"{before}{begin}\n\n{table}\n\n{end}{rest.split(end)[1]}", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
