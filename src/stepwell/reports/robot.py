"""Everything about what a robot did in one folder: figures, samples, numbers, its design."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from stepwell.base import write_atomic
from stepwell.files import dumps, staged_folder
from stepwell.reports.steps import Progress, Steps, names, save_figures, write_json, write_netcdf
from stepwell.results import maze_record, robot_record, sweep_record, walk_record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.robot import Prediction, Robot
    from stepwell.simulation import Maze, Sweep, Walk


def write_robot(
    robot: Robot,
    prediction: Prediction,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a robot is into a folder, all of it or nothing.

    Args:
        robot: any robot.
        prediction: of it.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of its design file, to keep beside the results; written anew by default.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: robot.toml, robot.json, and robot and prediction as .png and
        .svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn = {
        "robot": figures.robot_drawing(robot),
        "prediction": figures.prediction(prediction),
    }
    text = design or dumps(robot)
    record = robot_record(robot, prediction, design=text)
    with staged_folder(folder, "robot show", record, force=force) as draft:
        steps = Steps(progress, 2 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", text)
        steps.next()
        write_json(draft / "robot.json", record)
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_walk(
    walk: Walk,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    film: Callable[[Path], None] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a robot did into a folder, all of it or nothing.

    Args:
        walk: any walk, one that ended early too.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the robot's design file; written anew by default.
        film: called with the draft folder, to add a video to it.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: robot.toml, walk.json, walk.nc, and gait, trajectory and
        contacts as .png and .svg, and what `film` adds.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: dict[str, Figure] = {}
    if len(walk.time):
        drawn = {
            "trajectory": figures.trajectory(walk),
            "gait": figures.gait(walk),
            "contacts": figures.contacts(walk),
        }
    text = design or dumps(walk.robot)
    record = walk_record(walk, design=text)
    with staged_folder(folder, "walk", record, force=force) as draft:
        steps = Steps(progress, 3 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", text)
        steps.next()
        write_json(draft / "walk.json", record)
        steps.next()
        walk.to_netcdf(draft / "walk.nc")
        steps.next()
        save_figures(drawn, draft, steps)
        if film is not None:
            film(draft)
        return names(draft)


def write_maze(
    maze: Maze,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    start_seed: int | None = None,
    layout_seed: int | None = None,
    film: Callable[[Path], None] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a robot's way through an arena into a folder, all of it or nothing.

    Args:
        maze: a way through any arena.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the robot's design file; written anew by default.
        start_seed, layout_seed: from which start and obstacles were drawn, if they were.
        film: called with the draft folder, to add a video to it.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: robot.toml, arena.toml, maze.json, walk.nc, and maze and
        timeline as .png and .svg, and what `film` adds.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: dict[str, Figure] = {}
    if len(maze.walk.time):
        drawn = {"maze": figures.maze(maze), "timeline": figures.maze_timeline(maze)}
    text = design or dumps(maze.walk.robot)
    record = maze_record(maze, design=text, start_seed=start_seed, layout_seed=layout_seed)
    with staged_folder(folder, "maze", record, force=force) as draft:
        steps = Steps(progress, 4 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", text)
        steps.next()
        write_atomic(draft / "arena.toml", dumps(maze.arena))
        steps.next()
        write_json(draft / "maze.json", record)
        steps.next()
        maze.walk.to_netcdf(draft / "walk.nc")
        steps.next()
        save_figures(drawn, draft, steps)
        if film is not None:
            film(draft)
        return names(draft)


def write_sweep(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what many robots did into a folder, all of it or nothing.

    Args:
        sweep: any.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the design file that was varied, for the hash of it.
        seed: from which the values were drawn, if they were.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: sweep.csv, sweep.nc, sweep.json, and sweep as .png and .svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: Mapping[str, Figure] = {"sweep": figures.sweep(sweep)}
    record = sweep_record(sweep, design=design, seed=seed)
    with staged_folder(folder, "robot sweep", record, force=force) as draft:
        steps = Steps(progress, 3 + 2 * len(drawn))
        sweep.to_csv(draft / "sweep.csv")
        steps.next()
        write_netcdf(draft / "sweep.nc", sweep.to_xarray())
        steps.next()
        write_json(draft / "sweep.json", record)
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)
