"""Everything about a design that was found, or judged, in one folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.design import Yield
from stepwell.files import dumps
from stepwell.reports.pages import (
    design_page,
    reprogramming_page,
    survival_page,
    yield_page,
)
from stepwell.reports.steps import Folder, Pictures, Progress, bundle, pictured
from stepwell.results import (
    design_record,
    reprogram_record,
    survival_record,
    yield_record,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Design, Reprogramming, Survival

# Mechanisms that are drawn around the drawing, and cells that fit into a figure.
_CLOUD, _DRAWABLE_CELLS = 600, 16
_PLANE = "The forces at which each cell lets go, as drawn and as built"
_CAPTIONS = {"yield": "What those built do", "force-plane": _PLANE}


def write_design(
    found: Design, folder: Folder, *, progress: Progress | None = None, force: bool = False
) -> tuple[str, ...]:
    """Write a design that was found: report.html, design.toml and .json, yield.csv, force-plane."""
    from stepwell import figures

    plane = figures.plot(found)
    contents = {
        "design.toml": dumps(found.chain),
        "design.json": design_record(found),
        "yield.csv": found.yield_.to_csv,
        "report.html": design_page(found, {_PLANE: plane}),
    }
    drawn = {"force-plane": plane}
    return bundle(folder, "design", contents, drawn, progress=progress, force=force)


def write_yield(
    found: Yield,
    folder: Folder,
    *,
    design: str | None = None,
    calibrated: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write how many mechanisms do what is wanted: design.toml, yield.json, yield.csv and yield.

    For up to 16 cells the force-plane is drawn too; report.html tells it.
    """
    drawn = _of_yield(found)
    text = design or dumps(found.chain)
    contents = {
        "design.toml": text,
        "yield.json": yield_record(found, design=text, calibrated=calibrated),
        "yield.csv": found.to_csv,
        "report.html": yield_page(found, drawn.wide, drawn.narrow, calibrated),
    }
    return bundle(folder, "yield", contents, drawn.files, progress=progress, force=force)


def _of_yield(found: Yield) -> Pictures:
    from stepwell import figures

    draws: dict[str, Callable[[], Figure]] = {"yield": partial(figures.yield_bars, found)}
    if len(found.chain) <= _DRAWABLE_CELLS:
        clouds = found.end_forces(_CLOUD)
        draws["force-plane"] = partial(figures.force_plane, found.chain, clouds=clouds)
    return pictured(draws, _CAPTIONS)


def write_survival(
    found: Survival,
    folder: Folder,
    *,
    design: str | None = None,
    calibrated: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write how many mechanisms a program works on: design.toml, survival.json, report.html."""
    text = design or dumps(found.chain)
    contents = {
        "design.toml": text,
        "survival.json": survival_record(found, design=text, calibrated=calibrated),
        "report.html": survival_page(found, calibrated),
    }
    return bundle(folder, "yield", contents, progress=progress, force=force)


def write_reprogramming(
    found: Reprogramming,
    folder: Folder,
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write the smallest displacement of an anchor: reprogram.json, report.html.

    Where something was found, also design.toml, the design just past the change, and of an anchor
    way.csv.
    """
    contents: dict[str, object] = {
        "reprogram.json": reprogram_record(found, design=design),
        "report.html": reprogramming_page(found),
    }
    if found.chain_after is not None:
        contents["design.toml"] = dumps(found.chain_after)
        if isinstance(found.displacement, tuple):
            contents["way.csv"] = found.to_csv
    return bundle(folder, "reprogram", contents, progress=progress, force=force)
