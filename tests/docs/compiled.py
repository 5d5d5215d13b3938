"""The numbers of docs/compiled.md: compiled robots in arenas, as copies, and as made.

`python tests/docs/compiled.py` compiles the table `turn-away`, simulates all runs (about six
minutes of one core) and writes docs/compiled.json and the tables of the page; with --rows the
same for the table of motions, and with --page the tables of the page only. No arena was used to
choose a design.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import docs.compiled_behaviours as behaviours
import stepwell as sw
from stepwell.base import percent
from stepwell.design import DEFAULT_TOLERANCES, Draws
from stepwell.robot import (
    Action,
    BehaviourRow,
    Robot,
    RobotBehaviour,
    compile_behaviour,
    other_start,
)
from stepwell.simulation import behaviour_trials, mazes, verified

ROOT = Path(__file__).parents[2]
FILE, PAGE = ROOT / "docs" / "compiled.json", ROOT / "docs" / "compiled.md"
ROWS = ROOT / "docs" / "compiled-rows.json"
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


FREE = "forward", "backward"
TOUCHES = *FREE, "turn right", "turn left", "veer right", "veer left", "stop"


def combinations() -> list[dict[str, Any]]:
    """For each motion without contact and after a touch on the left: whether designs have both.

    A touch on the right gives the mirror image; both antennas together may give any motion.
    """
    found = []
    for free, touch in product(FREE, TOUCHES):
        if touch == free:
            continue
        motions = free, touch, Action(touch).mirrored, "any"
        given = zip(("free", "left", "right", "both"), motions, strict=True)
        rows = [BehaviourRow(contact, Action(motion)) for contact, motion in given]
        table = RobotBehaviour(rows, sw.preset("robot-antennas"))
        result = verified(compile_behaviour(table, samples=100), most=3)
        design, compiled = result.design, result.compiled
        crossed = design is not None and design.places.wiring == (1, 0)
        found.append(
            {
                "free": free,
                "touch": touch,
                "designs": compiled.met,
                "proved": compiled.proved,
                "antenna": ("" if design is None else "opposite" if crossed else "same"),
                "yield": None if design is None else design.built.estimate,
                "verified": result.verified,
                "walked": len(result.trials),
            }
        )
        print(found[-1], flush=True)
    return found


def combination_lines(found: list[dict[str, Any]]) -> list[str]:
    """The table of combinations."""
    rows = ["| free | touch on the left | designs | antenna moves | yield | simulated |"]
    rows.append("|---" * 6 + "|")
    for one in found:
        none = "none: proved" if one["proved"] else "none"
        designs = f"{one['designs']:,}" if one["designs"] else none
        share = "" if one["yield"] is None else percent(one["yield"])
        walked = "" if not one["walked"] else "yes" if one["verified"] else "no"
        leg = f"{one['antenna']} leg" if one["antenna"] else ""
        rows.append(f"| {one['free']} | {one['touch']} | {designs} | {leg} | {share} | {walked} |")
    return rows


def written(text: str, name: str, rows: list[str], script: str = "compiled") -> str:
    """The text of a page with one of its tables."""
    begin, end = f"<!-- {name}: written by tests/docs/{script}.py -->", f"<!-- end of {name} -->"
    before, rest = text.split(begin)
    table = "\n".join(rows)
    return f"{before}{begin}\n\n{table}\n\n{end}{rest.split(end)[1]}"


def page(text: str) -> str:
    """The text of the page with the tables of both records."""
    text = written(text, "runs", lines(json.loads(FILE.read_text("utf-8"))))
    records = json.loads(behaviours.FILE.read_text("utf-8"))
    text = written(text, "behaviours", behaviours.lines(records))
    return written(text, "rows", combination_lines(json.loads(ROWS.read_text("utf-8"))))


def main(arguments: list[str]) -> None:
    if "--rows" in arguments:
        ROWS.write_text(json.dumps(combinations(), indent=1) + "\n", "utf-8")
    elif "--page" not in arguments:
        record = chosen()
        robot = sw.files.loads(record["robot"]).robot
        for name in ARENAS:
            record["arenas"].append(in_arena(robot, name))
            FILE.write_text(json.dumps(record, indent=1) + "\n", "utf-8")
            print(record["arenas"][-1], flush=True)
    PAGE.write_text(page(PAGE.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
