"""The numbers of docs/compiled.md: compiled robots in arenas, as copies, and as made.

`python tests/docs/compiled.py` compiles the table `turn-away`, simulates all runs (about six
minutes of one core) and writes docs/compiled.json and the tables of the page; with --page it writes
the tables from that file. No arena was used to choose a design.
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
# Number of random starts in each arena.
ARENAS = {"wall": 20, "cylinder": 20, "three-walls": 10, "corridor": 10}
COPIES = 24
LIMITS = {"wall": 120.0, "cylinder": 120.0}
LIMIT = 600.0


def passed(run: sw.simulation.Maze) -> bool:
    """Whether a run passed its arena."""
    return run.outcome.name == "REACHED" if run.arena.goal is not None else run.walks_on


def in_arena(robot: Robot, name: str) -> dict[str, Any]:
    """How often a robot passes an arena from random starts."""
    arena, limit, starts = sw.load_arena(name), LIMITS.get(name, LIMIT), ARENAS[name]
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


def chosen() -> dict[str, Any]:
    """The robot of the package's table: numbers, copies, and as it is cut."""
    table = sw.files.load_behaviour("turn-away")
    result = verified(compile_behaviour(table))
    design, robot = result.design, result.robot
    assert design is not None
    made = result.with_parts(sw.build(robot, "acrylic-3mm").robot)
    trials = behaviour_trials(table, copies(robot))
    return {
        "robot": sw.files.dumps(robot),
        "margin_mN": 1e3 * design.margin,
        "yield": design.built.estimate,
        "advance": result.walked[0].trial.advance,
        "verified": result.verified,
        "made_margin_mN": 1e3 * min(row.force for row in made.made_rows),
        "made_advance": made.made_trials[0].trial.advance,
        "made_verified": all(row.right for row in made.made_trials),
        "copies": COPIES,
        "right_copies": sum(all(row.right for row in rows) for rows in trials),
        "arenas": [],
    }


def lines(record: dict[str, Any]) -> list[str]:
    """The tables of the page."""
    rows = ["| arena | starts | passed |", "|---|---|---|"]
    rows += [
        f"| `{run['arena']}` | {run['starts']} | {run['passed']} |" for run in record["arenas"]
    ]
    rows += ["", "| robot | margin [mN] | d/u_max, free | all rows in the simulation |"]
    rows += ["|---|---|---|---|"]
    answers = {True: "yes", False: "no"}
    rows += [
        f"| {name} | {record[f'{key}margin_mN']:.0f} | {record[f'{key}advance']:.2f} | "
        f"{answers[record[f'{key}verified']]} |"
        for name, key in (("nominal", ""), ("as cut", "made_"))
    ]
    right, count = record["right_copies"], record["copies"]
    return [*rows, f"| copies within tolerances | | | {right} of {count} |"]


def main(arguments: list[str]) -> None:
    if "--page" not in arguments:
        record = chosen()
        robot = sw.files.loads(record["robot"]).robot
        for name in ARENAS:
            record["arenas"].append(in_arena(robot, name))
            FILE.write_text(json.dumps(record, indent=1) + "\n", "utf-8")
            print(record["arenas"][-1], flush=True)
    begin, end = "<!-- runs: written by tests/docs/compiled.py -->", "<!-- end of runs -->"
    text = PAGE.read_text("utf-8")
    before, rest = text.split(begin)
    table = "\n".join(lines(json.loads(FILE.read_text("utf-8"))))
    PAGE.write_text(f"{before}{begin}\n\n{table}\n\n{end}{rest.split(end)[1]}", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
