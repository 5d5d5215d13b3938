"""`stepwell view`: a robot in MuJoCo's viewer."""

from typing import Annotated

import typer

from stepwell.cli.options import Robot, named, usable

_Arena = Annotated[
    str | None, typer.Option(metavar="ARENA", help="Put it there; see `stepwell maze --list`.")
]


def view(robot: Robot, arena: _Arena = None) -> None:
    """Watch a robot walk in MuJoCo's viewer.

    It needs a display. The actuator's command runs, and the mouse can push the robot about.
    """
    from stepwell import files
    from stepwell.cli.robots import viewer as _viewer

    design = files.load_robot(named(robot))
    place = files.load_arena(arena) if arena is not None else None
    if not _viewer.has_display():
        typer.echo(_viewer.NO_DISPLAY, err=True)
        raise typer.Exit(1)
    with usable(robot):
        _viewer.show(design, place)
