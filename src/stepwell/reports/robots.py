"""What folders of robots have: predicted, walked, in an arena, and many of them."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stepwell.accounts import Account
from stepwell.base import write_netcdf
from stepwell.files import dumps
from stepwell.reports.write import Contents, Draw, Progress, design_text
from stepwell.studio.replay import replay

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.simulation import Maze, Sweep, Walk

# A video of a longer walk is faster than the robot [s].
_LONGEST_VIDEO = 16.0
Warn = Callable[[str], object]


def contents(account: Account, *, video: bool = False, warn: Warn = warnings.warn) -> Contents:
    """What the folder of a result has besides its page.

    Args:
        account: of the result.
        video: of a simulation: whether to add it as .mp4, where PyAV is installed, and .gif.
        warn: called with the reason where a video cannot be made.
    """
    made = _CONTENTS[type(account.value).__name__](account)
    if not video:
        return made
    return replace(made, film=partial(_film, account.value, made.command, warn))


def _prediction(account: Account) -> Contents:
    found = account.value
    return Contents(
        "robot show",
        "robot.json",
        {"robot.toml": design_text(account)},
        {"robot": _draw("robot_drawing", found.robot), "prediction": _draw("prediction", found)},
    )


def _walk(account: Account) -> Contents:
    walk: Walk = account.value
    figures = ("trajectory", "gait", "contacts") if len(walk.time) else ()
    return Contents(
        "walk",
        "walk.json",
        {"robot.toml": design_text(account), "walk.nc": walk.to_netcdf},
        {name: _draw(name, walk) for name in figures},
        motion=partial(replay, walk),
    )


def _maze(account: Account) -> Contents:
    maze: Maze = account.value
    figures = {"maze": "maze", "timeline": "maze_timeline"} if len(maze.walk.time) else {}
    return Contents(
        "maze",
        "maze.json",
        {
            "robot.toml": design_text(account),
            "arena.toml": dumps(maze.arena),
            "walk.nc": maze.walk.to_netcdf,
        },
        {name: _draw(figure, maze) for name, figure in figures.items()},
        motion=partial(replay, maze),
    )


def _sweep(account: Account) -> Contents:
    sweep: Sweep = account.value
    return Contents(
        "robot sweep",
        "sweep.json",
        {"sweep.csv": sweep.to_csv, "sweep.nc": lambda file: write_netcdf(file, sweep.to_xarray())},
        {"sweep": _draw("sweep", sweep)},
    )


_CONTENTS: dict[str, Callable[[Account], Contents]] = {
    "Maze": _maze,
    "Prediction": _prediction,
    "Sweep": _sweep,
    "Walk": _walk,
}


def _draw(name: str, value: Any) -> Draw:
    """What draws a figure; without Matplotlib it is not called."""

    def draw(**options: Any) -> Figure:
        from stepwell import figures

        return getattr(figures, name)(value, **options)

    return draw


def _film(
    result: Walk | Maze, name: str, warn: Warn, folder: Path, progress: Progress | None
) -> None:
    from stepwell import simulation

    walk = result.walk if isinstance(result, simulation.Maze) else result
    if len(walk.time) < 2:
        return
    speed = max(1.0, float(walk.time[-1]) / _LONGEST_VIDEO)
    targets = (folder / f"{name}.mp4", folder / f"{name}.gif")
    for some in (targets, targets[1:]):
        try:
            simulation.video(result, *some, speed=speed, progress=progress)
            return
        except ModuleNotFoundError as error:  # an MP4 needs what a GIF does not
            warn(str(error))
        except simulation.VideoError as error:
            # All other files of the folder can be written without it.
            warn(str(error))
            return
