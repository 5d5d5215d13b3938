"""`stepwell map`: what a chain does for each place of an anchor, or of any two parameters."""

from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.cli.options import (
    EXAMPLE,
    Design,
    Force,
    Json,
    Out,
    Range,
    free,
    grid,
    parameter_range,
    read_chain,
)
from stepwell.cli.screen import progress, report, usable

if TYPE_CHECKING:
    from stepwell.base import Floats
    from stepwell.mechanism import Chain

CELL, ACROSS, UP = "outer", Range(0, 20, 200), Range(-15, 15, 200)
_Axis = Annotated[
    Range,
    typer.Option(
        parser=grid, metavar="FROM:TO:COUNT", help="Places of that anchor along this axis [mm]."
    ),
]
_Parameter = Annotated[
    Range | None,
    typer.Option(
        parser=parameter_range,
        metavar="NAME=FROM:TO:COUNT",
        help=f"A parameter along this axis instead, in mm, deg, N or N/m, as in {EXAMPLE}.",
    ),
]


def map_(
    design: Design,
    cell: Annotated[
        str,
        typer.Option(
            help="Whose anchor q moves: a cell's name, inner, outer, or its number, 1 for the "
            "innermost."
        ),
    ] = CELL,
    x: _Axis = ACROSS,
    y: _Axis = UP,
    across: _Parameter = None,
    up: _Parameter = None,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Draw the transition map over a cell's anchor, or over any two parameters of a chain.

    It tells what the chain does for every place of one anchor, and where exactly that changes;
    with --across and --up, what it does for all values of two of its parameters. With --out, the
    picture, its data as NetCDF and the boundaries as CSV are written into a folder.
    """
    from stepwell.accounts import About, account
    from stepwell.design import (
        MapView,
        boundaries,
        parameter_boundaries,
        parameter_map,
        transition_map,
    )

    text, chain = read_chain(design)
    free(out, "map", force)
    with usable(design):
        if across is None and up is None:
            index = cell_of(chain, cell)
            designs = marks(chain, index)
            places = {"x": x.values(1e3), "y": y.values(1e3)}
            nodes = partial(transition_map, chain, index, **places)
            curves = partial(boundaries, chain, index, **places)
        else:
            first, second = _both(cell, x, y, across, up)
            (across_axis, here_across), (up_axis, here_up) = (
                _axis(first, chain),
                _axis(second, chain),
            )
            nodes = partial(parameter_map, chain, across_axis, up_axis)
            curves = partial(parameter_boundaries, chain, across_axis, up_axis)
            designs = {"this design": (here_across, here_up)}
        with progress("map") as tell:
            dataset = nodes(progress=tell)
        with progress("boundaries") as tell:
            found = curves(progress=tell)
        reported = account(MapView(dataset, found, designs), About(text, design))
        report(reported, as_json, out, force)


def _both(
    cell: str, x: Range, y: Range, across: Range | None, up: Range | None
) -> tuple[Range, Range]:
    """Two parameters, without options of the other kind of map."""
    if across is None or up is None:
        missing, given = ("--across", "--up") if across is None else ("--up", "--across")
        raise typer.BadParameter(f"needs {missing} NAME=FROM:TO:COUNT too.", param_hint=given)
    if (cell, x, y) != (CELL, ACROSS, UP):
        raise typer.BadParameter("cannot stand with --cell, --x or --y.", param_hint="--across")
    return across, up


def _axis(given: Range, chain: "Chain") -> tuple[tuple[str, "Floats"], float]:
    """A parameter with its values in SI, for a chain that has it; and what it is there."""
    from stepwell.base import told_in
    from stepwell.design import parameter

    one = parameter(chain, given.name)
    values = one.values(given.values(told_in(one.unit)[1]), 2)
    here = one.value(chain)
    assert not isinstance(here, tuple)
    return (given.name, values), here


def cell_of(chain: "Chain", text: str) -> int:
    """The index of the cell a user means by a name, inner, outer or a number from 1."""
    names = chain.names
    if names.count(text) == 1:
        return names.index(text)
    ends = {"inner": 0, "outer": len(chain) - 1}
    if text in ends and text not in names:
        return ends[text]
    if text.isdecimal() and text.isascii() and 1 <= int(text) <= len(chain) and text not in names:
        return int(text) - 1
    known = ", ".join(f"{name} ({number})" for number, name in enumerate(names[:12], 1))
    raise typer.BadParameter(f"{text!r}: must be one of {known}.", param_hint="--cell")


def marks(chain: "Chain", cell: int) -> dict[str, tuple[float, float]]:
    """Where the design itself stands on its map [m]; nothing where its bands differ in q."""
    from stepwell.mechanism import Element

    own = chain.cells[cell]
    if isinstance(own, Element):
        raise typer.BadParameter(
            f"{chain.names[cell]} is an element and has no anchor: pass --across "
            f"NAME=FROM:TO:COUNT and --up NAME=FROM:TO:COUNT.",
            param_hint="--cell",
        )
    anchors = {band.q for band in own.bands}
    return {"this design": anchors.pop()} if len(anchors) == 1 else {}
