"""`stepwell animate`: the mechanism in motion."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.options import Design, ForceFile, From, To, free_file, own, planned
from stepwell.cli.screen import progress, show_lines

if TYPE_CHECKING:
    from stepwell.sequences import Cycle, Program


def animate(
    design: Design,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE.gif", help="The file to write.")
    ] = Path("cycle.gif"),
    seconds: Annotated[float, typer.Option(help="How long one round lasts [s].", min=0.5)] = 8.0,
    fps: Annotated[float, typer.Option(help="Frames a second.", min=1, max=50)] = 20.0,
    program: Annotated[
        bool,
        typer.Option(
            "--program",
            help="Play the design's own program, or one planned to --to, instead of a full cycle.",
        ),
    ] = False,
    start: From = None,
    to: To = None,
    force: ForceFile = False,
) -> None:
    """Write a design in motion as a GIF.

    Snaps included, with the energy landscape of two cells, or the force of more, beside it.
    """
    from stepwell import figures

    free_file(out, force)
    result = _motion(design, program, start, to)
    try:
        with progress("frames") as tell:
            figures.animation(result, out, seconds=seconds, fps=fps, progress=tell)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    show_lines(f"Wrote {out}")


def _motion(design: str, program: bool, start: str | None, to: str | None) -> "Cycle | Program":
    """What is to be seen."""
    from stepwell import files

    if not program:
        if start or to:
            raise typer.BadParameter("needs --program.", param_hint="--to" if to else "--from")
        return files.load_chain(design).cycle()
    if start or to:
        return planned(files.load_chain(design), start, to)
    return own(files.read(design), design)
