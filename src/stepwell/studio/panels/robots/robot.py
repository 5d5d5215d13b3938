"""A robot that stands at its start: its parts, and where they are."""

from __future__ import annotations

import math

from stepwell.studio.panels.robots._arena import arena_of
from stepwell.studio.wire import Ask, Design, View


def answer(design: Design, ask: Ask) -> View:
    """Parts and lines of the robot, their places, and what its antennas do."""
    arena = arena_of(ask)
    ask.close()
    robot = design.robot
    # Numbers of a robot can be wrong, and said so, where it cannot be simulated.
    from stepwell.studio.panels.robots._scene import WALL_MM, Scene

    scene = Scene(robot, arena)
    return View(
        {
            "parts": scene.parts(),
            "lines": scene.lines(),
            "wall_mm": WALL_MM,
            "legs": [{"name": leg.name, "cells": list(leg.chain.names)} for leg in robot.legs],
            "antennas": [
                {
                    "name": one.name,
                    "side": one.side,
                    "swing_deg": math.degrees(one.swing),
                    "most_mm": math.hypot(*one.moves) * 1e3 if one.connected else 0.0,
                }
                for one in robot.antennas
            ],
            "period_s": robot.drive.period,
        },
        scene.placed(scene.start),
    )
