"""`stepwell walk` and `stepwell maze`: a robot simulated on a bare floor, or among obstacles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import Force, Json, NoVideo, Out, Robot, completing, free, read_robot
from stepwell.cli.screen import Progress, finish, progress, show_table, stopped, usable, warn

if TYPE_CHECKING:
    import stepwell.robot as values
    from stepwell.simulation import Maze, Walk


def walk(
    robot: Robot,
    cycles: Annotated[
        float, typer.Option(help="How often the actuator goes out and back.", min=0.01)
    ] = 8,
    out: Out = None,
    no_video: NoVideo = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Let a robot walk, and say how.

    The actuator's position is the only command; gaits emerge from bands, weight and contact.
    With --out, figures, samples as NetCDF, the result as JSON and a video (MP4 and GIF) are
    written into a folder, together with the design.
    """
    from stepwell import reports, results, simulation
    from stepwell.cli.text import robots as texts

    text, design = read_robot(robot)
    free(out, "walk", force, robot=text)
    with usable(robot), progress("walking") as tell:
        result = simulation.walk(design, cycles, progress=tell)
    record = results.walk_record(result, design=text)
    write = partial(reports.write_walk, design=text)
    write = partial(write, result) if no_video else with_video(write, result, "walk")
    finish(record, texts.walk, as_json, out, force, write)
    stopped(result.stopped)


def _list(wanted: bool) -> None:
    if wanted:
        from stepwell import files

        show_table("Arenas", ["name", "what it is"], list(files.arenas().items()), left=(0, 1))
        raise typer.Exit


def maze(
    robot: Robot,
    arena: Annotated[
        str,
        typer.Argument(
            metavar="ARENA",
            help="An arena's name (--list shows them), or a file of your own (.toml, .txt).",
            autocompletion=completing.arenas,
        ),
    ],
    limit: Annotated[float, typer.Option(help="Time it is given [s].", min=1)] = 600.0,
    start_seed: Annotated[
        int | None,
        typer.Option(help="Start up to 40 mm and 10° elsewhere, drawn from this seed.", min=0),
    ] = None,
    layout_seed: Annotated[
        int | None,
        typer.Option(help="Move walls up to 40 mm and 8°, drawn from this seed.", min=0),
    ] = None,
    disconnect: Annotated[
        bool, typer.Option("--disconnect", help="Take the antennas' levers off the anchors.")
    ] = False,
    no_antennas: Annotated[
        bool, typer.Option("--no-antennas", help="Take the antennas off altogether.")
    ] = False,
    out: Out = None,
    no_video: NoVideo = False,
    force: Force = False,
    as_json: Json = False,
    _: Annotated[
        bool,
        typer.Option(
            "--list", help="List the arenas that come along.", callback=_list, is_eager=True
        ),
    ] = False,
) -> None:
    """Let a robot find its way through an arena.

    It walks until it reaches the goal, gets nowhere any more, or runs out of time; nothing
    steers it but its antennas. --disconnect and --no-antennas are the controls: the same
    robot without what reprograms its legs. With --out, figures, samples as NetCDF, the result
    as JSON and a video (MP4 and GIF) are written into a folder, together with both designs.
    """
    from stepwell import files, reports, results, simulation
    from stepwell.cli.text import robots as texts

    text, given = read_robot(robot)
    design = _changed(given, disconnect, no_antennas)
    told: dict[str, Any] = {
        "design": text if design is given else None,
        "start_seed": start_seed,
        "layout_seed": layout_seed,
    }
    free(out, "maze", force)
    place = _jittered(files.load_arena(arena), start_seed, layout_seed)
    with usable(robot), progress("walking") as tell:
        result = simulation.maze(design, place, limit=limit, progress=tell)
    write = partial(reports.write_maze, **told)
    write = partial(write, result) if no_video else with_video(write, result, "maze")
    finish(results.maze_record(result, **told), texts.maze, as_json, out, force, write)
    stopped(result.walk.stopped)


def _changed(robot: values.Robot, disconnect: bool, bare: bool) -> values.Robot:
    """The robot as given, or one of the two controls."""
    if not (disconnect or bare):
        return robot
    option = "--no-antennas" if bare else "--disconnect"
    if disconnect and bare:
        raise typer.BadParameter(f"{option} leaves no lever to take off: give one of the two.")
    if not robot.antennas:
        raise typer.BadParameter("this robot has no antennas.", param_hint=option)
    antennas = () if bare else tuple(replace(one, connected=False) for one in robot.antennas)
    return replace(robot, antennas=antennas)


def _jittered(arena: values.Arena, start: int | None, layout: int | None) -> values.Arena:
    from stepwell.robot import other_layout, other_start

    if layout is not None:
        with usable("--layout-seed"):
            arena = other_layout(arena, layout)
    if start is not None:
        with usable("--start-seed"):
            arena = other_start(arena, start)
    return arena


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
