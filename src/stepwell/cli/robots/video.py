"""Writing the video of a run, or saying why there is none."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.cli.screen import Progress, warn

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk

# Nobody watches longer, and every frame takes its time to draw.
LONGEST = 16.0  # [s]


def with_video(
    write: Callable[..., tuple[str, ...]], result: Walk | Maze, name: str
) -> Callable[..., tuple[str, ...]]:
    """What writes the folder of a run, with NAME.mp4, if PyAV is here, and NAME.gif in it."""

    def written(folder: Path, *, progress: Progress | None, force: bool) -> tuple[str, ...]:
        film = partial(_film, result, name, progress)
        return write(result, folder, film=film, progress=progress, force=force)

    return written


def _film(result: Walk | Maze, name: str, progress: Progress | None, folder: Path) -> None:
    from stepwell import simulation

    walk = result.walk if isinstance(result, simulation.Maze) else result
    if len(walk.time) < 2:
        return
    speed = max(1.0, float(walk.time[-1]) / LONGEST)
    targets = (folder / f"{name}.mp4", folder / f"{name}.gif")
    for some in (targets, targets[1:]):
        try:
            simulation.video(result, *some, speed=speed, progress=progress)
            return
        except ModuleNotFoundError as error:  # an MP4 needs what a GIF does not
            warn(str(error))
        except simulation.VideoError as error:
            # The figures are there, and they need none of it.
            warn(str(error))
            return
