"""`stepwell graph`: everything that one actuator can do to a chain."""

from pathlib import Path
from typing import Annotated

import typer

from stepwell.cli.options import Design, Drive, ForceFile, Json, free_file, read_chain
from stepwell.cli.screen import progress, show_json, show_lines, usable


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
        ),
    ] = None,
    force: ForceFile = False,
    as_json: Json = False,
) -> None:
    """Say everything that one actuator can do to a chain.

    Its transition graph in the terms of the field: main loop and sub-loops, Garden-of-Eden
    states, return-point memory, scrambling, accumulators, latches, and states out of reach.
    With --out, the graph is drawn, or written for other programs.
    """
    from stepwell import reports, results

    text, chain = read_chain(design)
    free_file(out, force)
    if out is not None:
        with usable("--out"):
            reports.checked_suffix(out)
    with usable(design), progress("graph") as tell:
        found = chain.graph(drive, start=start, progress=tell)
        record = results.graph_record(found, design=text)
    if out is not None:
        with usable("--out"):
            reports.write_graph(found, out)
    if as_json:
        show_json(record, *([out] if out else []))
        return
    title = [chain.title, ""] if chain.title else []
    show_lines(*title, str(found.reading), *(["", f"Wrote {out}"] if out else []))
