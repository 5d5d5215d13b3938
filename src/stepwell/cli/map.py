"""`stepwell map`: which pathway each place of an anchor gives."""

from typing import Annotated

import typer

from stepwell.cli._grid import Grid, cell_of, grid, marks
from stepwell.cli._options import Design, Json, Out

ACROSS, UP = Grid(0, 20, 200), Grid(-15, 15, 200)
_Axis = Annotated[
    Grid,
    typer.Option(
        parser=grid, metavar="FROM:TO:COUNT", help="Places of that anchor along this axis [mm]."
    ),
]
_Cell = Annotated[
    str,
    typer.Option(help="Whose anchor q moves: a cell's name, inner, outer, or its number from 0."),
]


def map_(
    design: Design,
    cell: _Cell = "outer",
    x: _Axis = ACROSS,
    y: _Axis = UP,
    out: Out = None,
    as_json: Json = False,
) -> None:
    """Draw the transition map of two cells.

    It tells what the pair does for every place of one anchor, and where exactly that changes.
    With --out, the picture, its data as NetCDF and the exact boundaries as CSV are written
    into a folder.
    """
    from stepwell import files
    from stepwell.cli import _map_text
    from stepwell.cli._progress import progress
    from stepwell.cli._show import show_json, show_written
    from stepwell.design import boundaries, transition_map

    chain = files.load_chain(design)
    moved = cell_of(chain, cell)
    xs, ys = x.metres, y.metres
    try:
        with progress("map") as tell:
            dataset = transition_map(chain, moved, x=xs, y=ys, progress=tell)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint=design) from None
    with progress("boundaries") as tell:
        curves = boundaries(chain, moved, x=xs, y=ys, progress=tell)
    designs, names = marks(chain, moved), ()
    if out is not None:
        with progress("writing") as tell:
            names = files.write_map(dataset, curves, out, designs=designs, progress=tell)
    record = files.map_record(dataset, curves, next(iter(designs.values()), None))
    if as_json:
        show_json(record, out, names)
    else:
        _map_text.show(record)
        show_written(out, names)
