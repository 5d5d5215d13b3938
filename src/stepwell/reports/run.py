"""Everything about one result in one folder: figures, data, report, the design itself."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from stepwell.files import dumps
from stepwell.reports.page import report
from stepwell.reports.steps import Progress, bundle, netcdf
from stepwell.results import boundary_rows, map_record, run_record

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

    from stepwell.design import Boundary, Margin
    from stepwell.sequences import Cycle

# Beyond this a drawing is too small to see, and the figures room refuses it.
_DRAWABLE_CELLS, _DRAWABLE_STATES = 12, 30


def write_run(
    cycle: Cycle,
    margin: Margin,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    source: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what a design does: design.toml, path.csv, result.json, report.html and its figures.

    `source` is the design file's name, for the report.
    """
    text, drawn = design or dumps(cycle.chain), _figures(cycle)
    contents = {
        "design.toml": text,
        "path.csv": cycle.path.to_csv,
        "result.json": run_record(cycle, margin, design=text),
        "report.html": report(cycle, margin, dict(drawn.values()), source),
    }
    figures = {name: figure for name, (_, figure) in drawn.items()}
    return bundle(folder, "run", contents, figures, progress=progress, force=force)


def write_map(
    dataset: xarray.Dataset,
    boundaries: tuple[Boundary, ...],
    folder: str | os.PathLike[str],
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
        The names of the files: map.nc, map.json, boundaries.csv, map.png and map.svg.

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
    return bundle(folder, "map", contents, drawn, progress=progress, force=force)


def _shows(dataset: xarray.Dataset, design: tuple[float, float]) -> bool:
    """Whether a map holds a design."""
    axes = zip((dataset["x"], dataset["y"]), design, strict=True)
    return all(float(axis[0]) <= value <= float(axis[-1]) for axis, value in axes)


def _figures(cycle: Cycle) -> dict[str, tuple[str, Figure]]:
    """File name without suffix: caption and figure."""
    from stepwell import figures

    chain, drawn = cycle.chain, {}
    if len(chain) <= _DRAWABLE_CELLS and len(cycle.sequence) <= _DRAWABLE_STATES:
        caption = "The mechanism in the states of its cycle"
        drawn["mechanism"] = caption, figures.mechanism(chain, cycle.sequence)
    if len(chain) == 2:
        drawn["landscape"] = "The energy landscape and the way through it", figures.landscape(cycle)
    drawn["force-stroke"] = "Actuator force against stroke", figures.force_stroke(cycle)
    drawn["travel-stroke"] = "Travel of each cell against stroke", figures.travel_stroke(cycle)
    return drawn
