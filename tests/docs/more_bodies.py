"""The numbers of docs/more-bodies.md: four and six legs on one actuator, and a gripper.

`python tests/docs/more_bodies.py` simulates all walks (about three minutes of one core) and writes
docs/more-bodies.json and the tables of the page; with --page the tables only. The criteria, and
what was known when they were fixed, stand on the page.
"""

from __future__ import annotations

import contextlib
import io
import json
import runpy
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

import stepwell as sw
from docs.compiled import copies, written
from stepwell.base import GRAVITY
from stepwell.design import DEFAULT_TOLERANCES, Draws
from stepwell.robot import Robot
from stepwell.simulation import Walk

ROOT = Path(__file__).parents[2]
FILE, PAGE = ROOT / "docs" / "more-bodies.json", ROOT / "docs" / "more-bodies.md"
NAMES = "robot-six-legs", "robot-four-legs"
CYCLES, COPIES = 4, 20
LIFTED = 0.001  # a foot that is higher than this above the floor [m] is in the air
APART = 0.03  # least fraction of a cycle between neighbours, and the largest within a pair
LEAST, STRAIGHT = 0.5, 2.0  # least advance over u_max, and largest turn per cycle [°]
FRICTION, DRAG = (0.3, 0.5, 0.65, 0.8), (0.2, 0.39, 0.6)
_ROWS = "left", "right"
# Objects in the gripper: widths [m], and masses over the one that friction holds.
WIDTHS, SHARES = (0.006, 0.008, 0.010, 0.012), (0.5, 0.8, 0.9, 1.1, 1.5)
EXAMPLE = ROOT / "examples" / "17_two_finger_gripper.py"

Phases = tuple[list[float], list[float]]


def phases(walk: Walk) -> dict[str, Phases]:
    """For each leg the fractions of the last cycle at which its foot lifts and lands."""
    begin, end = walk.starts[-2:]
    inside = (walk.time >= begin) & (walk.time <= end)
    phase = ((walk.time[inside] - begin) / (end - begin))[1:]
    found = {}
    for i, leg in enumerate(walk.robot.legs):
        up = walk.foot_height[inside, i] > LIFTED
        lifts, lands = up[1:] & ~up[:-1], ~up[1:] & up[:-1]
        found[leg.name] = phase[lifts].round(3).tolist(), phase[lands].round(3).tolist()
    return found


def failures(walk: Walk) -> Iterator[str]:
    """The criteria that a walk does not meet."""
    found = phases(walk)
    if not all(len(lifts) == len(lands) == 1 for lifts, lands in found.values()):
        yield "each foot lifts and lands once"
        return
    for k, name in enumerate(("lift", "land")):
        left, right = (
            [one[k][0] for leg, one in found.items() if leg.startswith(row)] for row in _ROWS
        )
        if any(later - sooner < APART for row in (left, right) for sooner, later in pairwise(row)):
            yield f"feet {name} in a wave"
        if any(abs(a - b) > APART for a, b in zip(left, right, strict=True)):
            yield f"the feet of a pair {name} together"
    if not np.mean(walk.advance[1:]) >= LEAST:
        yield "advance"
    if not np.degrees(np.abs(np.mean(walk.turn[1:]))) <= STRAIGHT:
        yield "straight"


def floors(robot: Robot) -> list[Robot]:
    """The robot on floors of other friction: for each drag all coefficients of the feet."""
    return [
        replace(robot, floor=replace(robot.floor, drag=drag, foot_friction=friction))
        for drag, friction in product(DRAG, FRICTION)
    ]


def judged(robots: Sequence[Robot]) -> list[dict[str, Any]]:
    """Advance, and criteria that are not met, of a walk of each robot."""
    walks = (robot.walk(CYCLES) for robot in robots)
    return [
        {"advance": round(float(np.mean(walk.advance[1:])), 3), "failures": [*failures(walk)]}
        for walk in walks
    ]


def measured(name: str) -> dict[str, Any]:
    """The walks of a preset: as designed, as copies within tolerances, and on other floors."""
    robot: Robot = sw.preset(name)
    walk = robot.walk(CYCLES)
    return {
        "name": name,
        "advance": round(float(np.mean(walk.advance[1:])), 3),
        "turn_deg": round(float(np.degrees(np.mean(walk.turn[1:]))), 2),
        "phases": phases(walk),
        "failures": [*failures(walk)],
        "copies": judged(copies(robot, COPIES)),
        "floors": judged(floors(robot)),
    }


