"""`stepwell replay`: a chain or a robot in motion as one page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.options import Arena, ForceFile, completing, free_file, local, own, read_design
from stepwell.cli.screen import Progress, progress, show_lines, usable

if TYPE_CHECKING:
    import stepwell.robot as values
    from stepwell.simulation import Maze, Walk

_CYCLES = 8.0


def replay(
    design: Annotated[
        str,
        typer.Argument(
            metavar="DESIGN",
            help="A design file (TOML) of a chain or a robot, or preset:NAME.",
            autocompletion=completing.designs,
        ),
    ],
    arena: Arena = None,
    cycles: Annotated[
        float | None,
        typer.Option(
            help="How often a robot's actuator goes out and back: 8 times by default, in an arena "
            "until the robot reaches the goal or gets nowhere, for 600 s at most.",
            min=0.01,
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", metavar="FILE.html", help="The file to write.", callback=local),
    ] = Path("replay.html"),
    force: ForceFile = False,
) -> None:
    """Write a design in motion as one HTML page that plays anywhere.

    It works without a server and without a network, so it can be mailed: a slider, the mechanism,
    its curves with one cursor, and what the numbers rest on. A design with a program is shown as
    it is programmed, any other in its full cycle. A robot is simulated, and seen from above and
    from the side.
    """
    from stepwell import files
    from stepwell.mechanism import Chain
    from stepwell.studio import replay as page_of

    if out.suffix.lower() not in (".html", ".htm"):
        raise typer.BadParameter(f"must end in .html, as in {out.stem}.html.", param_hint=str(out))
    free_file(out, force)
    text, found = read_design(design)
    if isinstance(found, Chain):
        for option, value in (("--arena", arena), ("--cycles", cycles)):
            if value is not None:
                raise typer.BadParameter("is for a robot: this is a chain.", param_hint=option)
        result = own(text, design) if files.loads(text, design).program else found
        with progress("margin") as tell:
            content = page_of(result, progress=tell)
    else:
        with usable(design), progress("walking") as tell:
            run = _run(found, arena, cycles, tell)
        with usable(design), progress("page"):
            content = page_of(run)
    files.write_atomic(out, content)
    show_lines(f"Wrote {out}")


def _run(
    robot: values.Robot, arena: str | None, cycles: float | None, tell: Progress | None
) -> Walk | Maze:
    from stepwell import files

    place = files.load_arena(arena) if arena is not None else None
    from stepwell import simulation

    if place is None or cycles is not None:
        return simulation.walk(robot, cycles or _CYCLES, arena=place, progress=tell)
    return simulation.maze(robot, place, progress=tell)
