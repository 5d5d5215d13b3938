"""Everything about what a chain does, in one folder: figures, data, report, the design itself."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import InputError, Measure, have, need, write_atomic
from stepwell.design import boundaries, transition_map, yields
from stepwell.files import dumps, with_program
from stepwell.files.tables import WrittenProgram
from stepwell.mechanism import Cell, Chain
from stepwell.reports.pages import map_page, program_page, report
from stepwell.reports.steps import (
    MOST_BUILT,
    PHONE,
    Folder,
    Progress,
    bundle,
    narrow,
    netcdf,
    pictured,
    replay_of,
)
from stepwell.results import boundary_rows, checked, map_record, program_record, run_record

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from stepwell.design import Boundary, Margin, Yield
    from stepwell.sequences import Cycle, Program, TransitionGraph
    from stepwell.statics import Landing

# How many are built by the engine, and in closed form; cells of figures that fill a phone.
_FEW, _MANY, _MOST_NARROW = 100, 20_000, 8
# Nodes along a map, and how far it reaches, in distances to the nearest other sequence.
_NODES, _BEYOND = 41, 1.35

FIGURES = (".svg", ".png", ".pdf")
# What writes a graph for other programs, by the end of the file's name.
EXPORTS = {".graphml": "to_graphml", ".dot": "to_dot", ".json": "to_json"}


def write_run(
    cycle: Cycle,
    margin: Margin,
    folder: Folder,
    *,
    design: str | None = None,
    source: str | None = None,
    landings: Sequence[Landing] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a design does: design.toml, path.csv, result.json, report.html and its figures.

    `source` is the design file's name, for the report; `landings` as for `results.run_record`.
    """
    from stepwell import figures

    landings = checked(cycle.path) if landings is None else landings
    chain, text = cycle.chain, design or dumps(cycle.chain)
    built = _built(chain)
    drawn = figures.standard(cycle)
    of_margin = _of_margin(margin)
    of_yield = {} if built is None else {"yield": figures.yield_bars(built)}
    captions = _captions(chain.measure)

    def captioned(of: Mapping[str, Figure]) -> dict[str, Figure]:
        return {captions[name]: figure for name, figure in of.items()}

    page = report(
        cycle,
        margin,
        captioned(drawn),
        source,
        landings,
        # Of more cells a phone shows too little.
        narrow=captioned(figures.standard(cycle, width=PHONE))
        if len(chain) <= _MOST_NARROW
        else {},
        margins=captioned(of_margin),
        built=built,
        built_as=captioned(of_yield),
        replay=replay_of(chain, chain.title or source or "", margin),
    )
    contents = {
        "design.toml": text,
        "path.csv": cycle.path.to_csv,
        "result.json": run_record(cycle, margin, landings, design=text),
        "report.html": page,
    }
    drawn = {
        name.replace("_", "-"): figure for name, figure in (drawn | of_margin | of_yield).items()
    }
    return bundle(folder, "run", contents, drawn, progress=progress, force=force)


def _built(chain: Chain) -> Yield | None:
    """How many of those built do what the drawing does, as far as that is soon known."""
    if len(chain) > MOST_BUILT:
        return None
    few = yields(chain, n=_FEW)
    # In closed form many take no longer than these.
    return few if few.by_engine else yields(chain, n=_MANY)


def _of_margin(margin: Margin) -> dict[str, Figure]:
    """The margin, and a map round the anchor that is nearest to something else."""
    from stepwell import figures

    chain, drawn = margin.chain, {"margins": figures.margins(margin)}
    anchors = [change for change in margin.changes if change.parameter == "anchor"]
    nearest = min(anchors, key=lambda change: change.distance, default=None)
    # By the engine a map takes seconds; and of long chains it has too many regions.
    if nearest is None or margin.method != "exact" or len(chain) > MOST_BUILT:
        return drawn
    cell, far = chain.cells[nearest.cell], _BEYOND * nearest.distance
    # Of maps, the core alone knows nothing.
    if not isinstance(cell, Cell) or not 0.0 < far < math.inf or not have("tables"):
        return drawn
    here = cell.bands[0].q
    x, y = (np.linspace(at - far, at + far, _NODES) for at in here)
    around = transition_map(chain, nearest.cell, x=x, y=y)
    curves = boundaries(chain, nearest.cell, x=x[[0, -1]], y=y[[0, -1]])
    dots = {"this design": here}
    return drawn | {"around": narrow(partial(figures.transition_map, around, curves, dots))}


def _captions(measure: Measure) -> dict[str, str]:
    travel = measure.travel.capitalize()
    return {
        "mechanism": "The mechanism in the states of its cycle",
        "landscape": "The energy landscape and the way through it",
        "force_stroke": f"Actuator {measure.force} against {measure.stroke}",
        "travel_stroke": f"{travel} of each cell against {measure.stroke}",
        "element_curves": "What every element resists with, and where it leaves its phases",
        "margins": "How far each thing may be changed before it does something else",
        "around": "What it does with the most sensitive anchor elsewhere",
        "yield": "What those built do",
    }


def write_map(
    dataset: xarray.Dataset,
    boundaries: tuple[Boundary, ...],
    folder: Folder,
    *,
    designs: Mapping[str, tuple[float, float]] | None = None,
    text: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a map into a folder, all of it or nothing.

    Args:
        dataset: what `design.transition_map` or `design.parameter_map` returns.
        boundaries: what `design.boundaries` or `design.parameter_boundaries` returns for the same.
        folder: made if missing; what the same function wrote there before is replaced.
        designs: the two parameters in SI of each design to be marked, by name; the first is the
            one that map.json tells.
        text: of the design file, for the hash of it in map.json.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: map.nc, map.json, boundaries.csv, report.html, map.png and
        map.svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    designs = designs or {}
    inside = {name: place for name, place in designs.items() if _shows(dataset, place)}
    record = map_record(dataset, boundaries, next(iter(designs.values()), None), text=text)
    contents = {
        "map.nc": netcdf(dataset),
        "map.json": record,
        "boundaries.csv": boundary_rows(boundaries),
    }
    drawn = {"map": figures.transition_map(dataset, boundaries, inside)}
    small = narrow(partial(figures.transition_map, dataset, boundaries, inside))
    contents["report.html"] = map_page(record, drawn["map"], small)
    return bundle(folder, "map", contents, drawn, progress=progress, force=force)


def _shows(dataset: xarray.Dataset, design: tuple[float, float]) -> bool:
    """Whether a map holds a design."""
    axes = zip((dataset["x"], dataset["y"]), design, strict=True)
    return all(float(axis[0]) <= value <= float(axis[-1]) for axis, value in axes)


def write_program(
    program: Program,
    folder: Folder,
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a stroke program: program.csv, program.json, program, and design.toml that has it.

    report.html tells it.
    """
    from stepwell import figures

    kept = WrittenProgram.of(program)
    contents = {
        "design.toml": with_program(design, kept) if design else dumps(program.chain, program=kept),
        "program.csv": program.to_csv,
        "program.json": program_record(program, design=design),
    }
    found = pictured(
        {"program": partial(figures.stroke_program, program)},
        {"program": "The program, and what the cells do"},
    )
    contents["report.html"] = program_page(
        program, found.wide, found.narrow, replay_of(program, program.chain.title)
    )
    return bundle(folder, "program", contents, found.files, progress=progress, force=force)


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
