"""`stepwell walk` and `stepwell maze`: a robot simulated on a bare floor, or among obstacles."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.options import Force, Json, NoVideo, Out, Robot, completing, free, read_robot
from stepwell.cli.screen import progress, report, show_table, stopped, usable, warn

if TYPE_CHECKING:
    import stepwell.robot as values


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
    """Simulate a walk on a flat floor: gaits, advance, turn and cost of transport.

    The actuator's position is the only command; gaits emerge from bands, weight and contact.
    With --out, figures, samples as NetCDF, the result as JSON and a video (MP4 and GIF) are
    written into a folder, together with the design.
    """
    from stepwell import simulation
    from stepwell.accounts import About, account

    text, design = read_robot(robot)
    free(out, "walk", force, robot=text)
    with usable(robot), progress("walking") as tell:
        result = simulation.walk(design, cycles, progress=tell)
    found = account(result, About(text, robot))
    report(found, as_json, out, force, video=not no_video, warn=warn)
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
    """Simulate a robot in an arena: whether it reaches the goal, and what it touches.

    It walks until it reaches the goal, gets nowhere any more, or runs out of time; nothing
    steers it but its antennas. --disconnect and --no-antennas are the controls: the same
    robot without what reprograms its legs. With --out, figures, samples as NetCDF, the result
    as JSON and a video (MP4 and GIF) are written into a folder, together with both designs.
    """
    from stepwell import files, simulation
    from stepwell.accounts import About, account

    text, given = read_robot(robot)
    design = _changed(given, disconnect, no_antennas)
    seeds = {"start_seed": start_seed, "layout_seed": layout_seed}
    free(out, "maze", force)
    place = _jittered(files.load_arena(arena), start_seed, layout_seed)
    with usable(robot), progress("walking") as tell:
        result = simulation.maze(design, place, limit=limit, progress=tell)
    found = account(result, About(text if design is given else design, robot, seeds=seeds))
    report(found, as_json, out, force, video=not no_video, warn=warn)
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
