"""`stepwell maze`: a robot simulated among walls and cylinders."""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import Force, Json, NoVideo, Out, Robot, free, read_robot
from stepwell.cli.robots.video import with_video
from stepwell.cli.screen import finish, progress, show_table, stopped, usable

if TYPE_CHECKING:
    import stepwell.robot as values


def _list(wanted: bool) -> None:
    if wanted:
        from stepwell import files

        show_table("Arenas", ["name", "what it is"], list(files.arenas().items()), left=(0, 1))
        raise typer.Exit


_Arena = Annotated[
    str,
    typer.Argument(
        metavar="ARENA",
        help="An arena's name (--list shows them), or a file of your own (.toml, .txt).",
    ),
]
_Limit = Annotated[float, typer.Option(help="Time it is given [s].", min=1)]
_StartSeed = Annotated[
    int | None,
    typer.Option(help="Start up to 40 mm and 10° elsewhere, drawn from this seed.", min=0),
]
_LayoutSeed = Annotated[
    int | None,
    typer.Option(help="Move walls up to 40 mm and 8°, drawn from this seed.", min=0),
]
_Disconnect = Annotated[
    bool, typer.Option("--disconnect", help="Take the antennas' levers off the anchors.")
]
_Bare = Annotated[bool, typer.Option("--no-antennas", help="Take the antennas off altogether.")]
_List = Annotated[
    bool,
    typer.Option("--list", help="List the arenas that come along.", callback=_list, is_eager=True),
]


def maze(
    robot: Robot,
    arena: _Arena,
    limit: _Limit = 600.0,
    start_seed: _StartSeed = None,
    layout_seed: _LayoutSeed = None,
    disconnect: _Disconnect = False,
    no_antennas: _Bare = False,
    out: Out = None,
    no_video: NoVideo = False,
    force: Force = False,
    as_json: Json = False,
    _: _List = False,
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


def _changed(robot: "values.Robot", disconnect: bool, bare: bool) -> "values.Robot":
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


def _jittered(arena: "values.Arena", start: int | None, layout: int | None) -> "values.Arena":
    from stepwell.robot import other_layout, other_start

    if layout is not None:
        with usable("--layout-seed"):
            arena = other_layout(arena, layout)
    if start is not None:
        with usable("--start-seed"):
            arena = other_start(arena, start)
    return arena
