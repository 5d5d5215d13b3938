"""`stepwell export`: a robot as a model for MuJoCo."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import ForceFile, Robot, named, usable

_File = Annotated[
    Path,
    typer.Option("--out", "-o", metavar="FILE.xml", help="The file to write.", show_default=False),
]
_Arena = Annotated[
    str | None, typer.Option(metavar="ARENA", help="Put it there; see `stepwell maze --list`.")
]


def export(
    robot: Robot, out: _File = Path("robot.xml"), arena: _Arena = None, force: ForceFile = False
) -> None:
    """Write a robot as MJCF.

    MuJoCo's own viewer opens it: bands, levers, links and antennas are there to be seen. Its
    keyframe `start` stands on the floor with every cell at 0.
    """
    from stepwell import files, simulation
    from stepwell.cli.options import free_file
    from stepwell.cli.screen import show_lines

    free_file(out, force)
    design = files.load_robot(named(robot))
    place = files.load_arena(arena) if arena is not None else None
    with usable(robot):
        text = simulation.mjcf(design, place)
    files.write_atomic(out, text)
    show_lines(f"Wrote {out}")
