"""`stepwell map`: what a chain does for each place of an anchor, or of any two parameters."""

from functools import partial
from typing import Annotated

import typer

from stepwell.cli.options import (
    EXAMPLE,
    Design,
    Force,
    Grid,
    Json,
    Out,
    ParameterRange,
    cell_of,
    grid,
    marks,
    parameter_range,
)
from stepwell.cli.screen import usable

CELL, ACROSS, UP = "outer", Grid(0, 20, 200), Grid(-15, 15, 200)
_Axis = Annotated[
    Grid,
    typer.Option(
        parser=grid, metavar="FROM:TO:COUNT", help="Places of that anchor along this axis [mm]."
    ),
]
_Cell = Annotated[
    str,
    typer.Option(
        help="Whose anchor q moves: a cell's name, inner, outer, or its number, 1 for the "
        "innermost."
    ),
]
_Parameter = Annotated[
    ParameterRange | None,
    typer.Option(
        parser=parameter_range,
        metavar="NAME=FROM:TO:COUNT",
        help=f"A parameter along this axis instead, in mm, deg, N or N/m, as in {EXAMPLE}.",
    ),
]


def map_(
    design: Design,
    cell: _Cell = CELL,
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
    from stepwell import files, reports, results
    from stepwell.cli.options import free
    from stepwell.cli.screen import progress, show_json, show_written
    from stepwell.cli.text import map as _map_text
    from stepwell.design import boundaries, parameter_boundaries, parameter_map, transition_map

    text = files.read(design)
    chain = files.loads_chain(text, design)
    free(out, "map", force)
    names: tuple[str, ...] = ()
    with usable(design):
        if across is None and up is None:
            index = cell_of(chain, cell)
            nodes = partial(transition_map, chain, index, x=x.metres, y=y.metres)
            curves = partial(boundaries, chain, index, x=x.metres, y=y.metres)
            designs = marks(chain, index)
        else:
            first, second = _both(cell, x, y, across, up)
            axes = first.values(chain), second.values(chain)
            nodes = partial(parameter_map, chain, *axes)
            curves = partial(parameter_boundaries, chain, *axes)
            designs = {"this design": (first.read(chain), second.read(chain))}
        with progress("map") as tell:
            dataset = nodes(progress=tell)
        with progress("boundaries") as tell:
            found = curves(progress=tell)
        if out is not None:
            with progress("writing") as tell:
                names = reports.write_map(
                    dataset, found, out, designs=designs, text=text, progress=tell, force=force
                )
    record = results.map_record(dataset, found, next(iter(designs.values()), None), text=text)
    if as_json:
        show_json(record, out, names)
    else:
        _map_text.show(record)
        show_written(out, names)


def _both(
    cell: str, x: Grid, y: Grid, across: ParameterRange | None, up: ParameterRange | None
) -> tuple[ParameterRange, ParameterRange]:
    """Two parameters, without options of the other kind of map."""
    if across is None or up is None:
        missing, given = ("--across", "--up") if across is None else ("--up", "--across")
        raise typer.BadParameter(f"needs {missing} NAME=FROM:TO:COUNT too.", param_hint=given)
    if (cell, x, y) != (CELL, ACROSS, UP):
        raise typer.BadParameter("cannot stand with --cell, --x or --y.", param_hint="--across")
    return across, up
