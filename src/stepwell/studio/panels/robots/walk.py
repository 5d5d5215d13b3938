"""A robot that walks, on a bare floor or in an arena, seen while it does."""

from __future__ import annotations

from stepwell.accounts import account
from stepwell.studio.panels.robots._arena import walk_asked
from stepwell.studio.wire import Ask, Design, View

LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The record that `stepwell walk --json` prints, and every sample."""
    arena, cycles = walk_asked(ask)
    robot = design.robot
    from stepwell.simulation import walk
    from stepwell.studio.panels.robots._live import Live

    live = Live(robot, arena, ask)
    found = walk(robot, cycles, arena=arena, progress=ask.tell, look=live.look)
    return live.view(found, record=account(found).record)
