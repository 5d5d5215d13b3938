"""A run that is seen while it goes on: each time only what is new of it."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any

import numpy as np

from stepwell.robot import Arena, Robot
from stepwell.robot.gait import states
from stepwell.simulation import Walk
from stepwell.studio.panels.robots._scene import Scene
from stepwell.studio.wire import Ask, View

# So often what is new is sent [s].
_EVERY = 0.2
_MM = 1e3


class Live:
    """Sends the samples of a run as they come.

    Args:
        robot, arena: of the run.
        ask: of the page, which is shown them.
    """

    def __init__(self, robot: Robot, arena: Arena | None, ask: Ask):
        self._scene, self._ask = Scene(robot, arena), ask
        self._sent, self._last = 0, monotonic()

    def look(self, so_far: Callable[[], Walk]) -> None:
        """Send what is new, not too often."""
        if monotonic() - self._last >= _EVERY:
            self._ask.show(self.view(so_far()))
            self._last = monotonic()

    def view(self, walk: Walk, **told: Any) -> View:
        """The samples that were not sent yet.

        Args:
            walk: so far.
            told: what else the page is told.
        """
        new = slice(self._sent, None)
        header = {"first": self._sent, **told}
        self._sent = len(walk.time)
        shares = [_shares(walk, k)[new] for k in range(len(walk.robot.legs))]
        gears = [one.gear if one.connected else 0.0 for one in walk.robot.antennas]
        codes = [[-1 if one is None else int(one, 2) for one in states(share)] for share in shares]
        return View(
            header,
            {
                "time": walk.time[new],
                "x": walk.x[new] * _MM,
                "y": walk.y[new] * _MM,
                "yaw": np.degrees(walk.yaw[new]),
                "stroke": walk.stroke[new] * _MM,
                "antenna": np.degrees(walk.antenna[new]),
                "moved": walk.antenna[new] * np.array(gears) * _MM,
                "foot_force": walk.foot_force[new],
                # A leg's state as a binary number; -1 in transit.
                "state": np.array(codes, np.int32).reshape(len(shares), -1).T,
                **self._scene.placed(walk.positions[new]),
            },
        )


def _shares(walk: Walk, leg: int) -> np.ndarray[Any, Any]:
    full = walk.robot.legs[leg].chain.full_travels
    return walk.travel[:, leg, : len(full)] / np.array(full)
