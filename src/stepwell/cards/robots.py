"""Cards of robots and of their runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, counted, number, record, rows_of
from stepwell.cards.html import Card, facts
from stepwell.results import CHANGE, CYCLES, MEAN, PREDICTED, RESOLUTION, ROBOT, WALKED

if TYPE_CHECKING:
    from stepwell.robot import Arena, Prediction, Robot
    from stepwell.simulation import Convergence, Maze, Sweep, Walk

_NAMED = {q.name: q for q in WALKED}


def _robot(robot: Robot) -> Card:
    _, mass, weight, most, _ = ROBOT
    legs = ", ".join(leg.name for leg in robot.legs)
    antennas = ", ".join(one.name for one in robot.antennas)
    drive = f"{number(robot.drive.amplitude * 1e3)} mm in {number(robot.drive.period)} s"
    told = facts((mass, weight, most), robot) | {"legs": legs, "driven": drive}
    return Card(
        robot.title or "Robot",
        ["One actuator drives every leg; what it does follows from its springs."],
        told | ({"antennas": antennas} if antennas else {}),
    )


def _prediction(found: Prediction) -> Card:
    named = {q.name: q for q in PREDICTED}
    columns = [named[name] for name in ("name", "gait", "advance", "margin", "nearest")]
    doubt = [leg.name for leg in found.legs if leg.near_boundary]
    turn = f"{math.degrees(found.turn):z.1f}°"
    return Card(
        f"Prediction for {found.robot.title}" if found.robot.title else "Prediction",
        [
            f"{found.motion.value.capitalize()}: d/u_max {found.advance:z.2f} and {turn} to the "
            "left a cycle, said without simulation.",
            f"{found.too_soft[:1].upper()}{found.too_soft[1:]}." if found.too_soft else "",
            f"Too close to call: {', '.join(doubt)}." if doubt else "",
        ],
        {},
        columns,
        [record(columns, leg) for leg in found.legs],
        "legs",
    )


def _walk(walk: Walk) -> Card:
    from stepwell.simulation import Trial

    names = "cycles", "distance", "duration", "cost_of_transport", "stopped"
    mean = facts(MEAN, Trial.of(walk)) if walk.cycles else {}
    return Card(
        f"Walk of {walk.robot.title}" if walk.robot.title else "Walk",
        (),
        facts([_NAMED[name] for name in names], walk) | mean,
        [Column("cycle", lambda row: str(row["cycle"]), True), *CYCLES],
        [{"cycle": k} | row for k, row in enumerate(rows_of(record(CYCLES, walk)), 1)],
        "cycles",
    )


def _maze(maze: Maze) -> Card:
    touched = sum(time is not None for time in maze.touched.values())
    return Card(
        f"{maze.walk.robot.title or 'Robot'} in {maze.arena.title or 'an arena'}",
        [
            f"{str(maze.outcome).capitalize()} after {number(maze.duration)} s, having touched "
            f"{touched} of {len(maze.touched)} obstacles."
        ],
        {},
        CHANGE,
        [record(CHANGE, change) for change in maze.changes],
        "changes of gait",
    )


def _arena(arena: Arena) -> Card:
    count = f"{counted(len(arena.walls), 'wall')} and {counted(len(arena.cylinders), 'cylinder')}"
    return Card(arena.title or "Arena", [f"{count}{', and a goal' * (arena.goal is not None)}."])


def _sweep(sweep: Sweep) -> Card:
    from stepwell.simulation import TRIAL

    keys = list(sweep.values)
    values = zip(*sweep.values.values(), strict=True) if keys else ((),) * len(sweep.trials)
    rows = [
        {"values": row} | record(TRIAL, trial)
        for row, trial in zip(values, sweep.trials, strict=True)
    ]
    varied = [
        Column(key, lambda row, k=k: number(row["values"][k]), True) for k, key in enumerate(keys)
    ]
    failed = sum(bool(trial.stopped) for trial in sweep.trials)
    return Card(
        f"Sweep of {counted(len(sweep.trials), 'robot')}",
        [f"{failed} did not walk to the end." if failed else ""],
        {},
        [*varied, *TRIAL],
        rows,
        "robots",
    )


def _convergence(found: Convergence) -> Card:
    return Card(
        f"{found.robot.title or 'Robot'}, by time step",
        [f"{repr(found).removeprefix('Convergence(').removesuffix(')').capitalize()}."],
        {},
        RESOLUTION,
        [record(RESOLUTION, row) for row in found.rows],
        "time steps",
    )


ROBOTS: dict[str, Callable[[Any], Card]] = {
    "Arena": _arena,
    "Convergence": _convergence,
    "Maze": _maze,
    "Prediction": _prediction,
    "Robot": _robot,
    "Sweep": _sweep,
    "Walk": _walk,
}
