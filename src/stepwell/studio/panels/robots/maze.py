"""A robot on its way through an arena, seen while it goes."""

from __future__ import annotations

from stepwell.accounts import account
from stepwell.studio.panels.robots._arena import maze_asked
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell maze --json` prints, and every sample."""
    arena, limit = maze_asked(ask)
    robot = design.robot
    from stepwell.simulation import maze
    from stepwell.studio.panels.robots._live import Live

    live = Live(robot, arena, ask)
    found = maze(robot, arena, limit=limit, progress=ask.tell, look=live.look)
    return live.view(found.walk, record=account(found).record, outcome=str(found.outcome))
