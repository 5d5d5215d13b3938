"""Everything about what a robot did in one folder: figures, samples, numbers, its design."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from stepwell.files._steps import Progress, Steps, names, save_figures, write_json
from stepwell.files.atomic import staged_folder, write_atomic
from stepwell.files.robot_record import maze_record, robot_record, sweep_record, walk_record
from stepwell.files.write import dumps

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.physics import Maze, Sweep, Walk
    from stepwell.robot import Prediction, Robot


def write_robot(
    robot: Robot,
    prediction: Prediction,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
) -> tuple[str, ...]:
    """Write what a robot is into a folder, all of it or nothing.

    Args:
        robot: any robot.
        prediction: of it.
        folder: made if missing; files of the same names are replaced, others stay.
        design: text of its design file, to keep beside the results; written anew by default.
        progress: called with (done, total) files.

    Returns:
        The names of the files: robot.toml, robot.json, and robot and prediction as .png and
        .svg.

    Raises:
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn = {
        "robot": figures.robot_drawing(robot),
        "prediction": figures.prediction(prediction),
    }
    with staged_folder(folder) as draft:
        steps = Steps(progress, 2 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", design or dumps(robot))
        steps.next()
        write_json(draft / "robot.json", robot_record(robot, prediction))
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_walk(
    walk: Walk,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
) -> tuple[str, ...]:
    """Write what a robot did into a folder, all of it or nothing.

    Args:
        walk: any walk, one that ended early too.
        folder: made if missing; files of the same names are replaced, others stay.
        design: text of the robot's design file; written anew by default.
        progress: called with (done, total) files.

    Returns:
        The names of the files: robot.toml, walk.json, walk.nc, and gait, trajectory and
        contacts as .png and .svg. `physics.video` writes the video.

    Raises:
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
    with staged_folder(folder) as draft:
        steps = Steps(progress, 3 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", design or dumps(walk.robot))
        steps.next()
        write_json(draft / "walk.json", walk_record(walk))
        steps.next()
        walk.to_netcdf(draft / "walk.nc")
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_maze(
    maze: Maze,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
) -> tuple[str, ...]:
    """Write a robot's way through an arena into a folder, all of it or nothing.

    Args:
        maze: a way through any arena.
        folder: made if missing; files of the same names are replaced, others stay.
        design: text of the robot's design file; written anew by default.
        progress: called with (done, total) files.

    Returns:
        The names of the files: robot.toml, arena.toml, maze.json, walk.nc, and maze and
        timeline as .png and .svg. `physics.video` writes the video.

    Raises:
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: dict[str, Figure] = {}
    if len(maze.walk.time):
        drawn = {"maze": figures.maze(maze), "timeline": figures.maze_timeline(maze)}
    with staged_folder(folder) as draft:
        steps = Steps(progress, 4 + 2 * len(drawn))
        write_atomic(draft / "robot.toml", design or dumps(maze.walk.robot))
        steps.next()
        write_atomic(draft / "arena.toml", dumps(maze.arena))
        steps.next()
        write_json(draft / "maze.json", maze_record(maze))
        steps.next()
        maze.walk.to_netcdf(draft / "walk.nc")
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_sweep(
    sweep: Sweep, folder: str | os.PathLike[str], *, progress: Progress | None = None
) -> tuple[str, ...]:
    """Write what many robots did into a folder, all of it or nothing.

    Args:
        sweep: any.
        folder: made if missing; files of the same names are replaced, others stay.
        progress: called with (done, total) files.

    Returns:
        The names of the files: sweep.csv, sweep.nc, sweep.json, and sweep as .png and .svg.

    Raises:
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: Mapping[str, Figure] = {"sweep": figures.sweep(sweep)}
    with staged_folder(folder) as draft:
        steps = Steps(progress, 3 + 2 * len(drawn))
        sweep.to_csv(draft / "sweep.csv")
        steps.next()
        sweep.to_xarray().to_netcdf(draft / "sweep.nc", engine="scipy")
        steps.next()
        write_json(draft / "sweep.json", sweep_record(sweep))
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)
