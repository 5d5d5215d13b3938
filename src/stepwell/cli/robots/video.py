"""Writing the video of a run, or saying why there is none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.cli.screen import warn

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk

# Nobody watches longer, and every frame takes its time to draw.
LONGEST = 16.0  # [s]


def film(
    result: Walk | Maze, name: str, progress: Callable[[float, float], None] | None
) -> Callable[[Path], None]:
    """What writes NAME.mp4, if PyAV is here, and NAME.gif; nothing where no frames can be drawn."""

    def write(folder: Path) -> None:
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

    return write
