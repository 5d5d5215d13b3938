"""The samples of a run as the page has them, in its units."""

from __future__ import annotations

from typing import Any

import numpy as np

from stepwell.robot import states
from stepwell.simulation import Walk
from stepwell.studio.panels.robots._scene import Scene

_MM = 1e3


def samples_of(
    walk: Walk, scene: Scene, rows: slice | np.ndarray[Any, Any]
) -> dict[str, np.ndarray[Any, Any]]:
    """Where a robot was, what its actuator and antennas did, and in which states its legs were.

    Args:
        walk: a run.
        scene: of its robot.
        rows: of its samples.
    """
    codes = [
        [-1 if one is None else int(one, 2) for one in states(_shares(walk, k)[rows])]
        for k in range(len(walk.robot.legs))
    ]
    gears = [one.gear if one.connected else 0.0 for one in walk.robot.antennas]
    return {
        "time": walk.time[rows],
        "x": walk.x[rows] * _MM,
        "y": walk.y[rows] * _MM,
        "yaw": np.degrees(walk.yaw[rows]),
        "stroke": walk.stroke[rows] * _MM,
        "antenna": np.degrees(walk.antenna[rows]),
        "moved": walk.antenna[rows] * np.array(gears) * _MM,
        "foot_force": walk.foot_force[rows],
        # A leg's state as a binary number; -1 in transit.
        "state": np.array(codes, np.int32).reshape(len(codes), -1).T,
        **scene.placed(walk.positions[rows]),
    }


def _shares(walk: Walk, leg: int) -> np.ndarray[Any, Any]:
    full = walk.robot.legs[leg].chain.full_travels
    return walk.travel[:, leg, : len(full)] / np.array(full)
