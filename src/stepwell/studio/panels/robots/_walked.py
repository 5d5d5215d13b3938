"""A whole run of a robot, small enough for a page that is mailed."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.accounts import account, simulation_assumptions
from stepwell.base import InputError, __version__
from stepwell.files import arena_tables
from stepwell.studio.wire import View

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk

# What a number is rounded to, in its unit; poses are looked at and not read.
_STEPS = {"time": 1e-4, "place": 0.05, "turn": 1e-4, "state": 1.0}
_STEP = 1e-3
# Compressed, a page of so much stays below a megabyte; a browser holds so many samples with ease.
_MOST_BYTES, _MOST_SAMPLES = 600_000, 30_000


def walked(result: Walk | Maze) -> View:
    """All that is to be seen of a run, from the start of its first cycle on.

    Every block holds, of each of its columns in turn, the differences from the sample before in
    whole `steps`: those of a gait come again and again, and compress to a hundredth.

    Args:
        result: a walk, or a way through an arena.

    Raises:
        ValueError: a run that was over before its first sample.
    """
    # Without MuJoCo there is none of these modules.
    from stepwell.simulation import Maze
    from stepwell.studio.panels.robots._samples import samples_of
    from stepwell.studio.panels.robots._scene import Scene

    walk = result.walk if isinstance(result, Maze) else result
    if not len(walk.time):
        raise InputError(f"the walk has no samples. {walk.stopped}")
    scene = Scene(walk.robot, walk.arena)
    settled = min(int(np.searchsorted(walk.time, 0.0)), len(walk.time) - 1)
    every = 1 + (len(walk.time) - settled) // _MOST_SAMPLES
    blocks = samples_of(walk, scene, slice(settled, None, every))
    # Obstacles end what comes again; then fewer samples have to do.
    while _size(told := _differences(blocks)) > _MOST_BYTES and len(blocks["time"]) > 2:
        blocks = {name: block[::2] for name, block in blocks.items()}
    is_maze = isinstance(result, Maze)
    header = {
        **scene.told(),
        "title": walk.robot.title,
        "version": __version__,
        "arena": None if walk.arena is None else arena_tables(walk.arena),
        "steps": {name: _STEPS.get(name, _STEP) for name in told},
        "record": account(result).record,
        "outcome": str(result.outcome) if is_maze else "",
        "assumptions": simulation_assumptions(walk),
    }
    return View(header, told)


def _differences(blocks: dict[str, np.ndarray[Any, Any]]) -> dict[str, np.ndarray[Any, Any]]:
    found: dict[str, np.ndarray[Any, Any]] = {}
    for name, block in blocks.items():
        columns = block.reshape(len(block), -1).T
        whole = np.round(columns / _STEPS.get(name, _STEP)).astype(np.int32)
        found[name] = np.diff(whole, axis=1, prepend=np.int32(0))
    return found


def _size(blocks: dict[str, np.ndarray[Any, Any]]) -> int:
    return sum(len(zlib.compress(block.tobytes(), 9)) for block in blocks.values())
