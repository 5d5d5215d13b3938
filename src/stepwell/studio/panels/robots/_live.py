"""A run that is seen while it goes on: each time only what is new of it."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any

from stepwell.robot import Arena, Robot
from stepwell.simulation import Walk
from stepwell.studio.panels.robots._samples import samples_of
from stepwell.studio.panels.robots._scene import Scene
from stepwell.studio.wire import Ask, View

# So often what is new is sent [s].
_EVERY = 0.2


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
        return View(header, samples_of(walk, self._scene, new))
