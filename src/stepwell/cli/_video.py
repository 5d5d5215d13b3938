"""Writing the video of a run, or saying why there is none."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from stepwell.physics import Maze, Walk

# Nobody watches longer, and every frame takes its time to draw.
LONGEST = 16.0  # [s]


def write_video(result: Walk | Maze, folder: Path, name: str) -> tuple[str, ...]:
    """Write NAME.mp4 and NAME.gif into a folder; nothing where no frames can be drawn.

    Returns:
        The names of the files.
    """
    from stepwell import physics
    from stepwell.cli._progress import progress

    walk = result.walk if isinstance(result, physics.Maze) else result
    if len(walk.time) < 2:
        return ()
    speed = max(1.0, float(walk.time[-1]) / LONGEST)
    try:
        with progress("video") as tell:
            targets = (folder / f"{name}.mp4", folder / f"{name}.gif")
            files = physics.video(result, *targets, speed=speed, progress=tell)
    except (physics.VideoError, ModuleNotFoundError) as error:
        # The figures are there, and they need none of it.
        typer.echo(str(error), err=True)
        return ()
    return tuple(file.name for file in files)
