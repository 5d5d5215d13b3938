"""A robot at its pace, in few poses."""

from __future__ import annotations

import numpy as np

from stepwell.robot import Robot
from stepwell.studio.wire import View

# A robot has many parts; it is at its pace in its second cycle.
_POSES, _CYCLES = 30, 2.0


def walking(robot: Robot) -> View:
    """Parts, lines and poses of the second cycle of a walk.

    Raises:
        ExtraError: MuJoCo is not installed.
    """
    # Without MuJoCo there is none of these modules.
    from stepwell.simulation import walk
    from stepwell.studio.panels.robots._scene import Scene

    scene, found = Scene(robot), walk(robot, _CYCLES)
    last = np.flatnonzero(found.time >= found.time[-1] - robot.drive.period)
    rows = last[np.linspace(0, len(last) - 1, _POSES).astype(int)]
    header = {"parts": scene.parts(), "lines": scene.lines()}
    return View(header, scene.placed(found.positions[rows]))
