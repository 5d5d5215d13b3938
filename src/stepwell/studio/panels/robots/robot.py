"""A robot that stands at its start: its parts, and where they are."""

from __future__ import annotations

from stepwell.studio.panels.robots._arena import arena_of
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """Parts and lines of the robot, their places, and what its antennas do."""
    arena = arena_of(ask)
    ask.close()
    robot = design.robot
    # Numbers of a robot can be wrong, and said so, where it cannot be simulated.
    from stepwell.studio.panels.robots._scene import Scene

    scene = Scene(robot, arena)
    return View(scene.told(), scene.placed(scene.start))
