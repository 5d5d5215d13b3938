"""A way through an arena: its outcome, and what antennas touched and changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from stepwell.accounts.account import (
    Account,
    Fact,
    Level,
    Motion,
    Notes,
    Picture,
    Row,
    Section,
    Table,
)
from stepwell.accounts.assumptions import simulation_assumptions
from stepwell.accounts.head import About
from stepwell.accounts.robot import SOURCES, assumed, parameter_section
from stepwell.accounts.shape import Shape
from stepwell.accounts.walk import WALKED, simulated_in, stopped_early, transport
from stepwell.base import Column, Quantity, Schema, amount, number, read_off
from stepwell.files import digest, dumps

if TYPE_CHECKING:
    from stepwell.robot import Arena, Robot
    from stepwell.simulation import Maze


_ANTENNA: Schema = (
    Quantity("name"),
    Quantity("leg"),
    Quantity("connected", holds=bool),
)
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


def maze_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of a way through an arena."""
    return (
        Quantity("arena_sha256", read=lambda maze: _hash(maze.arena), missing=True),
        Quantity("start_seed", holds=int, missing=True),
        Quantity("layout_seed", holds=int, missing=True),
        *read_off(WALKED, "walk"),
        Quantity("arena", read="arena.title"),
        Quantity("start", "mm", read="arena.start", holds=[float]),
        Quantity("heading", "deg", read="arena.heading"),
        Quantity("end", "mm", holds=[float], missing=True),
        Quantity("outcome"),
        Quantity("limit", "s"),
        Quantity("antennas", read="walk.robot.antennas", holds=[_ANTENNA]),
        Quantity("touched", read=lambda maze: maze.touched.items(), holds=[_TOUCHED]),
        Quantity("contacts", holds=[_CONTACT]),
        Quantity("changes", holds=[_CHANGE]),
    )


def _hash(arena: Arena) -> str | None:
    try:
        return digest(dumps(arena))
    except ValueError:
        return None


def maze_account(maze: Maze, about: About | None = None) -> Account:
    """What is reported of a way through an arena."""
    walk, arena, robot = maze.walk, maze.arena, maze.walk.robot
    about = about or About(robot)
    title = robot.title or "A robot in an arena"
    touched = sum(time is not None for time in maze.touched.values())
    # With its lever off, an antenna moves no anchor.
    legs = {one.name: one.leg for one in robot.antennas if one.connected}
    leg = Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))

    def rows(key: str) -> Callable[[], Sequence[Row]]:
        return lambda: made.record[key]

    made = Account(
        maze,
        kind="maze/1",
        schema=maze_schema(),
        title=title,
        origin=simulated_in(arena),
        answer=f"{maze.outcome} after {amount(maze.duration, 's')}",
        about=about,
        packages=("mujoco",),
        given={name: about.seeds.get(name) for name in ("start_seed", "layout_seed")},
        facts=(
            Fact("Arena", arena.title, Level.TERMINAL),
            Fact("Obstacles touched", f"{touched} of {len(maze.touched)}" * bool(maze.touched)),
            Fact("Antennas", _antennas(robot), Level.TERMINAL),
            Fact("Distance", amount(walk.distance, "m"), Level.TERMINAL),
            Fact("Cycles", str(walk.cycles), Level.TERMINAL),
            Fact("End position", _end(maze), Level.TERMINAL),
            transport(walk, Level.TERMINAL),
            assumed(robot),
        ),
        warnings=(stopped_early(walk),),
        sections=(
            Section("Motion", [Motion(title)]),
            Section(
                "Path",
                [
                    Picture("maze", "Path from above"),
                    Picture("timeline", "Antennas, gaits and obstacles over time"),
                ],
            ),
            Section(
                "Obstacles",
                [Table(_TOUCHED, rows("touched"), "When each was first touched.", most=None)],
            ),
            Section(
                "Antenna contacts",
                [
                    Table(
                        (*_CONTACT, leg), rows("contacts"), "Each contact, and the leg it changes."
                    )
                ],
            ),
            Section(
                "Gait changes",
                [
                    Table(
                        _CHANGE,
                        rows("changes"),
                        "From which cycle on a leg has another gait.",
                        more="changes of gait",
                        level=Level.CARD,
                    )
                ],
            ),
            parameter_section(robot),
            Section("Assumptions", [Notes(simulation_assumptions(walk), Level.PAGE)]),
        ),
        hints=(SOURCES,),
    )
    return made


def _antennas(robot: Robot) -> str:
    off = [one.name for one in robot.antennas if not one.connected]
    count = str(len(robot.antennas) or "none")
    return f"{count}; levers disconnected: {', '.join(off)}" if off else count


def _end(maze: Maze) -> str:
    if maze.end is None:
        return ""
    x, y = (number(one * 1e3) for one in maze.end)
    return f"({x}, {y}) mm"
