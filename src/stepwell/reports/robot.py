"""Everything about what a robot did in one folder: figures, samples, numbers, its design."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from stepwell.files import dumps
from stepwell.reports.pages import maze_page, robot_page, sweep_page, walk_page
from stepwell.reports.steps import Film, Folder, Progress, bundle, netcdf, pictured
from stepwell.results import maze_record, robot_record, sweep_record, walk_record
from stepwell.studio.replay import replay

if TYPE_CHECKING:
    from stepwell.robot import Prediction, Robot
    from stepwell.simulation import Maze, Sweep, Walk

_CAPTIONS = {
    "robot": "The robot from the side and from above",
    "prediction": "The gait that statics predicts",
    "trajectory": "Its path from above, and what each cycle did",
    "gait": "What the cells of every leg did",
    "contacts": "What carried it, and what the actuator did",
    "maze": "Its way from above",
    "timeline": "What it did when",
    "sweep": "What each of them did",
}


def write_robot(
    robot: Robot,
    prediction: Prediction,
    folder: Folder,
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a robot is: robot.toml, robot.json, report.html, robot and prediction drawn."""
    from stepwell import figures

    found = pictured(
        {
            "robot": partial(figures.robot_drawing, robot),
            "prediction": partial(figures.prediction, prediction),
        },
        _CAPTIONS,
    )
    text = design or dumps(robot)
    record = robot_record(robot, prediction, design=text)
    contents = {
        "robot.toml": text,
        "robot.json": record,
        "report.html": robot_page(record, prediction.motion.value, found.wide, found.narrow),
    }
    return bundle(folder, "robot show", contents, found.files, progress=progress, force=force)


def write_walk(
    walk: Walk,
    folder: Folder,
    *,
    design: str | None = None,
    film: Film | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a walk, one that ended early too: robot.toml, walk.json, walk.nc, what `film` adds.

    report.html tells it. The figures are gait, trajectory and contacts.
    """
    from stepwell import figures

    draws = (
        {
            "trajectory": partial(figures.trajectory, walk),
            "gait": partial(figures.gait, walk),
            "contacts": partial(figures.contacts, walk),
        }
        if len(walk.time)
        else {}
    )
    found = pictured(draws, _CAPTIONS)
    text = design or dumps(walk.robot)
    record = walk_record(walk, design=text)
    contents = {
        "robot.toml": text,
        "walk.json": record,
        "walk.nc": walk.to_netcdf,
        "report.html": walk_page(record, found.wide, found.narrow, replay(walk) if draws else ""),
    }
    return bundle(folder, "walk", contents, found.files, film=film, progress=progress, force=force)


def write_maze(
    maze: Maze,
    folder: Folder,
    *,
    design: str | None = None,
    start_seed: int | None = None,
    layout_seed: int | None = None,
    film: Film | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a way through an arena: robot.toml, arena.toml, maze.json, walk.nc, what `film` adds.

    report.html tells it. The figures are maze and timeline; the seeds are those of start and
    obstacles, if drawn.
    """
    from stepwell import figures

    draws = (
        {"maze": partial(figures.maze, maze), "timeline": partial(figures.maze_timeline, maze)}
        if len(maze.walk.time)
        else {}
    )
    found = pictured(draws, _CAPTIONS)
    text = design or dumps(maze.walk.robot)
    record = maze_record(maze, design=text, start_seed=start_seed, layout_seed=layout_seed)
    contents = {
        "robot.toml": text,
        "arena.toml": dumps(maze.arena),
        "maze.json": record,
        "walk.nc": maze.walk.to_netcdf,
        "report.html": maze_page(
            record, str(maze.outcome), found.wide, found.narrow, replay(maze) if draws else ""
        ),
    }
    return bundle(folder, "maze", contents, found.files, film=film, progress=progress, force=force)


def write_sweep(
    sweep: Sweep,
    folder: Folder,
    *,
    design: str | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what many robots did: sweep.csv, sweep.nc, sweep.json and sweep; `seed` drew them.

    report.html tells it.
    """
    from stepwell import figures
    from stepwell.simulation import TRIAL

    found = pictured({"sweep": partial(figures.sweep, sweep)}, _CAPTIONS)
    record = sweep_record(sweep, design=design, seed=seed)
    contents = {
        "sweep.csv": sweep.to_csv,
        "sweep.nc": netcdf(sweep.to_xarray()),
        "sweep.json": record,
        "report.html": sweep_page(record, TRIAL, found.wide, found.narrow),
    }
    return bundle(folder, "robot sweep", contents, found.files, progress=progress, force=force)
