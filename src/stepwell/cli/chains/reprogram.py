"""`stepwell reprogram`: how far an anchor has to be moved to change what a chain does."""

import math
from functools import partial
from typing import Annotated, NamedTuple

import typer

from stepwell.base import REACH
from stepwell.cli.options import Design, Force, Json, Out, free, read_chain
from stepwell.cli.screen import answered, finish, progress, usable


class Direction(NamedTuple):
    """A direction in the plane of an anchor, of any length."""

    x: float
    y: float


def along(text: str) -> Direction:
    """X:Y, or an angle in degrees from the x axis, as a direction."""
    try:
        parts = [float(part) for part in text.split(":")]
        angle = math.radians(parts[0])
        x, y = parts if len(parts) > 1 else (math.cos(angle), math.sin(angle))
    except (OverflowError, ValueError):
        x, y = math.nan, math.nan
    if not 0 < math.hypot(x, y) < math.inf:
        raise typer.BadParameter(f"{text!r}: must be X:Y, as in -1:0, or degrees, as in 180.")
    return Direction(x, y)


def reprogram(
    design: Design,
    by: Annotated[
        str,
        typer.Option(
            "--by",
            metavar="ANCHOR",
            help="The anchor that is moved: a cell's name or number, then .p on its inner block or "
            ".q on its outer one, as in inner.p.",
        ),
    ],
    target: Annotated[
        str | None,
        typer.Option(
            metavar="SEQUENCE",
            help="The cycle wanted, as in '00>01>11>10>00'; any other than now by default.",
        ),
    ] = None,
    line: Annotated[
        Direction | None,
        typer.Option(
            "--along",
            parser=along,
            metavar="X:Y|DEGREES",
            help="The line that the anchor keeps to; anywhere in the plane by default.",
        ),
    ] = None,
    one_way: Annotated[
        bool, typer.Option("--one-way", help="Only in the sense of --along, not against it.")
    ] = False,
    reach: Annotated[
        float,
        typer.Option(metavar="MM", help="Farthest that is looked at [mm].", min=0.001, max=1e6),
    ] = REACH * 1e3,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find the smallest displacement of an anchor that changes what a chain does.

    You get the displacement, the sequence just past it, and the force that has to push the
    anchor on the way: what an antenna must deliver. With --out, the design past the change,
    the way as CSV and the result as JSON are written into a folder.
    """
    from stepwell import reports, results
    from stepwell.cli.text import chains as texts
    from stepwell.design import reprogram

    if one_way and line is None:
        raise typer.BadParameter("needs --along X:Y, the way to go.", param_hint="--one-way")
    text, chain = read_chain(design)
    free(out, "reprogram", force)
    ways = {"along": line, "one_way": one_way, "reach": reach / 1e3}
    with usable(design), progress("search") as tell:
        found = reprogram(chain, target, by, **ways, progress=tell)
    record = results.reprogram_record(found, design=text)
    write = partial(reports.write_reprogramming, found, design=text)
    finish(record, texts.reprogram, as_json, out, force, write)
    answered(record["possible"])
