"""A robot on its way through an arena, seen while it goes."""

from __future__ import annotations

from stepwell.base import InputError
from stepwell.results import maze_record
from stepwell.studio.panels.robots._arena import arena_of
from stepwell.studio.wire import Ask, Design, View

LONG = True
_LONGEST = 3600.0  # s


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell maze --json` prints, and every sample."""
    arena = arena_of(ask)
    limit = ask.number("limit_s", 1.0, _LONGEST, 600.0)
    ask.close()
    if arena is None:
        raise InputError("ask.arena: is missing; a maze needs one, if only the open floor.")
    robot = design.robot
    from stepwell.simulation import maze
    from stepwell.studio.panels.robots._live import Live

    live = Live(robot, arena, ask)
    found = maze(robot, arena, limit=limit, progress=ask.tell, look=live.look)
    return live.view(found.walk, record=maze_record(found), outcome=str(found.outcome))
