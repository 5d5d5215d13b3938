"""`stepwell run`, `graph`, `program` and `animate`: what a chain does."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.options import (
    Design,
    Drive,
    Force,
    ForceFile,
    From,
    Json,
    MobilityRatio,
    Out,
    Robust,
    To,
    drive_of,
    free,
    free_file,
    local,
    own,
    planned,
    read_chain,
)
from stepwell.cli.screen import (
    answered,
    progress,
    report,
    show_json,
    show_lines,
    show_verbatim,
    usable,
)

if TYPE_CHECKING:
    from stepwell.sequences import Cycle, Program


def run(
    design: Design,
    mobility_ratio: MobilityRatio = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say what a design does.

    Its sequence, its forces, every switch and snap, how far it is from doing otherwise, and whether
    snaps land where they do whatever the mobilities of the cells are.
    With --out, the figures, the path as CSV, the result as JSON and a report in HTML are
    written into a folder, together with the design.
    """
    from stepwell.accounts import About, account
    from stepwell.design import Run, margin

    text, chain = read_chain(design)
    free(out, "run", force, design=text)
    with progress("following") as tell:
        path = (cycle := chain.cycle(progress=tell)).path
    with usable("--mobility-ratio"), progress("landings"):
        landings = (
            path.checked_landings if mobility_ratio is None else path.landings(mobility_ratio)
        )
    with progress("margin") as tell:
        found = Run(cycle, margin(chain, progress=tell), landings)
    report(account(found, About(text, design)), as_json, out, force)


def graph(
    design: Design,
    drive: Drive = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="STATE",
            help="Only what can be reached from this state, such as 000; all states by default.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="Write the graph: .svg, .png, .pdf a figure; .graphml, .dot, .json for others.",
            dir_okay=False,
            callback=local,
        ),
    ] = None,
    force: ForceFile = False,
    as_json: Json = False,
) -> None:
    """Say everything that one actuator can do to a chain.

    Its transition graph in the terms of the field: main loop and sub-loops, Garden-of-Eden
    states, return-point memory, scrambling, accumulators, latches, and states out of reach.
    With --out, the graph is drawn, or written for other programs. A graph of too many states to
    be listed is counted, and walked from all cells at 0 or from --start.
    """
    from stepwell import reports
    from stepwell.accounts import About, account

    text, chain = read_chain(design)
    free_file(out, force)
    if out is not None:
        with usable("--out"):
            reports.checked_suffix(out)
    with usable(design):
        implicit = chain.implicit_graph(drive_of(drive, chain))
    if out is None and not implicit.is_listable and (start is None or implicit.by_fields):
        with usable(design), progress("graph") as tell:
            walked = implicit.walked(start, progress=tell)
        report(account(walked, About(text, design)), as_json)
        return
    with usable(design), progress("graph") as tell:
        found = chain.graph(drive_of(drive, chain), start=start, progress=tell)
        reported = account(found, About(text, design))
    if out is not None:
        with usable("--out"):
            reports.write_graph(found, out)
    if as_json:
        show_json(reported.record, *([out] if out else []))
        return
    report(reported, as_json)
    if out:
        show_lines("")
        show_verbatim(f"Wrote {out}")


def program(
    design: Design,
    start: From = None,
    to: To = None,
    robust: Robust = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find the fewest turning points of the actuator from one state to another.

    Each comes with the window in which turning does the same; or you get the proof that no
    program does it. Without --to, the program in the design file is played, and you are told
    whether it ends as it should. With --robust, no snap on the way may land elsewhere for other
    mobilities. With --out, a figure, the turning points as CSV, the result
    as JSON and the design with the program in it are written into a folder.
    """
    from stepwell.accounts import About, account
    from stepwell.sequences import Unreachable

    text, chain = read_chain(design)
    free(out, "program", force)
    try:
        if start or to:
            found = planned(chain, start, to, robust)
        else:
            found = replace(own(text, design), robust=robust)
    except Unreachable as why:
        found, out = why, None
    reported = account(found, About(text, design))
    report(reported, as_json, out, force)
    answered(reported.record["does_it"])


def animate(
    design: Design,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", metavar="FILE.gif", help="The file to write.", callback=local),
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
    show_verbatim(f"Wrote {out}")


def _motion(design: str, program: bool, start: str | None, to: str | None) -> Cycle | Program:
    from stepwell import files

    if not program:
        if start or to:
            raise typer.BadParameter("needs --program.", param_hint="--to" if to else "--from")
        return files.load(design).chain.cycle()
    if start or to:
        return planned(files.load(design).chain, start, to)
    return own(files.text_of(design), design)
