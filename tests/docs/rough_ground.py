"""The numbers of docs/rough-ground.md: the paper's robot on slopes, steps and other floors.

`python tests/docs/rough_ground.py` simulates all walks (about three minutes of one core) and writes
docs/rough-ground.json and the tables of the page; with --page the tables only. The criteria, and
which of them were fixed before the runs, stand on the page.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from stepwell.files import load_arena, vary, vary_arena
from stepwell.robot import Arena, Patch, Robot
from stepwell.simulation import Trial, sweep

ROOT = Path(__file__).parents[2]
FILE, PAGE = ROOT / "docs" / "rough-ground.json", ROOT / "docs" / "rough-ground.md"

SEEDS = 0, 1, 2
# A slope is passed with a fraction of the advance on the bare floor from EVEN to FAST; a step,
# which the robot meets after some cycles, with a fraction of at least MET.
EVEN, MET, FAST = 0.5, 0.9, 2.0
SHORT, LONG = 4, 16  # cycles of a walk
AT = 0.110  # begin of a step or a groove, ahead of the start [m]

UPHILL = 0, 2, 4, 5, 6, 7, 7.2, 8
CROSS = 2, 4, 5, 6, 7, 8
STEPS = 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1
GROOVES = 0.5, 1, 1.5, 2, 3, 5
BUMPS = 0.05, 0.1, 0.2, 0.3
FRICTION, DRAG = (0.2, 0.3, 0.4, 0.5, 0.65, 0.8), (0.2, 0.39, 0.6, 0.79, 1.0)
Q_OUT, Q_IN = "chain.cell.outer.q_mm[0]", "chain.cell.inner.q_mm[0]"
STIFFNESS = "chain.band.stiffness_N_per_m"
CHANGES: Sequence[Mapping[str, float]] = (
    {},
    {Q_OUT: 22},
    {Q_OUT: 24},
    {Q_IN: 8},
    {Q_IN: 6},
    {Q_IN: 12},
    {STIFFNESS: 45},
    {STIFFNESS: 60},
    {"foot.below_mm": 0.3},
    {Q_OUT: 24, STIFFNESS: 60},
)
_SLOPES, _STEPS, _RUBBER = (5, 7), (0.15, 0.3, 0.5), 0.79


def slope(angle: float, uphill: float = 0.0) -> Arena:
    """A bare floor with this slope [deg]."""
    return vary_arena(Arena(), {"slope.angle_deg": angle, "slope.uphill_deg": uphill})


def across(level: float, begin: float = AT, length: float = 3.0) -> Patch:
    """A patch across the way with a level [mm]."""
    return Patch((begin, -3.0), (begin + length, 3.0), level=level * 1e-3)


def bumps(level: float) -> Arena:
    """Bars of 5 mm in steps of 25 mm, with a level [mm]."""
    return Arena(patches=[across(level, begin, 0.005) for begin in np.arange(AT, 0.6, 0.025)])


def trials(
    robot: Robot, arenas: Sequence[Arena], cycles: int, seeds: Sequence[int | None] = SEEDS
) -> list[list[Trial]]:
    """For each arena the walks of a robot from random starts, or for None from its own start."""
    entries = [
        arena if seed is None else vary_arena(arena, {"start_seed": seed})
        for arena in arenas
        for seed in seeds
    ]
    done = sweep([robot] * len(entries), arenas=entries, cycles=cycles).trials
    return [list(done[i : i + len(seeds)]) for i in range(0, len(done), len(seeds))]


def passed(advance: Sequence[float], least: float, bare: float) -> int:
    """Number of walks with a fraction of the advance on the bare floor in the range allowed."""
    # A walk that stopped early has no advance, which is a NaN.
    return sum(least * bare <= one <= FAST * bare for one in advance)


def measured(some: Sequence[Trial]) -> dict[str, Any]:
    """What a row of a table needs of the walks on one ground."""
    return {
        "advance": [one.advance for one in some],
        "sideways": float(np.mean([one.sideways for one in some])),
        "turn": float(np.degrees(np.mean([one.turn for one in some]))),
    }


def grounds(robot: Robot) -> dict[str, list[dict[str, Any]]]:
    """The walks of a robot on each ground, by the name of the table."""
    long = {
        "step": (STEPS, [Arena(patches=[across(level)]) for level in STEPS]),
        "head-on": (STEPS, [Arena(patches=[across(level)]) for level in STEPS]),
        "groove": (GROOVES, [Arena(patches=[across(-1, AT, w * 1e-3)]) for w in GROOVES]),
        "bumps": (BUMPS, [bumps(level) for level in BUMPS]),
    }
    short = {
        "uphill": (UPHILL, [slope(angle) for angle in UPHILL]),
        "downhill": (UPHILL[1:], [slope(-angle) for angle in UPHILL[1:]]),
        "cross": (CROSS, [slope(angle, 90) for angle in CROSS]),
    }
    found: dict[str, list[dict[str, Any]]] = {}
    for tables, cycles in ((short, SHORT), (long, LONG)):
        for name, (values, arenas) in tables.items():
            rows = trials(robot, arenas, cycles, [None] if name == "head-on" else SEEDS)
            pairs = zip(values, rows, strict=True)
            found[name] = [{"value": value} | measured(some) for value, some in pairs]
            print(name, [row["advance"] for row in found[name]], flush=True)
    return found


def frictions(robot: Robot) -> list[list[float]]:
    """Advance of a robot by drag (rows) and friction of the feet (columns)."""
    floors = [
        vary(robot, {"floor.foot_friction": friction, "floor.drag_N": drag})
        for drag in DRAG
        for friction in FRICTION
    ]
    advance = [trial.advance for trial in sweep(floors, cycles=SHORT).trials]
    return np.reshape(advance, (len(DRAG), len(FRICTION))).tolist()


def changed(robot: Robot, values: Mapping[str, float]) -> dict[str, Any]:
    """What a change of the robot gains on slopes, steps and rubber."""
    own = vary(robot, values)
    bare = trials(own, [Arena()], SHORT, [0])[0][0].advance
    slopes = trials(own, [slope(angle) for angle in _SLOPES], SHORT, [0])
    steps = trials(own, [Arena(patches=[across(level)]) for level in _STEPS], LONG, [None])
    pairs = zip(_STEPS, steps, strict=True)
    over = [level for level, some in pairs if passed([some[0].advance], MET, bare)]
    (rubber,) = trials(vary(own, {"floor.drag_N": _RUBBER}), [Arena()], SHORT, [0])
    row = {
        "change": dict(values),
        "bare": bare,
        "slopes": [some[0].advance for some in slopes],
        "step": max(over, default=0.0),
        "rubber": rubber[0].advance,
    }
    print(row, flush=True)
    return row


def computed() -> dict[str, Any]:
    """All numbers of the page."""
    robot = sw.preset("robot-forward")
    bare = trials(robot, [load_arena("open")], SHORT)[0]
    return {
        "bare": float(np.mean([one.advance for one in bare])),
        "weight_N": robot.weight,
        "limit_deg": float(np.degrees(np.arctan(robot.floor.drag / robot.weight))),
        "grounds": grounds(robot),
        "friction": frictions(robot),
        "changes": [changed(robot, values) for values in CHANGES],
    }


_WORDS = {
    "uphill": "uphill, {}°",
    "downhill": "downhill, {}°",
    "cross": "across the slope, {}°",
    "step": "step up, {} mm",
    "head-on": "step up, met head-on, {} mm",
    "groove": "groove 1 mm deep, {} mm wide",
    "bumps": "bars of 5 mm every 25 mm, {} mm high",
}


def ground_lines(record: dict[str, Any]) -> list[str]:
    """The table of grounds."""
    rows = ["| ground | d/u_max, least to largest | to the left | turn [°] | passed |"]
    rows.append("|---" * 5 + "|")
    for name, words in _WORDS.items():
        least = EVEN if name in ("uphill", "downhill", "cross") else MET
        for row in record["grounds"][name]:
            low, high = min(row["advance"]), max(row["advance"])
            count = passed(row["advance"], least, record["bare"])
            ground = words.format(f"{row['value']:g}")
            advance = f"{low:z.2f}" if low == high else f"{low:z.2f} to {high:z.2f}"
            rows.append(
                f"| {ground} | {advance} | {row['sideways']:z.2f} | {row['turn']:z.1f} | "
                f"{count} of {len(row['advance'])} |"
            )
    return rows


def friction_lines(record: dict[str, Any]) -> list[str]:
    """The map of frictions."""
    head = " | ".join(f"{value:g}" for value in FRICTION)
    rows = [f"| drag [N] | {head} |", "|---" * (len(FRICTION) + 1) + "|"]
    for drag, each in zip(DRAG, record["friction"], strict=True):
        rows.append(f"| {drag:g} | " + " | ".join(f"{value:z.2f}" for value in each) + " |")
    return rows


_NAMES = {
    Q_OUT: "outer q_x {:g} mm",
    Q_IN: "inner q_x {:g} mm",
    STIFFNESS: "bands {:g} N/m",
    "foot.below_mm": "feet {:g} mm deep",
}


def change_lines(record: dict[str, Any]) -> list[str]:
    """The table of changes."""
    head = ", ".join(f"{angle}°" for angle in _SLOPES)
    rows = [
        f"| robot | d/u_max, bare floor | uphill, {head} | largest step passed [mm] | "
        f"drag {_RUBBER} N |"
    ]
    rows.append("|---" * 5 + "|")
    for row in record["changes"]:
        words = ", ".join(_NAMES[key].format(value) for key, value in row["change"].items())
        up = ", ".join(f"{value:z.2f}" for value in row["slopes"])
        step = f"{row['step']:g}" if row["step"] else f"none of {_STEPS[0]:g} or more"
        rows.append(
            f"| {words or 'as it is'} | {row['bare']:z.2f} | {up} | {step} | {row['rubber']:z.2f} |"
        )
    return rows


def page(text: str) -> str:
    """The text of the page with the tables of the record."""
    record = json.loads(FILE.read_text("utf-8"))
    tables = (("grounds", ground_lines), ("friction", friction_lines), ("changes", change_lines))
    for name, lines in tables:
        begin = f"<!-- {name}: written by tests/docs/rough_ground.py -->"
        end = f"<!-- end of {name} -->"
        before, rest = text.split(begin)
        table = "\n".join(lines(record))
        text = f"{before}{begin}\n\n{table}\n\n{end}{rest.split(end)[1]}"
    return text


def main(arguments: list[str]) -> None:
    """Compute the record unless only the page is asked for, then write the page."""
    if "--page" not in arguments:
        FILE.write_text(json.dumps(computed(), indent=1) + "\n", "utf-8")
    PAGE.write_text(page(PAGE.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
