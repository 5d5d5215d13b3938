"""`stepwell animate`: the mechanism in motion."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli._options import Design

_Gif = Annotated[Path, typer.Option("--out", "-o", metavar="FILE.gif", help="The file to write.")]
_Seconds = Annotated[float, typer.Option(help="How long one round lasts [s].", min=0.5, max=120)]
_Fps = Annotated[float, typer.Option(help="Frames a second.", min=1, max=50)]


def animate(
    design: Design, out: _Gif = Path("cycle.gif"), seconds: _Seconds = 8.0, fps: _Fps = 20.0
) -> None:
    """Write a design in motion as a GIF.

    Snaps included, with the energy landscape of two cells, or the force of more, beside it.
    """
    from stepwell import figures, files
    from stepwell.cli._progress import progress
    from stepwell.cli._show import show_lines

    cycle = files.load_chain(design).cycle()
    try:
        with progress("frames") as tell:
            figures.animation(cycle, out, seconds=seconds, fps=fps, progress=tell)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    show_lines(f"Wrote {out}")
