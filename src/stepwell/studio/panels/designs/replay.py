"""The motion on the page as one HTML file that can be mailed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stepwell.mechanism import Chain
from stepwell.sequences import Program
from stepwell.studio.panels.motions import program_of
from stepwell.studio.panels.robots import maze_asked, walk_asked
from stepwell.studio.wire import Ask, Design, View

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk

# Where no closed form tells the margins they are searched, and robots are simulated.
LONG = True


def answer(design: Design, ask: Ask) -> View:
    """The file: of a run where `cycles` or `limit_s` are asked for, else of a chain.

    A run is as in panels `walk` and `maze`, which give the same samples. A chain is shown as its
    `turning_points_mm` have it where there are some, else as the design's own program, else in
    its full cycle.
    """
    from stepwell.studio.replay import replay

    title = ask.text("title", 10_000) if ask.has("title") else None
    result = _result(design, ask)
    page = replay(result, title=title, progress=ask.tell)
    return View({"suffix": "html"}, {"file": np.frombuffer(page.encode(), np.uint8)})


def _result(design: Design, ask: Ask) -> Chain | Program | Walk | Maze:
    if ask.has("limit_s"):
        arena, limit = maze_asked(ask)
        robot = design.robot
        from stepwell.simulation import maze

        return maze(robot, arena, limit=limit, progress=ask.tell)
    if ask.has("cycles"):
        place, cycles = walk_asked(ask)
        robot = design.robot
        from stepwell.simulation import walk

        return walk(robot, cycles, arena=place, progress=ask.tell)
    chain, written = design.chain, design.program
    if ask.has("turning_points_mm"):
        result = program_of(chain, ask)
    else:
        result = chain if written is None else written.on(chain)
    ask.close()
    return result
