"""`stepwell map`: what a chain does for each place of an anchor, or of any two parameters."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

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

if TYPE_CHECKING:
    from stepwell.mechanism import Chain

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
        show_default=False,
    ),
]


class _Place(NamedTuple):
    """The design file, and where its map goes."""

    text: str
    out: Path | None
    force: bool


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
    """Draw the transition map of two cells, or of any two parameters of a chain.

    It tells what the pair does for every place of one anchor, and where exactly that changes;
    with --across and --up, what any chain does for all values of two of its parameters. With
    --out, the picture, its data as NetCDF and the boundaries as CSV are written into a folder.
    """
    from stepwell import files
    from stepwell.cli.options import free
    from stepwell.cli.screen import show_json, show_written
    from stepwell.cli.text import map as _map_text

    text = files.read(design)
    chain = files.loads_chain(text, design)
    free(out, "map", force)
    place = _Place(text, out, force)
    with usable(design):
        if across is None and up is None:
            record, names = _of_anchor(chain, cell_of(chain, cell), x, y, place)
        else:
            axes = _both(cell, x, y, across, up)
            record, names = _of_parameters(chain, axes, place)
    if as_json:
        show_json(record, out, names)
    else:
        _map_text.show(record)
        show_written(out, names)


_Shown = tuple[dict[str, Any], tuple[str, ...]]
_Axes = tuple[ParameterRange, ParameterRange]


def _of_anchor(chain: "Chain", cell: int, x: Grid, y: Grid, place: _Place) -> _Shown:
    """The record of an anchor's map, and the files written."""
    from stepwell import reports, results
    from stepwell.cli.screen import progress
    from stepwell.design import boundaries, transition_map

    xs, ys = x.metres, y.metres
    with progress("map") as tell:
        dataset = transition_map(chain, cell, x=xs, y=ys, progress=tell)
    with progress("boundaries") as tell:
        curves = boundaries(chain, cell, x=xs, y=ys, progress=tell)
    designs, names = marks(chain, cell), ()
    if place.out is not None:
        with progress("writing") as tell:
            names = reports.write_map(
                dataset,
                curves,
                place.out,
                designs=designs,
                text=place.text,
                progress=tell,
                force=place.force,
            )
    here = next(iter(designs.values()), None)
    return results.map_record(dataset, curves, here, text=place.text), names


def _of_parameters(chain: "Chain", axes: _Axes, place: _Place) -> _Shown:
    """The record of a map over two parameters, and the files written."""
    from stepwell import reports, results
    from stepwell.cli.screen import progress
    from stepwell.design import parameter_boundaries, parameter_map

    x, y = (axis.values(chain) for axis in axes)
    with progress("map") as tell:
        dataset = parameter_map(chain, x, y, progress=tell)
    with progress("boundaries") as tell:
        curves = parameter_boundaries(chain, x, y, progress=tell)
    here, names = (axes[0].read(chain), axes[1].read(chain)), ()
    if place.out is not None:
        with progress("writing") as tell:
            names = reports.write_parameter_map(
                dataset,
                curves,
                place.out,
                design=here,
                text=place.text,
                progress=tell,
                force=place.force,
            )
    return results.parameter_map_record(dataset, curves, here, text=place.text), names


def _both(
    cell: str, x: Grid, y: Grid, across: ParameterRange | None, up: ParameterRange | None
) -> _Axes:
    """Two parameters, without options of the other kind of map."""
    if across is None or up is None:
        missing, given = ("--across", "--up") if across is None else ("--up", "--across")
        raise typer.BadParameter(f"needs {missing} NAME=FROM:TO:COUNT too.", param_hint=given)
    if (cell, x, y) != (CELL, ACROSS, UP):
        raise typer.BadParameter("cannot stand with --cell, --x or --y.", param_hint="--across")
    return across, up
