"""The second tables of docs/compiled.md: robots that follow walls, leave corners and reverse.

`python tests/docs/compiled_behaviours.py [TABLE…]` compiles these tables of the package, or all,
simulates all runs that docs/compiled-behaviours.json does not have yet, and writes them there;
`python tests/docs/compiled.py --page` writes the page. Criteria, arenas and numbers of starts were
fixed before the runs.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.base import percent
from stepwell.robot import Robot, compile_behaviour, other_start
from stepwell.simulation import Maze, RowTrial, mazes, sweep, verified

DOCS = Path(__file__).parents[2] / "docs"
FILE = DOCS / "compiled-behaviours.json"
# For each table its arenas with time limits [s].
RUNS = {
    "follow-wall": {"bend-left": 300.0, "bend-right": 300.0, "long-wall": 300.0},
    "leave-corner": {"corner": 80.0},
    "turn-away": {"wall-ahead": 30.0},
}
STARTS = 20
WALL_AHEAD = sw.load_arena("wall-ahead").title
BACK = 0.010  # way back from a wall that counts as a reversal [m]
_AFTER, _OTHER = "cycles_after_touch", "of_another_gait"
PRESSED = 0.05  # fraction of its swing from which on an antenna counts as pressed


def passed(run: Maze) -> bool:
    """Whether a run passed its arena: goal reached, else free at the end."""
    return run.outcome.name == "REACHED" if run.arena.goal is not None else run.walks_on


def reverses(run: Maze) -> bool:
    """Whether the robot goes back by 10 mm after both antennas were pressed together."""
    both = _pressed(run).all(axis=1)
    if not both.any():
        return False
    way = run.walk.x[int(both.argmax()) :]
    return bool((np.maximum.accumulate(way) - way).max() >= BACK)


def after_touch(run: Maze) -> list[tuple[str, ...]]:
    """Gaits of all legs in cycles without contact that follow one with a contact."""
    walk = run.walk
    touched = {int(one) for one in walk.time[_pressed(run).any(axis=1)] // walk.robot.drive.period}
    gaits = list(zip(*walk.gaits.values(), strict=True))
    return [gaits[k] for k in range(2, len(gaits)) if k - 1 in touched and k not in touched]


def _pressed(run: Maze) -> Any:
    swings = np.array([one.swing for one in run.walk.robot.antennas])
    return run.walk.antenna > PRESSED * swings


def judged(run: Maze, free: tuple[str, ...]) -> dict[str, Any]:
    """Verdict and duration of a run, and gaits in cycles after a touch."""
    cycles = after_touch(run)
    return {
        "passed": reverses(run) if run.arena.title == WALL_AHEAD else passed(run),
        "duration_s": run.duration,
        _AFTER: len(cycles),
        _OTHER: sum(gaits != free for gaits in cycles),
    }


def gaits_of(robot: Robot) -> tuple[str, ...]:
    """Gaits of all legs without contact, in a walk of two cycles."""
    return sweep([robot], cycles=2).trials[0].gaits


def walked(rows: tuple[RowTrial, ...]) -> list[dict[str, Any]]:
    """Motion per cycle in each row of a table."""
    return [
        {
            "contact": one.row.contact,
            "motion": str(one.row.motion),
            "advance": one.trial.advance,
            "turn_deg": math.degrees(one.trial.turn),
            "gaits": [*one.trial.gaits],
            "right": one.right,
        }
        for one in rows
    ]


def compiled(name: str) -> dict[str, Any]:
    """The robot of a table of the package, and its numbers, nominal and as cut."""
    if name == "turn-away":
        # Its numbers are in the first tables of the page.
        robot = json.loads((DOCS / "compiled.json").read_text("utf-8"))["robot"]
        return {"table": name, "robot": robot, "arenas": {}}
    result = verified(compile_behaviour(sw.files.load_behaviour(name)))
    design = result.design
    assert design is not None
    made = result.with_parts(sw.build(result.robot, "acrylic-3mm").robot)
    return {
        "table": name,
        "robot": sw.files.dumps(result.robot),
        "designs": result.compiled.met,
        "margin_mN": 1e3 * design.margin,
        "yield": design.built.estimate,
        "rows": walked(result.walked),
        "made_margin_mN": 1e3 * min(row.force for row in made.made_rows),
        "made_rows": walked(made.made_trials),
        "arenas": {},
    }


def lines(records: list[dict[str, Any]]) -> list[str]:
    """The tables of the page: rows of each table, nominal and as cut, and arenas."""
    own = [one for one in records if "rows" in one]
    out = ["| table | designs | margin [mN] | yield | margin as cut [mN] |", "|---" * 5 + "|"]
    out += [
        f"| `{one['table']}` | {one['designs']:,} | {one['margin_mN']:.0f} | "
        f"{percent(one['yield'])} | {one['made_margin_mN']:.0f} |"
        for one in own
    ]
    out += ["", "| table | contact | motion | d/u_max, turn | as cut | met |", "|---" * 6 + "|"]
    out += [
        f"| `{one['table']}` | {row['contact']} | {row['motion']} | {_motion(row)} | "
        f"{_motion(made)} | {_met(row)}, {_met(made)} |"
        for one in own
        for row, made in zip(one["rows"], one["made_rows"], strict=True)
    ]
    out += ["", "| table | arena | starts | passed | median time [s] |", "|---" * 5 + "|"]
    for one in records:
        for arena, runs in one["arenas"].items():
            right, time = sum(run["passed"] for run in runs), [run["duration_s"] for run in runs]
            out.append(
                f"| `{one['table']}` | `{arena}` | {len(runs)} | {right} | {median(time):.0f} |"
            )
    every = [run for one in records for runs in one["arenas"].values() for run in runs]
    cycles, others = (sum(run[key] for run in every) for key in (_AFTER, _OTHER))
    text = f"Cycles without contact after a cycle with one: {cycles}; of another gait: {others}."
    return [*out, "", text]


def _motion(row: dict[str, Any]) -> str:
    return f"{row['advance']:z.2f}, {row['turn_deg']:z.1f}°".replace("-", "−")


def _met(row: dict[str, Any]) -> str:
    return "yes" if row["right"] else "no"


def main(names: list[str]) -> None:
    known = json.loads(FILE.read_text("utf-8")) if FILE.exists() else []
    records = {one["table"]: one for one in known}

    def keep() -> None:
        ordered = [records[one] for one in RUNS if one in records]
        FILE.write_text(json.dumps(ordered, indent=1) + "\n", "utf-8")

    for name in names or RUNS:
        if name not in records:
            records[name] = compiled(name)
            keep()
        robot = sw.files.loads(records[name]["robot"]).robot
        free = gaits_of(robot)
        for arena, limit in RUNS[name].items():
            place, runs = sw.load_arena(arena), records[name]["arenas"].setdefault(arena, [])
            while len(runs) < STARTS:
                seeds = range(len(runs), min(len(runs) + 2, STARTS))
                entries = [(robot, other_start(place, seed)) for seed in seeds]
                runs += [judged(run, free) for run in mazes(entries, limit=limit)]
                keep()
                print(name, arena, runs[-2:], flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
