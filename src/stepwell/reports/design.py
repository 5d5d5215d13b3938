"""Everything about a design that was found, or judged, in one folder."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import write_atomic
from stepwell.files import dumps, staged_folder
from stepwell.reports.steps import Progress, Steps, names, save_figures, write_json
from stepwell.results import design_record, reprogram_record, survival_record, yield_record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Design, Reprogramming, Survival, Yield

# Mechanisms that are drawn around the drawing, and cells that fit into a figure.
_CLOUD, _DRAWABLE_CELLS = 600, 16


def write_design(
    found: Design,
    folder: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a design that was found into a folder, all of it or nothing.

    Args:
        found: what `design.design` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: design.toml, design.json, yield.csv, force-plane.png and
        force-plane.svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    record = design_record(found)
    with staged_folder(folder, "design", record, force=force) as draft:
        steps = Steps(progress, 5)
        write_atomic(draft / "design.toml", dumps(found.chain))
        steps.next()
        write_json(draft / "design.json", record)
        steps.next()
        found.yield_.to_csv(draft / "yield.csv")
        steps.next()
        drilled = found.holes is not None
        plane = figures.force_plane(
            found.chain,
            loading=found.loading,
            unloading=found.unloading,
            region=() if drilled else found.region,
            places=np.concatenate(found.region) if drilled else None,
            clouds=found.yield_.end_forces(_CLOUD),
        )
        save_figures({"force-plane": plane}, draft, steps)
        return names(draft)


def write_yield(
    found: Yield,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write how many built mechanisms do what is wanted into a folder, all of it or nothing.

    Args:
        found: what `design.yields` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the design file, to keep beside the results; written anew by default.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: design.toml, yield.json, yield.csv, and yield and, for up to 16
        cells, force-plane as .png and .svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    drawn: dict[str, Figure] = {"yield": figures.yield_bars(found)}
    if len(found.chain) <= _DRAWABLE_CELLS:
        drawn["force-plane"] = figures.force_plane(found.chain, clouds=found.end_forces(_CLOUD))
    text = design or dumps(found.chain)
    record = yield_record(found, design=text)
    with staged_folder(folder, "yield", record, force=force) as draft:
        steps = Steps(progress, 3 + 2 * len(drawn))
        write_atomic(draft / "design.toml", text)
        steps.next()
        write_json(draft / "yield.json", record)
        steps.next()
        found.to_csv(draft / "yield.csv")
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_survival(
    found: Survival,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write how many built mechanisms a program works on into a folder, all of it or nothing.

    Args:
        found: what `design.survival` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the design file, to keep beside the result; written anew by default.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: design.toml and survival.json.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    text = design or dumps(found.chain)
    record = survival_record(found, design=text)
    with staged_folder(folder, "yield", record, force=force) as draft:
        write_atomic(draft / "design.toml", text)
        write_json(draft / "survival.json", record)
        return names(draft)


def write_reprogramming(
    found: Reprogramming,
    folder: str | os.PathLike[str],
    *,
    design: str | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write the smallest displacement of an anchor into a folder, all of it or nothing.

    Args:
        found: what `design.reprogram` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        design: text of the design file, for the hash of it; written anew by default.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: reprogram.json; where something was found, way.csv and
        design.toml, the design just past the change.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    record = reprogram_record(found, design=design)
    with staged_folder(folder, "reprogram", record, force=force) as draft:
        write_json(draft / "reprogram.json", record)
        if found.chain_after is not None:
            write_atomic(draft / "design.toml", dumps(found.chain_after))
            found.to_csv(draft / "way.csv")
        return names(draft)