def gripped() -> dict[str, Any]:
    """The gripper of the example with objects of other widths and masses, and its copies."""
    with contextlib.redirect_stdout(io.StringIO()):
        names = runpy.run_path(str(EXAMPLE))
    chain, width, limit = names["chain"], names["width"], names["limit"]

    def run(chain: sw.Chain, width: float, mass: float) -> dict[str, Any]:
        one = names["grip"](chain, width, mass)
        return {"held": one.held, "force": round(one.force, 4), "opened": one.opened}

    second = chain.levers[1]
    rows: list[dict[str, Any]] = []
    for some in WIDTHS:
        force = -float(second.force(second.angle(names["GAP"] - some)))
        mass = 2 * names["FRICTION"] * force / GRAVITY
        runs = [run(chain, some, share * mass) for share in SHARES]
        rows.append(
            {
                "width_mm": 1e3 * some,
                "predicted": round(force, 4),
                "mass_g": 1e3 * mass,
                "runs": runs,
            }
        )
    made = [Draws(chain, DEFAULT_TOLERANCES, seed).sample(0) for seed in range(COPIES)]
    return {"objects": rows, "copies": [run(one, width, limit / 2) for one in made]}


def grip_lines(record: dict[str, Any]) -> list[str]:
    """The table of the gripper: force predicted and simulated, and which masses it holds."""
    head = ["width [mm]", "force, predicted [N]", "simulated [N]", "largest mass, predicted [g]"]
    head += [f"{share:g} of it" for share in SHARES]
    rows = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for one in record["objects"]:
        ends = [
            ("held" if run["held"] else "lost") + ("" if run["opened"] else ", not released")
            for run in one["runs"]
        ]
        numbers = f"{one['predicted']:.3f} | {one['runs'][0]['force']:.3f} | {one['mass_g']:.0f}"
        rows.append(f"| {one['width_mm']:g} | {numbers} | {' | '.join(ends)} |")
    right = sum(one["held"] and one["opened"] for one in record["copies"])
    return [*rows, "", f"Copies that hold and release: {right} of {len(record['copies'])}."]


def wave_lines(record: list[dict[str, Any]]) -> list[str]:
    """The table of lifts and landings of the left row."""
    rows = ["| robot | leg | lifts at | lands at |", "|---" * 4 + "|"]
    for one in record:
        for leg, ((lift,), (land,)) in one["phases"].items():
            if leg.startswith(_ROWS[0]):
                rows.append(f"| `{one['name']}` | {leg} | {lift:.2f} | {land:.2f} |")
    rows += ["", "| robot | d/u_max | turn [°] | copies that pass | least and largest d/u_max |"]
    rows.append("|---" * 5 + "|")
    for one in record:
        right = sum(not copy["failures"] for copy in one["copies"])
        advance = [copy["advance"] for copy in one["copies"]]
        rows.append(
            f"| `{one['name']}` | {one['advance']:.2f} | {one['turn_deg']:z.1f} | "
            f"{right} of {len(advance)} | {min(advance):.2f}, {max(advance):.2f} |"
        )
    return rows


def floor_lines(record: list[dict[str, Any]]) -> list[str]:
    """The tables of floors: d/u_max, in brackets where a criterion is not met."""
    rows: list[str] = []
    for one in record:
        head = [f"`{one['name']}`, drag [N]", *(f"{value:g}" for value in FRICTION)]
        rows += [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        for k, drag in enumerate(DRAG):
            some = one["floors"][k * len(FRICTION) : (k + 1) * len(FRICTION)]
            shown = [
                f"({x['advance']:z.2f})" if x["failures"] else f"{x['advance']:.2f}" for x in some
            ]
            rows.append(f"| {' | '.join([f'{drag:g}', *shown])} |")
        rows.append("")
    return rows[:-1]


def page(text: str, record: dict[str, Any]) -> str:
    """The text of the page with the tables of the record."""
    text = written(text, "legs", wave_lines(record["robots"]), "more_bodies")
    text = written(text, "floors", floor_lines(record["robots"]), "more_bodies")
    return written(text, "gripper", grip_lines(record["gripper"]), "more_bodies")


def main(arguments: list[str]) -> None:
    if "--page" not in arguments:
        made: dict[str, Any] = {"gripper": gripped(), "robots": []}
        for name in NAMES:
            made["robots"].append(measured(name))
            FILE.write_text(json.dumps(made, indent=1) + "\n", "utf-8")
    record = json.loads(FILE.read_text("utf-8"))
    PAGE.write_text(page(PAGE.read_text("utf-8"), record), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
