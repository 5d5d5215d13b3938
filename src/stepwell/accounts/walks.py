"""Simulated walks on a bare floor and in an arena: gaits, progress, contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from stepwell import base, files
from stepwell.accounts import parts, words
from stepwell.accounts.head import About
from stepwell.accounts.robot import (
    FEET,
    PARAMETERS,
    SOURCES,
    assumed,
    depth_words,
    parameter_section,
    turn_words,
)
from stepwell.base import Quantity, Schema

if TYPE_CHECKING:
    from stepwell.robot import Arena, Robot
    from stepwell.simulation import Maze, Trial, Walk


_SETTINGS: Schema = (
    *base.quantities(time_step="ms", contact_time="ms"),
    Quantity("integrator", read=lambda settings: str(settings.integrator)),
    Quantity("linkage", read=lambda settings: str(settings.linkage)),
)
# Of every run, on a bare floor and among obstacles.
WALKED: Schema = (
    Quantity("title", read="robot.title"),
    Quantity("cycles", holds=int),
    Quantity("period", "s", read="robot.drive.period"),
    *base.quantities(duration="s", distance="mm", work="mJ"),
    Quantity("weight", "N", read="robot.weight"),
    *base.quantities(cost_of_transport=float, stopped=str),
    Quantity("simulation", holds=_SETTINGS, read="settings"),
    *base.read_off((PARAMETERS,), "robot"),
)
_CYCLES: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f", holds=[float]),
    Quantity("sideways", "over_u_max", "to the left", form="z.3f", holds=[float]),
    Quantity("turn", "deg", "turn to the left", form="z.1f", holds=[float]),
)
_LEG: Schema = (
    Quantity("name", head="leg"),
    *base.quantities(gaits=[str], predicted_gait=str | None, slip="mm"),
    FEET,
)


def _legs(walk: Walk) -> Sequence[parts.Row]:
    return base.rows_of(
        {
            "name": walk.gaits,
            "gaits": walk.gaits.values(),
            "predicted_gait": walk.comparison.predicted or [None] * len(walk.gaits),
            "slip": walk.slip,
            "feet": walk.comparison.depths,
        }
    )


def _mean(walk: Walk) -> Trial:
    from stepwell.simulation import Trial

    return Trial.of(walk)


# What is reported of a walk.
WALK: Schema = (
    *WALKED,
    Quantity("mean_advance", "over_u_max", read=lambda walk: _mean(walk).advance),
    Quantity("mean_turn", "deg", read=lambda walk: _mean(walk).turn),
    Quantity("work_per_cycle", "mJ", read=lambda walk: _mean(walk).work),
    Quantity("u_max", "mm", read="robot.u_max"),
    *_CYCLES,
    Quantity("foot", "mm", read="robot.foot.below"),
    Quantity("as_predicted", read="comparison.same", holds=bool, missing=True),
    Quantity("comparison", read="comparison.text"),
    Quantity("legs", holds=[_LEG], read=_legs),
)


def walk_account(walk: Walk, about: About) -> parts.Account:
    """What is reported of a walk."""
    robot, mean = walk.robot, _mean(walk)
    title = robot.title or "A walk"
    cycles = f"{base.counted(walk.cycles, 'cycle')} of {base.amount(robot.drive.period, 's')}"
    after = " after the first" if walk.cycles > 1 else ""
    return parts.Account(
        walk,
        kind="walk/1",
        schema=WALK,
        title=title,
        origin="Simulated on a flat floor." if walk.arena is None else simulated_in(walk.arena),
        answer=f"Walked {base.amount(walk.distance, 'm')} in {cycles}",
        packages=("mujoco",),
        facts=(
            parts.Fact("Duration", base.amount(walk.duration, "s")),
            parts.Fact(
                "Advance per cycle", f"d/u_max {mean.advance:z.3f}{after}" * bool(walk.cycles)
            ),
            parts.Fact("Turn per cycle", f"{turn_words(mean.turn)}{after}" * bool(walk.cycles)),
            parts.Fact("u_max", base.amount(robot.u_max, "m"), parts.Level.TERMINAL),
            parts.Fact(
                "Work per cycle",
                base.amount(mean.work, "J") * bool(walk.cycles),
                parts.Level.TERMINAL,
            ),
            transport(walk),
            parts.Fact(
                "Comparison with statics", lambda: walk.comparison.text, parts.Level.TERMINAL
            ),
            parts.Fact(
                "Foot depth",
                lambda: depth_words(robot, walk.comparison.depths),
                parts.Level.TERMINAL,
            ),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            parts.Section("Motion", parts.Replay(title)),
            parts.Section(
                "Path, gait and contacts",
                parts.Picture("trajectory", "Path from above, and advance and turn of each cycle"),
                parts.Picture("gait", "Travels and states of the cells of every leg"),
                parts.Picture("contacts", "Contacts, actuator force and work"),
            ),
            parts.Section(
                "Gaits",
                parts.RecordTable(
                    (_LEG[0], *_GAITS),
                    "legs",
                    "The states of the cells in a cycle, and how far the foot slips.",
                    most=None,
                    more="gaits",
                    pick=_gaits,
                ),
            ),
            parts.Section(
                "Cycles",
                parts.RecordTable(
                    (_CYCLE, *_CYCLES),
                    lambda: _cycles(walk),
                    "d/u_max is the advance over the largest step of the legs.",
                    more="cycles",
                    level=parts.Level.CARD,
                ),
            ),
            parameter_section(robot),
            parts.Section(
                "Assumptions", parts.Notes(words.simulation_assumptions(walk), parts.Level.PAGE)
            ),
        ),
        hints=(SOURCES,),
    )


def simulated_in(arena: Arena) -> str:
    """The arena of a run, in a sentence."""
    return f"Simulated in the arena: {arena.title or 'without a name'}."


def transport(walk: Walk, level: parts.Level = parts.Level.CARD) -> parts.Fact:
    """The cost of transport; none of a robot that got nowhere."""
    cost = walk.cost_of_transport
    known = f"{base.number(cost, 3)} (work over weight and distance)" if math.isfinite(cost) else ""
    return parts.Fact("Cost of transport", known, level)


def stopped_early(walk: Walk) -> parts.Warned:
    """The warning of a run that did not go on to its end."""
    stopped = [walk.stopped] if walk.stopped else []
    return parts.Warned("Stopped early", "The simulation ended before its time.", stopped)


_CYCLE = base.Column("cycle", lambda row: str(row["cycle"]), True)
_GAITS = (
    Quantity("cycles", head="cycles"),
    Quantity("states", head="states"),
    Quantity("slip", "mm", "slip per cycle", form=3),
)


def _cycles(walk: Walk) -> list[parts.Row]:
    rows = base.rows_of(base.record(_CYCLES, walk))
    return [{"cycle": k, **row} for k, row in enumerate(rows, 1)]


def _gaits(legs: Sequence[parts.Row]) -> list[parts.Row]:
    """Equal gaits that follow each other in one row: their cycles from 1, and the gait."""
    found: list[parts.Row] = []
    for leg in legs:
        first = 1
        for gait, same in groupby(leg["gaits"]):
            last = first + len(list(same)) - 1
            cycles = f"{first}" if first == last else f"{first} to {last}"
            found.append({**leg, "cycles": cycles, "states": gait or "none"})
            first = last + 1
    return found


_ANTENNA: Schema = base.quantities(name=str, leg=str, connected=bool)
_TOUCHED: Schema = (
    Quantity("obstacle", head="obstacle", read=lambda touch: touch[0]),
    Quantity("time", "s", "first touched", read=lambda touch: touch[1], none="never"),
)
_CONTACT: Schema = (
    Quantity("antenna", head="antenna"),
    Quantity("begin", "s", "from"),
    Quantity("end", "s", "to"),
    Quantity("swing", "deg", "swing", form=3),
    Quantity("moved", "mm", "anchor moved", form=3),
)
_CHANGE: Schema = (
    Quantity("time", "s", "from"),
    Quantity("leg", head="leg"),
    Quantity("before", head="before", form=lambda gait: gait or "none"),
    Quantity("after", head="after", form=lambda gait: gait or "none"),
)


def _hash(arena: Arena) -> str | None:
    try:
        return files.digest(files.dumps(arena))
    except ValueError:
        return None


# What is reported of a way through an arena.
MAZE: Schema = (
    Quantity("arena_sha256", read=lambda maze: _hash(maze.arena), missing=True),
    *base.quantities(start_seed=int | None, layout_seed=int | None),
    *base.read_off(WALKED, "walk"),
    Quantity("arena", read="arena.title"),
    Quantity("start", "mm", read="arena.start", holds=[float]),
    Quantity("heading", "deg", read="arena.heading"),
    Quantity("end", "mm", holds=[float], missing=True),
    *base.quantities(outcome=str, limit="s"),
    Quantity("antennas", read="walk.robot.antennas", holds=[_ANTENNA]),
    Quantity("touched", read=lambda maze: maze.touched.items(), holds=[_TOUCHED]),
    *base.quantities(contacts=[_CONTACT], changes=[_CHANGE]),
)


def maze_account(maze: Maze, about: About) -> parts.Account:
    """What is reported of a way through an arena."""
    walk, arena, robot = maze.walk, maze.arena, maze.walk.robot
    title = robot.title or "A robot in an arena"
    touched = sum(time is not None for time in maze.touched.values())
    # With its lever off, an antenna moves no anchor.
    legs = {one.name: one.leg for one in robot.antennas if one.connected}
    leg = base.Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))

    return parts.Account(
        maze,
        kind="maze/1",
        schema=MAZE,
        title=title,
        origin=simulated_in(arena),
        answer=f"{maze.outcome} after {base.amount(maze.duration, 's')}",
        packages=("mujoco",),
        given={name: about.seeds.get(name) for name in ("start_seed", "layout_seed")},
        facts=(
            parts.Fact("Arena", arena.title, parts.Level.TERMINAL),
            parts.Fact(
                "Obstacles touched", f"{touched} of {len(maze.touched)}" * bool(maze.touched)
            ),
            parts.Fact("Antennas", _antennas(robot), parts.Level.TERMINAL),
            parts.Fact("Distance", base.amount(walk.distance, "m"), parts.Level.TERMINAL),
            parts.Fact("Cycles", str(walk.cycles), parts.Level.TERMINAL),
            parts.Fact("End position", _end_words(maze), parts.Level.TERMINAL),
            transport(walk, parts.Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            parts.Section("Motion", parts.Replay(title)),
            parts.Section(
                "Path",
                parts.Picture("maze", "Path from above"),
                parts.Picture("timeline", "Antennas, gaits and obstacles over time"),
            ),
            parts.Section(
                "Obstacles",
                parts.RecordTable(_TOUCHED, "touched", "When each was first touched.", most=None),
            ),
            parts.Section(
                "Antenna contacts",
                parts.RecordTable(
                    (*_CONTACT, leg), "contacts", "Each contact, and the leg it changes."
                ),
            ),
            parts.Section(
                "Gait changes",
                parts.RecordTable(
                    _CHANGE,
                    "changes",
                    "From which cycle on a leg has another gait.",
                    more="changes of gait",
                    level=parts.Level.CARD,
                ),
            ),
            parameter_section(robot),
            parts.Section(
                "Assumptions", parts.Notes(words.simulation_assumptions(walk), parts.Level.PAGE)
            ),
        ),
        hints=(SOURCES,),
    )


def _antennas(robot: Robot) -> str:
    off = [one.name for one in robot.antennas if not one.connected]
    count = str(len(robot.antennas) or "none")
    return f"{count}; levers disconnected: {', '.join(off)}" if off else count


def _end_words(maze: Maze) -> str:
    if maze.end is None:
        return ""
    x, y = (base.number(base.to_unit(one, "mm")) for one in maze.end)
    return f"({x}, {y}) mm"
