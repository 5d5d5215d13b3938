"""What folders of chains have: runs, programs, maps, graphs."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stepwell.accounts import Account
from stepwell.base import (
    InputError,
    Quantity,
    csv_text,
    have,
    need,
    told_in,
    write_atomic,
    write_netcdf,
)
from stepwell.design import LONGEST_FOLLOWED, Margin, boundaries, transition_map
from stepwell.files import WrittenProgram, dumps, with_program
from stepwell.mechanism import Cell
from stepwell.reports.write import Contents, Draw, design_text
from stepwell.studio.replay import replay

if TYPE_CHECKING:
    from stepwell.design import Boundary, MapView, Run
    from stepwell.sequences import Program, TransitionGraph

FIGURES = (".svg", ".png", ".pdf")
# What writes a graph for other programs, by the end of the file's name.
EXPORTS = {".graphml": "to_graphml", ".dot": "to_dot", ".json": "to_json"}
# Nodes along a map, and how far it reaches, in distances to the nearest other sequence.
_NODES, _BEYOND = 41, 1.35


def contents(account: Account) -> Contents:
    """What the folder of a result has besides its page."""
    return _CONTENTS[type(account.value).__name__](account.value, account)


def _run(run: Run, account: Account) -> Contents:
    from stepwell import figures

    chain = run.chain
    plays = len(chain) <= LONGEST_FOLLOWED
    draws = {
        name.replace("_", "-"): draw for name, draw in figures.standard_draws(run.cycle).items()
    }
    draws |= _of_margin(run.margin)
    if run.built is not None:
        draws["yield"] = partial(figures.yield_bars, run.built)
    return Contents(
        "run",
        "result.json",
        {"design.toml": design_text(account), "path.csv": run.cycle.path.to_csv},
        draws,
        motion=partial(replay, run.cycle, title=chain.title, margin=run.margin) if plays else None,
    )


def _of_margin(margin: Margin) -> dict[str, Draw]:
    """The margin, and a map round the anchor that is nearest to another sequence."""
    from stepwell import figures

    chain, draws = margin.chain, {"margins": partial(figures.margins, margin)}
    anchors = [change for change in margin.changes if change.parameter == "anchor"]
    nearest = min(anchors, key=lambda change: change.distance, default=None)
    # By the engine a map takes seconds; and of long chains it has too many regions.
    if nearest is None or margin.method != "exact" or len(chain) > LONGEST_FOLLOWED:
        return draws
    cell, far = chain.cells[nearest.cell], _BEYOND * nearest.distance
    # Maps need xarray.
    if not isinstance(cell, Cell) or not 0.0 < far < math.inf or not have("tables"):
        return draws
    here = cell.bands[0].q
    x, y = (np.linspace(at - far, at + far, _NODES) for at in here)
    around = transition_map(chain, nearest.cell, x=x, y=y)
    curves = boundaries(chain, nearest.cell, x=x[[0, -1]], y=y[[0, -1]])
    dots = {"this design": here}
    draws["around"] = partial(figures.transition_map, around, curves, dots)
    return draws


def _program(program: Program, account: Account) -> Contents:
    from stepwell import figures

    text, kept = account.about.design, WrittenProgram.of(program)
    written = (
        with_program(text, kept) if isinstance(text, str) else dumps(program.chain, program=kept)
    )
    plays = len(program.chain) <= LONGEST_FOLLOWED
    return Contents(
        "program",
        "program.json",
        {"design.toml": written, "program.csv": program.to_csv},
        {"program": partial(figures.stroke_program, program)},
        motion=partial(replay, program, title=program.chain.title) if plays else None,
    )


def _map(view: MapView, account: Account) -> Contents:
    from stepwell import figures

    inside = {name: place for name, place in view.designs.items() if _shows(view, place)}
    return Contents(
        "map",
        "map.json",
        {
            "map.nc": partial(write_netcdf, data=view.dataset),
            "boundaries.csv": boundary_rows(view.boundaries),
        },
        {"map": partial(figures.transition_map, view.dataset, view.boundaries, inside)},
    )


def _shows(view: MapView, design: tuple[float, float]) -> bool:
    """Whether a map holds a design."""
    axes = zip((view.dataset["x"], view.dataset["y"]), design, strict=True)
    return all(float(axis[0]) <= value <= float(axis[-1]) for axis, value in axes)


def boundary_rows(boundaries: Iterable[Boundary]) -> str:
    """The curves of a map as CSV: curve, kind and both parameters, a row for every point."""
    head, rows = ["curve", "kind"], list[tuple[str, ...]]()
    for number, boundary in enumerate(boundaries):
        units = [told_in(unit) for unit in boundary.units]
        names = [
            Quantity(name, "" if unit == "1" else unit).key
            for name, (unit, _) in zip(boundary.parameters, units, strict=True)
        ]
        head = ["curve", "kind", *names]
        kind = boundary.kind.name.lower()
        (_, across), (_, up) = units
        rows += [
            (str(number), kind, f"{x * across:.9g}", f"{y * up:.9g}")
            for x, y in boundary.points.tolist()
        ]
    return csv_text(head, rows)


def checked_suffix(file: str | os.PathLike[str]) -> str:
    """How a transition graph is to be written, by the end of the file's name.

    Raises:
        ValueError: an end that means nothing.
        ExtraError: a figure, and Matplotlib is not installed.
    """
    suffix = Path(file).suffix.lower()
    if suffix not in (*FIGURES, *EXPORTS):
        raise InputError(
            f"{os.fspath(file)}: must end in {', '.join(FIGURES)} for a figure, or in "
            f"{', '.join(EXPORTS)} for other programs."
        )
    if suffix in FIGURES:
        need("figures")
    return suffix


def write_graph(graph: TransitionGraph, file: str | os.PathLike[str]) -> None:
    """Write a transition graph, whole or not at all.

    Args:
        graph: any; a figure holds at most 64 states with all cells at a stop.
        file: where to; .svg, .png or .pdf is a figure, .graphml, .dot and .json are for other
            programs.

    Raises:
        ValueError: a name with another end, or too many states for a figure.
        OSError: the folder is missing or cannot be written.
    """
    suffix = checked_suffix(file)
    if suffix in FIGURES:
        from stepwell import figures

        figures.save(figures.transition_graph(graph), file)
    else:
        from stepwell import sequences

        write_atomic(file, getattr(sequences, EXPORTS[suffix])(graph))


_CONTENTS: dict[str, Callable[..., Contents]] = {
    "MapView": _map,
    "Program": _program,
    "Run": _run,
}
