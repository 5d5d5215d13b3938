"""Simulated walks on a bare floor and in an arena: gaits, progress, contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from stepwell.accounts.head import About
from stepwell.accounts.parts import (
    Account,
    Fact,
    Level,
    Notes,
    Picture,
    RecordTable,
    Replay,
    Row,
    Section,
    Warned,
)
from stepwell.accounts.robot import (
    FEET,
    PARAMETERS,
    SOURCES,
    assumed,
    depth_words,
    parameter_section,
    turn_words,
)
from stepwell.accounts.words import simulation_assumptions
from stepwell.base import (
    Column,
    Quantity,
    Schema,
    amount,
    counted,
    number,
    quantities,
    read_off,
    record,
    rows_of,
    to_unit,
)
from stepwell.files import digest, dumps

if TYPE_CHECKING:
    from stepwell.robot import Arena, Robot
    from stepwell.simulation import Maze, Trial, Walk


_SETTINGS: Schema = (
    *quantities(time_step="ms", contact_time="ms"),
    Quantity("integrator", read=lambda settings: str(settings.integrator)),
    Quantity("linkage", read=lambda settings: str(settings.linkage)),
)
# Of every run, on a bare floor and among obstacles.
WALKED: Schema = (
    Quantity("title", read="robot.title"),
    Quantity("cycles", holds=int),
    Quantity("period", "s", read="robot.drive.period"),
    *quantities(duration="s", distance="mm", work="mJ"),
    Quantity("weight", "N", read="robot.weight"),
    *quantities(cost_of_transport=float, stopped=str),
    Quantity("simulation", holds=_SETTINGS, read="settings"),
    *read_off((PARAMETERS,), "robot"),
)
_CYCLES: Schema = (
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f", holds=[float]),
    Quantity("sideways", "over_u_max", "to the left", form="z.3f", holds=[float]),
    Quantity("turn", "deg", "turn to the left", form="z.1f", holds=[float]),
)
_LEG: Schema = (
    Quantity("name", head="leg"),
    *quantities(gaits=[str], predicted_gait=str | None, slip="mm"),
    FEET,
)


def _legs(walk: Walk) -> Sequence[Row]:
    return rows_of(
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


def walk_account(walk: Walk, about: About) -> Account:
    """What is reported of a walk."""
    robot, mean = walk.robot, _mean(walk)
    title = robot.title or "A walk"
    cycles = f"{counted(walk.cycles, 'cycle')} of {amount(robot.drive.period, 's')}"
    after = " after the first" if walk.cycles > 1 else ""
    return Account(
        walk,
        kind="walk/1",
        schema=WALK,
        title=title,
        origin="Simulated on a flat floor." if walk.arena is None else simulated_in(walk.arena),
        answer=f"Walked {amount(walk.distance, 'm')} in {cycles}",
        packages=("mujoco",),
        facts=(
            Fact("Duration", amount(walk.duration, "s")),
            Fact("Advance per cycle", f"d/u_max {mean.advance:z.3f}{after}" * bool(walk.cycles)),
            Fact("Turn per cycle", f"{turn_words(mean.turn)}{after}" * bool(walk.cycles)),
            Fact("u_max", amount(robot.u_max, "m"), Level.TERMINAL),
            Fact("Work per cycle", amount(mean.work, "J") * bool(walk.cycles), Level.TERMINAL),
            transport(walk),
            Fact("Comparison with statics", lambda: walk.comparison.text, Level.TERMINAL),
            Fact("Foot depth", lambda: depth_words(robot, walk.comparison.depths), Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            Section("Motion", Replay(title)),
            Section(
                "Path, gait and contacts",
                Picture("trajectory", "Path from above, and advance and turn of each cycle"),
                Picture("gait", "Travels and states of the cells of every leg"),
                Picture("contacts", "Contacts, actuator force and work"),
            ),
            Section(
                "Gaits",
                RecordTable(
                    (_LEG[0], *_GAITS),
                    "legs",
                    "The states of the cells in a cycle, and how far the foot slips.",
                    most=None,
                    more="gaits",
                    pick=_gaits,
                ),
            ),
            Section(
                "Cycles",
                RecordTable(
                    (_CYCLE, *_CYCLES),
                    lambda: _cycles(walk),
                    "d/u_max is the advance over the largest step of the legs.",
                    more="cycles",
                    level=Level.CARD,
                ),
            ),
            parameter_section(robot),
            Section("Assumptions", Notes(simulation_assumptions(walk), Level.PAGE)),
        ),
        hints=(SOURCES,),
    )


def simulated_in(arena: Arena) -> str:
    """The arena of a run, in a sentence."""
    return f"Simulated in the arena: {arena.title or 'without a name'}."


def transport(walk: Walk, level: Level = Level.CARD) -> Fact:
    """The cost of transport; none of a robot that got nowhere."""
    cost = walk.cost_of_transport
    known = f"{number(cost, 3)} (work over weight and distance)" if math.isfinite(cost) else ""
    return Fact("Cost of transport", known, level)


def stopped_early(walk: Walk) -> Warned:
    """The warning of a run that did not go on to its end."""
    stopped = [walk.stopped] if walk.stopped else []
    return Warned("Stopped early", "The simulation ended before its time.", stopped)


_CYCLE = Column("cycle", lambda row: str(row["cycle"]), True)
_GAITS = (
    Quantity("cycles", head="cycles"),
    Quantity("states", head="states"),
    Quantity("slip", "mm", "slip per cycle", form=3),
)


def _cycles(walk: Walk) -> list[Row]:
    rows = rows_of(record(_CYCLES, walk))
    return [{"cycle": k, **row} for k, row in enumerate(rows, 1)]


def _gaits(legs: Sequence[Row]) -> list[Row]:
    """Equal gaits that follow each other in one row: their cycles from 1, and the gait."""
    found: list[Row] = []
    for leg in legs:
        first = 1
        for gait, same in groupby(leg["gaits"]):
            last = first + len(list(same)) - 1
            cycles = f"{first}" if first == last else f"{first} to {last}"
            found.append({**leg, "cycles": cycles, "states": gait or "none"})
            first = last + 1
    return found


_ANTENNA: Schema = quantities(name=str, leg=str, connected=bool)
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
        return digest(dumps(arena))
    except ValueError:
        return None


# What is reported of a way through an arena.
MAZE: Schema = (
    Quantity("arena_sha256", read=lambda maze: _hash(maze.arena), missing=True),
    *quantities(start_seed=int | None, layout_seed=int | None),
    *read_off(WALKED, "walk"),
    Quantity("arena", read="arena.title"),
    Quantity("start", "mm", read="arena.start", holds=[float]),
    Quantity("heading", "deg", read="arena.heading"),
    Quantity("end", "mm", holds=[float], missing=True),
    *quantities(outcome=str, limit="s"),
    Quantity("antennas", read="walk.robot.antennas", holds=[_ANTENNA]),
    Quantity("touched", read=lambda maze: maze.touched.items(), holds=[_TOUCHED]),
    *quantities(contacts=[_CONTACT], changes=[_CHANGE]),
)


def maze_account(maze: Maze, about: About) -> Account:
    """What is reported of a way through an arena."""
    walk, arena, robot = maze.walk, maze.arena, maze.walk.robot
    title = robot.title or "A robot in an arena"
    touched = sum(time is not None for time in maze.touched.values())
    # With its lever off, an antenna moves no anchor.
    legs = {one.name: one.leg for one in robot.antennas if one.connected}
    leg = Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))

    return Account(
        maze,
        kind="maze/1",
        schema=MAZE,
        title=title,
        origin=simulated_in(arena),
        answer=f"{maze.outcome} after {amount(maze.duration, 's')}",
        packages=("mujoco",),
        given={name: about.seeds.get(name) for name in ("start_seed", "layout_seed")},
        facts=(
            Fact("Arena", arena.title, Level.TERMINAL),
            Fact("Obstacles touched", f"{touched} of {len(maze.touched)}" * bool(maze.touched)),
            Fact("Antennas", _antennas(robot), Level.TERMINAL),
            Fact("Distance", amount(walk.distance, "m"), Level.TERMINAL),
            Fact("Cycles", str(walk.cycles), Level.TERMINAL),
            Fact("End position", _end_words(maze), Level.TERMINAL),
            transport(walk, Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            Section("Motion", Replay(title)),
            Section(
                "Path",
                Picture("maze", "Path from above"),
                Picture("timeline", "Antennas, gaits and obstacles over time"),
            ),
            Section(
                "Obstacles",
                RecordTable(_TOUCHED, "touched", "When each was first touched.", most=None),
            ),
            Section(
                "Antenna contacts",
                RecordTable((*_CONTACT, leg), "contacts", "Each contact, and the leg it changes."),
            ),
            Section(
                "Gait changes",
                RecordTable(
                    _CHANGE,
                    "changes",
                    "From which cycle on a leg has another gait.",
                    more="changes of gait",
                    level=Level.CARD,
                ),
            ),
            parameter_section(robot),
            Section("Assumptions", Notes(simulation_assumptions(walk), Level.PAGE)),
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
    x, y = (number(to_unit(one, "mm")) for one in maze.end)
    return f"({x}, {y}) mm"
